-- SPDX-License-Identifier: BSD-3-Clause
--
-- Shared by all benches: seeded random numbers, and checks that name the difference.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;

package bench_pkg is

  -- Random numbers from one seed. Every process has its own.
  type random_t is protected
    procedure seed (value : positive);
    impure function integer_between (first : integer; last : integer) return integer;
    impure function vector (width : positive) return std_ulogic_vector;
    impure function chance (percent : natural) return boolean;
  end protected;

  procedure check_equal (got : std_ulogic_vector; expected : std_ulogic_vector; what : string);
  procedure check_equal (got : integer; expected : integer; what : string);
  procedure check_equal (got : std_ulogic; expected : std_ulogic; what : string);
  procedure check (condition : boolean; what : string);

  -- The runner accepts a bench only if it prints this.
  procedure wait_clocks (signal clock : in std_ulogic; count : natural);
  procedure report_passed (bench : string);

end package;

package body bench_pkg is

  type random_t is protected body
    variable seed_1 : positive := 1;
    variable seed_2 : positive := 1;

    procedure seed (value : positive) is
    begin
      seed_1 := value;
      seed_2 := 7919;
    end procedure;

    impure function integer_between (first : integer; last : integer) return integer is
      variable number : real;
    begin
      uniform(seed_1, seed_2, number);
      return first + integer(floor(number * (real(last) - real(first) + 1.0)));
    end function;

    impure function vector (width : positive) return std_ulogic_vector is
      variable result : std_ulogic_vector(width - 1 downto 0);
    begin
      for index in result'range loop
        result(index) := '1' when integer_between(0, 1) = 1 else '0';
      end loop;
      return result;
    end function;

    impure function chance (percent : natural) return boolean is
    begin
      return integer_between(0, 99) < percent;
    end function;
  end protected body;

  procedure check_equal (got : std_ulogic_vector; expected : std_ulogic_vector; what : string) is
  begin
    assert got = expected
      report what & ": got x" & to_hstring(got) & ", expected x" & to_hstring(expected)
      severity error;
  end procedure;

  procedure check_equal (got : integer; expected : integer; what : string) is
  begin
    assert got = expected
      report what & ": got " & integer'image(got) & ", expected " & integer'image(expected)
      severity error;
  end procedure;

  procedure check_equal (got : std_ulogic; expected : std_ulogic; what : string) is
  begin
    assert got = expected
      report what & ": got " & std_ulogic'image(got) & ", expected " & std_ulogic'image(expected)
      severity error;
  end procedure;

  procedure check (condition : boolean; what : string) is
  begin
    assert condition
      report what
      severity error;
  end procedure;

  procedure wait_clocks (signal clock : in std_ulogic; count : natural) is
  begin
    for number in 1 to count loop
      wait until rising_edge(clock);
    end loop;
  end procedure;

  procedure report_passed (bench : string) is
  begin
    report bench & ": passed"
      severity note;
  end procedure;

end package body;
