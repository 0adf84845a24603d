-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of hall with a clock of 1 MHz and a filter of one clock. The lines may change in any way at any clock, and
-- the bus may do anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity hall_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    m2s    : in wishbone_m2s_t;
    lines  : in std_ulogic_vector(2 downto 0);
    levels : in std_ulogic_vector(2 downto 0); -- shows the lines behind the filter, as all of these show signals
    sector : in unsigned(2 downto 0);
    known  : in std_ulogic;                    -- there has been a sector since the reset
    runs   : in std_ulogic;                    -- the angle is interpolated
    back   : in std_ulogic;
    timed  : in std_ulogic;                    -- the time since an edge is known
    taken  : in unsigned(5 downto 0)           -- steps since the last edge
  );
end entity;

architecture properties of hall_formal is

  constant step_size  : positive := 171;
  constant wide       : positive := 10_923; -- a sector, rounded up

  subtype angle_t is unsigned(15 downto 0);
  type angles_t is array (0 to 15) of angle_t;

  signal s2m                      : wishbone_s2m_t;
  signal moved, failed            : std_ulogic;
  signal position_wire            : wire_t;
  signal angle_wire               : wire_t;
  signal velocity_wire            : wire_t;
  signal position                 : signed(31 downto 0);
  signal angle, first, beyond     : angle_t;
  signal so_far                   : angle_t;                        -- the way of all steps since the edge
  signal begun                    : std_ulogic := '0';
  signal reset_1                  : std_ulogic := '1';
  signal good_1                   : std_ulogic := '0';              -- the code could be, a clock ago
  signal position_1               : signed(31 downto 0) := (others => '0');
  signal by                       : signed(31 downto 0) := (others => '0'); -- the way of the last clock
  signal way, turned              : std_ulogic := '0';              -- the last step was backward; it was a turn
  signal changed, jumped          : std_ulogic := '0';              -- the sector did, to any or to no neighbour
  signal broke                    : std_ulogic := '0';              -- a code came that cannot be
  signal bad_before               : std_ulogic := '0';              -- two clocks ago
  signal sector_above             : unsigned(2 downto 0);           -- the one behind it forward
  signal sector_1                 : unsigned(2 downto 0) := "000";

  -- Twelfths of a turn, and nothing for what is no sector.
  constant twelfth : angles_t := (
    x"0000", x"1555", x"2AAB", x"4000", x"5555", x"6AAB", x"8000", x"9555", x"AAAB", x"C000", x"D555", x"EAAB",
    others => x"0000");

  -- The place of a code in a turn forward: line 0 rises, line 2 falls, line 1 rises, and so on.
  function place_of (code : std_ulogic_vector(2 downto 0)) return natural is
  begin
    case code is
      when "101" => return 0;
      when "001" => return 1;
      when "011" => return 2;
      when "010" => return 3;
      when "110" => return 4;
      when others => return 5;
    end case;
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.hall
    generic map (clock_hz => 1_000_000, filter_ns => 0)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, moved => moved, failed => failed,
      stopped => open, position_wire => position_wire, angle_wire => angle_wire, velocity_wire => velocity_wire,
      lines => lines);

  position <= value_of(position_wire);
  angle    <= unsigned(angle_wire(15 downto 0));
  -- Where the sector begins, and how far the angle is in it.
  first    <= twelfth(to_integer(sector & '0'));
  beyond   <= angle - first;
  so_far   <= resize(to_unsigned(step_size, 8) * taken, 16);

  sector_above <= "000" when sector >= 5 else sector + 1;

  watch : process (clk) is
    variable good       : boolean;
    variable before, to_come : natural range 0 to 7;
  begin
    if rising_edge(clk) then
      begun      <= '1';
      reset_1    <= reset;
      position_1 <= position;
      sector_1   <= sector;
      good       := levels /= "000" and levels /= "111";
      good_1     <= '0';
      broke      <= not reset;
      if good then
        good_1 <= not reset;
        broke  <= '0';
      end if;
      bad_before <= broke;
      if reset = '1' then
        bad_before <= '0';
      end if;

      before  := to_integer(sector);
      to_come := place_of(levels);
      by      <= (others => '0');
      changed <= '0';
      jumped  <= '0';
      turned  <= '0';
      if good and known = '1' and to_come /= before and reset = '0' then
        changed <= '1';
        if to_come = (before + 1) mod 6 then
          by     <= to_signed(1, 32);
          way    <= '0';
          turned <= way;
        elsif before = (to_come + 1) mod 6 then
          by     <= to_signed(-1, 32);
          way    <= '1';
          turned <= not way;
        else
          jumped <= '1';
        end if;
      end if;
      if reset = '1' then
        way <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There are six sectors.
  six_sectors : assert always begun = '1' -> sector <= 5;

  -- The position goes one sector on, or one back, exactly if the lines say so.
  right_position : assert always begun = '1' and reset_1 = '0' -> position = position_1 + by;

  -- The values are valid exactly while the lines have a code that can be.
  valid_code : assert always begun = '1' -> is_valid(angle_wire) = good_1 and is_valid(position_wire) = good_1;

  -- Each change of the sector is told, and nothing else.
  move_is_told : assert always begun = '1' -> moved = changed;

  -- A code that cannot be is told once, and so is a jump over a sector. Nothing else is.
  fault_is_told : assert always begun = '1' and reset_1 = '0' -> failed = (jumped or (broke and not bad_before));

  -- The status has the direction of the last step.
  right_direction : assert always begun = '1' -> back = way;

  -- Behind a turn the angle waits in the middle of the sector, until there is a period of the new direction.
  turn_waits : assert always begun = '1' and turned = '1' -> runs = '0';

  -- The angle is interpolated only with a period that counts.
  runs_timed : assert always begun = '1' and runs = '1' -> timed = '1' and known = '1';

  -- With the lines at rest the sector stays.
  at_rest : assert always begun = '1' and reset_1 = '0' and sector /= sector_1 -> good_1 = '1';

  -- The angle that is interpolated is so many steps from its edge, in the direction of the motion.
  right_steps : assert always begun = '1' and runs = '1' and back = '0' -> angle = first + so_far;
  -- Backward it begins at the other edge.
  back_steps  : assert always begun = '1' and runs = '1' and back = '1' ->
                         angle = twelfth(to_integer(sector_above & '0')) - so_far;

  -- Without an interpolation it is the middle of the sector.
  in_the_middle : assert always begun = '1' and runs = '0' and known = '1' ->
                           angle = twelfth(to_integer(sector & '1'));

  -- The angle never passes its sector, however the rotor slows down.
  in_its_sector : assert always begun = '1' and known = '1' -> beyond <= wide;

  -- Three steps have been taken.
  steps_seen : cover {begun = '1' and runs = '1' and taken = 3};

end architecture;
