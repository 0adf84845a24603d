-- SPDX-License-Identifier: BSD-3-Clause
--
-- The generated scara_top, with TosNet: positions follow the set-points of each commit.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.bench_pkg.all;
use work.scara_user_pkg.all;

entity scara_tb is
  generic (
    steps_file   : string := "steps.txt";
    answers_file : string := "answers.txt"
  );
end entity;

architecture test of scara_tb is

  constant clock_hz : positive := 12_000_000;
  constant baud_hz  : positive := 1_500_000;

  signal clock, user_reset : std_ulogic := '0';
  signal to_board, to_host : std_ulogic;
  signal to_pc             : scara_to_pc_t;
  signal from_pc           : scara_from_pc_t;
  signal written           : scara_written_t;
  signal done              : boolean;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;

  board : entity work.scara_top
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, rx_line => to_board, tx_line => to_host, user_reset => user_reset,
      to_pc => to_pc, from_pc => from_pc, written => written);

  -- A robot that is where it is told to be, and a count of how often it was told.
  follow : process (clock) is
    variable count : signed(31 downto 0);
  begin
    if rising_edge(clock) then
      if user_reset = '1' then
        count := (others => '0');
        to_pc <= (others => (cpos => (others => '0'), spd => (others => '0')));
      elsif written.j1.pos_sp = '1' then
        count         := count + 1;
        to_pc.j1.cpos <= from_pc.j1.pos_sp + count;
        to_pc.j2.cpos <= from_pc.j2.pos_sp - count;
        to_pc.j3.cpos <= from_pc.j3.pos_sp;
        to_pc.j4.cpos <= from_pc.j4.pos_sp;
      end if;
    end if;
  end process;

  pc : entity unitylink.uart_player
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, steps_file => steps_file, answers_file => answers_file)
    port map (clock => clock, reset => user_reset, rx_line => to_host, tx_line => to_board, done => done);

  process is
  begin
    wait until done;
    report_passed("scara_tb");
    wait;
  end process;

end architecture;
