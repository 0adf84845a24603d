-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the motion unit of stepgen, with two axes. Any velocity may be written at any clock, which is any
-- change of mode, target and direction. Words are read, positions are shifted and latched, and the unit is reset at any
-- clock.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.stepgen_pkg.all;

entity stepgen_motion_formal is
  port (
    clk            : in std_ulogic;
    reset          : in std_ulogic;
    velocity_write : in std_ulogic;
    shift_write    : in std_ulogic;
    velocity_bank  : in std_ulogic;
    velocity_axis  : in natural range 0 to 1;
    velocity_data  : in std_ulogic_vector(31 downto 0);
    bank           : in std_ulogic;
    look           : in std_ulogic;
    look_axis      : in natural range 0 to 3;
    look_word      : in unsigned(2 downto 0);
    shift          : in std_ulogic;
    shift_axis     : in natural range 0 to 1;
    catch          : in std_ulogic_vector(1 downto 0);
    watched        : in natural range 0 to 1; -- the axis that is followed
    asks           : in std_ulogic;           -- signals of the design
    takes          : in std_ulogic;
    stores         : in std_ulogic
  );
end entity;

architecture properties of stepgen_motion_formal is

  constant base_clocks : positive := 8;
  constant clock_hz    : positive := base_clocks * 2 ** 20;
  constant young_most  : positive := 2; -- clocks from a rise of STEP to the position

  subtype count_t is unsigned(2 downto 0); -- positions are compared in their lowest bits

  signal clearing, base, looked, shifted, stepped, step_down, late, put : std_ulogic;
  signal look_data       : std_ulogic_vector(31 downto 0);
  signal caught          : std_ulogic_vector(1 downto 0);
  signal step_axis       : natural range 0 to 1;
  signal step, direction : std_ulogic_vector(1 downto 0);

  signal begun       : std_ulogic := '0';
  signal step_before : std_ulogic := '0';
  signal count       : count_t := (others => '0'); -- rises of STEP with their sign, and shifts
  signal amount      : count_t := (others => '0'); -- the shift that was written
  signal young       : natural range 0 to young_most := young_most; -- clocks since the last rise
  signal was_up      : std_ulogic := '0';          -- its direction
  signal shows       : std_ulogic := '0';          -- look_data is the position of the watched axis
  signal expected    : count_t := (others => '0'); -- the count when look_data was read
  signal seen        : count_t;
  signal missing     : count_t;

begin

  default clock is rising_edge(clk);

  dut : entity work.stepgen_motion
    generic map (
      axes => 2, clock_hz => clock_hz, step_len_ns => 100, step_space_ns => 100, dir_setup_ns => 100,
      dir_hold_ns => 100)
    port map (
      clock => clk, reset => reset, clearing => clearing, sweep => open,
      velocity_write => velocity_write, shift_write => shift_write, velocity_bank => velocity_bank,
      velocity_axis => velocity_axis, velocity_data => velocity_data, put => put, bank => bank, base => base,
      look => look, look_axis => look_axis, look_word => look_word, looked => looked, look_data => look_data,
      shift => shift, shift_axis => shift_axis, shifted => shifted, catch => catch, caught => caught,
      stepped => stepped, step_axis => step_axis, step_down => step_down, late => late,
      step => step, direction => direction);

  seen    <= unsigned(look_data(count_t'range));
  missing <= expected - seen;

  follow : process (clk) is
    variable sum : count_t;
  begin
    if rising_edge(clk) then
      begun       <= '1';
      step_before <= step(watched);
      sum         := count;
      if young < young_most then
        young <= young + 1;
      end if;
      if step(watched) = '1' and step_before = '0' then
        young  <= 0;
        was_up <= direction(watched);
        if direction(watched) = '1' then
          sum := sum + 1;
        else
          sum := sum - 1;
        end if;
      end if;
      if put = '1' and velocity_write = '0' then
        amount <= unsigned(velocity_data(count_t'range));
      end if;
      if shifted = '1' and shift_axis = watched then
        sum := sum + amount;
      end if;
      count    <= sum;
      expected <= count;
      shows  <= '1' when looked = '1' and look_axis = watched and look_word = motion_position else '0';

      if reset = '1' or clearing = '1' then
        count       <= (others => '0');
        young       <= young_most;
        step_before <= '0';
        shows       <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The watched axis is any, and stays the same.
  one_is_watched : assume always reset = '0' or reset = '1' -> next (watched = prev(watched));

  -- A shift stands until it is done, and its amount stays the same.
  shift_stands : assume always shift = '1' and shifted = '0' and reset = '0' and clearing = '0' ->
                 next (shift = '1' and shift_axis = prev(shift_axis));

  -- The amount of a shift is not written while the shift stands.
  amount_stands : assume always shift = '1' -> shift_write = '0';

  -- A position that is read is the number of rises of STEP with their sign, and of shifts. Only the last rise may be
  -- missing, for less than a base period.
  counted : assert always begun = '1' and shows = '1' ->
            missing = 0 or (young < young_most and was_up = '1' and missing = 1) or
            (young < young_most and was_up = '0' and missing = 7);

  -- A phase whose step is not taken is not stored. So the fraction of the step is kept, and the step is asked for
  -- again.
  fraction_kept : assert always begun = '1' and asks = '1' and takes = '0' -> stores = '0';

  -- The watched axis has stepped down after a step up.
  turned : cover {begun = '1' and young = 1 and was_up = '0' and count = 0};

end architecture;
