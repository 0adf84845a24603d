-- SPDX-License-Identifier: BSD-3-Clause
--
-- The host of benches (uart_host, host_pkg) before a board: values of one and several words, what the board refuses,
-- publishes, a frame that is lost, a reset of the board, and a board that is silent.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.address_map_pkg.all;
  use work.bench_pkg.all;
  use work.host_pkg.all;
  use work.physical_pkg.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.settings_pkg.all;
  use work.wishbone_pkg.all;

entity uart_host_tb is
  generic (
    address_bits : positive := 16;
    data_bits    : positive := 32
  );
end entity;

architecture test of uart_host_tb is

  constant clock_hz : positive := 24_000_000;
  constant baud_hz  : positive := 3_000_000;
  constant base_hz  : positive := 4_000;
  constant bit_time : time     := 1 sec / baud_hz;

  constant at    : host_address_t := to_unsigned(16#40#, 32);
  constant size  : positive  := 2 * data_bits - 3; -- of a value in two words
  constant value : std_ulogic_vector(63 downto 0) := x"9E3779B97F4A7C15";

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean    := false;

  signal request : host_request_t := host_request_idle;
  signal reply   : host_reply_t;
  signal publish : host_publish_t;

  signal host_line, board_line, to_board, from_board : std_ulogic;
  signal cut_to, cut_from                            : std_ulogic := '0';

  signal rx_valid, rx_ready, tx_valid, tx_ready : std_ulogic;
  signal rx_data, tx_data                       : std_ulogic_vector(7 downto 0);
  signal rx_error                               : receive_error_t;
  signal events                                 : std_ulogic_vector(3 downto 0) := "0000";
  signal m2s                                    : wishbone_m2s_t;
  signal s2m                                    : wishbone_s2m_t;
  signal to_slaves                              : wishbone_m2s_vector_t(0 to 0);
  signal from_slaves                            : wishbone_s2m_vector_t(0 to 0);
  signal read_words, write_words                : word_vector_t(0 to 2);
  signal written                                : std_ulogic_vector(0 to 2);
  signal writes                                 : natural := 0;

begin

  clock      <= not clock after 0.5 sec / clock_hz when not done;
  to_board   <= host_line or cut_to;
  from_board <= board_line or cut_from;

  host : entity work.uart_host
    generic map (baud_hz => baud_hz, answer_bits => 600, attempts => 3)
    port map (rx_line => from_board, tx_line => host_line, request => request, reply => reply, publish => publish);

  physical : entity work.uart
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, rx_line => to_board, tx_line => board_line, line_break => open,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data);

  core : entity work.core
    generic map (
      settings => core_settings(
        address_bits => address_bits, data_bits => data_bits, clock_hz => clock_hz, base_hz => base_hz, groups => 4,
        edge_events => (0 => '1', others => '0')))
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data,
      events => events, wishbone_m2s => m2s, wishbone_s2m => s2m);

  interconnect : entity work.wishbone_interconnect
    generic map (address_map => (0 => (base => x"00000040", words => 3)))
    port map (master_m2s => m2s, master_s2m => s2m, slaves_m2s => to_slaves, slaves_s2m => from_slaves);

  registers : entity work.register_slave
    generic map (writable => "110", data_width => data_bits)
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(0), wishbone_s2m => from_slaves(0),
      read_words => read_words, write_words => write_words, written => written, was_read => open);

  read_words <= (0 => write_words(0), 1 => write_words(1), 2 => not write_words(0));

  count : process (clock) is
  begin
    if rising_edge(clock) and written(0) = '1' then
      writes <= writes + 1;
    end if;
  end process;

  test : process is
    variable got    : std_ulogic_vector(size - 1 downto 0);
    variable one    : std_ulogic_vector(0 downto 0);
    variable word   : host_word_t;
    variable status : natural;
    variable before : natural;
  begin
    wait for 1 us;
    reset <= '0';

    write_value(request, reply, at, data_bits, value(size - 1 downto 0));
    read_value(request, reply, at, data_bits, got);
    check_equal(got, value(size - 1 downto 0), "a value of two words");
    write_value(request, reply, at, data_bits, "1");
    read_value(request, reply, at + 2, data_bits, one);
    check_equal(one, "0", "a value of one bit");

    read_word(request, reply, to_unsigned(16#7F#, 32), word, status);
    check_equal(status, reply_status_bus_error_c, "a read where nothing is");
    write_word(request, reply, at + 2, word, status);
    check_equal(status, reply_status_bus_error_c, "a write to what is read");

    subscribe(request, reply, 0, (at, at + 2));
    events(0) <= '1';
    await_publish(publish, 0, 1 ms);
    events(0) <= '0';
    check_equal(publish.count, 2, "words of a publish");
    check_equal(publish.words(0)(7 downto 0), x"01", "the first word of a publish");
    check_equal(publish.words(1)(7 downto 0), x"FE", "the second word of a publish");
    subscribe(request, reply, 3, (0 => at + 1), divisor => 2, on_event => false);
    await_publish(publish, 3, 3 ms);
    before := to_integer(publish.sequence_number);
    await_publish(publish, 3, 3 ms);
    check_equal(to_integer(publish.sequence_number), before + 1, "the sequence of publishes");

    -- The board does not hear a request, then the host not the answer. Both are repeated, and executed once.
    before := writes;
    cut_to <= '1', '0' after 200 * bit_time;
    write_word(request, reply, at, x"00000055", status);
    check_equal(status, status_ok, "a write that was repeated");
    cut_from <= '1', '0' after 400 * bit_time;
    write_word(request, reply, at, x"00000056", status);
    check_equal(status, status_ok, "a write whose answer was lost");
    check_equal(writes - before, 2, "writes");

    pulse(clock, reset);
    read_word(request, reply, at, word, status);
    check_equal(status, status_ok, "a read after a reset");
    check_equal(word(7 downto 0), x"00", "the word after a reset");

    cut_from <= '1';
    read_word(request, reply, at, word, status);
    check_equal(status, status_silent, "a read of a silent board");
    cut_from <= '0';
    read_word(request, reply, at + 2, word, status);
    check_equal(status, status_ok, "a read after the silence");
    check_equal(word(7 downto 0), x"FF", "the word after the silence");

    report_passed("uart_host_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 200 ms, "uart_host_tb");

end architecture;
