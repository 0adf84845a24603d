-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the four gates of h_bridge, form 0. The bus may do anything at any clock, and so may the fault input. A
-- clock is 100 ns here, a period is 16 clocks, and the least dead time is 250 ns.

library ieee;
  use ieee.std_logic_1164.all;

use work.wishbone_pkg.all;

entity h_bridge_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    fault   : in std_ulogic;
    watched : in natural range 0 to 1; -- the leg that is watched
    enable  : in std_ulogic            -- shows the bit of the design
  );
end entity;

architecture properties of h_bridge_formal is

  constant dead_clocks : positive := 3; -- the least dead time, in whole clocks

  signal s2m              : wishbone_s2m_t;
  signal tripped          : std_ulogic;
  signal pins             : std_ulogic_vector(3 downto 0);
  signal high, low, none  : std_ulogic;                                    -- none: all gates are off
  signal begun            : std_ulogic := '0';
  signal high_off         : natural range 0 to dead_clocks := dead_clocks; -- clocks for which it has been off
  signal low_off          : natural range 0 to dead_clocks := dead_clocks;
  signal off_1, off_2     : std_ulogic := '0';                             -- enable was 0 one and two clocks ago
  signal fault_1, fault_2 : std_ulogic := '0';
  signal locked, locked_1 : std_ulogic := '0';                             -- a fault came, and nothing has started

begin

  default clock is rising_edge(clk);

  dut : entity work.h_bridge
    generic map (
      clock_hz => 10_000_000, frequency_hz => 625_000, duty_bits => 6, dead_minimum_ns => 250, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped, fault => fault,
      pins => pins);

  high <= pins(2 * watched);
  low  <= pins(2 * watched + 1);
  none <= nor pins;

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
        high_off <= dead_clocks;
        low_off  <= dead_clocks;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The watched leg is any, and stays the same.
  one_is_watched : assume always begun = '1' -> watched = prev(watched);

  -- The two gates of a leg are never on together.
  never_both : assert always begun = '1' and high = '1' -> low = '0';

  -- Both high gates are never on together: the motor is driven, brakes on the low sides, or coasts.
  never_both_high : assert always begun = '1' -> (pins(0) and pins(2)) = '0';

  -- A high gate is on only when the low one has been off for the least dead time, whatever was written.
  dead_before_high : assert always begun = '1' and high = '1' -> low_off = dead_clocks;

  -- A low gate is on only when the high one has been off for the least dead time, whatever was written.
  dead_before_low : assert always begun = '1' and low = '1' -> high_off = dead_clocks;

  -- Two clocks after a fault on the pin all gates are off.
  fault_cuts : assert always begun = '1' and reset = '0' and fault = '1' -> next[2] (none = '1');

  -- They stay off, until enable rises without a fault. The same holds after a reset.
  stays_off : assert always begun = '1' and locked = '1' and locked_1 = '1' -> none = '1';

  -- Two clocks after enable has fallen all gates are off.
  disable_cuts : assert always begun = '1' and off_1 = '1' and off_2 = '1' -> none = '1';

  -- A leg goes from low to high, and back.
  high_seen : cover {begun = '1' and high = '1' and low_off = dead_clocks and fault_1 = '0'};

  -- A fault comes while a gate is on.
  fault_seen : cover {begun = '1' and fault = '1' and none = '0'; begun = '1'; none = '1'};

end architecture;
