-- SPDX-License-Identifier: BSD-3-Clause
--
-- Computes the velocities of all axes, one axis after the other, with one adder. It needs no division.
--
-- In each ramp period an axis moves its velocity towards a goal, by its acceleration at most. The goal is the velocity
-- target, or the speed limit towards the position target, or zero. In position mode the new velocity v must leave room
-- to brake. With the acceleration A a period and the way d to the target, that is
--
--   v * (v + A) <= 2 * A * d   (in units of the registers: v * (v + A) <= 2**15 * A * d, with d in 1/256 step)
--
-- If not, the goal is zero. The comparison is exact, for the middle of the target's step. It adds and subtracts both
-- products bit by bit, from the highest bits on, in one accumulator. It ends as soon as the sign is certain. So a
-- change of target, speed or acceleration takes effect at once, whatever the axis does.
--
-- An instruction takes three clocks: its address, its operand, and its sum. The third one is the first one of the next
-- instruction if both belong to the comparison, because nothing there waits for a sum. The bus may read the parameters
-- in the clocks without an address.
--
-- Ports     read_word, read_axis: the word that the ramp wants while `reads` is high. read_data has it in the next
--           clock. write_word: where `result` goes while `writes` is high. store: result is a velocity, for the bank
--           that is not in use. store_shift: result is a shift. Both wait until stored. look and looked are those of
--           stepgen_motion. base: a base period ends. enabled: without it the goal is zero. near: the axis is within
--           its target's step. moving: its velocity is not zero, or has just become so. A zero in a reversal is no
--           rest.
-- Latency   A pass takes at most pass_clocks for each axis. All new velocities come into use at the same base period.
-- Errors    None.
-- Reset     The pass ends. `clearing` clears the velocities.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.stepgen_pkg.all;

entity stepgen_ramp is
  generic (
    axes     : positive := 4;
    clock_hz : positive := 50_000_000
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic;
    clearing : in  std_ulogic;
    base     : in  std_ulogic;
    bank     : out std_ulogic := '0';

    axis       : out natural range 0 to axes - 1;
    reads      : out std_ulogic;
    read_word  : out word_index_t;
    read_data  : in  std_ulogic_vector(31 downto 0);
    writes     : out std_ulogic;
    write_word : out word_index_t;
    result     : out std_ulogic_vector(31 downto 0);

    store       : out std_ulogic;
    store_shift : out std_ulogic;
    stored      : in  std_ulogic;

    look      : out std_ulogic;
    look_word : out motion_word_t;
    looked    : in  std_ulogic;
    look_data : in  std_ulogic_vector(31 downto 0);

    enabled : in  std_ulogic_vector(axes - 1 downto 0);
    near    : out std_ulogic_vector(axes - 1 downto 0);
    moving  : out std_ulogic_vector(axes - 1 downto 0);

    shift   : in  std_ulogic_vector(axes - 1 downto 0); -- a shift waits in the parameters
    shifts  : out std_ulogic;                           -- stepgen_motion shall add it
    shifted : in  std_ulogic
  );
end entity;

architecture rtl of stepgen_ramp is

  constant phase_bits  : positive := fraction_bits + base_bits(axes, clock_hz);
  constant way_bits    : positive := 32 + fraction_bits;
  constant places      : positive := way_bits + 15;                  -- of the products
  constant pass_clocks : positive := 360;

  type state_t is (
    waiting, load_control, load_phase, load_target, load_position, load_velocity_target, compare_speed,
    load_goal, write_goal, load_change, reach, load_velocity, change_velocity, write_next, load_speed, add_reserve,
    write_reserve, add_way, take_speed, judge, finish, load_shift, put_shift, await_shift);

  signal state    : state_t := waiting;
  signal after_it : state_t;                        -- the instruction
  signal starts   : std_ulogic;                     -- the first clock of an instruction
  signal executes : std_ulogic := '0';              -- the second one
  signal adds     : std_ulogic := '0';              -- the third one
  signal settled  : std_ulogic;                     -- the state may go on: it needs no sum that is still to come
  signal number   : natural range 0 to axes - 1 := 0;
  signal count    : unsigned(base_bits(axes, clock_hz) - ramp_bits - 1 downto 0) := (others => '0');

  signal operand   : signed(31 downto 0) := (others => '0');
  signal sum       : signed(31 downto 0) := (others => '0');
  signal way       : unsigned(way_bits - 1 downto 0) := (others => '0');   -- to go, shifted out
  signal speed     : unsigned(speed_bits - 1 downto 0) := (others => '0'); -- of the candidate, shifted out
  signal place     : natural range 0 to places - 1 := 0;                   -- of the bits that are compared
  signal speeds    : std_ulogic := '0';             -- the place is one of a speed
  signal goes      : std_ulogic := '0';             -- enabled
  signal to_target : std_ulogic := '0';             -- position mode
  signal brakes    : std_ulogic := '0';             -- the candidate was too fast
  signal borrow    : std_ulogic := '0';             -- the position is in the upper half of its step
  signal arrived   : std_ulogic := '0';             -- the position is that of the target
  signal moves     : std_ulogic := '0';             -- the candidate is not zero
  signal turning   : std_ulogic_vector(axes - 1 downto 0) := (others => '0'); -- the velocity in use is not zero
  signal goal_down : std_ulogic := '0';             -- the signs of the goal, the way and the change of velocity
  signal way_down  : std_ulogic := '0';
  signal slower    : std_ulogic := '0';

  -- What an instruction does: sum := (0, sum or 2 * sum) + (operand or -operand).
  type kept_t is (kept_none, kept_sum, kept_double);
  signal instructs   : std_ulogic;                  -- the state is an instruction
  -- Its first two clocks decide on it, each for the next one.
  signal kept, kept_then          : kept_t := kept_none;
  signal minus, minus_then        : std_ulogic := '0'; -- the operand is inverted
  signal carry, carry_then        : std_ulogic := '0';
  signal from_motion, from_then   : std_ulogic := '0'; -- the operand is a word of stepgen_motion
  signal current, following : word_index_t;         -- the velocity in use, the next one
  signal tick        : std_ulogic;                  -- a ramp period ends
  signal certain     : std_ulogic;                  -- the sign of the comparison will not change
  signal turns       : std_ulogic;                  -- the sum is a velocity, not a way
  signal is_zero     : std_ulogic;                  -- of a way in steps: within the step of the target

begin

  assert axes * pass_clocks <= clock_hz / 2 ** ramp_bits
    report "stepgen: a clock of " & integer'image(clock_hz) & " Hz is too slow for the ramps of " &
           integer'image(axes) & " axes: it must be " & integer'image(axes * pass_clocks * 2 ** ramp_bits) &
           " Hz or more"
    severity failure;

  axis   <= number;
  result <= std_ulogic_vector(sum);
  tick   <= base when count = 2 ** count'length - 1 else '0';

  current   <= word_velocity when bank = '0' else word_next;
  following <= word_next when bank = '0' else word_velocity;

  settled     <= not adds when state /= add_way and state /= take_speed else '1';
  starts      <= instructs and not executes and settled;

  writes      <= settled when state = write_goal or state = write_next or state = write_reserve else '0';
  write_word  <= word_goal when state = write_goal else following when state = write_next else word_reserve;
  store       <= settled when state = write_next else '0';
  store_shift <= settled when state = put_shift else '0';
  shifts      <= '1' when state = await_shift else '0';

  from_motion <= '1' when state = load_phase or state = load_position else '0';
  look        <= from_motion and starts;
  look_word   <= motion_phase when state = load_phase else motion_position;
  reads       <= starts and not from_motion;

  -- The way ends in the middle of a step. So it borrows in the upper half of a step.
  turns   <= '1' when state = write_next else '0';
  certain <= '1' when sum(31 downto 29) /= "000" and sum(31 downto 29) /= "111" else '0';
  is_zero <= '1' when sum = (31 downto 0 => borrow and not turns) else '0';

  -- In the first clock of an instruction, and in a state of one clock, `sum` is the result of the instruction before.
  instruct : process (all) is
  begin
    instructs <= '1';
    after_it  <= waiting;
    read_word <= word_zero;
    kept      <= kept_none;
    minus     <= '0';
    carry     <= '0';

    case state is
      when load_control =>
        after_it <= load_phase;
        read_word <= word_control;
      when load_phase =>
        after_it <= load_target;
      when load_target =>
        after_it <= load_position;
        read_word <= word_target;
      when load_position =>
        after_it <= load_velocity_target;
        if to_target = '1' then
          after_it <= load_goal;
        end if;
        kept  <= kept_sum;
        minus <= '1';
        carry <= not borrow;
      when load_velocity_target =>
        after_it <= compare_speed;
        read_word <= word_velocity_target;
      when compare_speed =>
        after_it <= load_goal;
        -- The speed is subtracted from the target, or added to a negative one. If its sign changes, it is within.
        read_word <= word_speed;
        kept      <= kept_sum;
        minus     <= not sum(31);
        carry     <= not sum(31);
      when load_goal =>
        after_it <= write_goal;
        if goes = '1' and brakes = '0' then
          if to_target = '0' and sum(31) /= goal_down then
            read_word <= word_velocity_target;
          else
            read_word <= word_speed;
            minus     <= goal_down;
            carry     <= goal_down;
            if to_target = '1' then
              minus <= sum(31);
              carry <= sum(31);
            end if;
          end if;
        end if;
      when load_change =>
        after_it <= reach;
        read_word <= current;
        kept      <= kept_sum;
        minus     <= '1';
        carry     <= '1';
      when reach =>
        after_it <= load_velocity;
        read_word <= word_acceleration;
        kept      <= kept_sum;
        minus     <= not sum(31);
        carry     <= not sum(31);
      when load_velocity =>
        after_it  <= change_velocity;
        read_word <= current;
        if sum(31) /= slower then
          after_it  <= write_next;
          read_word <= word_goal;
        end if;
      when change_velocity =>
        after_it <= write_next;
        read_word <= word_acceleration;
        kept      <= kept_sum;
        minus     <= slower;
        carry     <= slower;
      when load_speed =>
        after_it <= add_reserve;
        read_word <= following;
        minus     <= way_down;
        carry     <= way_down;
      when add_reserve =>
        after_it <= write_reserve;
        read_word <= word_acceleration;
        kept      <= kept_sum;
      when add_way =>
        after_it <= take_speed;
        if way(way'high) /= way_down then
          read_word <= word_acceleration;
        end if;
        if place /= places - 1 then
          kept <= kept_double;
        end if;
      when take_speed =>
        after_it <= add_way;
        if place = 0 then
          after_it <= judge;
        end if;
        if speed(speed'high) = '1' and speeds = '1' then
          read_word <= word_reserve;
        end if;
        kept  <= kept_sum;
        minus <= '1';
        carry <= '1';
      when load_shift =>
        after_it <= put_shift;
        read_word <= word_shift;
      when others =>
        instructs <= '0';
    end case;
  end process;

  execute : process (clock) is
    variable word, before : signed(31 downto 0);
    variable total        : signed(32 downto 0);
  begin
    if rising_edge(clock) then
      word := signed(read_data);
      if from_then = '1' then
        word := signed(look_data);
      end if;
      if minus_then = '1' then
        word := not word;
      end if;
      operand <= word;
      case kept_then is
        when kept_none => before := (others => '0');
        when kept_sum => before := sum;
        when kept_double => before := sum(30 downto 0) & '0';
      end case;
      if state = load_goal and brakes = '0' then
        way(way'high downto fraction_bits) <= unsigned(sum);
      elsif state = load_phase then
        way(fraction_bits - 1 downto 0) <=
          look_data(phase_bits - 1) & not unsigned(look_data(phase_bits - 2 downto phase_bits - fraction_bits));
      elsif state = take_speed and executes = '1' then
        way <= way(way'high - 1 downto 0) & way_down;
      end if;
      if state = add_reserve and executes = '0' then
        speed <= unsigned(sum(speed_bits - 1 downto 0));
      elsif state = take_speed and executes = '1' and speeds = '1' then
        speed <= speed(speed'high - 1 downto 0) & '0';
      end if;

      if adds = '1' then
        total := (before & '1') + (operand & carry_then); -- one adder for both
        sum   <= total(32 downto 1);
      end if;
      kept_then  <= kept;
      minus_then <= minus;
      carry_then <= carry;
      from_then  <= from_motion;
      executes   <= starts and (looked or not from_motion);
      adds       <= executes;

      -- What the first clock of an instruction keeps of the result before.
      if executes = '0' then
        case state is
          when compare_speed =>
            goal_down <= sum(31);
          when load_goal =>
            if to_target = '1' and brakes = '0' then
              way_down <= sum(31);
            end if;
            if brakes = '0' then
              arrived <= is_zero and to_target;
            end if;
          when reach =>
            slower <= sum(31);
          when others =>
            null;
        end case;
      end if;

      case state is
        when write_goal =>
          if settled = '1' then
            state <= load_change;
          end if;
        when write_next =>
          moves <= not is_zero;
          if stored = '1' then
            state <= finish;
          end if;
          if stored = '1' and to_target = '1' and goes = '1' and brakes = '0' and sum(31) = way_down then
            state <= load_speed;
          end if;
        when write_reserve =>
          place  <= places - 1;
          speeds <= '0';
          if settled = '1' then
            state <= add_way;
          end if;
        when judge =>
          if settled = '1' then
            state <= finish;
            if sum(31) = '1' then
              brakes <= '1';
              state  <= load_goal;
            end if;
          end if;
        when finish =>
          near(number)    <= arrived;
          turning(number) <= moves;
          moving(number)  <= moves or turning(number);
          state           <= load_shift;
        when put_shift =>
          if stored = '1' then
            state <= await_shift;
          end if;
        when others =>
          if executes = '1' then
            state <= after_it;
          end if;
      end case;

      -- What the second clock keeps.
      if executes = '1' then
        case state is
          when load_control =>
            goes      <= read_data(control_enable) and enabled(number);
            to_target <= not read_data(control_velocity_mode);
            brakes    <= '0';
          when load_phase =>
            borrow <= look_data(phase_bits - 1);
          when take_speed =>
            if place > 0 then
              place <= place - 1;
            end if;
            if place = speed_bits then
              speeds <= '1';
            end if;
          when add_way =>
            if certain = '1' and place /= places - 1 then
              adds  <= '0';
              state <= judge;
            end if;
          when others =>
            null;
        end case;
      end if;

      if (state = load_shift and shift(number) = '0') or (state = await_shift and shifted = '1') then
        executes <= '0';
        state    <= waiting;
        if number /= axes - 1 then
          number <= number + 1;
          state  <= load_control;
        end if;
      end if;

      if base = '1' then
        count <= count + 1;
      end if;
      if tick = '1' then
        bank     <= not bank;
        number   <= 0;
        executes <= '0';
        adds     <= '0';
        state    <= load_control;
      end if;

      if reset = '1' or clearing = '1' then
        sum      <= (others => '0');
        count    <= (others => '0');
        bank     <= '0';
        number   <= 0;
        executes <= '0';
        adds     <= '0';
        state    <= waiting;
        near     <= (near'range => '0');
        moving   <= (moving'range => '0');
        turning  <= (turning'range => '0');
      end if;
    end if;
  end process;

end architecture;
