-- SPDX-License-Identifier: BSD-3-Clause
--
-- examples/hello_led/hello_led_board.vhd: buttons 0 and 3 are pressed; the PC lights LEDs.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.bench_pkg.all;

entity hello_led_board_tb is
  generic (
    steps_file   : string := "steps.txt";
    answers_file : string := "answers.txt"
  );
end entity;

architecture test of hello_led_board_tb is

  constant clock_hz : positive := 8_000_000;
  constant baud_hz  : positive := 1_000_000;

  signal clock             : std_ulogic := '0';
  signal reset             : std_ulogic := '1';
  signal to_board, to_host : std_ulogic;
  signal leds              : std_ulogic_vector(7 downto 0);
  signal done              : boolean;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;
  reset <= '0' after 2 us;

  board : entity work.hello_led_board
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (clock => clock, reset => reset, usb_rx => to_board, usb_tx => to_host, buttons => "1001", leds => leds);

  pc : entity unitylink.uart_player
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, steps_file => steps_file, answers_file => answers_file)
    port map (clock => clock, reset => reset, rx_line => to_host, tx_line => to_board, done => done);

  process is
  begin
    wait until done;
    check_equal(leds, std_ulogic_vector'("10100101"), "the LEDs");
    report_passed("hello_led_board_tb");
    wait;
  end process;

end architecture;
