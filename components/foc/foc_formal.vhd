-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of foc with duties of 5, 4 and 16 bits. A period may begin at any clock, and products, sines and voltages
-- may be anything: whatever the arithmetic gives, the duties keep to this. The wires and the bus may do anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity foc_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    m2s        : in wishbone_m2s_t;
    current_a  : in wire_t;
    current_b  : in wire_t;
    position   : in wire_t;
    enable     : in std_ulogic;          -- shows the bit of the design, as all of these show its signals
    is_tripped : in std_ulogic;
    step       : in unsigned(4 downto 0);
    integral_d : in signed(35 downto 0);
    integral_q : in signed(35 downto 0)
  );
end entity;

architecture properties of foc_formal is

  -- The places of `step` in its type.
  constant idle : natural := 0;
  constant give : natural := 18;

  signal s2m                    : wishbone_s2m_t;
  signal tripped                : std_ulogic;
  signal duty_0, duty_1, duty_2 : wire_t;
  signal valid                  : std_ulogic;
  signal begun                  : std_ulogic := '0';
  signal reset_1                : std_ulogic := '1';
  signal runs, good             : std_ulogic;
  signal enable_1, enable_2     : std_ulogic := '0';
  signal was_tripped            : std_ulogic := '0';
  signal valid_1                : std_ulogic := '0';
  signal stopped                : std_ulogic := '1'; -- it did not run, or an input was not valid, a clock ago
  signal bad_1                  : std_ulogic := '0'; -- it ran, and an input was not valid, a clock ago
  signal started                : std_ulogic := '0'; -- a period has begun since the start
  signal gave                   : std_ulogic := '0'; -- it has ended, a clock ago

begin

  default clock is rising_edge(clk);

  dut : entity work.foc
    generic map (
      clock_hz => 1_000_000, loop_hz => 1000, duty_0_wire_bits => 5, duty_1_wire_bits => 4, duty_2_wire_bits => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped,
      current_a_wire => current_a, current_b_wire => current_b, position_wire => position,
      duty_0_wire => duty_0, duty_1_wire => duty_1, duty_2_wire => duty_2);

  runs  <= enable and not is_tripped;
  good  <= is_valid(current_a) and is_valid(current_b) and is_valid(position);
  valid <= is_valid(duty_0) or is_valid(duty_1) or is_valid(duty_2);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun       <= '1';
      reset_1     <= reset;
      enable_1    <= enable;
      enable_2    <= enable_1;
      was_tripped <= is_tripped;
      valid_1     <= valid;
      stopped     <= reset or not runs or not good;
      bad_1       <= runs and not good and not reset;

      gave <= '0';
      if step /= idle then
        started <= '1';
      end if;
      if step = give then
        gave <= started;
      end if;
      if reset = '1' or runs = '0' or good = '0' then
        started <= '0';
        gave    <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- Without enable, behind a trip, and in the clock behind an input that is not valid, no duty is valid.
  none_when_off : assert always begun = '1' and valid = '1' -> enable = '1' and is_tripped = '0' and stopped = '0';

  -- The integrals are then 0, so a start begins anew.
  begins_anew : assert always begun = '1' and stopped = '1' -> integral_d = 0 and integral_q = 0;

  -- An input that is not valid while it runs trips in the next clock, and is told.
  bad_trips : assert always begun = '1' and bad_1 = '1' -> is_tripped = '1' and tripped = '1';

  -- Nothing else trips.
  nothing_else : assert always begun = '1' and tripped = '1' -> bad_1 = '1';

  -- A trip ends only when enable rises.
  stays_tripped : assert always begun = '1' and reset_1 = '0' and was_tripped = '1' and is_tripped = '0' ->
                           enable_1 = '1' and enable_2 = '0';

  -- The first valid duty is that of a whole period behind the start.
  whole_period : assert always begun = '1' and valid = '1' and valid_1 = '0' -> gave = '1';

  -- Each duty is within what its element can be.
  first_in_range : assert always begun = '1' -> value_of(duty_0) <= 15 and value_of(duty_0) >= -15;

  -- It is so with the fewest bits.
  second_in_range : assert always begun = '1' -> value_of(duty_1) <= 7 and value_of(duty_1) >= -7;

  -- It is so with the most bits.
  third_in_range : assert always begun = '1' -> value_of(duty_2) <= 32767 and value_of(duty_2) >= -32767;

end architecture;
