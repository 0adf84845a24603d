-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of stepgen_ramp with one axis. A ramp period may end at any clock in which no pass is under way. The
-- motion unit may answer, take a velocity and take a shift at any clock. The parameters may have any values, and change
-- between two passes. A reference has the velocity in use, the goal, and what the next velocity must be.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.stepgen_pkg.all;

entity stepgen_ramp_formal is
  port (
    clk          : in std_ulogic;
    reset        : in std_ulogic;
    clearing     : in std_ulogic;
    base         : in std_ulogic;
    enabled      : in std_ulogic_vector(0 downto 0);
    is_on        : in std_ulogic;                      -- in the control word
    in_velocity  : in std_ulogic;
    fastest      : in unsigned(27 downto 0);           -- the speed
    acceleration : in unsigned(19 downto 0);
    wanted       : in signed(31 downto 0);             -- the velocity target
    read_data    : in std_ulogic_vector(31 downto 0);
    stored       : in std_ulogic;
    looked       : in std_ulogic;
    look_data    : in std_ulogic_vector(31 downto 0);
    shift        : in std_ulogic_vector(0 downto 0);
    shifted      : in std_ulogic;
    state        : in unsigned(4 downto 0);            -- shows the instruction, as all of these show signals
    executes     : in std_ulogic;
    adds         : in std_ulogic;
    sum          : in signed(31 downto 0);
    slower       : in std_ulogic;
    goal_down    : in std_ulogic;
    goes         : in std_ulogic;
    to_target    : in std_ulogic;
    brakes       : in std_ulogic;
    place        : in unsigned(5 downto 0);
    tick         : in std_ulogic
  );
end entity;

architecture properties of stepgen_ramp_formal is

  constant clocks_most : positive := 288; -- of a pass in which it waits for nothing
  constant places      : positive := 55;
  constant way_begins  : positive := 43;  -- clocks until the comparison
  constant second_pass : positive := 246; -- clocks until the way back to the goal

  -- The places of `state` in its type.
  constant waiting       : natural := 0;
  constant load_control  : natural := 1;
  constant compare_speed : natural := 6;
  constant load_goal     : natural := 7;
  constant write_goal    : natural := 8;
  constant load_change   : natural := 9;
  constant reach         : natural := 10;
  constant load_velocity : natural := 11;
  constant change_velocity : natural := 12;
  constant write_next    : natural := 13;
  constant load_speed    : natural := 14;
  constant write_reserve : natural := 16;
  constant add_way       : natural := 17;
  constant take_speed    : natural := 18;
  constant judge         : natural := 19;
  constant finish        : natural := 20;
  constant load_shift    : natural := 21;
  constant put_shift     : natural := 22;
  constant await_shift   : natural := 23;

  subtype value_t is signed(31 downto 0);
  type upto_t is array (0 to 23) of natural; -- clocks until a state, at most

  constant clocks_until : upto_t := (
    0, 0, 3, 6, 9, 12, 15, 18, 21, 22, 25, 28, 31, 34, 35, 38, 41, way_begins, way_begins, 263, 282, 282, 285, 287);

  signal bank, reads, writes, store, store_shift, look, shifts : std_ulogic;
  signal axis                  : natural range 0 to 0;
  signal read_word, write_word : word_index_t;
  signal result                : std_ulogic_vector(31 downto 0);
  signal look_word             : motion_word_t;
  signal near, moving          : std_ulogic_vector(0 downto 0);

  signal begun         : std_ulogic := '0';
  signal void_1        : std_ulogic := '1';             -- it was reset or cleared a clock ago
  signal state_1       : unsigned(4 downto 0) := (others => '0');
  signal tick_1        : std_ulogic := '0';
  signal bank_1        : std_ulogic := '0';
  signal asks_shift_1  : std_ulogic := '0';             -- a shift was asked for, and was not done
  signal fastest_1     : unsigned(27 downto 0) := (others => '0');
  signal acceleration_1 : unsigned(19 downto 0) := (others => '0');
  signal wanted_1      : value_t := (others => '0');
  signal is_on_1, in_velocity_1 : std_ulogic := '0';
  signal has_read      : std_ulogic := '0';             -- read_data is of the word last_word
  signal last_word     : word_index_t := 0;
  signal shift_amount  : value_t := (others => '0');    -- that was read last
  signal drives        : std_ulogic := '0';             -- the axis is enabled, as this pass has read it
  signal follows       : std_ulogic := '0';             -- the velocity mode, likewise
  signal velocity      : value_t := (others => '0');    -- in use
  signal following     : value_t := (others => '0');    -- that comes into use next
  signal goal          : value_t := (others => '0');
  signal limit, change, missing : value_t;
  signal beyond        : value_t;                       -- the velocity target without the speed in its direction
  signal clamped       : value_t;                       -- the velocity target within the speed
  signal next_velocity : value_t;                       -- as it must be
  signal works         : natural range 0 to 511 := 0;   -- clocks of a pass in which it waits for nothing
  signal waits         : std_ulogic;
  signal stand         : std_ulogic;                    -- the parameters are those of a clock ago
  signal is_right      : std_ulogic;                    -- read_data is what is in the word
  signal is_used       : std_ulogic;                    -- write_word is the velocity in use
  signal in_place      : std_ulogic;                    -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.stepgen_ramp
    generic map (axes => 1, clock_hz => 8 * 2 ** 20)
    port map (
      clock => clk, reset => reset, clearing => clearing, base => base, bank => bank, axis => axis, reads => reads,
      read_word => read_word, read_data => read_data, writes => writes, write_word => write_word, result => result,
      store => store, store_shift => store_shift, stored => stored, look => look, look_word => look_word,
      looked => looked, look_data => look_data, enabled => enabled, near => near, moving => moving, shift => shift,
      shifts => shifts, shifted => shifted);

  limit   <= signed(resize(fastest, 32));
  change  <= signed(resize(acceleration, 32));
  missing <= goal - velocity;
  beyond  <= wanted + limit when wanted < 0 else wanted - limit;

  clamped <= limit when wanted > limit else -limit when wanted < -limit else wanted;

  next_velocity <= velocity + change when missing > change else velocity - change when missing < -change else goal;

  -- It waits for the motion unit only.
  waits <= (look and not looked) or ((store or store_shift) and not stored) or (shifts and not shifted);

  stand <= to_bit(fastest = fastest_1 and acceleration = acceleration_1 and wanted = wanted_1 and is_on = is_on_1 and
                  in_velocity = in_velocity_1);

  is_used <= to_bit((bank = '0' and write_word = word_velocity) or (bank = '1' and write_word = word_next));

  with last_word select is_right <=
    to_bit(read_data(0) = is_on and read_data(1) = in_velocity) when word_control,
    to_bit(signed(read_data) = limit) when word_speed,
    to_bit(signed(read_data) = change) when word_acceleration,
    to_bit(signed(read_data) = wanted) when word_velocity_target,
    to_bit(signed(read_data) = goal) when word_goal,
    to_bit(unsigned(read_data) = 0) when word_zero,
    bank or to_bit(signed(read_data) = velocity) when word_velocity,
    not bank or to_bit(signed(read_data) = velocity) when word_next,
    '1' when others;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun          <= '1';
      void_1         <= reset or clearing;
      state_1        <= state;
      tick_1         <= tick;
      bank_1         <= bank;
      asks_shift_1   <= shifts and not shifted and not reset and not clearing;
      fastest_1      <= fastest;
      acceleration_1 <= acceleration;
      wanted_1       <= wanted;
      is_on_1        <= is_on;
      in_velocity_1  <= in_velocity;
      has_read       <= reads;
      last_word      <= read_word;

      if has_read = '1' and last_word = word_control then
        drives  <= is_on and enabled(0);
        follows <= in_velocity;
      end if;
      if has_read = '1' and last_word = word_shift then
        shift_amount <= signed(read_data);
      end if;
      if writes = '1' then
        if write_word = word_goal then
          goal <= signed(result);
        elsif write_word = word_velocity or write_word = word_next then
          following <= signed(result);
        end if;
      end if;
      if tick = '1' then
        velocity <= following;
      end if;
      if state = waiting then
        works <= 0;
      elsif waits = '0' and works < 511 then
        works <= works + 1;
      end if;

      if reset = '1' or clearing = '1' then
        velocity  <= (others => '0');
        following <= (others => '0');
        has_read  <= '0';
        works     <= 0;
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits  : boolean;
    variable spent : natural range 0 to 1023; -- clocks until here, at most

    function is_small (value : value_t) return boolean is
    begin
      return value(31 downto 28) = x"0" or value(31 downto 28) = x"F";
    end function;

  begin
    fits := state <= await_shift and is_small(goal) and is_small(velocity) and is_small(following) and
            (adds = '0' or executes = '0' or state = add_way or state = take_speed) and place < places;

    -- What the sum is when an instruction begins.
    if adds = '0' then
      case to_integer(state) is
        when compare_speed   => fits := fits and sum = wanted;
        when load_goal       => fits := fits and (follows = '0' or sum = beyond);
        when load_change     => fits := fits and sum = goal;
        when reach           => fits := fits and sum = missing;
        when change_velocity => fits := fits and sum = velocity;
        when others          => null;
      end case;
      if state = load_velocity then
        fits := fits and ((missing < 0 and sum = missing + change) or (missing >= 0 and sum = missing - change));
      end if;
      if state = write_next then
        fits := fits and sum = next_velocity;
      end if;
    end if;
    if state = change_velocity then
      fits := fits and (missing >= change or missing <= -change);
    end if;
    if (state = reach and executes = '1') or state = load_velocity or state = change_velocity then
      fits := fits and slower = to_bit(missing < 0);
    end if;
    if state > load_control and state < finish then
      fits := fits and goes = drives and to_target = not follows and (brakes = '0' or follows = '0') and
              (follows = '0' or state < load_speed);
    end if;
    if ((state = compare_speed and executes = '1') or state = load_goal) and follows = '1' then
      fits := fits and goal_down = to_bit(wanted < 0);
    end if;

    -- How long it has taken until here.
    spent := clocks_until(minimum(to_integer(state), 23));
    if state = add_way then
      spent := spent + 4 * (places - 1 - to_integer(place)) + to_integer(unsigned'("" & executes));
    elsif state = take_speed then
      spent := spent + 4 * (places - 1 - to_integer(place)) + 2 + to_integer(unsigned'("" & executes));
    elsif executes = '1' then
      spent := spent + 2;
    elsif adds = '0' and state /= waiting then
      spent := spent + 1;
    end if;
    if brakes = '1' and state >= load_goal and state <= write_next then
      spent := spent + second_pass;
    end if;
    fits := fits and (works <= spent or state = waiting);
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- At power-up the instruction is any that there is.
  known_first : assume always begun = '1' or state <= await_shift;

  -- A ramp period ends when its pass has ended (its clocks: always_ends).
  pass_ends : assume always tick = '1' -> state = waiting;

  -- The parameters stand during a pass.
  parameters_stand : assume always begun = '1' and state_1 /= waiting -> stand = '1';

  -- A word that is read is what is in it.
  right_words : assume always has_read = '1' -> is_right = '1';

  -- The velocity and the shift are taken only while they are offered.
  takes_offered : assume always (stored = '0' or store = '1' or store_shift = '1') and (shifted = '0' or shifts = '1');

  -- At every clock, the design is where these say.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- A new velocity is the goal, or nearer to it by just the acceleration. So no change of mode, target, speed or enable
  -- makes a step in the velocity.
  right_velocity : assert always begun = '1' and store = '1' -> signed(result) = next_velocity;

  -- The goal of an axis that is not enabled is zero.
  off_stops : assert always begun = '1' and writes = '1' and write_word = word_goal and drives = '0' ->
                            signed(result) = 0;

  -- In velocity mode the goal is the velocity target, or the speed if that is less.
  right_goal : assert always begun = '1' and writes = '1' and write_word = word_goal and drives = '1' and
                             follows = '1' -> signed(result) = clamped;

  -- In position mode it is the speed in one of both directions, or zero.
  right_approach : assert always begun = '1' and writes = '1' and write_word = word_goal and drives = '1' and
                                 follows = '0' and signed(result) /= 0 ->
                                 signed(result) = limit or signed(result) = -limit;

  -- The velocity that is in use is never written.
  never_in_use : assert always begun = '1' and writes = '1' -> is_used = '0';

  -- A new velocity comes into use only when a ramp period ends.
  at_period : assert always begun = '1' and void_1 = '0' and bank /= bank_1 -> tick_1 = '1';

  -- A pass takes at most so many clocks, apart from those in which it waits for the motion unit.
  always_ends : assert always begun = '1' and state /= waiting -> not (works > clocks_most);

  -- A shift is asked for until it is done: so the motion unit adds it once (stepgen_motion).
  shift_stands : assert always begun = '1' and asks_shift_1 = '1' -> shifts = '1';

  -- Its amount is what was written, and stands meanwhile.
  right_shift : assert always begun = '1' and store_shift = '1' -> signed(result) = shift_amount and shifts = '0';

  -- A shift is done.
  shift_seen : cover {begun = '1' and shifts = '1' and shifted = '1'};

end architecture;
