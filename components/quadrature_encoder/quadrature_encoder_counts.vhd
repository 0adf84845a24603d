-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of one or several incremental encoders, in block RAM on the Wishbone bus. One adder serves all words in
-- turn: each word of each channel has a turn of two clocks in a round of 16 * channels clocks. (3 channels take the
-- time of 4, and 5 to 7 that of 8.) Channel n has 8 addresses, from 8 * n on:
--
--   +0  position, two's complement; wraps at the word          write: preset
--   +1  position at the last rising edge of index
--   +2  rising edges of index so far; wraps at the word
--   +3  impossible steps: both lines changed at once           write: sets the number
--   +4  clock of the last step, since the reset; wraps at the word
--   +5  clock of the last rising edge of index
--   +6  velocity: speed, or the negative of it when `back` is high (with_velocity 1, and one channel)
--
-- Between two turns a channel collects its steps in a small counter. Its turn takes in one clock what it has collected.
-- So no step is lost or doubled. Impossible steps in one round count as one. An edge of index is ignored within a round
-- of the one before.
--
-- Generics  with_index 0: +1, +2 and +5 stay zero, and there is no event. with_stamps 0: +4 and +5 stay zero.
--           with_velocity 0: there is no +6.
-- Velocity  It is taken while `hold` is high. Then speed and back must not change.
-- Reads     give the words of the last round that had ended when cyc rose. So all words of a channel are of one moment,
--           in a block of accesses as well. Channel n is 16 * n clocks later than channel 0. A write thaws the words
--           until cyc falls.
-- Memory    Four banks: a round reads one and writes another one, and the bus reads a third one while it is frozen.
-- Latency   2 clocks for a read. A write is acknowledged at the end of the round that took it, after at most 2 rounds.
--           Then it can be read. A step shows at most 2 rounds after the levels have changed.
-- Errors    err for addresses that do not exist, for other writes, and for writes that do not select all bytes.
-- Reset     All words become zero in the first round. What happens on the lines then is not counted, and accesses wait
--           until it has ended.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity quadrature_encoder_counts is
  generic (
    channels    : positive range 1 to 8  := 1;
    with_index  : natural range 0 to 1   := 0;
    with_stamps : natural range 0 to 1   := 0;
    with_velocity : natural range 0 to 1 := 0;
    data_width  : positive range 8 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    a     : in  std_ulogic_vector(channels - 1 downto 0); -- synchronous and filtered, as the next two
    b     : in  std_ulogic_vector(channels - 1 downto 0);
    index : in  std_ulogic_vector(channels - 1 downto 0);

    speed : in  unsigned(data_width - 2 downto 0) := (others => '0');
    back  : in  std_ulogic := '0';
    hold  : out std_ulogic;

    newest : out unsigned(data_width - 1 downto 0); -- the position of channel 0, a clock after its turn

    indexed : out std_ulogic; -- an index has come, for one clock
    failed  : out std_ulogic  -- an impossible step has come, for one clock
  );
end entity;

architecture rtl of quadrature_encoder_counts is

  constant words     : positive := 8; -- of a channel; the last one is the time, and has no address
  constant turn_bits : positive := bits_for(words * channels);
  constant round     : positive := 2 ** (turn_bits + 1); -- clocks: a turn has two
  constant sum_bits  : positive := turn_bits + 3;

  constant position       : natural := 0;
  constant index_position : natural := 1;
  constant index_count    : natural := 2;
  constant impossible     : natural := 3;
  constant stamp          : natural := 4;
  constant index_stamp    : natural := 5;
  constant velocity       : natural := 6;
  constant time_word      : natural := 7;

  subtype channels_t is std_ulogic_vector(channels - 1 downto 0);
  subtype word_t is unsigned(data_width - 1 downto 0);
  subtype count_t is unsigned(turn_bits downto 0);    -- of the clocks of a round
  subtype turn_t is unsigned(turn_bits - 1 downto 0); -- a channel and a word
  subtype sum_t is signed(sum_bits - 1 downto 0);
  subtype bank_t is unsigned(1 downto 0);             -- never "00"
  type memory_t is array (0 to 2 * round - 1) of word_t;
  type sums_t is array (0 to channels - 1) of sum_t;
  type counts_t is array (0 to channels - 1) of count_t;

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
  signal place     : turn_t;                     -- that is read: the word itself, or one that is copied
  signal base, sum : word_t;
  signal amount    : sum_t;                      -- that is added to it
  signal given     : std_ulogic := '0';          -- the bus gives the word instead
  signal preset    : std_ulogic := '0';          -- it was the position of this channel

  -- What the channels collect until their turn.
  signal a_before, b_before, index_before   : channels_t := (others => '0');
  signal steps, index_steps                 : sums_t := (others => (others => '0'));
  signal step_at, index_at                  : counts_t := (others => (others => '0'));
  signal has_stepped, has_failed, has_index : channels_t := (others => '0');
  signal stepped, due                       : std_ulogic := '0'; -- in the round that ended with turn 0 of this channel
  signal stepped_at                         : count_t := (others => '0');

  -- The bus.
  signal asked, known, may_write, reads, hit : std_ulogic;
  signal ack, err, put, thawed               : std_ulogic := '0';
  signal closed                              : std_ulogic := '1'; -- no word can be shown yet
  signal found                               : word_t;

  function word_of (turn : turn_t) return natural is
  begin
    return to_integer(turn(2 downto 0));
  end function;

  function address (bank : bank_t; turn : turn_t) return natural is
  begin
    return to_integer(bank & turn);
  end function;

begin

  -- The bus.
  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not closed;
  known     <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto turn_bits)) = 0 and
                        unsigned('0' & wishbone_m2s.adr(turn_t'range)) < words * channels and
                        (wishbone_m2s.adr(2 downto 1) /= "11" or
                         (with_velocity = 1 and wishbone_m2s.adr(0) = '0')) else '0';
  may_write <= '1' when known = '1' and wishbone_m2s.adr(2) = '0' and
                        wishbone_m2s.adr(1) = wishbone_m2s.adr(0) and
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
        found <= bus_memory(address(shown, unsigned(wishbone_m2s.adr(turn_t'range))));
      end if;
      -- The sum stands for two clocks. In one of them the bus does not read. Not an `else` of the line above: GHDL 2.0
      -- synthesises its condition without the `not`.
      if reads = '0' then
        bus_memory(address(bank, now)) <= sum;
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
    wishbone_s2m                  <= wishbone_s2m_idle;
    wishbone_s2m.dat(found'range) <= std_ulogic_vector(found);
    wishbone_s2m.ack              <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err              <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
  end process;

  -- The rounds. In its first clock a turn reads a word. The sum is there in the second one, and in the one after it.
  turn   <= count(count'high downto 1);
  second <= count(0);
  last   <= and count;
  hold   <= '1' when count >= 2 * velocity and count <= 2 * velocity + 2 else '0';

  choose : process (all) is
  begin
    place <= turn;
    if due = '1' and word_of(turn) = index_position then
      place(2 downto 0) <= to_unsigned(position, 3);
    end if;
    if with_stamps = 1 and
       ((stepped = '1' and word_of(turn) = stamp) or (due = '1' and word_of(turn) = index_stamp)) then
      place(2 downto 0) <= to_unsigned(time_word, 3);
    end if;
  end process;

  add : process (all) is
    variable word : word_t;
  begin
    word := base;
    if given = '1' then
      word := unsigned(wishbone_m2s.dat(word_t'range));
    end if;
    if with_velocity = 1 and word_of(now) = velocity then
      word := ('0' & speed) xor (word_t'range => back);
    end if;
    if starting = '1' then
      word := (others => '0');
    end if;
    sum <= word + unsigned(resize(amount, data_width));
  end process;

  run : process (clock) is
    variable begun : count_t; -- when the round of the channel begins
  begin
    if rising_edge(clock) then
      count <= count + 1;
      if second = '0' then
        base   <= memory(address(whole, place));
        now    <= turn;
        given  <= hit;
        amount <= (others => '0');
        for channel in 0 to channels - 1 loop
          begun := to_unsigned(2 * words * channel, turn_bits + 1);
          if shift_right(turn, 3) = channel then
            case word_of(turn) is
              when position =>
                amount     <= steps(channel);
                preset     <= hit;
                due        <= has_index(channel);
                stepped    <= has_stepped(channel);
                stepped_at <= step_at(channel) - begun;
              when index_position =>
                if due = '1' then
                  amount <= index_steps(channel);
                  given  <= preset;
                end if;
              when index_count =>
                amount(0) <= due;
              when impossible =>
                amount(0) <= has_failed(channel);
              when stamp =>
                if stepped = '1' then
                  amount <= signed(resize(stepped_at, sum_bits));
                end if;
              when index_stamp =>
                if with_stamps = 1 and due = '1' then
                  amount <= signed(resize(index_at(channel) - begun, sum_bits));
                end if;
              when velocity =>
                if with_velocity = 1 then
                  amount(0) <= back;
                end if;
              when others =>
                amount <= to_signed(round, sum_bits);
                if starting = '1' then
                  amount <= signed(resize(begun, sum_bits));
                end if;
            end case;
          end if;
        end loop;
      end if;
      if second = '1' and now = position then
        newest <= sum;
      end if;
      if second = '1' then
        memory(address(bank, now)) <= sum;
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
      end if;
    end if;
  end process;

  -- The lines. A turn takes what was collected before its clock.
  collect : process (clock) is
    variable changed_a, changed_b : std_ulogic;
    variable by, total            : sum_t;
  begin
    if rising_edge(clock) then
      a_before     <= a;
      b_before     <= b;
      index_before <= index;
      indexed      <= '0';
      failed       <= '0';

      for channel in 0 to channels - 1 loop
        changed_a := a(channel) xor a_before(channel);
        changed_b := b(channel) xor b_before(channel);

        by := (others => '0');
        if (changed_a xor changed_b) = '1' then
          by := to_signed(1, sum_bits);
          if (a(channel) xor b_before(channel)) = '0' then
            by := to_signed(-1, sum_bits);
          end if;
        end if;
        total := steps(channel) + by;
        if count = 2 * (words * channel + position) then
          total                := by;
          has_stepped(channel) <= '0';
        end if;
        steps(channel) <= total;
        if (changed_a xor changed_b) = '1' then
          has_stepped(channel) <= '1';
          step_at(channel)     <= count;
        end if;

        if count = 2 * (words * channel + impossible) then
          has_failed(channel) <= '0';
        end if;
        if (changed_a and changed_b) = '1' then
          has_failed(channel) <= '1';
          failed              <= not starting;
        end if;

        -- An index stands until its turns are over.
        if count = 2 * (words * channel + index_stamp) and due = '1' then
          has_index(channel) <= '0';
        end if;
        if index(channel) = '1' and index_before(channel) = '0' then
          indexed <= not starting;
          if has_index(channel) = '0' then
            has_index(channel)   <= '1';
            index_steps(channel) <= total;
            index_at(channel)    <= count;
          end if;
        end if;

        if starting = '1' or reset = '1' then
          steps(channel)       <= (others => '0');
          has_stepped(channel) <= '0';
          has_failed(channel)  <= '0';
          has_index(channel)   <= '0';
        end if;
        if with_index = 0 then
          has_index(channel)   <= '0';
          index_steps(channel) <= (others => '0');
          indexed              <= '0';
        end if;
        if with_stamps = 0 then
          has_stepped(channel) <= '0';
          step_at(channel)     <= (others => '0');
          index_at(channel)    <= (others => '0');
        end if;
      end loop;
    end if;
  end process;

end architecture;
