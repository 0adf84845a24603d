-- SPDX-License-Identifier: BSD-3-Clause
--
-- The PC's end of a UART, for benches of whole designs. It plays a file of steps, and writes the bytes received in each
-- step on a line.
--
--   s 2352...   sends these bytes, then waits until no byte has come for the time of 22 characters
--   w 5000      waits for so many clocks

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.textio.all;
  use work.physical_pkg.all;

entity uart_player is
  generic (
    clock_hz     : positive;
    baud_hz      : positive;
    steps_file   : string;
    answers_file : string
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic;
    rx_line : in  std_ulogic;
    tx_line : out std_ulogic;
    done    : out boolean := false
  );
end entity;

architecture test of uart_player is

  constant clocks_most  : positive := 2_000_000; -- of one step
  -- Behind the last byte that the uart accepts, 16 wait in its FIFO and one is on the line. The reply takes one more.
  constant quiet_clocks : positive := 22 * 10 * (clock_hz / baud_hz);

  signal rx_valid : std_ulogic;
  signal rx_data  : std_ulogic_vector(7 downto 0);
  signal rx_error : receive_error_t;
  signal tx_valid : std_ulogic := '0';
  signal tx_ready : std_ulogic;
  signal tx_data  : std_ulogic_vector(7 downto 0) := x"00";

begin

  uart : entity work.uart
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, rx_line => rx_line, tx_line => tx_line, line_break => open,
      rx_valid => rx_valid, rx_ready => '1', rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data);

  play : process is

    file steps   : text open read_mode is steps_file;
    file answers : text open write_mode is answers_file;

    variable step   : line;
    variable answer : line;
    variable kind   : character;
    variable gap    : character;
    variable byte   : std_ulogic_vector(7 downto 0);
    variable number : natural;
    variable quiet  : natural;
    variable clocks : natural;

    procedure one_clock is
    begin
      wait until rising_edge(clock);
      clocks := clocks + 1;
      quiet  := quiet + 1;
      if rx_valid = '1' then
        hwrite(answer, rx_data);
        quiet := 0;
      end if;
      assert rx_error = no_receive_error
        report "uart_player: an error on the line"
        severity failure;
      assert clocks < clocks_most
        report "uart_player: a step has no end"
        severity failure;
    end procedure;

  begin
    clocks := 0;
    while reset /= '0' loop
      one_clock;
    end loop;
    while not endfile(steps) loop
      readline(steps, step);
      read(step, kind);
      read(step, gap);
      clocks := 0;
      quiet  := 0;
      if kind = 's' then
        while step'length > 0 loop
          hread(step, byte);
          tx_valid <= '1';
          tx_data  <= byte;
          loop
            one_clock;
            exit when tx_ready = '1';
          end loop;
          tx_valid <= '0';
        end loop;
        quiet := 0;
        while quiet < quiet_clocks loop
          one_clock;
        end loop;
      else
        read(step, number);
        for index in 1 to number loop
          one_clock;
        end loop;
      end if;
      write(answer, string'(" end"));
      writeline(answers, answer);
    end loop;
    done <= true;
    wait;
  end process;

end architecture;
