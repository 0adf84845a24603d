-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of pid with an output of 5 bits and a safe output of 3. A period may begin at any clock, a product may
-- have any number of bits, and the sums of products may be anything: whatever the arithmetic gives, the output keeps
-- to this. The wires and the bus may do anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity pid_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    m2s        : in wishbone_m2s_t;
    feedback   : in wire_t;
    target     : in wire_t;
    words      : in std_ulogic_vector(511 downto 0); -- shows the registers, the first one leftmost; all of these show
    state      : in unsigned(3 downto 0);            -- signals of the design
    started    : in std_ulogic;
    is_tripped : in std_ulogic;
    limit      : in unsigned(3 downto 0);
    limit_low  : in signed(4 downto 0);
    is_high    : in std_ulogic;
    is_low     : in std_ulogic;
    sum        : in signed(51 downto 0);
    integral   : in signed(52 downto 0);
    result     : in signed(56 downto 0)
  );
end entity;

architecture properties of pid_formal is

  constant safe  : integer := 3;
  constant most  : integer := 15;
  constant point : positive := 24; -- bits of the integral behind the point

  -- The places of `state` in its type.
  constant look  : natural := 1;
  constant add   : natural := 4;
  constant clamp : natural := 5;
  constant give  : natural := 8;

  signal s2m                 : wishbone_s2m_t;
  signal tripped             : std_ulogic;
  signal output_wire         : wire_t;
  signal value               : signed(31 downto 0);
  signal begun               : std_ulogic := '0';
  signal reset_1             : std_ulogic := '1';
  signal enable, runs        : std_ulogic;
  signal enable_1, enable_2  : std_ulogic := '0';
  signal stopped             : std_ulogic := '1';              -- a reset, or it did not run, a clock ago
  signal was_tripped         : std_ulogic := '0';
  signal value_1             : signed(31 downto 0) := (others => '0');
  signal limit_1             : unsigned(3 downto 0) := (others => '0');
  signal integral_1          : signed(52 downto 0) := (others => '0');
  signal brim                : signed(52 downto 0);
  signal up, down            : std_ulogic := '0';              -- the output was at its limit, a clock ago
  signal added_up, added_down          : std_ulogic := '0';              -- a sum was added, a clock ago
  signal gave                : std_ulogic := '0';              -- the output of a period came, a clock ago
  signal expected            : signed(31 downto 0) := (others => '0');
  signal was_lost            : std_ulogic := '0';              -- the feedback was not valid, a clock ago
  signal error               : signed(31 downto 0) := (others => '0'); -- of a clock ago
  signal error_most          : unsigned(23 downto 0);
  signal bad, bad_1          : std_ulogic := '0';              -- the period that began must trip

begin

  default clock is rising_edge(clk);

  dut : entity work.pid
    generic map (clock_hz => 1_000_000, loop_hz => 1000, safe => safe, output_wire_bits => 5)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped,
      feedback_wire => feedback, target_wire => target, output_wire => output_wire);

  value      <= value_of(output_wire);
  enable     <= words(32 * 15);
  runs       <= enable and not is_tripped;
  error_most <= unsigned(words(32 * 4 + 23 downto 32 * 4));
  brim       <= shift_left(to_signed(most, 53), point);

  judge : process (all) is
    variable size : unsigned(32 downto 0);
  begin
    size := unsigned(resize(error, 33));
    if error < 0 then
      size := unsigned(-resize(error, 33));
    end if;
    bad  <= '0';
    if state = look and runs = '1' and (was_lost = '1' or (error_most /= 0 and size > error_most)) then
      bad <= '1';
    end if;
  end process;

  watch : process (clk) is
    variable whole : signed(40 downto 0);
  begin
    if rising_edge(clk) then
      begun       <= '1';
      reset_1     <= reset;
      enable_1    <= enable;
      enable_2    <= enable_1;
      stopped     <= reset or not runs;
      was_tripped <= is_tripped;
      value_1     <= value;
      limit_1     <= limit;
      integral_1  <= integral;
      up          <= is_high;
      down        <= is_low;
      was_lost    <= not is_valid(feedback);
      bad_1       <= bad and not reset;

      error <= signed(words(32 * 13 + 31 downto 32 * 13)) - value_of(feedback);
      if is_valid(target) = '1' then
        error <= value_of(target) - value_of(feedback);
      end if;

      added_up <= '0';
      added_down <= '0';
      if state = add and runs = '1' and reset = '0' then
        added_up <= not sum(sum'high);
        added_down <= sum(sum'high);
      end if;

      gave  <= '0';
      whole := result(56 downto 16);
      if state = give and started = '1' and runs = '1' and reset = '0' then
        gave <= '1';
      end if;
      expected <= resize(whole, 32);
      if whole > signed(resize(limit, 41)) then
        expected <= signed(resize(limit, 32));
      elsif whole < -signed(resize(limit, 41)) then
        expected <= -signed(resize(limit, 32));
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The output is always valid, and never beyond what its element can be.
  in_range : assert always begun = '1' -> is_valid(output_wire) = '1' and value <= most and value >= -most;

  -- Behind the clock in which a period looks at its error, the lower limit is that of the period.
  same_limits : assert always begun = '1' and state > look -> limit_low = -signed('0' & limit);

  -- A new output is within the limit of its period, or it is the safe one.
  within_limit : assert always begun = '1' and value /= value_1 and value /= safe ->
                          value <= signed(resize(limit_1, 32)) and value >= -signed(resize(limit_1, 32));

  -- A new output is what the sums gave, limited.
  right_output : assert always begun = '1' and gave = '1' -> value = expected;

  -- It changes only so, or to the safe one. So a period that was cut gives nothing.
  only_periods : assert always begun = '1' and value /= value_1 and gave = '0' -> value = safe;

  -- Without enable, and behind a trip, the output is the safe one from the next clock on, and the integral is 0.
  safe_when_off : assert always begun = '1' and stopped = '1' -> value = safe and integral = 0;

  -- A period that begins with a feedback that is not valid, or with an error that is too large, trips: two clocks later
  -- the output is the safe one.
  bad_trips : assert always begun = '1' and bad_1 = '1' -> tripped = '1' and is_tripped = '1' and value = safe;

  -- Nothing else trips.
  nothing_else : assert always begun = '1' and tripped = '1' -> bad_1 = '1';

  -- A trip ends only when enable rises.
  stays_tripped : assert always begun = '1' and reset_1 = '0' and was_tripped = '1' and is_tripped = '0' ->
                           enable_1 = '1' and enable_2 = '0';

  -- The integral never gives more than the output can be.
  no_wind_up : assert always begun = '1' and state /= clamp -> integral <= brim and integral >= -brim;

  -- At the upper limit of the output it does not grow.
  stands_high : assert always begun = '1' and up = '1' and integral > integral_1 -> integral <= 0;
  -- At the lower limit it does not fall.
  stands_low  : assert always begun = '1' and down = '1' and integral < integral_1 -> integral >= 0;

  -- A sum that is added never wraps upward.
  no_wrap_up   : assert always begun = '1' and added_up = '1' -> integral >= integral_1;
  -- A sum that is taken away never wraps downward.
  no_wrap_down : assert always begun = '1' and added_down = '1' -> integral <= integral_1;

  -- The output is at a limit that was written.
  high_seen : cover {begun = '1' and is_high = '1' and value = 9};

end architecture;
