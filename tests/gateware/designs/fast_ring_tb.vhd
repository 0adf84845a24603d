-- SPDX-License-Identifier: BSD-3-Clause
--
-- The generated fast_ring_top and fast_ring_node_2, a ring whose line has a bit a clock. Four samples of each bit come
-- from what would be SERDES inputs. The node gives back the word that it gets, and drives a motor.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.bench_pkg.all;
use work.fast_ring_config_pkg;

entity fast_ring_tb is
  generic (
    steps_file   : string := "steps.txt";
    answers_file : string := "answers.txt"
  );
end entity;

architecture test of fast_ring_tb is

  constant clock_hz : positive := 50_000_000;
  constant baud_hz  : positive := 3_000_000;

  signal clock, user_reset : std_ulogic := '0';
  signal to_board, to_host : std_ulogic;
  signal events            : std_ulogic_vector(fast_ring_config_pkg.settings.groups - 1 downto 0) := (others => '0');
  signal lines             : std_ulogic_vector(0 to 1); -- out of the PC's design, out of the node
  signal to_pc, to_node    : std_ulogic_vector(3 downto 0) := "0000";
  signal word              : std_ulogic_vector(31 downto 0);
  signal gates             : std_ulogic_vector(3 downto 0);
  signal was_on            : std_ulogic := '0';
  signal done              : boolean;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;

  board : entity work.fast_ring_top
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, rx_line => to_board, tx_line => to_host, user_reset => user_reset, ring_in => to_pc,
      ring_out => lines(0), tripped => open, events => events);

  node : entity work.fast_ring_node_2
    generic map (clock_hz => clock_hz)
    port map (
      clock => clock, reset => user_reset, ring_in => to_node, ring_out => lines(1), word => word, back => word,
      motor_fault => '0', motor_pins => gates, running => open, strobe => open, exchange => open);

  inputs : process (clock) is
  begin
    if rising_edge(clock) then
      to_node <= (others => lines(0));
      to_pc   <= (others => lines(1));
      was_on  <= was_on or gates(0);
    end if;
  end process;

  pc : entity unitylink.uart_player
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, steps_file => steps_file, answers_file => answers_file)
    port map (clock => clock, reset => user_reset, rx_line => to_host, tx_line => to_board, done => done);

  process is
  begin
    wait until done;
    check(was_on = '1', "the motor was never driven");
    report_passed("fast_ring_tb");
    wait;
  end process;

end architecture;
