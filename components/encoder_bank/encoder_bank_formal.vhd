-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of encoder_bank with two channels and words of 12 bits. A reference counts in registers, without memories.
-- It knows only at which clock of a round a channel is sampled, when it counts, and when the words are shown. A second
-- copy of the memories lets the properties look into those of the design.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wishbone_pkg.all;

entity encoder_bank_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s   : in wishbone_m2s_t;
    a     : in std_ulogic_vector(1 downto 0);
    b     : in std_ulogic_vector(1 downto 0);

    -- These show signals of the design.
    clocks    : in unsigned(1 downto 0); -- of the round
    begins    : in std_ulogic;           -- the first round
    shut      : in std_ulogic;
    old       : in unsigned(1 downto 0); -- banks: of the last whole round, of this round, and for the bus
    bank      : in unsigned(1 downto 0);
    for_bus   : in unsigned(1 downto 0);
    near      : in std_ulogic_vector(3 downto 0); -- the lines in the synchroniser, and behind it
    seen      : in std_ulogic_vector(3 downto 0);
    taken     : in std_ulogic_vector(1 downto 0); -- the sample of this turn
    known     : in std_ulogic_vector(27 downto 0);
    sum       : in unsigned(11 downto 0);
    fault_sum : in unsigned(11 downto 0);
    now_are   : in std_ulogic_vector(1 downto 0); -- levels to be written
    newest    : in std_ulogic_vector(1 downto 0);
    place     : in unsigned(2 downto 0);
    put       : in std_ulogic;
    thaws     : in std_ulogic;
    acks      : in std_ulogic;
    errs      : in std_ulogic;
    found     : in std_ulogic_vector(23 downto 0)
  );
end entity;

architecture properties of encoder_bank_formal is

  constant bits    : positive := 12;
  constant longest : positive := 6; -- clocks until an answer: less than two rounds

  subtype word_t is unsigned(bits - 1 downto 0);
  subtype lines_t is std_ulogic_vector(1 downto 0); -- b, a
  type words_t is array (0 to 3) of word_t;
  type channels_t is array (0 to 1) of lines_t;

  -- What the design has of a channel: position, impossible steps, levels, last sample.
  subtype state_t is std_ulogic_vector(2 * bits + 3 downto 0);
  type memory_t is array (0 to 7) of state_t;
  subtype counts_t is std_ulogic_vector(2 * bits - 1 downto 0);
  type bus_memory_t is array (0 to 7) of counts_t;

  constant nothing : words_t := (others => (others => '0'));

  signal s2m             : wishbone_s2m_t;
  signal failed          : std_ulogic;
  signal begun           : std_ulogic := '0';
  signal asked           : std_ulogic := '0';
  signal count           : unsigned(1 downto 0) := "00";
  signal starting        : std_ulogic := '1';
  signal closed          : std_ulogic := '1';
  signal first, second   : channels_t := (others => "00"); -- flip-flops of the lines
  signal sampled         : lines_t := "00";                -- of this turn
  signal sample, levels  : channels_t := (others => "00"); -- of the last round, and what counts
  signal live            : words_t := (others => (others => '0'));
  signal whole           : words_t := (others => (others => '0'));
  signal shown           : words_t := (others => (others => '0'));
  signal failed_now      : std_ulogic := '0';
  signal steps           : natural range 0 to 3 := 0;      -- of channel 0, for a cover
  signal took            : std_ulogic := '0';              -- a write, in this round
  signal thawed          : std_ulogic := '0';
  signal expected        : word_t := (others => '0');      -- of a read that is answered now
  signal waits           : natural range 0 to longest + 1 := 0; -- clocks without an answer
  signal written         : memory_t := (others => (others => '0')); -- the same as the memories of the design
  signal bus_written     : bus_memory_t := (others => (others => '0'));
  signal base, base_fault : word_t := (others => '0');     -- what the last turn had, and by how much it counted
  signal went            : signed(1 downto 0) := "00";
  signal fails           : unsigned(0 downto 0) := "0";
  signal waits_most      : natural range 0 to longest;     -- until this clock
  signal waits_fit       : std_ulogic;
  signal exists          : std_ulogic;                     -- the address
  signal turn_sums       : counts_t;                       -- what the last turn has counted

  -- The design is where the reference is.
  signal given_word, found_same : std_ulogic_vector(bits - 1 downto 0);
  signal round_fits  : std_ulogic_vector(0 to 15);
  signal answer_fits : std_ulogic_vector(0 to 6);
  signal sums_fit, memory_fits, known_fits, whole_fits, shown_fits, frozen_fits : std_ulogic_vector(0 to 1);

begin

  default clock is rising_edge(clk);

  dut : entity work.encoder_bank
    generic map (channels => 2, data_width => bits)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, failed => failed, a => a, b => b);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  follow : process (clk) is
    variable gives    : std_ulogic; -- the bus has a word
    variable takes    : std_ulogic; -- it is taken in this round
    variable was, now : lines_t;
    variable news     : words_t;
    variable step     : signed(1 downto 0);
    variable fault    : unsigned(0 downto 0);
  begin
    if rising_edge(clk) then
      begun      <= '1';
      asked      <= m2s.stb and not s2m.ack and not s2m.err and not reset;
      count      <= count + 1;
      expected   <= shown(to_integer(unsigned(m2s.adr(1 downto 0))));
      failed_now <= '0';
      waits      <= 0;
      if m2s.cyc = '1' and m2s.stb = '1' and s2m.ack = '0' and s2m.err = '0' and closed = '0' then
        waits <= minimum(waits + 1, longest + 1);
      end if;
      if clocks(0) = '1' then
        written(to_integer(place)) <= std_ulogic_vector(sum) & std_ulogic_vector(fault_sum) & now_are & newest;
      end if;
      if (m2s.cyc and m2s.stb and not m2s.we and not acks and not errs and not shut) = '0' then
        bus_written(to_integer(place)) <= std_ulogic_vector(sum) & std_ulogic_vector(fault_sum);
      end if;
      for number in 0 to 1 loop
        first(number) <= b(number) & a(number);
      end loop;
      second <= first;

      gives := m2s.cyc and m2s.stb and m2s.we and (and m2s.sel) and not s2m.ack and not s2m.err and not closed and
               exists;

      news  := live;
      takes := took;
      for channel in 0 to 1 loop
        if count = 2 * channel then
          sampled <= second(channel);
        end if;
        if count = 2 * channel + 1 then
          if gives = '1' and unsigned(m2s.adr(0 downto 0)) = channel then
            takes := '1';
          end if;
          if gives = '1' and unsigned(m2s.adr(1 downto 0)) = channel then
            news(channel) := unsigned(m2s.dat(word_t'range));
          end if;
          if gives = '1' and unsigned(m2s.adr(1 downto 0)) = 2 + channel then
            news(2 + channel) := unsigned(m2s.dat(word_t'range));
          end if;

          now := levels(channel);
          for line in 0 to 1 loop
            if sampled(line) = sample(channel)(line) or starting = '1' then
              now(line) := sampled(line);
            end if;
          end loop;
          was := levels(channel);
          levels(channel) <= now;
          sample(channel) <= sampled;
          step  := "00";
          fault := "0";
          if (now xor was) = "11" then
            fault      := "1";
            failed_now <= not starting;
          elsif (was = "00" and now = "01") or (was = "01" and now = "11") or (was = "11" and now = "10") or
                (was = "10" and now = "00") then
            step := "01"; -- a leads
          elsif now /= was then
            step := "11";
          end if;
          if starting = '1' then
            news  := nothing;
            step  := "00";
            fault := "0";
          end if;
          base       <= news(channel);
          base_fault <= news(2 + channel);
          went       <= step;
          fails      <= fault;
          news(channel)     := news(channel) + unsigned(resize(step, bits));
          news(2 + channel) := news(2 + channel) + fault;
          if channel = 0 and now /= was and starting = '0' then
            steps <= minimum(steps + 1, 3);
          end if;
        end if;
      end loop;
      live   <= news;
      took   <= takes;
      thawed <= m2s.cyc and thawed;

      if count = 3 then
        whole    <= news;
        starting <= '0';
        took     <= '0';
        thawed   <= m2s.cyc and (thawed or takes);
      end if;
      closed <= starting;
      if m2s.cyc = '0' or thawed = '1' or closed = '1' then
        shown <= whole;
      end if;

      if reset = '1' then
        count      <= "00";
        starting   <= '1';
        closed     <= '1';
        live       <= (others => (others => '0'));
        whole      <= (others => (others => '0'));
        shown      <= (others => (others => '0'));
        took       <= '0';
        failed_now <= '0';
        steps      <= 0;
        waits      <= 0;
      end if;
    end if;
  end process;

  -- Where the design is in its round, and which banks it uses. The bank of this round is neither the last one nor that
  -- of the bus. Each condition has a bit of its own, which the solver finds easier.
  round_fits <= (
    to_bit(clocks = count), begins xnor starting, shut xnor closed, thaws xnor thawed, put xnor took,
    to_bit(near = first(1) & first(0)), to_bit(seen = second(1) & second(0)),
    closed or not starting, not starting or (closed and to_bit(live = nothing)),
    to_bit(old /= 0), to_bit(bank /= 0), to_bit(for_bus /= 0), to_bit(bank /= for_bus),
    to_bit(count = 0 or old /= bank), to_bit(count /= 0 or old = bank or starting = '1'),
    to_bit(count /= 0 or starting = '0' or (old = 1 and bank = 2 and for_bus = 1)));

  exists <= to_bit(unsigned(m2s.adr) < 4);

  turn_sums <= std_ulogic_vector(base + unsigned(resize(went, bits))) & std_ulogic_vector(base_fault + fails);

  each : for channel in 0 to 1 generate
    signal state : state_t; -- of the reference
    signal turn  : std_ulogic; -- the turn behind its own: the state is to be written
    signal slot  : natural range 0 to 7;
    signal live_words, whole_words, shown_words : counts_t;
    signal is_due, due_sum : std_ulogic; -- to be in the memories, or still on the way to them
    signal sums_same, written_same, known_same : state_t;
    signal bus_same, whole_same, begun_same, shown_same, frozen_same : counts_t;
  begin
    live_words  <= std_ulogic_vector(live(channel)) & std_ulogic_vector(live(2 + channel));
    whole_words <= std_ulogic_vector(whole(channel)) & std_ulogic_vector(whole(2 + channel));
    shown_words <= std_ulogic_vector(shown(channel)) & std_ulogic_vector(shown(2 + channel));
    state       <= live_words & levels(channel) & sample(channel);
    turn        <= '1' when count = (2 + 2 * channel) mod 4 or count = (3 + 2 * channel) mod 4 else '0';
    slot        <= channel + 2 * to_integer(bank) when channel = 0 and count > 1 else
                   channel + 2 * to_integer(bank) when channel = 1 and count = 0 else
                   channel + 2 * to_integer(old);

    -- One bit at a time, which the solver finds easier.
    is_due       <= not turn and not starting;
    sums_same    <= ((turn_sums & now_are & newest xnor state) or not due_sum) and
                    ((std_ulogic_vector(sum) & std_ulogic_vector(fault_sum) xnor turn_sums) & "1111");
    due_sum      <= turn and to_bit(channel = 0 or starting = '0');
    written_same <= (written(slot) xnor state) or not is_due;
    bus_same     <= (bus_written(slot) xnor live_words) or not
                    (is_due or (due_sum and count(0) and not acks and not errs));
    known_same   <= (known xnor state) or not to_bit(count = 2 * channel + 1 and starting = '0');
    whole_same   <= (bus_written(channel + 2 * to_integer(old)) xnor whole_words) or not
                    to_bit(starting = '0' and (channel = 0 or count > 1));
    begun_same   <= (whole_words xnor live_words) or not to_bit(starting = '0' and count < 2);
    shown_same   <= (bus_written(channel + 2 * to_integer(for_bus)) xnor shown_words) or not
                    to_bit(closed = '0' and (channel = 0 or count /= 1 or for_bus /= old));
    frozen_same  <= (shown_words xnor whole_words) or not to_bit(closed = '0' and for_bus = old and count /= 0);

    sums_fit(channel)    <= (and sums_same) and to_bit(due_sum = '0' or place = slot);
    memory_fits(channel) <= (and written_same) and (and bus_same);
    known_fits(channel)  <= (and known_same) and to_bit(count /= 2 * channel + 1 or taken = sampled);
    whole_fits(channel)  <= (and whole_same) and (and begun_same);
    shown_fits(channel)  <= and shown_same;
    frozen_fits(channel) <= and frozen_same;
  end generate;

  -- How long an access waits at most until this clock. Channel 0 is written at clock 1, and channel 1 at clock 3.
  waits_most <=
    1 when m2s.we = '0' or exists = '0' or m2s.sel /= "1111" else
    longest when acks = '1' else
    to_integer(count) + 2 when put = '1' else
    to_integer(count + 2) when m2s.adr(0) = '0' else
    to_integer(count);
  waits_fit <= to_bit(waits <= waits_most) or not (m2s.cyc and m2s.stb) or to_bit(waits = 0);

  -- An answer, and a write that was taken.
  answer_fits <= (
    acks nand errs, not closed or (acks nor put), not put or (m2s.cyc and m2s.stb and m2s.we),
    not put or (and m2s.sel), not put or exists, not put or (acks nor errs), and found_same);
  given_word <= found(bits - 1 downto 0) when m2s.adr(1) = '1' else found(2 * bits - 1 downto bits);
  found_same <= (given_word xnor std_ulogic_vector(expected)) or not (acks and not m2s.we);

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always asked = '1' -> m2s.cyc = '1';

  -- At every clock, the design is at the same place of the same round as the reference.
  round_in_place : assert always (and round_fits) = '1';

  -- What is to be written of a channel is what the reference has.
  sums_in_place : assert always (and sums_fit) = '1';

  -- The memories have what the reference has, once it is written.
  memory_in_place : assert always (and memory_fits) = '1';

  -- So does the state that a turn has read.
  known_in_place : assert always (and known_fits) = '1';

  -- So have the words of the last round that has ended.
  whole_in_place : assert always (and whole_fits) = '1';

  -- So has the bank that the bus reads.
  shown_in_place : assert always (and shown_fits) = '1';

  -- The bank of the last round is that of the bus while both are the same.
  frozen_in_place : assert always (and frozen_fits) = '1';

  -- So has an answer.
  answer_in_place : assert always (and answer_fits) = '1';

  -- A write waits for the turn of its channel, and for the end of that round.
  waits_in_place : assert always waits_fit = '1';

  -- An access is answered in less than two rounds, once the first round behind a reset has ended.
  answered_soon : assert always waits <= 6;

  -- A read gives what the reference shows: no step of either channel is lost or doubled, also when a preset comes with
  -- it, none comes of a level that one sample has, and all words are of one moment.
  read_is_right : assert always begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' ->
                  unsigned(s2m.dat(word_t'range)) = expected;

  -- The event comes with each impossible step, and with nothing else.
  event_is_right : assert always begun = '1' and reset = '0' -> failed = failed_now;

  -- A preset was written and is read back, behind some steps.
  preset_seen : cover {begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and expected = 90 and
                       m2s.adr(1 downto 0) = "00" and steps = 2};

  -- An impossible step is read.
  fault_seen : cover {begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and expected = 1 and
                      m2s.adr(1 downto 0) = "11"};

end architecture;
