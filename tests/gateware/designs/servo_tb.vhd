-- SPDX-License-Identifier: BSD-3-Clause
--
-- examples/servo/servo_board.vhd: the wheel turns a count for every 100 µs of a servo's pulse, and pulse 1 closes the
-- switch.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.bench_pkg.all;

entity servo_tb is
  generic (
    steps_file   : string := "steps.txt";
    answers_file : string := "answers.txt"
  );
end entity;

architecture test of servo_tb is

  constant clock_hz : positive := 8_000_000;
  constant baud_hz  : positive := 1_000_000;

  signal clock             : std_ulogic := '0';
  signal reset             : std_ulogic := '1';
  signal to_board, to_host : std_ulogic;
  signal servos            : std_ulogic_vector(1 downto 0);
  signal lines             : std_ulogic_vector(1 downto 0) := "00"; -- b, a
  signal lamp              : std_ulogic;
  signal done              : boolean;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;
  reset <= '0' after 2 us;

  board : entity work.servo_board
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, usb_rx => to_board, usb_tx => to_host, servos => servos,
      encoder_a => lines(0), encoder_b => lines(1), limit_switch => not servos(1), lamp => lamp);

  -- Forwards: 00, 01, 11, 10.
  turn : process is
  begin
    wait until servos(0) = '1';
    loop
      wait until servos(0) = '0' for 100 us;
      exit when servos(0) = '0';
      lines <= lines(0) & not lines(1);
    end loop;
  end process;

  pc : entity unitylink.uart_player
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, steps_file => steps_file, answers_file => answers_file)
    port map (clock => clock, reset => reset, rx_line => to_host, tx_line => to_board, done => done);

  process is
  begin
    wait for 1 us;
    wait until rising_edge(clock);
    check_equal(lamp, '1', "the lamp begins lit");
    wait until done;
    check_equal(lamp, '0', "the lamp was put out");
    report_passed("servo_tb");
    wait;
  end process;

end architecture;
