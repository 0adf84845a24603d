-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the interconnect: two slaves on aligned ranges, one on an unaligned range, a hole, and all other
-- addresses.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.address_map_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_interconnect_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s   : in wishbone_m2s_t;
    s2m_0 : in wishbone_s2m_t;
    s2m_1 : in wishbone_s2m_t;
    s2m_2 : in wishbone_s2m_t
  );
end entity;

architecture properties of wishbone_interconnect_formal is

  constant address_map : address_map_t(0 to 2) := (
    0 => (base => x"00000000", words => 8),
    1 => (base => x"00000010", words => 4),
    2 => (base => x"0000001A", words => 3));

  signal s2m        : wishbone_s2m_t;
  signal slaves_m2s : wishbone_m2s_vector_t(0 to 2);
  signal slaves_s2m : wishbone_s2m_vector_t(0 to 2);

  -- The addressed slave, straight from the map.
  signal address   : unsigned(31 downto 0);
  signal meant     : std_ulogic_vector(0 to 2);
  signal strobes   : std_ulogic_vector(0 to 2);
  signal cycles    : std_ulogic_vector(0 to 2);
  signal inner     : unsigned(31 downto 0);      -- the address that this slave must get
  signal received  : unsigned(31 downto 0);      -- the address that it gets
  signal answer    : wishbone_s2m_t;             -- the answer of this slave

begin

  default clock is rising_edge(clk);

  dut : entity work.wishbone_interconnect
    generic map (address_map => address_map)
    port map (master_m2s => m2s, master_s2m => s2m, slaves_m2s => slaves_m2s, slaves_s2m => slaves_s2m);

  slaves_s2m <= (0 => s2m_0, 1 => s2m_1, 2 => s2m_2);

  master : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);
  slaves : for slave in 0 to 2 generate
    each : entity work.wishbone_master_view
      port map (clk => clk, reset => reset, m2s => slaves_m2s(slave), s2m => slaves_s2m(slave));
    strobes(slave) <= slaves_m2s(slave).stb;
    cycles(slave)  <= slaves_m2s(slave).cyc;
  end generate;

  address  <= unsigned(m2s.adr);
  meant(0) <= '1' when address < 8 else '0';
  meant(1) <= '1' when address >= 16 and address < 20 else '0';
  meant(2) <= '1' when address >= 26 and address < 29 else '0';

  pick : process (all) is
  begin
    inner    <= address;
    received <= unsigned(slaves_m2s(0).adr);
    answer   <= s2m_0;
    if meant(1) = '1' then
      inner    <= address - 16;
      received <= unsigned(slaves_m2s(1).adr);
      answer   <= s2m_1;
    elsif meant(2) = '1' then
      inner    <= address - 26;
      received <= unsigned(slaves_m2s(2).adr);
      answer   <= s2m_2;
    end if;
  end process;

  -- Only the slave at the address is asked.
  one_is_asked : assert always m2s.stb = '0' or strobes = meant;

  -- No slave is asked without a strobe.
  none_unasked : assert always m2s.stb = '1' or strobes = "000";

  -- The slave gets an address of its own range, from 0 on.
  own_address : assert always meant = "000" or received = inner;

  -- The answer of the slave comes back in the same clock.
  answer_comes_back : assert always m2s.stb = '0' or meant = "000" or
                      (s2m.ack = answer.ack and s2m.err = answer.err and s2m.dat = answer.dat);

  -- An address without a slave is refused at once.
  unmapped_is_refused : assert always m2s.stb = '0' or meant /= "000" or (s2m.err = '1' and s2m.ack = '0');

  -- Every slave sees the bus cycle.
  cycle_for_all : assert always cycles = (0 to 2 => m2s.cyc);

  -- An access goes to the unaligned range.
  unaligned : cover {m2s.stb = '1' and meant(2) = '1' and s2m.ack = '1'};

  -- An access goes to an address outside all ranges.
  beside : cover {m2s.stb = '1' and s2m.err = '1' and s2m_0.err = '0' and s2m_1.err = '0' and s2m_2.err = '0'};

end architecture;
