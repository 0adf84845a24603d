-- SPDX-License-Identifier: BSD-3-Clause
--
-- Several incremental encoders on the Wishbone bus that share one adder. Their positions and levels are in block RAM.
--
--   a  __/‾‾‾\___/‾‾‾\__        a before b counts up, four counts per period
--   b  ____/‾‾‾\___/‾‾‾\
--
--   +n             position of channel n, two's complement; wraps at the word       write: preset
--   +channels + n  impossible steps of channel n: both levels changed at once;
--                  12 bits, wraps                                                   write: sets the number
--
-- Rounds    A round of two clocks for each channel serves them one after the other. (3 channels take the time of 4, and
--           5 to 7 that of 8.) So the lines are sampled once in a round: 8 channels each 16 clocks, 32 each 64 clocks.
-- Filter    A level counts when two samples in a row have it. Samples are filter_ns apart, rounded up to whole rounds
--           and at least one. Below, this is the sample time.
-- Speed     At most one step in a sample time, and a level must last two of them. Faster steps are counted as
--           impossible, and the position is then wrong. 8 channels at 50 MHz have 3.1 million counts a second.
-- Reads     give the words of the last round that had ended when cyc rose. So all channels are of one moment, to a
--           round, in a block of accesses as well. A write thaws the words until cyc falls.
-- Preset    loses no step: a step counts before it or after it.
-- Event     failed: an impossible step of any channel.
-- Memory    Four banks: a round reads one and writes another one, and the bus reads a third one while it is frozen.
-- Latency   2 clocks for a read. A write is acknowledged at the end of the round that took it, after at most 2 rounds.
--           Then it can be read. The position follows the pins by at most two sample times, 2 rounds, and 3 clocks.
-- Errors    err for addresses from 2 * channels on, and for writes that do not select all bytes.
-- Reset     All words are zero. The levels of the pins in the first round behind it are not counted as a step. The
--           first access waits until that round has ended.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity encoder_bank is
  generic (
    clock_hz   : positive                := 50_000_000;
    channels   : positive range 2 to 32  := 8;
    filter_ns  : natural range 0 to 2000 := 0;
    data_width : positive range 12 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    failed       : out std_ulogic;

    a : in std_ulogic_vector(channels - 1 downto 0); -- asynchronous, like the next one
    b : in std_ulogic_vector(channels - 1 downto 0)
  );
end entity;

architecture rtl of encoder_bank is

  constant turn_bits    : positive := bits_for(channels);
  constant round_clocks : positive := 2 ** (turn_bits + 1);
  constant fault_bits   : positive := 12;
  constant rounds_apart : positive := (clocks_lasting(filter_ns, clock_hz) + round_clocks - 1) / round_clocks;

  subtype word_t is unsigned(data_width - 1 downto 0);
  subtype faults_t is unsigned(fault_bits - 1 downto 0);
  subtype lines_t is std_ulogic_vector(1 downto 0);   -- b, a
  subtype turn_t is unsigned(turn_bits - 1 downto 0); -- a channel
  subtype count_t is unsigned(turn_bits downto 0);    -- of the clocks of a round
  subtype bank_t is unsigned(1 downto 0);             -- never "00"
  subtype place_t is unsigned(turn_bits + 1 downto 0);

  -- What the memory holds of a channel: position, impossible steps, levels, and the last sample.
  subtype state_t is std_ulogic_vector(data_width + fault_bits + 3 downto 0);
  subtype position_c is natural range data_width + fault_bits + 3 downto fault_bits + 4;
  subtype faults_c is natural range fault_bits + 3 downto 4;
  subtype levels_c is natural range 3 downto 2;
  subtype sample_c is natural range 1 downto 0;
  subtype shown_t is std_ulogic_vector(data_width + fault_bits - 1 downto 0);
  type memory_t is array (0 to 4 * 2 ** turn_bits - 1) of state_t;
  type bus_memory_t is array (0 to 4 * 2 ** turn_bits - 1) of shown_t;

  -- Both hold the same, but for the levels. A memory is never read and written at once: what such a read gives depends
  -- on the chip.
  signal memory     : memory_t     := (others => (others => '0'));
  signal bus_memory : bus_memory_t := (others => (others => '0'));

  -- The rounds.
  signal count    : count_t := (others => '0');
  signal turn     : turn_t;                     -- the channel whose state is read
  signal second   : std_ulogic;                 -- the second clock of its turn
  signal last     : std_ulogic;                 -- the last clock of a round
  signal rounds   : natural range 0 to rounds_apart - 1 := 0; -- since the last one with samples
  signal samples  : std_ulogic;                 -- this round has samples
  signal starting : std_ulogic := '1';          -- the first round after a reset
  signal whole    : bank_t := "01";             -- of the last whole round
  signal bank     : bank_t := "10";             -- of this round
  signal shown    : bank_t := "01";             -- for the bus

  -- A channel: its turn reads, and the next turn writes.
  signal lines, settled   : std_ulogic_vector(2 * channels - 1 downto 0); -- b and a of each channel
  signal sample           : lines_t := "00";
  signal known            : state_t := (others => '0');   -- the state that was read
  signal base, sum        : word_t := (others => '0');
  signal faults, fault_sum : faults_t := (others => '0');
  signal levels, newest   : lines_t := "00";              -- to be written
  signal steps, down, fails : std_ulogic := '0';
  signal place            : place_t := (others => '0');   -- where

  -- The bus.
  signal asked, exists, is_faults, takes, reads, hit, done : std_ulogic;
  signal channel           : unsigned(turn_bits downto 0); -- that is accessed
  signal ack, err, put     : std_ulogic := '0';
  signal thawed            : std_ulogic := '0';
  signal closed            : std_ulogic := '1';            -- no word can be shown yet
  signal found             : shown_t := (others => '0');

begin

  pair : for number in 0 to channels - 1 generate
    lines(2 * number + 1 downto 2 * number) <= b(number) & a(number);
  end generate;

  pins_synchroniser : entity work.synchroniser
    generic map (width => 2 * channels)
    port map (clock => clock, asynchronous => lines, levels => settled);

  -- The bus.
  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not closed;
  exists    <= '1' when unsigned(wishbone_m2s.adr) < 2 * channels else '0';
  is_faults <= '1' when unsigned(wishbone_m2s.adr(turn_bits downto 0)) >= channels else '0';
  channel   <= unsigned(wishbone_m2s.adr(turn_bits downto 0)) - channels when is_faults = '1' else
               unsigned(wishbone_m2s.adr(turn_bits downto 0));
  takes     <= '1' when exists = '1' and wishbone_m2s.sel = (wishbone_m2s.sel'range => '1') else '0';
  reads     <= asked and not wishbone_m2s.we;
  hit       <= '1' when asked = '1' and wishbone_m2s.we = '1' and takes = '1' and second = '1' and
                        channel = turn else '0';
  done      <= asked and (put or hit);

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack    <= (reads and exists) or (done and last);
      err    <= asked and ((not exists and not wishbone_m2s.we) or (not takes and wishbone_m2s.we));
      put    <= done and not last;
      thawed <= wishbone_m2s.cyc and (thawed or (done and last));
      if reads = '1' then
        found <= bus_memory(to_integer(shown & channel(turn_t'range)));
      end if;
      -- The sum stands for two clocks. In one of them the bus does not read. Not an `else` of the line above: GHDL 2.0
      -- synthesises its condition without the `not`.
      if reads = '0' then
        bus_memory(to_integer(place)) <= std_ulogic_vector(sum & fault_sum);
      end if;

      if reset = '1' then
        ack <= '0';
        err <= '0';
        put <= '0';
      end if;
    end if;
  end process;

  reply : process (all) is
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.dat(data_width - 1 downto 0) <= found(found'high downto fault_bits);
    if is_faults = '1' then
      wishbone_s2m.dat                          <= (others => '0');
      wishbone_s2m.dat(fault_bits - 1 downto 0) <= found(fault_bits - 1 downto 0);
    end if;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
  end process;

  -- The rounds. In its first clock a turn reads. What it has found is there in the two clocks of the next turn.
  turn    <= count(count'high downto 1);
  second  <= count(0);
  last    <= and count;
  samples <= '1' when rounds = 0 else '0';

  sum       <= base + unsigned(resize(signed'(down & steps), data_width));
  fault_sum <= faults + unsigned'("" & fails);

  run : process (clock) is
    variable was, before, now : lines_t; -- the levels, the last sample, and the levels from now on
    variable changed          : lines_t;
    variable both             : std_ulogic_vector(2 ** (turn_bits + 1) - 1 downto 0);
  begin
    if rising_edge(clock) then
      count  <= count + 1;
      failed <= '0';
      if second = '0' then
        known  <= memory(to_integer(whole & turn));
        both   := (others => '0');
        both(settled'range) := settled;
        sample <= both(2 * to_integer(turn) + 1 downto 2 * to_integer(turn));
      end if;
      if second = '1' then
        memory(to_integer(place)) <= std_ulogic_vector(sum & fault_sum) & levels & newest;
      end if;

      if second = '1' then
        was    := known(levels_c);
        before := known(sample_c);
        now    := was;
        for line in lines_t'range loop
          if samples = '1' and sample(line) = before(line) then
            now(line) := sample(line);
          end if;
        end loop;
        changed := now xor was;
        levels  <= now;
        newest  <= before;
        if samples = '1' then
          newest <= sample;
        end if;
        steps  <= changed(0) xor changed(1);
        down   <= (changed(0) xor changed(1)) and not (now(0) xor was(1));
        fails  <= changed(0) and changed(1);
        failed <= changed(0) and changed(1) and not starting;
        base   <= unsigned(known(position_c));
        faults <= unsigned(known(faults_c));
        if hit = '1' and is_faults = '0' then
          base <= unsigned(wishbone_m2s.dat(word_t'range));
        end if;
        if hit = '1' and is_faults = '1' then
          faults <= unsigned(wishbone_m2s.dat(faults_t'range));
        end if;
        place <= bank & turn;

        if starting = '1' then
          levels <= sample;
          newest <= sample;
          steps  <= '0';
          down   <= '0';
          fails  <= '0';
          base   <= (others => '0');
          faults <= (others => '0');
        end if;
      end if;

      if last = '1' then
        whole    <= bank;
        starting <= '0';
        rounds   <= 0;
        if rounds /= rounds_apart - 1 then
          rounds <= rounds + 1;
        end if;
      end if;
      if count = 0 then
        bank <= bank xor shown;
      end if;
      closed <= starting;
      if wishbone_m2s.cyc = '0' or thawed = '1' or closed = '1' then
        shown <= whole;
      end if;

      if reset = '1' then
        count    <= (others => '0');
        rounds   <= 0;
        starting <= '1';
        closed   <= '1';
        whole    <= "01";
        bank     <= "10";
        shown    <= "01";
        failed   <= '0';
      end if;
    end if;
  end process;

end architecture;
