-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the memory on the bus. Any one of its words is followed.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity wishbone_memory_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    watched : in natural range 0 to 3  -- address of the followed word
  );
end entity;

architecture properties of wishbone_memory_formal is

  signal s2m      : wishbone_s2m_t;
  signal begun    : std_ulogic := '0';
  signal expected : std_ulogic_vector(7 downto 0) := (others => '0');
  signal answered : std_ulogic;
  signal asked    : std_ulogic := '0';  -- there was an access in the clock before

begin

  default clock is rising_edge(clk);

  dut : entity work.wishbone_memory
    generic map (words => 4, data_width => 8)
    port map (clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  answered <= s2m.ack or s2m.err;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      asked <= m2s.stb and not answered and not reset;
      -- The word changes with the strobe, one clock before the acknowledge.
      if m2s.stb = '1' and m2s.we = '1' and answered = '0' and unsigned(m2s.adr) = watched then
        expected <= m2s.dat(7 downto 0);
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no strobe during power-up: the reset drops such an access, but the memory would not.
  quiet_first : assume always begun = '1' or m2s.stb = '0';

  -- The followed word is any, and stays the same.
  one_is_watched : assume always reset = '0' or reset = '1' -> next (watched = prev(watched));

  -- A read gives the word that was written last.
  reads_back : assert always begun = '0' or s2m.ack = '0' or m2s.we = '1' or unsigned(m2s.adr) /= watched or
               s2m.dat(7 downto 0) = expected;

  -- An address within the memory is never refused.
  only_beyond_refused : assert always s2m.err = '1' -> unsigned(m2s.adr) >= 4;

  -- An address beyond the memory is never accepted.
  beyond_is_refused : assert always s2m.ack = '1' -> unsigned(m2s.adr) < 4;

  -- An access takes two clocks.
  two_clocks : assert always asked = '0' or m2s.stb = '0' or answered = '1';

  -- A word that was written is read.
  read_seen : cover {s2m.ack = '1' and m2s.we = '0' and unsigned(m2s.adr) = watched and expected = x"5A"};

end architecture;
