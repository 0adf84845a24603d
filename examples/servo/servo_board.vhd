-- SPDX-License-Identifier: BSD-3-Clause
--
-- A board around the generated servo_top: pins, and logic of one's own. This is all the VHDL that is written by hand.
--
-- Generics  clock_hz: the crystal. baud_hz: as in the spec.
-- Ports     reset: high starts anew; `unitylink build` holds it until the clock is steady. limit_switch: low when
--           closed; asynchronous, as the encoder's lines are.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
use work.servo_config_pkg;
use work.servo_user_pkg.all;

entity servo_board is
  generic (
    clock_hz : positive := 12_000_000;
    baud_hz  : positive := 1_000_000
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic := '0';
    usb_rx       : in  std_ulogic;
    usb_tx       : out std_ulogic;
    servos       : out std_ulogic_vector(1 downto 0);
    encoder_a    : in  std_ulogic;
    encoder_b    : in  std_ulogic;
    limit_switch : in  std_ulogic;
    lamp         : out std_ulogic
  );
end entity;

architecture rtl of servo_board is

  constant clocks_a_ms : positive := clock_hz / 1000;

  signal user_reset     : std_ulogic;
  signal to_pc          : servo_to_pc_t;
  signal from_pc        : servo_from_pc_t;
  signal events         : std_ulogic_vector(servo_config_pkg.settings.groups - 1 downto 0);
  signal pressed        : std_ulogic; -- the switch as it is now, and as it has been for a while
  signal closed, before : std_ulogic;
  signal clocks         : natural range 0 to clocks_a_ms - 1;

begin

  link : entity work.servo_top
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, rx_line => usb_rx, tx_line => usb_tx, user_reset => user_reset,
      to_pc => to_pc, from_pc => from_pc, events => events,
      drive_pins => servos, wheel_a => encoder_a, wheel_b => encoder_b, wheel_index => '0');

  lamp <= from_pc.lamp;

  pressed <= not limit_switch;

  debounced : entity unitylink.input_filter
    generic map (stable_clocks => clocks_a_ms)
    port map (clock => clock, reset => user_reset, pins(0) => pressed, levels(0) => closed);

  events <= (servo_config_pkg.limit_event => before, others => '0'); -- rises when trips has its new value

  process (clock) is
  begin
    if rising_edge(clock) then
      before <= closed;
      if closed = '1' and before = '0' then
        to_pc.trips <= to_pc.trips + 1;
      end if;
      if clocks = clocks_a_ms - 1 then
        clocks          <= 0;
        to_pc.uptime_ms <= to_pc.uptime_ms + 1;
      else
        clocks <= clocks + 1;
      end if;
      if user_reset = '1' then
        before          <= closed;
        clocks          <= 0;
        to_pc.trips     <= (others => '0');
        to_pc.uptime_ms <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
