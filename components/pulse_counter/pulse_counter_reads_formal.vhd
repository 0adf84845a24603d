-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of what the bus reads of the words of pulse_counter, with 8 bits. The words that are written may be
-- anything. One word is followed, and the solver chooses which.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity pulse_counter_reads_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    m2s      : in wishbone_m2s_t;
    followed : in unsigned(1 downto 0); -- the address of the word
    round    : in unsigned(3 downto 0); -- shows the clock in a round, as all of these show signals of the design
    starting : in std_ulogic;           -- the first round
    sum      : in unsigned(7 downto 0); -- the word of a turn
    reads    : in std_ulogic;           -- the bus does
    bank     : in unsigned(1 downto 0); -- that is written
    whole    : in unsigned(1 downto 0); -- of the last whole round
    shown    : in unsigned(1 downto 0)  -- to the bus
  );
end entity;

architecture properties of pulse_counter_reads_formal is

  subtype byte_t is unsigned(7 downto 0);

  signal s2m      : wishbone_s2m_t;
  signal begun    : std_ulogic := '0';
  signal reset_1  : std_ulogic := '1';
  signal asked    : std_ulogic := '0';
  signal chosen   : unsigned(1 downto 0) := "00";
  signal sum_1    : byte_t := (others => '0');
  signal round_1  : unsigned(3 downto 0) := (others => '0');
  signal writes   : std_ulogic;                      -- the word that is followed
  signal written  : byte_t := (others => '0');       -- in this round
  signal last     : byte_t := (others => '0');       -- in the last whole round
  signal frozen   : byte_t := (others => '0');       -- the one for the bus
  signal closed   : std_ulogic := '1';
  signal thawed   : std_ulogic := '0';               -- a write was answered in this cycle of the bus
  signal expected : byte_t := (others => '0');
  signal is_read  : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  dut : entity work.pulse_counter
    generic map (clock_hz => 1_000_000, filter_ns => 0, time_hz => 64_000, timeout_ms => 1, data_width => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, counted => open, stopped => open,
      count_wire => open, frequency_wire => open, line => '0');

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  writes <= '1' when round = '0' & chosen & '1' else '0';

  follow : process (clk) is
    variable thaws : std_ulogic;
  begin
    if rising_edge(clk) then
      begun   <= '1';
      reset_1 <= reset;
      asked   <= m2s.stb and not s2m.ack and not s2m.err and not reset;
      chosen  <= followed;
      sum_1   <= sum;
      round_1 <= round;

      if writes = '1' then
        written <= sum;
      end if;
      if round = 15 then
        last <= written;
      end if;
      thaws  := thawed or (s2m.ack and m2s.we);
      thawed <= m2s.cyc and thaws;
      closed <= starting;
      if m2s.cyc = '0' or thaws = '1' or closed = '1' then
        frozen <= last;
      end if;
      expected <= frozen;
      is_read  <= '0';
      if m2s.stb = '1' and m2s.we = '0' and unsigned(m2s.adr) = chosen and reset = '0' then
        is_read <= '1';
      end if;

      if reset = '1' then
        closed <= '1';
        thawed <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always asked = '1' -> m2s.cyc = '1';

  -- The word that is followed stays the same.
  one_word : assume always begun = '1' -> followed = chosen;

  -- The word of a turn stands in the clock behind its second one, too.
  sum_stands : assume always begun = '1' and round(0) = '0' and round = round_1 + 1 -> sum = sum_1;

  -- A read gives the word of the last round that had ended when cyc rose, or when the last write was answered. So all
  -- words of a block are of one moment, and no read comes between the two halves of an update.
  read_is_right : assert always begun = '1' and reset_1 = '0' and is_read = '1' and s2m.ack = '1' ->
                           unsigned(s2m.dat(byte_t'range)) = expected;

  -- The bank that is written is neither that of the bus nor that of the last round.
  banks_apart : assert always begun = '1' -> bank /= shown and (bank /= whole or round = 0) and shown /= "00" and
                              whole /= "00";

  -- The bus reads a word that was written twice since then.
  old_seen : cover {begun = '1' and reads = '1' and frozen = 1 and last = 2 and written = 3};

end architecture;
