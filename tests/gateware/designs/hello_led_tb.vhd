-- SPDX-License-Identifier: BSD-3-Clause
--
-- The generated hello_led_top: its buttons are the lamps turned over, and its clock counts how often the lamps were
-- written.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.bench_pkg.all;
use work.hello_led_user_pkg.all;

entity hello_led_tb is
  generic (
    steps_file   : string := "steps.txt";
    answers_file : string := "answers.txt"
  );
end entity;

architecture test of hello_led_tb is

  constant clock_hz : positive := 12_000_000;
  constant baud_hz  : positive := 1_500_000;

  signal clock, user_reset : std_ulogic := '0';
  signal to_board, to_host : std_ulogic;
  signal to_pc             : hello_led_to_pc_t;
  signal from_pc           : hello_led_from_pc_t;
  signal written           : hello_led_written_t;
  signal done              : boolean;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;

  board : entity work.hello_led_top
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, rx_line => to_board, tx_line => to_host, user_reset => user_reset,
      to_pc => to_pc, from_pc => from_pc, written => written);

  to_pc.buttons <= not from_pc.led;

  process (clock) is
  begin
    if rising_edge(clock) then
      if user_reset = '1' then
        to_pc.uptime_ms <= (others => '0');
      elsif written.led = '1' then
        to_pc.uptime_ms <= to_pc.uptime_ms + 1;
      end if;
    end if;
  end process;

  pc : entity unitylink.uart_player
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, steps_file => steps_file, answers_file => answers_file)
    port map (clock => clock, reset => user_reset, rx_line => to_host, tx_line => to_board, done => done);

  process is
  begin
    wait until done;
    report_passed("hello_led_tb");
    wait;
  end process;

end architecture;
