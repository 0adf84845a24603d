-- SPDX-License-Identifier: BSD-3-Clause
--
-- Two uarts with independent clocks send in both directions at once. Then errors, which must be in their place between
-- the bytes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity uart_tb is
  generic (
    a_clock_hz : positive := 50_000_000;
    b_clock_hz : positive := 24_000_000;
    baud_hz    : positive := 3_000_000;
    parity     : parity_t := even;
    bytes      : positive := 300;
    seed       : positive := 1
  );
end entity;

architecture test of uart_tb is

  constant depth    : positive := 4;
  constant bit_time : time     := 1 sec / baud_hz;

  type link_t is record
    valid, ready : std_ulogic;
    data         : std_ulogic_vector(7 downto 0);
  end record;

  signal a_clock, b_clock : std_ulogic := '0';
  signal reset            : std_ulogic := '1';
  signal a_line, b_line   : std_ulogic;        -- the lines that a and b drive
  signal wire             : std_ulogic;        -- what b receives from a
  signal cut              : std_ulogic := '1'; -- 0 pulls the wire low
  signal a_tx, a_rx       : link_t := ('0', '0', x"00");
  signal b_tx, b_rx       : link_t := ('0', '0', x"00");
  signal a_error, b_error : receive_error_t;
  signal b_break          : std_ulogic;
  signal breaks           : natural := 0;

  signal b_stall    : boolean := false;
  signal a_received : natural := 0;
  signal b_received : natural := 0; -- bytes
  signal b_errors   : natural := 0;
  signal b_last     : std_ulogic_vector(7 downto 0);
  signal b_kinds    : receive_error_t := no_receive_error;
  signal b_before   : natural := 0; -- bytes before the last error
  signal random_part : boolean := true;
  signal done       : boolean := false;

begin

  a_clock <= not a_clock after 0.5 sec / a_clock_hz when not done;
  b_clock <= not b_clock after 0.5 sec / b_clock_hz when not done;
  wire    <= a_line and cut;

  a : entity work.uart
    generic map (clock_hz => a_clock_hz, baud_hz => baud_hz, parity => parity, rx_depth => depth, tx_depth => depth)
    port map (
      clock => a_clock, reset => reset, rx_line => b_line, tx_line => a_line, line_break => open,
      rx_valid => a_rx.valid, rx_ready => a_rx.ready, rx_data => a_rx.data, rx_error => a_error,
      tx_valid => a_tx.valid, tx_ready => a_tx.ready, tx_data => a_tx.data);

  b : entity work.uart
    generic map (clock_hz => b_clock_hz, baud_hz => baud_hz, parity => parity, rx_depth => depth, tx_depth => depth)
    port map (
      clock => b_clock, reset => reset, rx_line => wire, tx_line => b_line, line_break => b_break,
      rx_valid => b_rx.valid, rx_ready => b_rx.ready, rx_data => b_rx.data, rx_error => b_error,
      tx_valid => b_tx.valid, tx_ready => b_tx.ready, tx_data => b_tx.data);

  b_sender : process is
    variable data : random_t;
  begin
    data.seed(seed + 2);
    wait until reset = '0';
    for index in 1 to bytes loop
      send(b_clock, b_tx.valid, b_tx.ready, b_tx.data, data.vector(8));
    end loop;
    wait;
  end process;

  a_reader : process is
    variable data, moments : random_t;
  begin
    data.seed(seed + 2);
    moments.seed(seed + 20);
    loop
      wait until rising_edge(a_clock) or done;
      exit when done;
      if a_rx.valid = '1' and a_rx.ready = '1' then
        check_equal(a_rx.data, data.vector(8), "byte " & integer'image(a_received) & " of b");
        a_received <= a_received + 1;
      end if;
      check(reset = '1' or a_error = no_receive_error, "an error at a");
      a_rx.ready <= '1' when moments.chance(10) else '0';
    end loop;
    wait;
  end process;

  b_reader : process is
    variable data, moments : random_t;
  begin
    data.seed(seed + 1);
    moments.seed(seed + 10);
    loop
      wait until rising_edge(b_clock) or done;
      exit when done;
      if b_rx.valid = '1' and b_rx.ready = '1' then
        if random_part then
          check_equal(b_rx.data, data.vector(8), "byte " & integer'image(b_received) & " of a");
        end if;
        b_last     <= b_rx.data;
        b_received <= b_received + 1;
      end if;
      if reset = '0' and b_error /= no_receive_error then
        check_equal(b_rx.valid, '0', "a byte and an error at once");
        b_errors <= b_errors + 1;
        b_kinds  <= b_error;
        b_before <= b_received;
      end if;
      if b_break = '1' then
        breaks <= breaks + 1;
      end if;
      b_rx.ready <= '1' when not b_stall and moments.chance(10) else '0';
    end loop;
    wait;
  end process;

  a_sender : process is
    variable data     : random_t;
    variable received : natural;

    procedure send (value : std_ulogic_vector(7 downto 0)) is
    begin
      send(a_clock, a_tx.valid, a_tx.ready, a_tx.data, value);
    end procedure;

    procedure settle is
    begin
      wait for bit_time * 12 * (depth + 4);
    end procedure;
  begin
    data.seed(seed + 1);
    wait for bit_time;
    reset <= '0';
    wait for bit_time;
    for index in 1 to bytes loop
      send(data.vector(8));
    end loop;
    while a_received < bytes or b_received < bytes loop
      wait for bit_time;
    end loop;
    check_equal(b_errors, 0, "errors of good traffic");
    random_part <= false;

    -- Two bytes, a break and one byte come while nobody reads. The error comes after the second byte and before the
    -- third.
    received := b_received;
    b_stall  <= true;
    send(x"11");
    send(x"22");
    settle;
    cut <= '0';
    wait for bit_time * 20;
    cut <= '1';
    wait for bit_time * 3;
    send(x"33");
    settle;
    check_equal(b_errors, 0, "errors before the bytes in front were read");
    check_equal(breaks, 1, "breaks");
    b_stall <= false;
    settle;
    check_equal(b_errors, 1, "errors after the break");
    check_equal(b_before, received + 2, "bytes in front of the error");
    check_equal(b_received, received + 3, "bytes with the break");
    check_equal(b_kinds(framing_error_bit), '1', "framing");
    check_equal(b_kinds(overrun_error_bit), '0', "overrun");
    check_equal(b_last, std_ulogic_vector'(x"33"), "the byte behind the break");

    -- An overrun: the first depth + 2 bytes, one error, and the bytes that came when there was room again.
    received := b_received;
    b_stall  <= true;
    for index in 1 to depth + 6 loop
      send(std_ulogic_vector(to_unsigned(index, 8)));
    end loop;
    settle;
    settle;
    b_stall <= false;
    settle;
    check_equal(b_received, received + depth + 2, "bytes in front of the overrun");
    check_equal(b_errors, 2, "errors after the overrun");
    check_equal(b_kinds, receive_error_t'("100"), "kind of error");
    check_equal(b_before, received + depth + 2, "bytes in front of the overrun");
    send(x"77");
    settle;
    check_equal(b_last, std_ulogic_vector'(x"77"), "the byte behind the overrun");

    report_passed("uart_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, bit_time * (bytes * 80 + 4000), "uart_tb");

end architecture;
