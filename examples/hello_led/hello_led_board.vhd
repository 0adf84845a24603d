-- SPDX-License-Identifier: BSD-3-Clause
--
-- A board around the generated hello_led_top: LEDs, buttons, and a counter of milliseconds. `unitylink build` finds it
-- by its name.
--
-- Generics  clock_hz, baud_hz: the board's and the line's.
-- Ports     reset: high starts anew; `unitylink build` holds it until the clock is steady. usb_rx, usb_tx: the link.
--           buttons: high when pressed, asynchronous; a level counts once it has held for a millisecond.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
use work.hello_led_user_pkg.all;

entity hello_led_board is
  generic (
    clock_hz : positive := 12_000_000;
    baud_hz  : positive := 1_000_000
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic := '0';
    usb_rx  : in  std_ulogic;
    usb_tx  : out std_ulogic;
    buttons : in  std_ulogic_vector(3 downto 0);
    leds    : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of hello_led_board is

  constant clocks_a_ms : positive := clock_hz / 1000;

  signal user_reset : std_ulogic;
  signal to_pc      : hello_led_to_pc_t;
  signal from_pc    : hello_led_from_pc_t;
  signal levels     : std_ulogic_vector(buttons'range);
  signal clocks     : natural range 0 to clocks_a_ms - 1;
  signal uptime_ms  : unsigned(31 downto 0);

begin

  link : entity work.hello_led_top
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, rx_line => usb_rx, tx_line => usb_tx, user_reset => user_reset,
      to_pc => to_pc, from_pc => from_pc);

  debounced : entity unitylink.input_filter
    generic map (width => buttons'length, stable_clocks => clocks_a_ms)
    port map (clock => clock, reset => user_reset, pins => buttons, levels => levels);

  leds            <= std_ulogic_vector(from_pc.led(7 downto 0));
  to_pc.buttons   <= resize(unsigned(levels), 32);
  to_pc.uptime_ms <= uptime_ms;

  process (clock) is
  begin
    if rising_edge(clock) then
      if clocks = clocks_a_ms - 1 then
        clocks    <= 0;
        uptime_ms <= uptime_ms + 1;
      else
        clocks <= clocks + 1;
      end if;
      if user_reset = '1' then
        clocks    <= 0;
        uptime_ms <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
