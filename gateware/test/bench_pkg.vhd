-- SPDX-License-Identifier: BSD-3-Clause
--
-- Shared by all benches: seeded random numbers, checks that name the difference, steps of a clock, bytes as text, and
-- the watchdog.

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

  -- Waits for so many rising edges. `tick` then waits until what changes at the last of them has settled.
  procedure wait_clocks (signal clock : in std_ulogic; count : natural);
  procedure tick (signal clock : in std_ulogic; count : natural := 1);

  -- Waits for a random number of clocks, which may be none: after each of them another one follows with this chance.
  procedure pause (signal clock : in std_ulogic; variable random : inout random_t; percent : natural);

  -- Sets `what` for one clock.
  procedure pulse (signal clock : in std_ulogic; signal what : out std_ulogic);

  -- Offers one word of a stream until it is taken.
  procedure send (
    signal clock : in  std_ulogic;
    signal valid : out std_ulogic;
    signal ready : in  std_ulogic;
    signal data  : out std_ulogic_vector;
    word         : in  std_ulogic_vector
  );

  function byte_of (c : character) return std_ulogic_vector;
  function character_of (byte : std_ulogic_vector(7 downto 0)) return character;

  -- The value of a hexadecimal digit, in upper or lower case.
  function digit_value (c : character) return natural;

  -- The runner accepts a bench only if it prints this.
  procedure report_passed (bench : string);

  -- Stops a bench that has not ended in time. It is called as a concurrent statement.
  procedure watchdog (signal ended : in boolean; limit : time; bench : string);

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

  procedure tick (signal clock : in std_ulogic; count : natural := 1) is
  begin
    wait_clocks(clock, count);
    wait for 1 ps;
  end procedure;

  procedure pause (signal clock : in std_ulogic; variable random : inout random_t; percent : natural) is
  begin
    while random.chance(percent) loop
      wait until rising_edge(clock);
    end loop;
  end procedure;

  procedure pulse (signal clock : in std_ulogic; signal what : out std_ulogic) is
  begin
    what <= '1';
    wait_clocks(clock, 1);
    what <= '0';
    wait for 1 ps;
  end procedure;

  procedure send (
    signal clock : in  std_ulogic;
    signal valid : out std_ulogic;
    signal ready : in  std_ulogic;
    signal data  : out std_ulogic_vector;
    word         : in  std_ulogic_vector
  ) is
  begin
    valid <= '1';
    data  <= word;
    wait until rising_edge(clock) and ready = '1';
    valid <= '0';
  end procedure;

  function byte_of (c : character) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned(character'pos(c), 8));
  end function;

  function character_of (byte : std_ulogic_vector(7 downto 0)) return character is
  begin
    return character'val(to_integer(unsigned(byte)));
  end function;

  function digit_value (c : character) return natural is
  begin
    case c is
      when '0' to '9' => return character'pos(c) - character'pos('0');
      when 'A' to 'F' => return character'pos(c) - character'pos('A') + 10;
      when 'a' to 'f' => return character'pos(c) - character'pos('a') + 10;
      when others =>
        report "not a hexadecimal digit: " & c severity failure;
        return 0;
    end case;
  end function;

  procedure report_passed (bench : string) is
  begin
    report bench & ": passed"
      severity note;
  end procedure;

  procedure watchdog (signal ended : in boolean; limit : time; bench : string) is
  begin
    wait until ended for limit;
    assert ended
      report bench & ": not done in time"
      severity failure;
    wait;
  end procedure;

end package body;
