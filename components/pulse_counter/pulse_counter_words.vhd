-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of pulse_counter, in block RAM on the Wishbone bus. One adder serves them in turn: each word has a turn of
-- two clocks in a round of 16 clocks.
--
--   +0  pulses so far; wraps at the word                           write: preset
--   +1  bit 0 pause: pulses are not counted                        write
--   +2  time of the last pulse, in ticks since the reset; wraps at the word
--   +3  ticks between the last two pulses, or 0: there are none, or the last one is longer ago than the timeout
--   +6  frequency (with_frequency 1)
--
-- Between two turns the pulses are collected in a small counter. Its turn takes in one clock what it has collected. So
-- no pulse is lost or doubled. Hidden words are the age of the last pulse (+4) and the time (+7), at the begin of the
-- round. +5 is always 0.
--
-- Gate      Pulses count while `gate` is high and pause is 0. If that fails for a clock, +3 is 0 until two more pulses
--           have come, in rounds without such a clock.
-- Timeout   It is at most 1/64 and a round longer than said. `stopped` is then high for a clock.
-- Frequency is taken while `hold` is high. Then it must not change.
-- Reads     give the words of the last round that had ended when cyc rose, so all words are of one moment. A write
--           thaws them until cyc falls.
-- Memory    Four banks: a round reads one and writes another one, and the bus reads a third one while it is frozen.
-- Latency   2 clocks for a read. A write is acknowledged at the end of the round that took it, after at most 2 rounds.
--           Then it can be read. A pulse shows at most 2 rounds later.
-- Errors    err for other addresses and writes, and for writes that do not select all bytes.
-- Reset     All words become zero in the first round. Pulses are not counted then, and accesses wait until its end.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity pulse_counter_words is
  generic (
    timeout_ticks  : positive              := 5_000_000;
    with_frequency : natural range 0 to 1  := 0;
    data_width     : positive range 8 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    pulse     : in  std_ulogic; -- high for one clock for each
    gate      : in  std_ulogic;
    tick      : in  std_ulogic; -- high for one clock for each
    frequency : in  unsigned(data_width - 2 downto 0) := (others => '0');
    hold      : out std_ulogic;

    counts  : out std_ulogic; -- this pulse counts
    newest  : out unsigned(data_width - 1 downto 0) := (others => '0'); -- +0, a clock after its turn
    counted : out std_ulogic := '0'; -- a clock after a pulse that counts
    stopped : out std_ulogic := '0'
  );
end entity;

architecture rtl of pulse_counter_words is

  constant turn_bits : positive := 3;
  constant sum_bits  : positive := 6;

  constant count_turn     : natural := 0;
  constant pause_turn     : natural := 1;
  constant stamp_turn     : natural := 2;
  constant period_turn    : natural := 3;
  constant age_turn       : natural := 4;
  constant nothing_turn   : natural := 5;
  constant frequency_turn : natural := 6;
  constant time_turn      : natural := 7;

  -- The age is compared by its highest bits, so that this costs few cells.
  constant limit_bits : positive := 7;
  constant coarse     : natural  := maximum(bits_for(timeout_ticks + 1), limit_bits) - limit_bits;
  constant limit      : positive := (timeout_ticks - 1) / 2 ** coarse + 1;

  subtype word_t is unsigned(data_width - 1 downto 0);
  subtype turn_t is unsigned(turn_bits - 1 downto 0);
  subtype count_t is unsigned(turn_bits downto 0); -- of the clocks of a round: a turn has two
  subtype ticks_t is unsigned(turn_bits + 1 downto 0); -- 0 to 16
  subtype sum_t is signed(sum_bits - 1 downto 0);
  subtype bank_t is unsigned(1 downto 0); -- never "00"
  type memory_t is array (0 to 31) of word_t;

  -- Both hold the same. A memory is never read and written at once: what such a read gives depends on the chip.
  signal memory, bus_memory : memory_t := (others => (others => '0'));

  -- The rounds.
  signal count     : count_t := (others => '0'); -- of clocks
  signal turn, now : turn_t := (others => '0');  -- whose word is read, and whose word is written
  signal second    : std_ulogic;                 -- the second clock of a turn, which writes
  signal last      : std_ulogic;                 -- the last clock of a round
  signal starting  : std_ulogic := '1';          -- the first round after a reset
  signal whole     : bank_t := "01";             -- of the last whole round
  signal bank      : bank_t := "10";             -- of this round
  signal shown     : bank_t := "01";             -- for the bus
  signal place     : turn_t;                     -- that is read: the word itself, or another one
  signal base, sum : word_t;
  signal amount    : sum_t := (others => '0');   -- that is added to it
  signal given     : std_ulogic := '0';          -- the bus gives the word instead
  signal paused    : std_ulogic := '0';
  signal rests     : std_ulogic := '1';          -- no pulse since the timeout

  -- What is collected, and what the turns of this round take of it.
  signal pulses               : unsigned(turn_bits downto 0) := (others => '0');
  signal ticks                : ticks_t := (others => '0'); -- since the collecting began
  signal at, span             : ticks_t := (others => '0'); -- of the last pulse, and since the one before
  signal has_pulse, has_two   : std_ulogic := '0';
  signal was_shut             : std_ulogic := '0';
  signal stepped, twice, shut : std_ulogic := '0';
  signal passed, stepped_at, period : ticks_t := (others => '0');

  -- The bus.
  signal asked, known, may_write, reads, hit : std_ulogic;
  signal ack, err, put, thawed               : std_ulogic := '0';
  signal closed                              : std_ulogic := '1'; -- no word can be shown yet
  signal found                               : word_t;

begin

  assert timeout_ticks >= 64 and bits_for(timeout_ticks + 1) < data_width
    report "pulse_counter: the timeout is 64 ticks to half of the largest word, got " & integer'image(timeout_ticks)
    severity failure;

  -- The bus.
  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not closed;
  known     <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto turn_bits)) = 0 and
                        (wishbone_m2s.adr(2) = '0' or
                         (with_frequency = 1 and wishbone_m2s.adr(1 downto 0) = "10")) else '0';
  may_write <= '1' when known = '1' and wishbone_m2s.adr(2 downto 1) = "00" and
                        wishbone_m2s.sel = (wishbone_m2s.sel'range => '1') else '0';
  reads     <= asked and not wishbone_m2s.we;
  hit       <= '1' when asked = '1' and wishbone_m2s.we = '1' and may_write = '1' and
                        unsigned(wishbone_m2s.adr(turn_t'range)) = turn else '0';

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack    <= (reads and known) or (put and last);
      err    <= asked and ((not known and not wishbone_m2s.we) or (not may_write and wishbone_m2s.we));
      put    <= asked and (put or (hit and not second)) and not last;
      thawed <= wishbone_m2s.cyc and (thawed or (put and last));
      if reads = '1' then
        found <= bus_memory(to_integer(shown & unsigned(wishbone_m2s.adr(turn_t'range))));
      end if;
      -- The sum stands for two clocks. In one of them the bus does not read. Not an `else` of the line above: GHDL 2.0
      -- synthesises its condition without the `not`.
      if reads = '0' then
        bus_memory(to_integer(bank & now)) <= sum;
      end if;

      if reset = '1' then
        ack    <= '0';
        err    <= '0';
        put    <= '0';
        thawed <= '0';
      end if;
    end if;
  end process;

  reply : process (all) is
  begin
    wishbone_s2m                  <= wishbone_s2m_idle;
    wishbone_s2m.dat(found'range) <= std_ulogic_vector(found);
    wishbone_s2m.ack              <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err              <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
  end process;

  -- The rounds. In its first clock a turn reads a word. The sum is there in the second one, and in the one after it.
  turn   <= count(count'high downto 1);
  second <= count(0);
  last   <= and count;
  hold   <= '1' when count >= 2 * frequency_turn and count <= 2 * frequency_turn + 2 else '0';

  choose : process (all) is
    variable number : natural range 0 to 7;
  begin
    number := to_integer(turn);
    place  <= turn;
    if number = stamp_turn and stepped = '1' then
      place <= to_unsigned(time_turn, turn_bits);
    end if;
    if number = period_turn and stepped = '1' then
      place <= to_unsigned(age_turn, turn_bits);
    end if;
    if starting = '1' or
       (number = age_turn and stepped = '1') or
       (number = period_turn and (shut = '1' or twice = '1' or rests = '1')) then
      place <= to_unsigned(nothing_turn, turn_bits);
    end if;
  end process;

  add : process (all) is
    variable word : word_t;
  begin
    word := base;
    if given = '1' then
      word := unsigned(wishbone_m2s.dat(word_t'range));
    end if;
    if with_frequency = 1 and now = frequency_turn then
      word := '0' & frequency;
      if starting = '1' then
        word := (others => '0');
      end if;
    end if;
    sum <= word + unsigned(resize(amount, data_width));
  end process;

  run : process (clock) is
    variable since : sum_t; -- ticks from the last pulse to the end of the collecting
  begin
    if rising_edge(clock) then
      count   <= count + 1;
      counted <= counts;
      stopped <= '0';

      if second = '0' then
        base   <= memory(to_integer(whole & place));
        now    <= turn;
        given  <= hit;
        amount <= (others => '0');
        since  := signed('0' & passed) - signed('0' & stepped_at);
        case to_integer(turn) is
          when count_turn =>
            amount     <= signed(resize(pulses, sum_bits));
            stepped    <= has_pulse;
            twice      <= has_two;
            shut       <= was_shut;
            passed     <= ticks;
            stepped_at <= (others => '0');
            if has_pulse = '1' then
              stepped_at <= at;
            end if;
            period     <= span;
          when stamp_turn =>
            amount <= signed(resize(stepped_at, sum_bits));
          when period_turn =>
            if stepped = '1' and shut = '0' and (twice = '1' or rests = '0') then
              amount <= signed(resize(period, sum_bits));
            end if;
          when age_turn =>
            if stepped = '1' or rests = '0' then
              amount <= since;
            end if;
          when time_turn =>
            amount <= signed(resize(passed, sum_bits));
          when others => null;
        end case;
        if starting = '1' then
          amount <= (others => '0');
        end if;
      else
        memory(to_integer(bank & now)) <= sum;
        if now = count_turn then
          newest <= sum;
        end if;
        if now = pause_turn and given = '1' then
          paused <= wishbone_m2s.dat(0);
        end if;
        if now = age_turn then
          if shut = '1' then
            rests <= '1';
          elsif stepped = '1' then
            rests <= '0';
          elsif shift_right(sum, coarse)(limit_bits downto 0) >= limit then
            rests   <= '1';
            stopped <= not rests;
          end if;
        end if;
      end if;

      if last = '1' then
        whole    <= bank;
        starting <= '0';
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
        starting <= '1';
        closed   <= '1';
        whole    <= "01";
        bank     <= "10";
        shown    <= "01";
        newest   <= (others => '0');
        paused   <= '0';
        rests    <= '1';
        stepped  <= '0';
        shut     <= '0';
        stopped  <= '0';
        counted  <= '0';
      end if;
    end if;
  end process;

  -- The pulses. The turn of +0 takes what was collected before its clock.
  counts <= pulse and gate and not paused and not starting;

  collect : process (clock) is
    variable before : unsigned(pulses'range);
    variable begun  : ticks_t; -- ticks so far
    variable since  : ticks_t; -- the time of the pulse before, if there is one
  begin
    if rising_edge(clock) then
      before := pulses;
      begun  := ticks;
      since  := (others => '0');
      if has_pulse = '1' then
        since := at;
      end if;
      if count = 0 then
        before    := (others => '0');
        begun     := (others => '0');
        since     := (others => '0');
        has_pulse <= '0';
        has_two   <= '0';
        was_shut  <= '0';
      end if;
      pulses <= before;
      ticks  <= begun;
      if tick = '1' then
        ticks <= begun + 1;
      end if;
      if counts = '1' then
        pulses    <= before + 1;
        at        <= begun;
        span      <= begun - since;
        has_pulse <= '1';
        if count /= 0 then
          has_two <= has_pulse;
        end if;
      end if;
      if paused = '1' or gate = '0' then
        was_shut <= '1';
      end if;

      if reset = '1' then
        pulses    <= (others => '0');
        ticks     <= (others => '0');
        has_pulse <= '0';
        has_two   <= '0';
        was_shut  <= '0';
      end if;
    end if;
  end process;

end architecture;
