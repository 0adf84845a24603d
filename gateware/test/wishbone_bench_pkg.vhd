-- SPDX-License-Identifier: BSD-3-Clause
--
-- A Wishbone master as procedures. An access that does not end within `access_clocks_most` fails the bench. With `keep`
-- it leaves cyc high, as inside a block.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_pkg.all;

package wishbone_bench_pkg is

  constant access_clocks_most : positive := 64;

  type bus_answer_t is record
    word    : std_ulogic_vector(31 downto 0);
    refused : boolean;
    clocks  : positive;
  end record;

  -- One access, which the slave may refuse.
  procedure bus_access (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    we           : in  std_ulogic;
    address      : in  unsigned(31 downto 0);
    data         : in  std_ulogic_vector(31 downto 0);
    answer       : out bus_answer_t;
    keep         : in  boolean := false;
    sel          : in  std_ulogic_vector(3 downto 0) := "1111"
  );

  -- A write and a read, which the slave may refuse.
  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  std_ulogic_vector(31 downto 0);
    answer       : out bus_answer_t;
    keep         : in  boolean := false
  );

  procedure bus_read (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    answer       : out bus_answer_t;
    keep         : in  boolean := false
  );

  -- A write that must not be refused.
  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  std_ulogic_vector(31 downto 0);
    keep         : in  boolean := false
  );

  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  natural
  );

  -- A read that must not be refused, and must give this word.
  procedure bus_expect (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    expected     : in  std_ulogic_vector(31 downto 0);
    keep         : in  boolean := false
  );

  procedure bus_expect (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    expected     : in  natural;
    keep         : in  boolean := false
  );

  -- A write or a read that must be refused.
  procedure bus_refuse (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    we           : in  std_ulogic;
    address      : in  natural;
    what         : in  string;
    data         : in  std_ulogic_vector(31 downto 0) := x"00000001";
    sel          : in  std_ulogic_vector(3 downto 0)  := "1111"
  );

end package;

package body wishbone_bench_pkg is

  procedure bus_access (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    we           : in  std_ulogic;
    address      : in  unsigned(31 downto 0);
    data         : in  std_ulogic_vector(31 downto 0);
    answer       : out bus_answer_t;
    keep         : in  boolean := false;
    sel          : in  std_ulogic_vector(3 downto 0) := "1111"
  ) is
  begin
    m2s <= (cyc => '1', stb => '1', we => we, adr => std_ulogic_vector(address), dat => data, sel => sel);
    for count in 1 to access_clocks_most loop
      wait until rising_edge(clock);
      if s2m.ack = '1' or s2m.err = '1' then
        answer  := (word => s2m.dat, refused => s2m.err = '1', clocks => count);
        m2s     <= wishbone_m2s_idle;
        m2s.cyc <= '1' when keep else '0';
        return;
      end if;
    end loop;
    report "an access to x" & to_hstring(std_ulogic_vector(address)) & " did not end"
      severity failure;
  end procedure;

  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  std_ulogic_vector(31 downto 0);
    answer       : out bus_answer_t;
    keep         : in  boolean := false
  ) is
  begin
    bus_access(clock, m2s, s2m, '1', to_unsigned(address, 32), data, answer, keep);
  end procedure;

  procedure bus_read (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    answer       : out bus_answer_t;
    keep         : in  boolean := false
  ) is
  begin
    bus_access(clock, m2s, s2m, '0', to_unsigned(address, 32), x"00000000", answer, keep);
  end procedure;

  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  std_ulogic_vector(31 downto 0);
    keep         : in  boolean := false
  ) is
    variable answer : bus_answer_t;
  begin
    bus_write(clock, m2s, s2m, address, data, answer, keep);
    check(not answer.refused, "a write of " & integer'image(address) & " was refused");
  end procedure;

  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  natural
  ) is
  begin
    bus_write(clock, m2s, s2m, address, std_ulogic_vector(to_unsigned(data, 32)));
  end procedure;

  procedure bus_expect (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    expected     : in  std_ulogic_vector(31 downto 0);
    keep         : in  boolean := false
  ) is
    variable answer : bus_answer_t;
  begin
    bus_read(clock, m2s, s2m, address, answer, keep);
    check(not answer.refused, "a read of " & integer'image(address) & " was refused");
    check_equal(answer.word, expected, "word " & integer'image(address));
  end procedure;

  procedure bus_expect (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    expected     : in  natural;
    keep         : in  boolean := false
  ) is
  begin
    bus_expect(clock, m2s, s2m, address, std_ulogic_vector(to_unsigned(expected, 32)), keep);
  end procedure;

  procedure bus_refuse (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    we           : in  std_ulogic;
    address      : in  natural;
    what         : in  string;
    data         : in  std_ulogic_vector(31 downto 0) := x"00000001";
    sel          : in  std_ulogic_vector(3 downto 0)  := "1111"
  ) is
    variable answer : bus_answer_t;
  begin
    bus_access(clock, m2s, s2m, we, to_unsigned(address, 32), data, answer, sel => sel);
    check(answer.refused, what & " was not refused");
  end procedure;

end package body;
