-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of sonar with a period of 20 us, echoes below 4 us, and a clock of 1 MHz. The line and the bus may do
-- anything at any clock. Two failures in a row are too many.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity sonar_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    m2s    : in wishbone_m2s_t;
    echo   : in std_ulogic;
    enable : in std_ulogic; -- shows the bit of the design
    level  : in std_ulogic  -- shows the line behind the filter
  );
end entity;

architecture properties of sonar_formal is

  constant trigger_clocks : positive := 12;
  constant period         : positive := 20;
  constant timeout        : positive := 4;
  constant filtered       : positive := 6;  -- clocks after which a level counts for certain
  constant length_most    : positive := 31;

  signal s2m                      : wishbone_s2m_t;
  signal sampled, failed, trigger : std_ulogic;
  signal echo_wire                : wire_t;
  signal begun                    : std_ulogic := '0';
  signal off                      : std_ulogic := '1';                       -- reset or disabled, a clock ago
  signal trigger_1                : std_ulogic := '0';
  signal rises                    : std_ulogic;
  signal lasted                   : natural range 0 to 31 := 0;              -- clocks of the trigger
  signal apart                    : natural range 0 to period := period;     -- clocks since it rose
  signal was_high                 : natural range 0 to filtered := 0;        -- clocks of the line
  signal owed                     : std_ulogic := '0';                       -- a trigger has no sample and no failure
  signal tells                    : std_ulogic := '0';                       -- one does in this clock
  signal armed, heard             : std_ulogic := '0';                       -- triggered, and the echo has begun
  signal length                   : natural range 0 to length_most := 0;     -- of the echo
  signal expected                 : natural range 0 to length_most := 0;     -- that of the one that has ended
  signal bad                      : natural range 0 to 2 := 0;               -- failures in a row

begin

  default clock is rising_edge(clk);

  dut : entity work.sonar
    generic map (
      clock_hz => 1_000_000, period_us => period, timeout_us => timeout, failures_most => 2, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      echo_wire => echo_wire, trigger => trigger, echo => echo);

  rises <= trigger and not trigger_1;

  watch : process (clk) is
    variable now_armed : std_ulogic;
    variable so_far    : natural range 0 to length_most;
  begin
    if rising_edge(clk) then
      begun     <= '1';
      off       <= not enable;
      trigger_1 <= trigger;
      tells     <= '0';

      lasted <= 0;
      if trigger = '1' then
        lasted <= minimum(lasted + 1, 31);
      end if;
      apart <= minimum(apart + 1, period);
      if rises = '1' then
        apart <= 1;
      end if;
      was_high <= 0;
      if echo = '1' then
        was_high <= minimum(was_high + 1, filtered);
      end if;

      if rises = '1' then
        owed  <= '1';
        tells <= owed and not sampled and not failed and not m2s.cyc;
      elsif sampled = '1' or failed = '1' then
        owed <= '0';
      end if;

      now_armed := armed or rises;
      so_far    := length;
      if rises = '1' then
        so_far := 0;
      end if;
      if now_armed = '1' and level = '1' then
        heard  <= '1';
        so_far := minimum(so_far + 1, length_most);
      elsif heard = '1' then
        heard     <= '0';
        now_armed := '0';
        expected  <= so_far;
      end if;
      armed  <= now_armed;
      length <= so_far;

      if sampled = '1' then
        bad <= 0;
      elsif failed = '1' then
        bad <= minimum(bad + 1, 2);
      end if;

      if reset = '1' or enable = '0' then
        off   <= '1';
        owed  <= '0';
        tells <= '0';
        armed <= '0';
        heard <= '0';
        apart <= period;
      end if;
      if reset = '1' then
        bad <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A trigger has its length, unless enable falls.
  trigger_ends  : assert always begun = '1' and off = '0' and trigger = '0' and trigger_1 = '1' ->
                           lasted = trigger_clocks;
  -- No trigger is longer.
  never_longer  : assert always begun = '1' and trigger = '1' -> lasted < trigger_clocks;

  -- Without enable there is none.
  none_when_off : assert always begun = '1' and off = '1' -> trigger = '0';

  -- No trigger begins while the line is high.
  line_is_low   : assert always begun = '1' and rises = '1' -> was_high < filtered;
  -- A trigger begins a period after the last one, and not sooner.
  not_too_soon  : assert always begun = '1' and rises = '1' -> apart = period;

  -- A sample is the length of the echo behind its trigger, and below the timeout.
  right_length  : assert always begun = '1' and sampled = '1' and off = '0' ->
                           unsigned(value_of(echo_wire)) = expected and expected < timeout;

  -- A trigger without a sample or a failure until the next one is told as a failure with that one.
  none_forgotten : assert always begun = '1' and tells = '1' -> failed = '1';

  -- Two failures in a row end the validity.
  too_many       : assert always begun = '1' and bad = 2 and sampled = '0' -> is_valid(echo_wire) = '0';
  -- Without enable, nothing is valid.
  void_when_off  : assert always begun = '1' and off = '1' -> is_valid(echo_wire) = '0';

  -- A sample with the echo that was made.
  good_seen : cover {begun = '1' and sampled = '1' and expected = 3};
  -- A failure while the last sample is still valid.
  bad_seen  : cover {begun = '1' and failed = '1' and is_valid(echo_wire) = '1'};

end architecture;
