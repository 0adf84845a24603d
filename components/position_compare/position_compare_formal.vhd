-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of position_compare with pulses of three clocks. The wire may jump to any position, or be lost, at any
-- clock, and the bus may write whatever it likes. A reference compares each sample with the place of its clock.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity position_compare_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    m2s      : in wishbone_m2s_t;
    position : in wire_t;

    -- These show signals of the design.
    words     : in std_ulogic_vector(127 downto 0); -- +0 leftmost
    written   : in std_ulogic_vector(3 downto 0);   -- the same
    at        : in unsigned(31 downto 0);
    count     : in unsigned(31 downto 0);
    past      : in std_ulogic;
    valid     : in std_ulogic;
    fresh     : in std_ulogic;
    armed     : in std_ulogic;
    pulse     : in std_ulogic;
    left      : in unsigned(1 downto 0);
    above     : in std_ulogic;
    is_active : in std_ulogic
  );
end entity;

architecture properties of position_compare_formal is

  constant pulse_clocks : positive := 3;
  constant patience     : positive := pulse_clocks;     -- clocks in which a place may wait for its pulse

  subtype word_t is unsigned(31 downto 0);

  signal s2m               : wishbone_s2m_t;
  signal reached, line     : std_ulogic;
  signal enable, down, level : std_ulogic;
  signal step, way         : word_t;
  signal behind            : word_t;                       -- how far the position is behind the place; wraps
  signal begun             : std_ulogic := '0';
  signal place             : word_t := (others => '0');
  signal place_1, way_1    : word_t := (others => '0');    -- a clock ago
  signal is_past, is_known : std_ulogic := '0';            -- the sample of the clock before: at the place or behind it
  signal is_current        : std_ulogic := '0';            -- it was compared with this place
  signal counts            : std_ulogic;                   -- the sample says something
  signal was_before        : std_ulogic := '0';            -- a sample was before the place since the last pulse
  signal is_spent          : std_ulogic := '0';            -- this place had its pulse, and no sample before it since
  signal due, rises        : std_ulogic;                   -- a pulse begins, or a level
  signal due_1, event_1    : std_ulogic := '0';
  signal is_spent_1, off_1 : std_ulogic := '0';
  signal run               : natural range 0 to pulse_clocks := 0; -- clocks of the pulse that are still to come
  signal high              : std_ulogic := '0';            -- the level
  signal active            : std_ulogic := '0';
  signal number            : word_t := (others => '0');    -- of events
  signal waits             : natural range 0 to patience + 1 := 0;
  signal in_place          : std_ulogic;                   -- the design is where the reference is

begin

  default clock is rising_edge(clk);

  dut : entity work.position_compare
    generic map (clock_hz => 50_000_000, pulse_ns => 60)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, reached => reached,
      position_wire => position, line => line);

  enable <= words(96);
  down   <= words(97);
  level  <= words(98);
  step   <= '0' & unsigned(words(62 downto 32));
  way    <= step when down = '0' else 0 - step;
  behind <= unsigned(value_of(position)) - place when down = '0' else place - unsigned(value_of(position));

  counts <= enable and is_known and is_current and not written(3);
  due    <= counts and is_past and was_before and not level and to_bit(run = 0);
  rises  <= enable and level and is_known and counts and is_past and not high;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun        <= '1';
      is_past      <= not behind(31);
      is_known     <= is_valid(position);
      is_current   <= '1';
      due_1        <= due;
      event_1      <= due or rises;
      is_spent_1   <= is_spent;
      off_1        <= reset or not enable;
      place_1      <= place;
      way_1        <= way;

      if due = '1' or rises = '1' then
        number <= number + 1;
      end if;

      -- Only samples, pulses and writes say whether the position was before the place.
      if is_known = '0' then
        was_before <= '0';
      elsif counts = '1' and is_past = '0' then
        was_before <= '1';
        is_spent   <= '0';
      elsif due = '1' then
        was_before <= or step;
        is_spent   <= nor step;
      end if;
      if due = '1' then
        place <= place + way;
      end if;
      if written(2) = '1' then
        place      <= unsigned(words(95 downto 64));
        is_current <= '0';
      end if;
      if written(2) = '1' or written(3) = '1' then
        was_before <= '0';
        is_spent   <= '0';
      end if;

      if due = '1' then
        run <= pulse_clocks;
      elsif run /= 0 then
        run <= run - 1;
      end if;
      if enable = '0' or level = '1' then
        run <= 0;
      end if;

      if enable = '0' or is_known = '0' then
        high <= '0';
      elsif is_current = '1' and written(3) = '0' then
        high <= is_past;
      end if;
      active <= enable and to_bit(run /= 0);
      if level = '1' then
        active <= enable and high;
      end if;

      waits <= 0;
      if counts = '1' and is_past = '1' and was_before = '1' and level = '0' and due = '0' then
        waits <= minimum(waits + 1, patience + 1);
      end if;

      if reset = '1' then
        place      <= (others => '0');
        number     <= (others => '0');
        is_current <= '0';
        was_before <= '0';
        is_spent   <= '0';
        due_1      <= '0';
        event_1    <= '0';
        run        <= 0;
        high       <= '0';
        active     <= '0';
        waits      <= 0;
      end if;
    end if;
  end process;

  in_place <= to_bit(
    at = place and count = number and past = is_past and valid = is_known and fresh = is_current and
    armed = was_before and pulse = to_bit(run /= 0) and (run = 0 or left = run - 1) and left < pulse_clocks and
    above = high and is_active = active and waits + run <= patience and (was_before = '0' or is_spent = '0'));

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- At every clock, the design is where the reference is: the next place, the number of events, and the line.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- The event comes with each pulse and with the begin of each level, and with nothing else.
  event_is_right : assert always begun = '1' -> reached = event_1;

  -- A pulse lasts three clocks, and there is a clock between two. A level follows the position.
  line_is_right : assert always begun = '1' -> line = active;

  -- One place gives one pulse at each passing: between two pulses the position has been before it, or the place is
  -- another one.
  once : assert always begun = '1' and due_1 = '1' -> is_spent_1 = '0';

  -- Each pulse moves the place on by a step, so no place of a row is left out, and none has two pulses.
  moves_on : assert always begun = '1' and due_1 = '1' and fresh = '1' -> at = place_1 + way_1;

  -- No passing is lost: a place that was reached waits only for the end of the pulse before.
  soon : assert always waits <= 3;

  -- Without enable the line rests in the next clock.
  rests : assert always begun = '1' and off_1 = '1' -> line = '0';

  -- A second pulse of one row.
  row_seen : cover {begun = '1' and reached = '1' and level = '0' and number = 2 and step = 5};

  -- A pulse downwards, at one place.
  down_seen : cover {begun = '1' and reached = '1' and level = '0' and down = '1' and step = 0 and number = 1};

  -- A level.
  level_seen : cover {begun = '1' and line = '1' and level = '1'};

end architecture;
