-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the words that pulse_counter_words writes, with 8 bits and a timeout of 64 ticks. A tick may come in
-- any clock, and a pulse in every second one. A reference counts each pulse at once, with its own time. It knows of the
-- rounds only in which clock a word is taken. What the bus reads of these words is proven in pulse_counter_reads.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wishbone_pkg.all;

entity pulse_counter_words_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    m2s      : in wishbone_m2s_t;
    pulse    : in std_ulogic;
    gate     : in std_ulogic;
    tick     : in std_ulogic;
    round    : in unsigned(3 downto 0); -- shows the clock in a round, as all of these show signals of the design
    starting : in std_ulogic;           -- the first round
    closed   : in std_ulogic;           -- the bus must wait
    whole    : in unsigned(1 downto 0); -- the bank of the last whole round
    bank     : in unsigned(1 downto 0); -- of this round
    shown    : in unsigned(1 downto 0);
    now      : in unsigned(2 downto 0); -- the word that is written
    sum      : in unsigned(7 downto 0); -- the word of a turn, in its second clock
    paused   : in std_ulogic;
    rests    : in std_ulogic;
    puts     : in std_ulogic;           -- a write was taken, and is not acknowledged
    acks     : in std_ulogic;
    pulses   : in unsigned(3 downto 0);
    ticks, at, span, passed, stepped_at, between : in unsigned(4 downto 0);
    has_pulse, has_two, has_shut, stepped, twice, shut : in std_ulogic
  );
end entity;

architecture properties of pulse_counter_words_formal is

  constant timeout : positive := 64; -- ticks

  subtype byte_t is unsigned(7 downto 0);
  type bytes_t is array (0 to 31) of byte_t;

  signal s2m              : wishbone_s2m_t;
  signal counts, counted, stopped : std_ulogic;
  signal newest           : byte_t;
  signal begun            : std_ulogic := '0';
  signal reset_1          : std_ulogic := '1';
  signal pulse_1          : std_ulogic := '0';
  signal asked            : std_ulogic := '0';
  signal takes            : std_ulogic;                   -- this pulse counts
  signal gives            : std_ulogic;                   -- the bus has a word
  signal turn             : natural range 0 to 7;
  signal is_odd           : std_ulogic;                   -- a word is written now

  -- What has come since the count was taken.
  signal window           : byte_t := (others => '0');    -- pulses
  signal came             : natural range 0 to 2 := 0;    -- the same, 2 for more
  signal was_shut         : std_ulogic := '0';
  signal elapsed          : byte_t := (others => '0');    -- ticks since the reset
  signal last, last_but_one : byte_t := (others => '0');  -- when the last two pulses came

  -- What was taken: the words of this round, and those of the round before it.
  signal count, pause, stamp, period, age, clock_time : byte_t := (others => '0');
  signal old_stamp, old_period, old_age, old_time     : byte_t := (others => '0');
  signal last_taken, but_one_taken : byte_t := (others => '0');
  signal came_taken       : natural range 0 to 2 := 0;
  signal shut_taken       : std_ulogic := '0';
  signal fresh, old_fresh : std_ulogic := '0';            -- the time of the last pulse counts
  signal has_age          : std_ulogic := '0';
  signal ends             : std_ulogic := '0';            -- the timeout does, in this round
  signal counted_now, stopped_now : std_ulogic := '0';
  signal acts             : natural range 0 to 2 := 0;    -- how often this write was taken
  signal copy             : bytes_t := (others => (others => '0')); -- the memory once more
  signal in_place         : std_ulogic;                   -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.pulse_counter_words
    generic map (timeout_ticks => timeout, with_frequency => 0, data_width => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, pulse => pulse, gate => gate,
      tick => tick, frequency => (others => '0'), hold => open, counts => counts, newest => newest,
      counted => counted, stopped => stopped);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  takes  <= pulse and gate and not paused and not starting;
  turn   <= to_integer(round(3 downto 1));
  is_odd <= round(0);
  gives  <= m2s.cyc and m2s.stb and m2s.we and (and m2s.sel) and not s2m.ack and not s2m.err and not closed and
            nor m2s.adr(31 downto 1);

  follow : process (clk) is
    variable before : byte_t; -- pulses so far
    variable base   : byte_t;
    variable knows  : std_ulogic;
  begin
    if rising_edge(clk) then
      begun   <= '1';
      reset_1 <= reset;
      pulse_1 <= pulse;
      asked   <= m2s.stb and not s2m.ack and not s2m.err and not reset;

      if tick = '1' then
        elapsed <= elapsed + 1;
      end if;
      counted_now <= takes;
      stopped_now <= '0';

      before := window;
      if round = 0 then
        base := count;
        if gives = '1' and m2s.adr(0) = '0' then
          base := unsigned(m2s.dat(byte_t'range));
        end if;
        count         <= base + window;
        clock_time    <= elapsed;
        old_time      <= clock_time;
        old_stamp     <= stamp;
        old_period    <= period;
        old_age       <= age;
        old_fresh     <= fresh;
        last_taken    <= last;
        but_one_taken <= last_but_one;
        came_taken    <= came;
        shut_taken    <= was_shut;
        knows := fresh;
        if came /= 0 then
          stamp <= last;
          knows := '1';
        end if;
        has_age <= knows;
        age     <= elapsed - last;
        if was_shut = '1' or (came < 2 and fresh = '0') then
          period <= (others => '0');
        elsif came /= 0 then
          period <= last - last_but_one;
        end if;
        fresh <= knows and not was_shut;
        ends  <= '0';
        if fresh = '1' and came = 0 and was_shut = '0' and elapsed - last >= timeout then
          fresh <= '0';
          ends  <= '1';
        end if;
        before   := (others => '0');
        came     <= 0;
        was_shut <= '0';
      end if;
      window <= before;
      if takes = '1' then
        window       <= before + 1;
        last         <= elapsed;
        last_but_one <= last;
        came         <= 1;
        if round /= 0 then
          came <= minimum(came + 1, 2);
        end if;
      end if;
      if paused = '1' or gate = '0' then
        was_shut <= '1';
      end if;

      if round = 2 and gives = '1' and m2s.adr(0) = '1' then
        pause <= unsigned(m2s.dat(byte_t'range));
      end if;
      if round = 9 then
        stopped_now <= ends;
      end if;

      if asked = '0' then
        acts <= 0;
      end if;
      if gives = '1' and round = (unsigned'("00") & m2s.adr(0) & '0') then
        acts <= minimum(acts + 1, 2);
      end if;

      for number in copy'range loop
        if is_odd = '1' and bank & now = number then
          copy(number) <= sum;
        end if;
      end loop;

      if reset = '1' then
        window      <= (others => '0');
        came        <= 0;
        was_shut    <= '0';
        elapsed     <= (others => '0');
        last        <= (others => '0');
        count       <= (others => '0');
        pause       <= (others => '0');
        stamp       <= (others => '0');
        period      <= (others => '0');
        clock_time  <= (others => '0');
        last_taken  <= (others => '0');
        fresh       <= '0';
        has_age     <= '0';
        ends        <= '0';
        counted_now <= '0';
        stopped_now <= '0';
        acts        <= 0;
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits : boolean;
    variable here : natural range 0 to 16; -- clocks since the count was taken

    impure function holds_word (of_bank : unsigned(1 downto 0); word : natural; value : byte_t) return boolean is
    begin
      return copy(to_integer(of_bank & to_unsigned(word, 3))) = value;
    end function;

  begin
    here := to_integer(round);
    if here = 0 then
      here := 16;
    end if;

    -- The banks.
    fits := bank /= 0 and whole /= 0 and shown /= 0 and bank /= shown and
            (round = 0 or bank /= whole) and (round /= 0 or starting = '1' or bank = whole) and
            (is_odd = '0' or now = turn) and (closed = '1' or starting = '0');
    for number in 0 to 3 loop
      fits := fits and copy(8 * number + 5) = 0;
    end loop;

    -- What is collected.
    fits := fits and came <= 2 and came_taken <= 2 and acts <= 2 and window = pulses and
            has_pulse = to_bit(came /= 0) and has_two = to_bit(came = 2) and
            has_shut = was_shut and elapsed - clock_time = ticks and ticks <= 16 and
            2 * window <= here + to_integer(unsigned'("" & pulse_1)) and
            (round = 0 or ticks <= round) and
            (came = 0 or last - clock_time = at) and (came /= 1 or (span = at and last_but_one = last_taken)) and
            (came /= 2 or last - last_but_one = span) and (came /= 0 or last = last_taken) and
            (came = 0 or (at <= ticks and span <= at)) and (came = 0) = (window = 0) and (came = 2) = (window >= 2) and
            (starting = '0' or (came = 0 and clock_time = 0 and count = 0 and pause = 0 and stamp = 0 and period = 0 and
                                fresh = '0' and has_age = '0' and paused = '0' and ends = '0' and last_taken = 0 and
                                (round = 0 or (came_taken = 0 and shut_taken = '0' and passed = 0 and
                                               stepped_at = 0))));

    -- The bus.
    fits := fits and (closed = '0' or (puts = '0' and acks = '0' and acts = 0)) and
            (puts = '0' or (acts = 1 and asked = '1' and acks = '0' and s2m.err = '0' and m2s.we = '1' and
                            (and m2s.sel) = '1' and unsigned(m2s.adr(31 downto 1)) = 0 and round /= 0 and
                            (m2s.adr(0) = '0' or round > 2))) and
            (acts = 0 or puts = '1' or (acks = '1' and round = 0) or (asked = '0' and round = 1));

    -- What was taken.
    if round /= 0 then
      fits := fits and stepped = to_bit(came_taken /= 0) and twice = to_bit(came_taken = 2) and shut = shut_taken and
              passed <= 16 and clock_time - old_time = passed and age = clock_time - last_taken and
              (starting = '1' or (
                (came_taken = 0 or (last_taken - old_time = stepped_at and stamp = last_taken and
                                    stepped_at <= passed)) and
                (came_taken /= 0 or (stepped_at = 0 and stamp = old_stamp)) and
                (came_taken /= 1 or between = stepped_at) and
                (came_taken /= 2 or last_taken - but_one_taken = between) and
                (old_fresh = '0' or came_taken /= 0 or old_time - last_taken = old_age) and
                (old_fresh = '0' or came_taken /= 1 or old_time - but_one_taken = old_age) and
                has_age = (old_fresh or to_bit(came_taken /= 0))));
      fits := fits and (old_fresh = '0' or old_age < timeout or starting = '1');
      if starting = '0' then
        if shut_taken = '1' or (came_taken < 2 and old_fresh = '0') then
          fits := fits and period = 0;
        elsif came_taken /= 0 then
          fits := fits and period = last_taken - but_one_taken;
        else
          fits := fits and period = old_period;
        end if;
        fits := fits and fresh = (has_age and not shut_taken and not ends) and
                ends = to_bit(old_fresh = '1' and came_taken = 0 and shut_taken = '0' and age >= timeout);
      end if;
    end if;
    fits := fits and (fresh = '0' or (has_age = '1' and age = clock_time - last_taken and age < timeout));
    if round = 0 or round > 9 then
      fits := fits and rests = not fresh;
    elsif starting = '0' then
      fits := fits and rests = not old_fresh;
    else
      fits := fits and rests = '1';
    end if;

    -- The words of the last whole round, until they are read.
    if starting = '0' then
      if round = 0 then
        fits := fits and holds_word(whole, 0, count) and holds_word(whole, 2, stamp) and
                holds_word(whole, 3, period) and
                (fresh = '0' or holds_word(whole, 4, age)) and holds_word(whole, 7, clock_time);
      else
        fits := fits and (round > 4 or holds_word(whole, 2, old_stamp)) and
                (round > 6 or holds_word(whole, 3, old_period)) and
                (round > 8 or old_fresh = '0' or holds_word(whole, 4, old_age)) and
                holds_word(whole, 7, old_time);
      end if;
      fits := fits and (round > 2 or holds_word(whole, 1, pause));
    end if;
    -- The words of this round, as soon as they are written.
    fits := fits and (round < 2 or holds_word(bank, 0, count)) and (round < 4 or holds_word(bank, 1, pause)) and
            (round < 6 or holds_word(bank, 2, stamp)) and (round < 8 or holds_word(bank, 3, period)) and
            (round < 10 or has_age = '0' or holds_word(bank, 4, age));
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always asked = '1' -> m2s.cyc = '1';

  -- A pulse is an edge of a line: no two come in clocks next to each other (pulse_counter).
  are_edges : assume always pulse_1 = '1' -> pulse = '0';

  -- At every clock, the design and its memory are where these say.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- The count that is written is the one before it, or the preset, and each pulse since then: none is lost or doubled.
  right_count : assert always begun = '1' and is_odd = '1' and turn = 0 -> sum = count;

  -- The wire has this count.
  right_wire : assert always begun = '1' and reset_1 = '0' and round > 1 -> newest = count;

  -- The pause that is written is what the bus gave last.
  right_pause : assert always begun = '1' and is_odd = '1' and turn = 1 -> sum = pause;
  -- It acts from the clock in which it is written.
  pause_acts  : assert always begun = '1' and round /= 3 -> paused = pause(0);

  -- The stamp that is written is the time of the last pulse.
  right_stamp : assert always begun = '1' and is_odd = '1' and turn = 2 -> sum = stamp;

  -- The period that is written is the time between the last two pulses, or 0: they are not known, or the last one is
  -- older than the timeout, or the counter was shut.
  right_period : assert always begun = '1' and is_odd = '1' and turn = 3 -> sum = period;

  -- The age of the last pulse and the time, from which the periods and the stamps of later rounds are made, are right.
  right_age  : assert always begun = '1' and is_odd = '1' and turn = 4 and has_age = '1' -> sum = age;
  -- The time is right.
  right_time : assert always begun = '1' and is_odd = '1' and turn = 7 -> sum = clock_time;

  -- Each pulse that counts has its event, and nothing else has.
  each_is_told : assert always begun = '1' -> counted = counted_now;

  -- The timeout has one event, and no pulse or pause has.
  stop_is_told : assert always begun = '1' -> stopped = stopped_now;

  -- A write is acknowledged when it was taken, and it is taken once.
  acts_once : assert always begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '1' -> acts = 1;

end architecture;
