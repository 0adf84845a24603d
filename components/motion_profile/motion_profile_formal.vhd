-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of motion_profile without smoothing. A period may begin at any clock, and the way that is left may be any,
-- also the way for the brakes. The wires and the bus may do anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity motion_profile_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    m2s      : in wishbone_m2s_t;
    feedback : in wire_t;
    enable   : in std_ulogic;            -- shows the bit of the design, as all of these show its signals
    state    : in unsigned(3 downto 0);
    speed    : in unsigned(31 downto 0);
    most     : in unsigned(31 downto 0);
    ramp     : in unsigned(23 downto 0);
    back     : in std_ulogic;
    place    : in signed(55 downto 0)
  );
end entity;

architecture properties of motion_profile_formal is

  -- The places of `state` in its type.
  constant choose : natural := 4;
  constant move   : natural := 6;
  constant give   : natural := 9;

  signal s2m             : wishbone_s2m_t;
  signal arrived         : std_ulogic;
  signal position_wire   : wire_t;
  signal velocity_wire   : wire_t;
  signal ramp_wire       : wire_t;
  signal begun           : std_ulogic := '0';
  signal reset_1         : std_ulogic := '1';
  signal off_1, off_2    : std_ulogic := '1';                         -- a reset, or not enabled, so many clocks ago
  signal expected        : signed(31 downto 0) := (others => '0');    -- the position without enable
  signal position_1      : signed(31 downto 0) := (others => '0');
  signal speed_1, most_1 : unsigned(31 downto 0) := (others => '0');
  signal ramp_1          : unsigned(23 downto 0) := (others => '0');
  signal back_1          : std_ulogic := '0';
  signal place_1         : signed(55 downto 0) := (others => '0');
  signal chose           : std_ulogic := '0';                         -- a speed was chosen a clock ago
  signal moved           : std_ulogic := '0';                         -- the place was moved a clock ago
  signal gave            : std_ulogic := '0';                         -- a period ended a clock ago
  signal arrived_1       : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  dut : entity work.motion_profile
    generic map (clock_hz => 1_000_000, loop_hz => 1000, velocity_wire_bits => 8, acceleration_wire_bits => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, arrived => arrived,
      feedback_wire => feedback, position_wire => position_wire, velocity_wire => velocity_wire,
      acceleration_wire => ramp_wire);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun      <= '1';
      reset_1    <= reset;
      off_1      <= reset or not enable;
      off_2      <= off_1;
      position_1 <= value_of(position_wire);
      speed_1    <= speed;
      most_1     <= most;
      ramp_1     <= ramp;
      back_1     <= back;
      place_1    <= place;
      arrived_1  <= arrived;
      expected   <= value_of(position_wire);
      if is_valid(feedback) = '1' then
        expected <= value_of(feedback);
      end if;

      chose <= '0';
      moved <= '0';
      gave  <= '0';
      if reset = '0' and enable = '1' then
        if state = choose then
          chose <= '1';
        end if;
        if state = move then
          moved <= '1';
        end if;
        if state = give then
          gave <= '1';
        end if;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A period has ten states.
  ten_states : assert always begun = '1' -> state <= give;

  -- Without enable the position is that of the feedback, a clock later: a loop that follows rests.
  follows : assert always begun = '1' and off_1 = '1' -> value_of(position_wire) = expected;

  -- It has then no velocity.
  rests_when_off : assert always begun = '1' and off_1 = '1' -> value_of(velocity_wire) = 0 and speed = 0;

  -- Nor has it an acceleration.
  no_ramp_when_off : assert always begun = '1' and off_1 = '1' -> value_of(ramp_wire) = 0;

  -- A start makes no step: the position stays until the first period has ended.
  no_step : assert always begun = '1' and off_1 = '0' and value_of(position_wire) /= position_1 -> gave = '1';

  -- The speed never grows beyond the highest speed of its period.
  within_speed : assert always begun = '1' and speed > speed_1 and speed /= speed_1 - ramp_1 ->
                          speed <= most_1;

  -- It changes only once in a period, and by the acceleration.
  one_ramp : assert always begun = '1' and off_1 = '0' and speed /= speed_1 ->
                      chose = '1' and (speed = speed_1 + ramp_1 or speed = speed_1 - ramp_1);

  -- The direction changes only at rest.
  turns_at_rest : assert always begun = '1' and back /= back_1 -> speed_1 = 0;

  -- The place moves once in a period.
  moves_once : assert always begun = '1' and off_1 = '0' and place /= place_1 -> moved = '1';

  -- It arrives once, and only without a velocity.
  arrives : assert always begun = '1' and arrived = '1' -> gave = '1' and speed = 0 and arrived_1 = '0';

end architecture;
