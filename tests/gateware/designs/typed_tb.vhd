-- SPDX-License-Identifier: BSD-3-Clause
--
-- The generated typed_top: what the PC writes comes back through other words, types and access modes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.bench_pkg.all;
use work.typed_config_pkg;
use work.typed_user_pkg.all;

entity typed_tb is
  generic (
    steps_file   : string := "steps.txt";
    answers_file : string := "answers.txt"
  );
end entity;

architecture test of typed_tb is

  constant clock_hz : positive := 12_000_000;
  constant baud_hz  : positive := 1_500_000;

  signal clock, user_reset : std_ulogic := '0';
  signal to_board, to_host : std_ulogic;
  signal to_pc             : typed_to_pc_t;
  signal from_pc           : typed_from_pc_t;
  signal written           : typed_written_t;
  signal was_read          : typed_was_read_t;
  signal pins              : std_ulogic_vector(3 downto 0);
  signal events            : std_ulogic_vector(typed_config_pkg.settings.groups - 1 downto 0) := (others => '0');
  signal done              : boolean;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;

  board : entity work.typed_top
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, rx_line => to_board, tx_line => to_host, user_reset => user_reset,
      to_pc => to_pc, from_pc => from_pc, written => written, was_read => was_read, drive_pins => pins,
      events => events);

  to_pc.status  <= (ready => pins(1), mode => from_pc.mode, count => from_pc.wide(63 downto 60));
  to_pc.wide_in <= signed(from_pc.wide(39 downto 0));
  to_pc.ok      <= '1' when from_pc.mode = mode_stop else '0';

  each_leg : for leg in to_pc.leg'range generate
    to_pc.leg(leg).pos <= from_pc.leg(leg).sp + signed(from_pc.duty(leg));
  end generate;

  logic : process (clock) is
  begin
    if rising_edge(clock) then
      if from_pc.kick = 7 then
        to_pc.flags <= to_pc.flags + 1; -- once a write, for it lasts a clock
      end if;
      if written.wide = '1' then
        to_pc.count <= to_pc.count + 1;
      elsif was_read.count = '1' then
        to_pc.count <= (others => '0');
      end if;
      if written.mode = '1' then
        to_pc.sticky <= to_pc.sticky or resize(from_pc.mode, 8);
      elsif written.sticky = '1' then
        to_pc.sticky <= to_pc.sticky and not from_pc.sticky;
      end if;
      events(typed_config_pkg.limit_event) <= written.mode;
      if user_reset = '1' then
        to_pc.flags  <= (others => '0');
        to_pc.count  <= (others => '0');
        to_pc.sticky <= (others => '0');
      end if;
    end if;
  end process;

  pc : entity unitylink.uart_player
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, steps_file => steps_file, answers_file => answers_file)
    port map (clock => clock, reset => user_reset, rx_line => to_host, tx_line => to_board, done => done);

  process is
  begin
    wait until done;
    report_passed("typed_tb");
    wait;
  end process;

end architecture;
