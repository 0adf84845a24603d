-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the double buffer. A reference follows any one word in both banks, and swaps them at a commit. The word
-- may be any, so all words change in the same clock, and a reader never gets words of two moments.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity double_buffer_slave_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    watched : in natural range 0 to 1;  -- the word that is followed
    user_read_address  : in natural range 0 to 1;
    user_write_valid   : in std_ulogic;
    user_write_address : in natural range 0 to 1;
    user_write_data    : in std_ulogic_vector(7 downto 0)
  );
end entity;

architecture properties of double_buffer_slave_formal is

  constant words : positive := 2;

  signal s2m              : wishbone_s2m_t;
  signal committed        : std_ulogic;
  signal user_read_data   : std_ulogic_vector(7 downto 0);
  signal user_write_ready : std_ulogic;
  signal begun, asked     : std_ulogic := '0';
  signal answered, whole  : std_ulogic;

  signal visible, hidden  : std_ulogic_vector(7 downto 0) := (others => '0');  -- expected values of the followed word
  signal commits          : unsigned(7 downto 0) := (others => '0');
  signal bus_expected     : std_ulogic_vector(7 downto 0) := (others => '0');  -- what the access must read
  signal user_expected    : std_ulogic_vector(7 downto 0) := (others => '0');
  signal user_reads       : std_ulogic := '0';  -- a read of that word
  signal swaps            : std_ulogic := '0';  -- `committed` must be high

begin

  default clock is rising_edge(clk);

  dut : entity work.double_buffer_slave
    generic map (words => words, data_width => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, committed => committed,
      user_read_address => user_read_address, user_read_data => user_read_data,
      user_write_valid => user_write_valid, user_write_ready => user_write_ready,
      user_write_address => user_write_address, user_write_data => user_write_data);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  answered <= s2m.ack or s2m.err;
  whole    <= m2s.sel(0);

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun      <= '1';
      asked      <= m2s.stb and not answered and not reset;
      swaps      <= '0';
      user_reads <= '0';
      if user_read_address = watched then
        user_reads    <= '1';
        user_expected <= visible;
      end if;
      if m2s.stb = '1' and answered = '0' then
        bus_expected <= visible;
        if unsigned(m2s.adr) = words then
          bus_expected <= std_ulogic_vector(commits);
        end if;
        if m2s.we = '1' and whole = '1' and unsigned(m2s.adr) = watched then
          hidden <= m2s.dat(7 downto 0);
        elsif m2s.we = '1' and whole = '1' and unsigned(m2s.adr) = words then
          visible <= hidden;
          hidden  <= visible;
          commits <= commits + 1;
          swaps   <= '1';
        end if;
      elsif user_write_valid = '1' and user_write_ready = '1' and user_write_address = watched then
        visible <= user_write_data;
      end if;
      if reset = '1' then
        commits <= (others => '0');
        swaps   <= '0';
      end if;
    end if;
  end process;

  -- One reset, at power-up. A later reset makes the first bank visible and keeps both banks. That is no commit, so this
  -- file excludes it.
  reset_first : assume always begun /= reset;

  -- There is no access during power-up.
  quiet_first : assume always begun = '1' or (m2s.cyc = '0' and user_write_valid = '0');

  -- The followed word is any, and stays the same.
  one_is_watched : assume always reset = '0' or reset = '1' -> next (watched = prev(watched));

  -- The FPGA reads the word that was visible when it asked. All words change with the commit and not before.
  user_never_mixed : assert always begun = '0' or user_reads = '0' or user_read_data = user_expected;

  -- The bus also reads such words, and the number of their commits.
  bus_never_mixed : assert always begun = '0' or s2m.ack = '0' or m2s.we = '1' or
                    (unsigned(m2s.adr) /= watched and unsigned(m2s.adr) /= words) or s2m.dat(7 downto 0) = bus_expected;

  -- Each commit is reported to the FPGA, in the first clock in which its reads see it.
  commit_is_told : assert always begun = '0' or committed = swaps;

  -- The FPGA writes nothing during a block of the bus, so the block sees one moment.
  block_sees_one_moment : assert always m2s.cyc = '0' or user_write_ready = '0';

  -- An address out of range, or a write of part of a word, is refused and changes nothing.
  refused_rightly : assert always answered = '0' or
                    (s2m.err = '1') = (unsigned(m2s.adr) > words or (m2s.we = '1' and whole = '0'));

  -- An access takes two clocks.
  two_clocks : assert always asked = '0' or m2s.stb = '0' or answered = '1';

  -- A word from the PC becomes visible to the FPGA.
  seen_by_user : cover {user_reads = '1' and user_read_data = x"A5" and commits = 1};

  -- A word from the FPGA is read by the bus after a commit.
  seen_by_bus : cover {s2m.ack = '1' and m2s.we = '0' and unsigned(m2s.adr) = watched and
                       s2m.dat(7 downto 0) = x"5A" and commits = 1};

end architecture;
