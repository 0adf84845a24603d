-- SPDX-License-Identifier: BSD-3-Clause
--
-- Makes steps from the velocities of all axes, and counts them. One adder and two memories serve all axes.
--
-- Each base period has these slots, one clock each:
--
--   0                the clock, as it will be in slot 1 of the next base period
--   1                the stamp of the latch of one axis
--   2                the position of this latch, or a shift of a position
--   3 ..             the phases: phase := phase + velocity. A carry is a step up, a borrow a step down.
--   positions_at ..  the positions of the axes that stepped: position := position +- 1
--
-- All of them are one operation: a word of the memory, plus a term, goes to a word of the memory. The term is a
-- velocity or a constant. A slot without work serves `look`, which reads a word.
--
-- A phase is stored only if its step was taken by the pins. So a step that has to wait is neither lost nor doubled: the
-- axis stands still until DIR has turned or the pulse before has ended. Position and phase are one number. At a
-- reversal the axis goes back through the same fraction of a step. A word is read again three slots after its operation
-- began, or later. The order of the slots sees to that.
--
-- Ports     velocity_write: stores velocity_data, a velocity in 1/256 step/s, for velocity_axis and velocity_bank.
--           shift_write stores a shift. Both wait until put. bank: which of both velocities of an axis is in use.
--           look: asks for the word look_word of look_axis. It is on look_data one clock after looked. shift: adds the
--           shift to the position of shift_axis. shifted is high for one clock when that was done. catch: latch the
--           position of this axis and the time. caught is high for one clock when that was done. stepped, step_axis,
--           step_down: a step was taken. late: a step waits because the pulse before has not ended.
-- Latency   A step is on its pin 3 clocks after its slot, and in the position at most 5 clocks after that.
--           A look waits less than two base periods. A latch comes within axes + 1 base periods.
-- Reset     Clears all words. `clearing` is high meanwhile, and `sweep` counts the words of stepgen. Nothing is served.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.stepgen_pkg.all;
  use work.width_pkg.all;

entity stepgen_motion is
  generic (
    axes          : positive := 4;
    clock_hz      : positive := 50_000_000;
    step_len_ns   : natural  := 200;
    step_space_ns : natural  := 200;
    dir_setup_ns  : natural  := 200;
    dir_hold_ns   : natural  := 200
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic;
    clearing : out std_ulogic := '1';
    sweep    : out unsigned(axis_bits(axes) + 3 downto 0) := (others => '0');

    velocity_write : in std_ulogic;
    shift_write    : in std_ulogic;
    velocity_bank  : in std_ulogic;
    velocity_axis  : in natural range 0 to axes - 1;
    velocity_data  : in std_ulogic_vector(31 downto 0);
    put            : out std_ulogic;
    bank           : in std_ulogic;
    base           : out std_ulogic; -- the last clock of a base period

    look      : in  std_ulogic;
    look_axis : in  natural range 0 to 2 ** axis_bits(axes) - 1;
    look_word : in  motion_word_t;
    looked    : out std_ulogic;
    look_data : out std_ulogic_vector(31 downto 0);

    shift      : in  std_ulogic;
    shift_axis : in  natural range 0 to axes - 1;
    shifted    : out std_ulogic;

    catch  : in  std_ulogic_vector(axes - 1 downto 0);
    caught : out std_ulogic_vector(axes - 1 downto 0);

    stepped   : out std_ulogic;
    step_axis : out natural range 0 to axes - 1;
    step_down : out std_ulogic;
    late      : out std_ulogic;

    step      : out std_ulogic_vector(axes - 1 downto 0);
    direction : out std_ulogic_vector(axes - 1 downto 0)
  );
end entity;

architecture rtl of stepgen_motion is

  constant number_bits  : positive := axis_bits(axes);
  constant rate_bits    : positive := base_bits(axes, clock_hz);
  constant phase_bits   : positive := fraction_bits + rate_bits;
  constant short_clocks : positive := clock_hz / 2 ** rate_bits; -- of a base period; some are one longer
  constant phases_at    : positive := 3;
  constant positions_at : positive := phases_at + maximum(axes, 3);
  constant last_slot    : positive := positions_at + axes;       -- of the work

  -- The base rate is made without an error: `owed` gains 2**rate_bits in each clock, and loses clock_hz in each period.
  -- Both are divided by their common powers of two.
  function common_bits return natural is
    variable rest : positive := clock_hz;
    variable bits : natural := 0;
  begin
    while rest mod 2 = 0 and bits < rate_bits loop
      rest := rest / 2;
      bits := bits + 1;
    end loop;
    return bits;
  end function;

  constant gain : positive := 2 ** (rate_bits - common_bits);
  constant loss : positive := clock_hz / 2 ** common_bits;

  subtype address_t is unsigned(number_bits + 2 downto 0);
  subtype term_index_t is unsigned(number_bits + 1 downto 0);
  subtype word_t is std_ulogic_vector(31 downto 0);
  type memory_t is array (0 to 2 ** address_t'length - 1) of word_t;
  type terms_t is array (0 to 2 ** term_index_t'length - 1) of word_t;

  -- Terms beside the velocities.
  constant first_constant : natural := 2 ** (number_bits + 1);
  constant term_none  : natural := first_constant;
  constant term_up    : natural := first_constant + 1;
  constant term_down  : natural := first_constant + 2;
  constant term_short : natural := first_constant + 3;
  constant term_long  : natural := first_constant + 2 ** number_bits;
  constant term_begin : natural := first_constant + 2 ** number_bits + 1;
  constant term_shift : natural := first_constant + 2 ** number_bits + 2;

  -- Clocks from the end of the reset to slot 1 of the second base period.
  constant begin_clocks : positive := 2 ** sweep'length + short_clocks + 1;

  function constants return terms_t is
    variable result : terms_t := (others => (others => '0'));
  begin
    result(term_up)    := (0 => '1', others => '0');
    result(term_down)  := (others => '1');
    result(term_short) := std_ulogic_vector(to_unsigned(short_clocks, 32));
    result(term_long)  := std_ulogic_vector(to_unsigned(short_clocks + 1, 32));
    result(term_begin) := std_ulogic_vector(to_unsigned(begin_clocks, 32));
    return result;
  end function;

  signal memory : memory_t;
  signal terms  : terms_t := constants;

  type work_t is (idle, other, phase, position, latch_position, latch_stamp, shift_position);
  subtype axis_t is natural range 0 to axes - 1;

  signal owed    : signed(bits_for(loss + 1) downto 0) := (others => '0');
  signal paid    : std_ulogic;                                -- a base period ends
  signal slot    : natural range 0 to short_clocks := 0;
  signal first   : std_ulogic := '1';                          -- the clock has not been written yet
  signal was_long : std_ulogic := '0';                         -- the base period before was one clock longer
  signal served  : axis_t := 0;                                -- the axis whose latch this base period may serve
  signal moved   : std_ulogic_vector(axes - 1 downto 0) := (others => '0'); -- stepped, but not yet in the position

  -- A word is never read and written at once, nor is a term: what such a read gives depends on the chip.
  -- The three stages of an operation: its addresses, its sum, its result.
  signal work_now, work_then, work_last : work_t := idle;
  signal axis_now, axis_then, axis_last : axis_t := 0;
  signal from_now                       : address_t;
  signal to_now, to_then, to_last       : address_t := (others => '0');
  signal term_now, to_term              : term_index_t;
  signal word, term                     : word_t;
  signal sum                            : signed(31 downto 0) := (others => '0');

  signal ask, taken       : std_ulogic;
  signal down, beyond     : std_ulogic;                       -- of a phase
  signal asks, takes, lates : std_ulogic_vector(axes - 1 downto 0);
  signal store, put_term  : std_ulogic;
  signal clash            : std_ulogic;                       -- the word that is read is being written

  function place (number : natural; part : motion_word_t) return address_t is
  begin
    return part & to_unsigned(number, number_bits);
  end function;

begin

  look_data <= word;
  paid      <= not owed(owed'high);
  base      <= paid and not clearing;

  choose : process (all) is
  begin
    work_now <= idle;
    axis_now <= served;
    from_now <= place(look_axis, look_word);
    to_now   <= place(look_axis, look_word);
    term_now <= to_unsigned(term_none, term_now'length);
    looked   <= look and not clearing and not clash;

    if slot = 0 then
      work_now <= other;
      from_now <= place(0, motion_now);
      to_now   <= place(0, motion_now);
      term_now <= to_unsigned(term_short, term_now'length);
      if first = '1' then
        term_now <= to_unsigned(term_begin, term_now'length);
      elsif was_long = '1' then
        term_now <= to_unsigned(term_long, term_now'length);
      end if;
      looked <= '0';
    elsif slot = 1 and catch(served) = '1' then
      work_now <= latch_stamp;
      from_now <= place(0, motion_now);
      to_now   <= place(served, motion_stamp);
      looked   <= '0';
    elsif slot = 2 and work_then = latch_stamp then
      work_now <= latch_position;
      from_now <= place(served, motion_position);
      to_now   <= place(served, motion_latched);
      looked   <= '0';
    elsif slot = 2 and shift = '1' then
      work_now <= shift_position;
      axis_now <= shift_axis;
      from_now <= place(shift_axis, motion_position);
      to_now   <= place(shift_axis, motion_position);
      term_now <= to_unsigned(term_shift, term_now'length);
      looked   <= '0';
    elsif slot >= phases_at and slot < phases_at + axes then
      work_now <= phase;
      axis_now <= slot - phases_at;
      from_now <= place(slot - phases_at, motion_phase);
      to_now   <= place(slot - phases_at, motion_phase);
      term_now <= '0' & bank & to_unsigned(slot - phases_at, number_bits);
      looked   <= '0';
    elsif slot >= positions_at and slot < last_slot then
      if moved(slot - positions_at) = '1' then
        work_now <= position;
        axis_now <= slot - positions_at;
        from_now <= place(slot - positions_at, motion_position);
        to_now   <= place(slot - positions_at, motion_position);
        term_now <= to_unsigned(term_down, term_now'length);
        if direction(slot - positions_at) = '1' then
          term_now <= to_unsigned(term_up, term_now'length);
        end if;
        looked <= '0';
      end if;
    end if;
  end process;

  -- A phase went below zero or beyond one.
  down   <= sum(31);
  beyond <= sum(31) or sum(phase_bits);
  ask    <= '1' when work_last = phase and clearing = '0' and beyond = '1' else '0';

  route : process (all) is
  begin
    asks            <= (others => '0');
    asks(axis_last) <= ask;
    taken           <= takes(axis_last);
  end process;

  store <= '0' when work_last = idle or (ask = '1' and taken = '0') else '1';

  stepped   <= taken;
  step_axis <= axis_last;
  step_down <= down;
  late      <= or lates;
  shifted   <= '1' when work_last = shift_position else '0';

  told : process (all) is
  begin
    caught <= (others => '0');
    if work_last = latch_position then
      caught(axis_last) <= '1';
    end if;
  end process;

  pins : for number in 0 to axes - 1 generate
    pulse : entity work.stepgen_pulse
      generic map (
        length_clocks => clocks_of(step_len_ns, clock_hz), space_clocks => clocks_of(step_space_ns, clock_hz),
        setup_clocks => clocks_of(dir_setup_ns, clock_hz), hold_clocks => clocks_of(dir_hold_ns, clock_hz))
      port map (
        clock => clock, reset => reset, ask => asks(number), down => down, taken => takes(number),
        late => lates(number),
        step => step(number), direction => direction(number));
  end generate;

  -- The slots never read a word that is just written, so only a look waits for that.
  clash <= '1' when (store = '1' or clearing = '1') and from_now = to_last else '0';

  put_term <= '1' when (velocity_write = '1' or shift_write = '1') and (work_now = idle or clearing = '1') else '0';
  put      <= put_term;
  to_term  <= '0' & velocity_bank & to_unsigned(velocity_axis, number_bits) when velocity_write = '1' else
              to_unsigned(term_shift, to_term'length);

  memories : process (clock) is
  begin
    if rising_edge(clock) then
      if clash = '0' then
        word <= memory(to_integer(from_now));
      end if;
      if store = '1' or clearing = '1' then
        memory(to_integer(to_last)) <= std_ulogic_vector(sum);
      end if;
      if put_term = '1' then
        terms(to_integer(to_term)) <= velocity_data;
      end if;
      if put_term = '0' then
        term <= terms(to_integer(term_now));
      end if;
    end if;
  end process;

  advance : process (clock) is
    variable masked : signed(31 downto 0);
  begin
    if rising_edge(clock) then
      -- A phase has no bits above its fraction. What a carry or a borrow left there is dropped.
      masked := signed(word);
      if work_then = phase then
        masked(31 downto phase_bits) := (others => '0');
      end if;
      sum <= masked + signed(term);

      work_then <= work_now;
      work_last <= work_then;
      axis_then <= axis_now;
      axis_last <= axis_then;
      to_then   <= to_now;
      to_last   <= to_then;

      if taken = '1' then
        moved(axis_last) <= '1';
      end if;
      if work_now = position then
        moved(axis_now) <= '0';
      end if;
      if slot = 0 then
        first <= '0';
      end if;

      if paid = '1' then
        owed     <= owed + (gain - loss);
        slot     <= 0;
        was_long <= '0';
        if slot = short_clocks then
          was_long <= '1';
        end if;
        if served = axes - 1 then
          served <= 0;
        else
          served <= served + 1;
        end if;
      else
        owed <= owed + gain;
        slot <= slot + 1;
      end if;

      if clearing = '1' then
        sum       <= (others => '0');
        to_last   <= sweep(address_t'range);
        sweep     <= sweep + 1;
        work_then <= idle;
        work_last <= idle;
        moved     <= (others => '0');
        owed      <= to_signed(gain - loss, owed'length);
        slot      <= 0;
        first     <= '1';
        was_long  <= '0';
        served    <= 0;
        if sweep = 2 ** sweep'length - 1 then
          clearing <= '0';
        end if;
      end if;

      if reset = '1' then
        clearing <= '1';
        sweep    <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
