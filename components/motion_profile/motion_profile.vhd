-- SPDX-License-Identifier: BSD-3-Clause
--
-- A motion profile: the way to a target with limited speed, acceleration and jerk, for a control loop in the gateware.
--
--                 +-------------+    +-----------------+--> position_wire, to the target of a loop
--   target ------>| trapezoid   |--->| mean of the last|--> velocity_wire, to its feed-forward
--   speed ------->| of speeds   |    | 2**smooth_bits  |--> acceleration_wire
--   acceleration >|             |    | periods         |
--                 +-------------+    +-----------------+
--                        ^ feedback_wire: where it starts
--
--   +0   control: bit 0 enable
--   +1   status (read): bit 0 running, 1 it has arrived at the target and rests
--   +2   target in counts, two's complement
--   +3   the highest speed in 1/2**24 count a period, 32 bits
--   +4   the acceleration in 1/2**24 count a period squared, 24 bits
--   +5   position of the profile in counts (read)
--   +6   velocity of the profile in 1/256 count a period, two's complement (read)
--
-- Way       In each of loop_hz periods the speed grows or falls by the acceleration, or stays. It falls as late as it
--           can without passing the target. Targets and the highest speed count from the next period on, also in
--           motion. The acceleration is taken at rest, and is at most the highest speed of a period. A highest speed
--           of 0 brakes and rests. The way may wrap as the position does: it is the shorter one.
-- Smooth    The velocity is the mean of those of the last 2**smooth_bits periods. So the acceleration changes in that
--           time, and not at once: an S-curve. The profile ends that time later, at the same place.
-- Safe      While enable is 0 the position is the feedback, if it is valid, and the velocity 0. So a loop that follows
--           rests, and a start makes no step. 0 is the safe value of the control word.
-- Event     arrived is high for one clock when a motion has ended: after a start, or after the target was written, the
--           target is reached.
-- Latency   A period begins with the target of that clock, and 10 clocks later the wires have it. An access takes 2
--           clocks.
-- Errors    err for other addresses, for a write of +1, +5 or +6, and for one that does not select all bytes.
-- Reset     Disabled. Target, speed and acceleration are 0, so nothing moves before they are written.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity motion_profile is
  generic (
    clock_hz               : positive                := 50_000_000;
    loop_hz                : positive                := 20_000;
    smooth_bits            : natural range 0 to 10   := 0;
    position_wire_bits     : positive range 4 to 32  := 32; -- of the element to which the wire leads
    velocity_wire_bits     : positive range 4 to 32  := 24;
    acceleration_wire_bits : positive range 4 to 32  := 24;
    data_width             : positive range 32 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    arrived      : out std_ulogic;

    feedback_wire     : in  wire_t := no_wire;
    position_wire     : out wire_t;
    velocity_wire     : out wire_t;
    acceleration_wire : out wire_t
  );
end entity;

architecture rtl of motion_profile is

  constant fraction_bits : positive := 24; -- behind the point of a count
  constant place_bits    : positive := 32 + fraction_bits;
  constant periods       : positive := 2 ** smooth_bits;
  constant bits          : positive := phase_bits(clock_hz, loop_hz);
  constant work_clocks   : positive := 16;

  subtype speed_t is unsigned(31 downto 0);
  subtype ramp_t is unsigned(fraction_bits - 1 downto 0);
  subtype place_t is signed(place_bits - 1 downto 0);
  subtype way_t is signed(place_bits downto 0);
  subtype step_t is signed(32 downto 0);                     -- of a period
  subtype sum_t is signed(33 + smooth_bits downto 0);        -- of steps
  subtype mean_t is signed(place_bits + smooth_bits - 1 downto 0);
  type steps_t is array (0 to periods - 1) of step_t;
  type state_t is (idle, aim, measure, compare, choose, go, move, recall, advance, give);

  signal read_words  : word_vector_t(0 to 6);
  signal write_words : word_vector_t(0 to 6);
  signal written     : std_ulogic_vector(0 to 6);

  signal phase  : unsigned(bits downto 0) := (others => '0');
  signal state  : state_t := idle;
  signal enable : std_ulogic;

  -- The trapezoid.
  signal place   : place_t := (others => '0');
  signal rest    : place_t := (others => '0');             -- of the way to the target
  signal way     : way_t := (others => '0');               -- the same, in the direction of the motion
  signal speed   : speed_t := (others => '0');             -- in the direction `back`
  signal back    : std_ulogic := '0';
  signal most    : speed_t := (others => '0');             -- of this period
  signal ramp    : ramp_t := (others => '0');              -- of this motion
  signal faster  : unsigned(32 downto 0) := (others => '0');
  signal brake   : unsigned(place_bits - 1 downto 0) := (others => '0'); -- the way until it rests, from this speed on
  signal further : unsigned(place_bits downto 0) := (others => '0');     -- the same, if it were faster

  signal is_near, is_short, has_room, fits, is_fast, is_last : std_ulogic := '0';

  -- The mean.
  signal steps  : steps_t := (others => (others => '0'));
  signal index  : natural range 0 to periods - 1 := 0;
  signal full   : std_ulogic := '0';                       -- all of `steps` is of this motion
  signal step   : step_t := (others => '0');
  signal old    : step_t := (others => '0');               -- the step that leaves the mean
  signal change : signed(33 downto 0) := (others => '0');
  signal sum    : sum_t := (others => '0');
  signal mean   : mean_t := (others => '0');

  signal velocity     : signed(31 downto 0) := (others => '0');
  signal acceleration : signed(33 downto 0) := (others => '0');
  signal position     : signed(31 downto 0) := (others => '0');

  signal waits   : std_ulogic := '0'; -- a target was written that has not been looked at
  signal moves   : std_ulogic := '1'; -- the target is new, and is not reached
  signal rests   : std_ulogic := '0'; -- at the target

begin

  assert clock_hz / loop_hz >= work_clocks
    report "motion_profile: a period is at least " & integer'image(work_clocks) & " clocks"
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "1011100", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  process (all) is
  begin
    read_words    <= write_words;
    read_words(0) <= (0 => enable, others => '0');
    read_words(1) <= (0 => enable, 1 => rests, others => '0');
    read_words(4) <= extended(write_words(4)(ramp_t'range));
    read_words(5) <= std_ulogic_vector(position);
    read_words(6) <= std_ulogic_vector(velocity);
  end process;

  enable <= write_words(0)(0);

  position_wire     <= wire_of(limited(position, position_wire_bits));
  velocity_wire     <= wire_of(limited(velocity, velocity_wire_bits));
  acceleration_wire <= wire_of(limited(acceleration, acceleration_wire_bits));

  memory : process (clock) is
  begin
    if rising_edge(clock) then
      old <= steps(index);
      if state = move then
        steps(index) <= step;
      end if;
    end if;
  end process;

  run : process (clock) is
    variable now : signed(31 downto 0);
  begin
    if rising_edge(clock) then
      phase   <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, loop_hz);
      arrived <= '0';

      case state is
        when idle =>
          if phase(bits) = '1' then
            state <= aim;
            waits <= '0';
            rest  <= shift_left(resize(signed(write_words(2)), place_bits), fraction_bits) - place;
            most  <= unsigned(write_words(3));
            if speed = 0 then
              ramp <= unsigned(write_words(4)(ramp_t'range));
              if unsigned(write_words(3)) < unsigned(write_words(4)(ramp_t'range)) then
                ramp <= unsigned(write_words(3)(ramp_t'range));
              end if;
            end if;
          end if;
        when aim =>
          state  <= measure;
          faster <= resize(speed, faster'length) + ramp;
          if speed = 0 then
            back <= rest(rest'high);
          end if;
        when measure =>
          state   <= compare;
          further <= resize(brake, further'length) + faster;
          way     <= resize(rest, way_t'length);
          if back = '1' then
            way <= -resize(rest, way_t'length);
          end if;
        when compare =>
          state <= choose;
          is_near  <= '0';
          is_short <= '0';
          has_room <= '0';
          fits     <= '0';
          is_fast  <= '0';
          if speed = 0 and way < signed('0' & resize(ramp, way_t'length)) then
            is_near <= '1';
          end if;
          if way < signed('0' & brake) then
            is_short <= '1';
          end if;
          if way >= signed('0' & further) then
            has_room <= '1';
          end if;
          if faster <= most then
            fits <= '1';
          end if;
          if speed > most then
            is_fast <= '1';
          end if;
        when choose =>
          state   <= go;
          is_last <= is_near;
          if is_near = '1' then
            null;
          elsif (is_fast = '1' or is_short = '1') and speed /= 0 then
            speed <= speed - ramp;
            brake <= brake - speed;
          elsif has_room = '1' and fits = '1' then
            speed <= faster(speed_t'range);
            brake <= further(brake'range);
          end if;
        when go =>
          state <= move;
          step  <= signed('0' & speed);
          if is_last = '1' then
            step <= rest(step_t'range); -- less than the acceleration
          elsif back = '1' then
            step <= -signed('0' & speed);
          end if;
        when move =>
          state  <= recall;
          place  <= place + step;
          change <= resize(step, change'length);
          if full = '1' then
            change <= resize(step, change'length) - old;
          end if;
          if index = periods - 1 then
            index <= 0;
            full  <= '1';
          else
            index <= index + 1;
          end if;
        when recall =>
          state <= advance;
          sum   <= sum + change;
        when advance =>
          state <= give;
          mean  <= mean + sum;
        when give =>
          state        <= idle;
          position     <= mean(mean'high downto mean'high - 31);
          velocity     <= resize(shift_right(sum, smooth_bits + fraction_bits - 8), 32);
          acceleration <= shift_right(change, smooth_bits);
          if waits = '0' then
            rests <= '0';
            if speed = 0 and is_last = '1' and step = 0 and sum = 0 then
              rests   <= '1';
              moves   <= '0';
              arrived <= moves;
            end if;
          end if;
      end case;

      if written(2) = '1' and enable = '1' then
        waits <= '1';
        moves <= '1';
        rests <= '0';
      end if;

      if enable = '0' or reset = '1' then
        state        <= idle;
        speed        <= (others => '0');
        brake        <= (others => '0');
        sum          <= (others => '0');
        velocity     <= (others => '0');
        acceleration <= (others => '0');
        index        <= 0;
        full         <= '0';
        waits        <= '0';
        moves        <= '1';
        rests        <= '0';
        arrived      <= '0';
        now := position;
        if is_valid(feedback_wire) = '1' then
          now := value_of(feedback_wire);
        end if;
        position <= now;
        place    <= shift_left(resize(now, place_bits), fraction_bits);
        mean     <= shift_left(resize(now, mean'length), fraction_bits + smooth_bits);
      end if;
      if reset = '1' then
        phase <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
