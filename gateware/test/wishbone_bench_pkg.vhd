-- SPDX-License-Identifier: BSD-3-Clause
--
-- A Wishbone master as procedures. An access that does not end within `access_clocks_most` fails the bench.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_pkg.all;

package wishbone_bench_pkg is

  constant access_clocks_most : positive := 20;

  -- One access. `keep` leaves cyc high, as inside a block.
  procedure bus_access (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    we           : in  std_ulogic;
    address      : in  unsigned(31 downto 0);
    data         : in  std_ulogic_vector(31 downto 0);
    sel          : in  std_ulogic_vector(3 downto 0);
    keep         : in  boolean;
    word         : out std_ulogic_vector(31 downto 0);
    refused      : out boolean;
    clocks       : out positive
  );

  -- A single access to a whole word, which must not be refused.
  procedure bus_write (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    data         : in  std_ulogic_vector(31 downto 0)
  );

  procedure bus_read (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    word         : out std_ulogic_vector(31 downto 0)
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
    sel          : in  std_ulogic_vector(3 downto 0);
    keep         : in  boolean;
    word         : out std_ulogic_vector(31 downto 0);
    refused      : out boolean;
    clocks       : out positive
  ) is
  begin
    m2s <= (cyc => '1', stb => '1', we => we, adr => std_ulogic_vector(address), dat => data, sel => sel);
    for count in 1 to access_clocks_most loop
      wait until rising_edge(clock);
      if s2m.ack = '1' or s2m.err = '1' then
        word    := s2m.dat;
        refused := s2m.err = '1';
        clocks  := count;
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
    data         : in  std_ulogic_vector(31 downto 0)
  ) is
    variable word    : std_ulogic_vector(31 downto 0);
    variable refused : boolean;
    variable clocks  : positive;
  begin
    bus_access(clock, m2s, s2m, '1', to_unsigned(address, 32), data, "1111", false, word, refused, clocks);
    check(not refused, "a write to " & integer'image(address) & " was refused");
  end procedure;

  procedure bus_read (
    signal clock : in  std_ulogic;
    signal m2s   : out wishbone_m2s_t;
    signal s2m   : in  wishbone_s2m_t;
    address      : in  natural;
    word         : out std_ulogic_vector(31 downto 0)
  ) is
    variable refused : boolean;
    variable clocks  : positive;
  begin
    bus_access(clock, m2s, s2m, '0', to_unsigned(address, 32), x"00000000", "1111", false, word, refused, clocks);
    check(not refused, "a read of " & integer'image(address) & " was refused");
  end procedure;

end package body;
