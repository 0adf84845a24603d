-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the gates of three_phase_pwm. The bus may do anything at any clock, and so may the fault input and the
-- wires. A clock is 100 ns here, a period is 16 clocks, and the least dead time is 250 ns.

library ieee;
  use ieee.std_logic_1164.all;

use work.wire_pkg.all;
use work.wishbone_pkg.all;

entity three_phase_pwm_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    fault   : in std_ulogic;
    valid   : in std_ulogic_vector(2 downto 0); -- of the wires
    value   : in std_ulogic_vector(5 downto 0); -- of all wires
    watched : in natural range 0 to 2; -- the phase that is watched
    enable  : in std_ulogic            -- shows the bit of the design
  );
end entity;

architecture properties of three_phase_pwm_formal is

  constant dead_clocks : positive := 3; -- the least dead time, in whole clocks

  subtype high_bits_t is std_ulogic_vector(wire_bits - 2 downto 6);
  subtype phases_t is std_ulogic_vector(2 downto 0);

  signal s2m             : wishbone_s2m_t;
  signal highs, lows     : phases_t;
  signal sample, tripped : std_ulogic;
  signal high, low, none : std_ulogic;                                        -- none: all gates are off
  signal begun           : std_ulogic := '0';
  signal high_off        : natural range 0 to dead_clocks := dead_clocks;     -- clocks for which it has been off
  signal low_off         : natural range 0 to dead_clocks := dead_clocks;
  signal off_1, off_2    : std_ulogic := '0';                                 -- enable was 0 one and two clocks ago
  signal fault_1, fault_2 : std_ulogic := '0';
  signal locked, locked_1 : std_ulogic := '0';                                -- a fault came, and nothing has started
  signal valid_1         : phases_t := "000";                                 -- of the wires, a clock ago
  signal ends            : std_ulogic;                                        -- a wire, while enable is 1
  signal lost, lost_1    : std_ulogic := '0';                                 -- one ended, and enable has not risen

begin

  default clock is rising_edge(clk);

  dut : entity work.three_phase_pwm
    generic map (
      clock_hz => 10_000_000, frequency_hz => 625_000, duty_bits => 6, dead_minimum_ns => 250, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sample => sample, tripped => tripped,
      duty_0_wire => valid(0) & high_bits_t'(others => '0') & value,
      duty_1_wire => valid(1) & high_bits_t'(others => '0') & value,
      duty_2_wire => valid(2) & high_bits_t'(others => '0') & value,
      fault => fault, high => highs, low => lows);

  high <= highs(watched);
  low  <= lows(watched);
  none <= nor (highs & lows);
  ends <= enable and or (valid_1 and not valid);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun    <= '1';
      off_1    <= not enable;
      off_2    <= off_1;
      fault_1  <= fault;
      fault_2  <= fault_1;
      locked   <= fault or (locked and not (enable and off_1 and not fault_1 and not fault_2));
      locked_1 <= locked;
      valid_1  <= valid;
      lost     <= ends or (lost and not (enable and off_1));
      lost_1   <= lost;

      high_off <= 0;
      if high = '0' then
        high_off <= minimum(dead_clocks, high_off + 1);
      end if;
      low_off <= 0;
      if low = '0' then
        low_off <= minimum(dead_clocks, low_off + 1);
      end if;

      if reset = '1' then
        off_1    <= '0';
        fault_1  <= '0';
        locked   <= '1';
        lost     <= '0';
        high_off <= dead_clocks;
        low_off  <= dead_clocks;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The watched phase is any, and stays the same.
  one_is_watched : assume always begun = '1' -> watched = prev(watched);

  -- The two gates of a phase are never on together.
  never_both : assert always begun = '1' and high = '1' -> low = '0';

  -- A high gate is on only when the low one has been off for the least dead time, whatever was written.
  dead_before_high : assert always begun = '1' and high = '1' -> low_off = dead_clocks;

  -- A low gate is on only when the high one has been off for the least dead time, whatever was written.
  dead_before_low : assert always begun = '1' and low = '1' -> high_off = dead_clocks;

  -- Two clocks after a fault on the pin all gates are off.
  fault_cuts : assert always begun = '1' and reset = '0' and fault = '1' -> next[2] (none = '1');

  -- They stay off, until enable rises without a fault. The same holds after a reset.
  stays_off : assert always begun = '1' and locked = '1' and locked_1 = '1' -> none = '1';

  -- Two clocks after a wire has ended all gates are off.
  end_cuts : assert always begun = '1' and reset = '0' and ends = '1' -> next[2] (none = '1');

  -- They stay off, until enable rises.
  stays_cut : assert always begun = '1' and lost = '1' and lost_1 = '1' -> none = '1';

  -- Two clocks after enable has fallen all gates are off.
  disable_cuts : assert always begun = '1' and off_1 = '1' and off_2 = '1' -> none = '1';

  -- A phase goes from low to high, and back.
  high_seen : cover {begun = '1' and high = '1' and low_off = dead_clocks and fault_1 = '0'};

  -- A wire ends while a gate is on.
  end_seen : cover {begun = '1' and ends = '1' and none = '0'; begun = '1'; none = '1'};

  -- A fault comes while a gate is on.
  fault_seen : cover {begun = '1' and fault = '1' and none = '0'; begun = '1'; none = '1'};

end architecture;
