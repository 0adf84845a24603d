-- SPDX-License-Identifier: BSD-3-Clause
--
-- uart_bridge on a line with a far end: bytes both ways, the driver and its hold time, the pulses of arrival, a full
-- queue on each side, broken characters, rates, a half-duplex line with its echo, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity uart_bridge_tb is
  generic (
    clock_hz    : positive := 8_000_000;
    baud_hz     : positive := 500_000;
    parity      : natural  := 0;
    stop_bits   : positive := 1;
    half_duplex : natural  := 0;
    hold_us     : natural  := 3;
    seed        : positive := 1
  );
end entity;

architecture test of uart_bridge_tb is

  constant depth        : positive := 8;
  constant clock_period : time     := 1 sec / clock_hz;
  constant valid        : natural  := 512;
  constant gap          : natural  := 256;

  subtype byte_t is std_ulogic_vector(7 downto 0);
  type bytes_t is array (0 to 255) of byte_t;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal bit_time  : time := 1 sec / baud_hz;
  signal arrival   : std_ulogic;
  signal arrivals  : natural := 0;
  signal arrival_1 : std_ulogic := '0';
  signal far       : std_ulogic := '1';  -- what the far end sends
  signal rx, tx, tx_enable : std_ulogic;
  signal heard     : bytes_t := (others => x"00"); -- by the far end
  signal count     : natural := 0;
  signal rose, fell, last_edge : time := 0 ns;     -- of tx_enable, and of the last start bit

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.uart_bridge
    generic map (
      clock_hz => clock_hz, baud_hz => baud_hz, parity => parity, stop_bits => stop_bits, half_duplex => half_duplex,
      hold_us => hold_us, depth => depth)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, arrival => arrival,
      rx => rx, tx => tx, tx_enable => tx_enable);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  -- Two wires of RS-485 bring back what is sent.
  rx <= far when half_duplex = 0 or tx_enable = '0' else tx;

  watch : process (clock) is
  begin
    if rising_edge(clock) then
      arrival_1 <= arrival;
      if arrival = '1' and arrival_1 = '0' then
        arrivals <= arrivals + 1;
      end if;
    end if;
  end process;

  driver : process (tx_enable) is
  begin
    if rising_edge(tx_enable) then
      rose <= now;
    elsif falling_edge(tx_enable) then
      fell <= now;
    end if;
  end process;

  -- The far end checks each frame.
  far_end : process is
    variable bits  : byte_t;
    variable begun : time;
  begin
    wait until falling_edge(tx) and reset = '0';
    begun := now;
    last_edge <= begun;
    check_equal(tx_enable, '1', "the driver is on while a byte is sent");
    check(begun - rose >= hold_us * 1 us, "the driver is on for hold_us before a byte");
    wait for bit_time / 2;
    for place in 0 to 7 loop
      wait for bit_time;
      bits(place) := tx;
    end loop;
    if parity /= 0 then
      wait for bit_time;
      check_equal((xor bits) xor tx, to_unsigned(parity - 1, 1)(0), "parity");
    end if;
    for number in 1 to stop_bits loop
      wait for bit_time;
      check_equal(tx, '1', "stop bit");
    end loop;
    heard(count) <= bits;
    count        <= count + 1;
  end process;

  master : process is

    variable random : random_t;
    variable before : natural;
    variable bytes  : bytes_t;
    variable answer : bus_answer_t;

    procedure far_sends (
      byte : byte_t; stop : std_ulogic := '1'; wrong : std_ulogic := '0'; early : time := 0 ns) is
    begin
      far <= '0';
      wait for bit_time;
      for place in 0 to 7 loop
        far <= byte(place);
        wait for bit_time;
      end loop;
      if parity /= 0 then
        far <= (xor byte) xor to_unsigned(parity - 1, 1)(0) xor wrong;
        wait for bit_time;
      end if;
      far <= stop;
      wait for bit_time * stop_bits - early; -- it may end before its last bit does
      far <= '1';
    end procedure;

    procedure until_sent is
    begin
      wait_clocks(clock, 4);
      while tx_enable = '1' loop
        wait_clocks(clock, 1);
      end loop;
    end procedure;

    procedure take_byte (byte : byte_t; flags : natural := valid) is
    begin
      bus_expect(clock, m2s, s2m, 1, flags + to_integer(unsigned(byte)));
    end procedure;

    procedure expect_state (broken : natural; lost : natural; what_sends : natural := 0) is
    begin
      bus_expect(clock, m2s, s2m, 3, broken + 256 * lost + 32768 * what_sends);
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    check_equal(tx_enable, '0', "the driver is off from power-up on");
    reset <= '0';
    wait_clocks(clock, 20);
    check_equal(tx, '1', "the line rests high");
    bus_expect(clock, m2s, s2m, 0, depth);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);
    expect_state(0, 0);

    -- To the line, without a gap, and no more than there is room for. One byte leaves its queue at once.
    for place in 0 to depth loop
      bytes(place) := random.vector(8);
      bus_write(clock, m2s, s2m, 0, to_integer(unsigned(bytes(place))));
      if place = 0 then
        wait_clocks(clock, 10 + hold_us * (clock_hz / 1_000_000));
      end if;
    end loop;
    bus_refuse(clock, m2s, s2m, '1', 0, "a byte without room");
    bus_expect(clock, m2s, s2m, 0, 0);
    expect_state(0, 0, 1);
    until_sent;
    check_equal(count, depth + 1, "bytes at the far end");
    for place in 0 to depth loop
      check_equal(heard(place), bytes(place), "byte " & integer'image(place));
    end loop;
    check(fell - last_edge >= (9 + stop_bits + boolean'pos(parity /= 0)) * bit_time + hold_us * 1 us - clock_period,
          "the driver is on for hold_us behind the last byte");
    check(fell - last_edge <= (9 + stop_bits + boolean'pos(parity /= 0)) * bit_time + hold_us * 1 us + 4 * clock_period,
          "the driver is let go then");
    bus_expect(clock, m2s, s2m, 0, depth);
    expect_state(0, 0);

    -- A byte within the hold time goes out with the driver still on.
    if hold_us > 0 then
      before := count;
      bus_write(clock, m2s, s2m, 0, 16#5A#);
      wait until count = before + 1;
      wait for bit_time / 2 + 1 us;
      bus_write(clock, m2s, s2m, 0, 16#A5#);
      check_equal(tx_enable, '1', "the driver is still on");
      wait until count = before + 2;
      check_equal(heard(before + 1), x"A5", "a late byte");
      until_sent;
    end if;

    -- From the line: each byte has its pulse, the next one behind a read.
    before := arrivals;
    for place in 0 to 2 loop
      bytes(place) := random.vector(8);
      far_sends(bytes(place));
    end loop;
    wait_clocks(clock, 12);
    check(arrivals > before, "a byte is told");
    for place in 0 to 2 loop
      before := arrivals;
      take_byte(bytes(place));
      wait_clocks(clock, 6);
      check_equal(arrivals - before, boolean'pos(place < 2), "pulses behind a read");
    end loop;
    bus_expect(clock, m2s, s2m, 1, 0); -- there is none left
    before := arrivals;
    far_sends(x"11");
    wait_clocks(clock, 12);
    check_equal(arrivals - before, 1, "pulses of a byte");
    far_sends(x"22"); -- nobody has read: it is told again
    wait_clocks(clock, 12);
    check_equal(arrivals - before, 2, "pulses of a second byte, without a read");
    take_byte(x"11");
    take_byte(x"22");

    -- Reads without a pause while a byte arrives: one of them has it, and none takes it unseen.
    for offset in 0 to 3 loop
      before := 0;
      far_sends(std_ulogic_vector(to_unsigned(16#C0# + offset, 8)), early => bit_time / 2);
      wait_clocks(clock, offset);
      for number in 0 to 31 loop
        bus_read(clock, m2s, s2m, 1, answer);
        if answer.word(9) = '1' then
          check_equal(answer.word(7 downto 0), std_ulogic_vector(to_unsigned(16#C0# + offset, 8)), "a byte in time");
          before := before + 1;
        end if;
      end loop;
      check_equal(before, 1, "how often a byte is read");
    end loop;

    -- A broken character, or one with a wrong parity, is no byte. The next byte says that something is missing.
    if parity = 0 then
      far_sends(x"33", stop => '0');
    else
      far_sends(x"33", wrong => '1');
    end if;
    wait for 2 * bit_time;
    far_sends(x"44");
    far_sends(x"55");
    wait_clocks(clock, 12);
    expect_state(1, 0);
    take_byte(x"44", valid + gap);
    take_byte(x"55");

    -- Without room the newest ones are lost, and counted. The queue has a byte more, at its end.
    for place in 0 to depth + 2 loop
      far_sends(std_ulogic_vector(to_unsigned(place, 8)));
    end loop;
    wait_clocks(clock, 12);
    expect_state(1, 2);
    for place in 0 to depth loop
      take_byte(std_ulogic_vector(to_unsigned(place, 8)));
    end loop;
    bus_expect(clock, m2s, s2m, 1, 0);
    far_sends(x"66");
    wait_clocks(clock, 12);
    take_byte(x"66", valid + gap);

    -- Another rate, which waits for what is to be sent.
    before := count;
    bus_write(clock, m2s, s2m, 0, 16#77#);
    bus_write(clock, m2s, s2m, 2, 7);
    bus_expect(clock, m2s, s2m, 2, 7);
    until_sent;
    check_equal(heard(before), x"77", "a byte before the new rate");
    wait_clocks(clock, 4);
    bit_time <= 1 sec / 230_400;
    wait for 0 ns;
    bus_write(clock, m2s, s2m, 0, 16#99#);
    until_sent;
    check_equal(heard(before + 1), x"99", "a byte at another rate");
    far_sends(x"AA");
    wait_clocks(clock, 12);
    take_byte(x"AA");
    -- One that is too fast for the clock is the rate of the generic, and so is a number that means nothing.
    bit_time <= 1 sec / baud_hz;
    for index in 9 to 15 loop
      bus_write(clock, m2s, s2m, 2, index);
      wait_clocks(clock, 20);
      if (index = 9) = (clock_hz < 8 * 921_600) or index > 9 then
        far_sends(std_ulogic_vector(to_unsigned(index, 8)));
        wait_clocks(clock, 12);
        take_byte(std_ulogic_vector(to_unsigned(index, 8)));
      end if;
    end loop;

    -- Errors change nothing.
    bus_refuse(clock, m2s, s2m, '1', 1, "a write of a received byte");
    bus_refuse(clock, m2s, s2m, '1', 3, "a write of the state");
    bus_refuse(clock, m2s, s2m, '0', 4, "a read behind the last word");
    bus_refuse(clock, m2s, s2m, '1', 4, "a write behind the last word");

    -- A reset cuts all short.
    bus_write(clock, m2s, s2m, 0, 16#0F#);
    far_sends(x"01");
    wait_clocks(clock, 12);
    reset <= '1';
    wait_clocks(clock, 3);
    check_equal(tx_enable, '0', "the driver is off in a reset");
    check_equal(tx, '1', "the line is high in a reset");
    reset <= '0';
    wait_clocks(clock, 3);
    bus_expect(clock, m2s, s2m, 0, depth);
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, 0);
    expect_state(0, 0);

    done <= true;
    report_passed("uart_bridge_tb");
    wait;
  end process;

  watchdog(done, 100 ms, "uart_bridge_tb");

end architecture;
