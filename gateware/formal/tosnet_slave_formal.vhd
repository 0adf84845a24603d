-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of TosNet's commit, with two words for the nodes, a network cycle of five clocks, and a network that comes
-- and goes. A reference follows the writes that were acknowledged to the PC, and swaps its two banks at a commit.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_slave_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    online  : in std_ulogic;
    damaged : in std_ulogic
  );
end entity;

architecture properties of tosnet_slave_formal is

  constant first_address  : natural := 16#40#;
  constant second_address : natural := 16#41#;

  signal s2m              : wishbone_s2m_t;
  signal cycle, committed : std_ulogic;
  signal halted           : std_ulogic;
  signal words            : word_vector_t(0 to 1);
  signal begun            : std_ulogic := '0';

  signal written, asked                 : std_ulogic;  -- a write to the memory, or to the status, was acknowledged
  signal was_online, after_reset        : std_ulogic := '1';
  signal was_words                      : std_ulogic_vector(63 downto 0) := (others => '0');
  signal visible, hidden                : std_ulogic_vector(7 downto 0)  := (others => '0');  -- four bits of each word
  signal now_words                      : std_ulogic_vector(63 downto 0);
  signal pending                        : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  dut : entity work.tosnet_slave
    generic map (
      master_id => 1, nodes => (0 => (id => 2, registers => x"01")), write_addresses => (first_address, second_address),
      read_addresses => (0 => 16#80#), cycle_clocks => 5, whole_memory => false, async_depth => 0)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, cycle => cycle, committed => committed,
      halted => halted, write_words => words, read_words => (0 => x"00000000"), online => online, damaged => damaged,
      to_node_valid => open, to_node_data => open, to_node_last => open, to_node_id => open, from_node_ready => open);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  now_words <= words(0) & words(1);
  written   <= s2m.ack and m2s.we when unsigned(m2s.adr) < tosnet_memory_words_c else '0';
  asked     <= s2m.ack and m2s.we when unsigned(m2s.adr) = tosnet_status_c else '0';

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun       <= '1';
      was_online  <= online;
      after_reset <= reset;
      was_words   <= now_words;
      pending     <= (pending or asked) and not written and not committed;
      if written = '1' and unsigned(m2s.adr) = first_address then
        hidden(7 downto 4) <= m2s.dat(3 downto 0);
      elsif written = '1' and unsigned(m2s.adr) = second_address then
        hidden(3 downto 0) <= m2s.dat(3 downto 0);
      elsif committed = '1' then
        visible <= hidden;
        hidden  <= visible;
      end if;
      if reset = '1' then
        pending <= '0';
        visible <= (others => '0');
        hidden  <= (others => '0');
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no access during power-up.
  quiet_first : assume always begun = '1' or m2s.stb = '0';

  -- The PC waits for the answer to each access.
  patient : assume always m2s.stb = '1' and s2m.ack = '0' and s2m.err = '0' and reset = '0' -> next (m2s.stb = '1');

  -- The words of the nodes change together, and only in the clock of a commit.
  change_together : assert always begun = '0' or after_reset = '1' or committed = '1' or now_words = was_words;

  -- The nodes see the words of the last commit: all that the PC wrote before it, and nothing that the PC wrote after
  -- it. Four bits of each word are followed.
  words_are_committed : assert always begun = '0' or after_reset = '1' or
                        was_words(35 downto 32) & was_words(3 downto 0) = visible;

  -- A commit takes effect at the end of a cycle exactly if the network is there and a commit waits. A later write
  -- aborts a waiting commit.
  commits_when_asked : assert always begun = '0' or after_reset = '1' or
                       committed = (cycle and was_online and (pending or asked) and not written);

  -- After a reset the nodes see zeros.
  reset_is_zero : assert always reset = '1' -> next (words(0) = x"00000000" and words(1) = x"00000000");

  -- A commit takes effect.
  commit_seen : cover {committed = '1' and hidden = x"A5"};

  -- A write aborts a commit.
  abort_seen : cover {pending = '1' and written = '1'};

end architecture;
