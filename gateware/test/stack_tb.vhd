-- SPDX-License-Identifier: BSD-3-Clause
--
-- A whole design, from the PC's wire to the pins: uart, core, interconnect, and a slave of every kind.
--
--   PC uart == wire ==> uart -> core -> wishbone_master -> interconnect -> gpio x00, fifo_slave x08,
--   double_buffer_slave x10,
--                                                          encoders x20 x24, pwm x30, registers x40

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.address_map_pkg.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;
  use work.register_pkg.all;
  use work.settings_pkg.all;
  use work.stream_bench_pkg.digits;
  use work.wishbone_pkg.all;

entity stack_tb is
  generic (
    seed : positive := 1
  );
end entity;

architecture test of stack_tb is

  constant clock_hz : positive := 24_000_000;
  constant baud_hz  : positive := 3_000_000;
  constant bit_time : time     := 1 sec / baud_hz;
  constant words    : positive := 20; -- published by event

  constant address_map : address_map_t := (
    (base => x"00000000", words => 6),
    (base => x"00000008", words => 3),
    (base => x"00000010", words => 9),
    (base => x"00000020", words => 4),
    (base => x"00000024", words => 4),
    (base => x"00000030", words => 4),
    (base => x"00000040", words => 2));

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean    := false;

  -- The PC.
  signal pc_line, wire, device_line : std_ulogic;
  signal cut                        : std_ulogic := '1';
  signal pc_tx_valid, pc_tx_ready   : std_ulogic := '0';
  signal pc_tx_data, pc_rx_data     : std_ulogic_vector(7 downto 0);
  signal pc_rx_valid, pc_rx_ready   : std_ulogic := '0';

  -- The device.
  signal rx_valid, rx_ready, tx_valid, tx_ready : std_ulogic;
  signal rx_data, tx_data                       : std_ulogic_vector(7 downto 0);
  signal rx_error                               : receive_error_t;
  signal events                                 : std_ulogic_vector(1 downto 0);
  signal m2s                                    : wishbone_m2s_t;
  signal s2m                                    : wishbone_s2m_t;
  signal to_slaves                              : wishbone_m2s_vector_t(0 to address_map'length - 1);
  signal from_slaves                            : wishbone_s2m_vector_t(0 to address_map'length - 1);
  signal pins, drive                            : std_ulogic_vector(7 downto 0);
  signal put_valid, put_ready, get_valid        : std_ulogic := '0';
  signal put_data, get_data                     : std_ulogic_vector(31 downto 0) := (others => '0');
  signal a, b                                   : std_ulogic := '0';
  signal pwm_pins                               : std_ulogic_vector(1 downto 0);
  signal read_words, write_words                : word_vector_t(0 to 1);

  signal puts_on : boolean := false;

  impure function word_of (n : natural) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned(n, 16)) & std_ulogic_vector(to_unsigned((n * 40503 + seed) mod 65536, 16));
  end function;

begin

  clock <= not clock after 0.5 sec / clock_hz when not done;
  wire  <= pc_line and cut;

  pc : entity work.uart
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, rx_depth => 4096, tx_depth => 256)
    port map (
      clock => clock, reset => reset, rx_line => device_line, tx_line => pc_line, line_break => open,
      rx_valid => pc_rx_valid, rx_ready => pc_rx_ready, rx_data => pc_rx_data, rx_error => open,
      tx_valid => pc_tx_valid, tx_ready => pc_tx_ready, tx_data => pc_tx_data);

  physical : entity work.uart
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, rx_line => wire, tx_line => device_line, line_break => open,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data);

  core : entity work.core
    generic map (
      settings => core_settings(
        protocol => protocol_classic, clock_hz => clock_hz, groups => 2, group_size => 16, read_many => 32,
        edge_events => (1 => '1', others => '0')))
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data,
      events => events, wishbone_m2s => m2s, wishbone_s2m => s2m);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  interconnect : entity work.wishbone_interconnect
    generic map (address_map => address_map)
    port map (master_m2s => m2s, master_s2m => s2m, slaves_m2s => to_slaves, slaves_s2m => from_slaves);

  gpio : entity work.gpio
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(0), wishbone_s2m => from_slaves(0), changed => open,
      pin_in => pins, pin_out => pins, pin_drive => drive);

  fifo : entity work.fifo_slave
    generic map (depth => 4, remind_clocks => 20000)
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(1), wishbone_s2m => from_slaves(1),
      arrival => events(1), not_empty => open,
      to_pc_valid => put_valid, to_pc_ready => put_ready, to_pc_data => put_data,
      from_pc_valid => get_valid, from_pc_ready => '0', from_pc_data => get_data);

  double_buffer : entity work.double_buffer_slave
    generic map (words => 8)
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(2), wishbone_s2m => from_slaves(2), committed => open,
      user_read_address => 0, user_read_data => open,
      user_write_valid => '0', user_write_ready => open, user_write_address => 0, user_write_data => x"00000000");

  encoder_1 : entity work.quadrature_encoder
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(3), wishbone_s2m => from_slaves(3), a => a, b => b);

  -- The same signals swapped: at any moment the sum of both positions is zero.
  encoder_2 : entity work.quadrature_encoder
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(4), wishbone_s2m => from_slaves(4), a => b, b => a);

  pwm : entity work.pwm
    generic map (clock_hz => clock_hz, channels => 2)
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(5), wishbone_s2m => from_slaves(5), pins => pwm_pins);

  registers : entity work.register_slave
    generic map (writable => "10")
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(6), wishbone_s2m => from_slaves(6),
      read_words => read_words, write_words => write_words, written => open);

  read_words <= (0 => write_words(0), 1 => not write_words(0));
  events(0)  <= '0';

  -- Turns without end, with a step every 5 to 60 clocks.
  turning : process is
    variable random  : random_t;
    variable quarter : unsigned(1 downto 0) := "00";
  begin
    random.seed(seed + 1);
    wait until reset = '0';
    while not done loop
      for index in 1 to random.integer_between(5, 60) loop
        wait until rising_edge(clock) or done;
      end loop;
      quarter := quarter + 1;
      a       <= quarter(1) xor quarter(0);
      b       <= quarter(1);
    end loop;
    wait;
  end process;

  -- Irregular data: bursts and pauses.
  putting : process is
    variable random : random_t;
  begin
    random.seed(seed + 2);
    wait until puts_on;
    for index in 0 to words - 1 loop
      if random.chance(40) then
        wait_clocks(clock, random.integer_between(1, 6000));
      end if;
      send(clock, put_valid, put_ready, put_data, word_of(index));
    end loop;
    wait;
  end process;

  user : process is

    variable received : string(1 to 400);
    variable length   : natural;

    procedure send (text : string) is
    begin
      for index in text'range loop
        send(clock, pc_tx_valid, pc_tx_ready, pc_tx_data, byte_of(text(index)));
      end loop;
    end procedure;

    procedure receive is
    begin
      length      := 0;
      pc_rx_ready <= '1';
      loop
        wait until rising_edge(clock) and pc_rx_valid = '1' and pc_rx_ready = '1';
        exit when pc_rx_data = x"0A";
        length           := length + 1;
        received(length) := character_of(pc_rx_data);
      end loop;
      pc_rx_ready <= '0';
    end procedure;

    procedure expect (text : string) is
    begin
      receive;
      check(received(1 to length) = text, "received " & received(1 to length) & ", expected " & text);
    end procedure;

    procedure ask (request : string; reply : string) is
    begin
      send(request & LF);
      expect(reply);
    end procedure;

    -- The word at the end of a reply, or `back` words before it.
    impure function word_received (back : natural) return integer is
      variable result : signed(31 downto 0) := (others => '0');
    begin
      for index in length - 8 * back - 7 to length - 8 * back loop
        result := result(27 downto 0) & to_signed(digit_value(received(index)), 5)(3 downto 0);
      end loop;
      return to_integer(result);
    end function;

  begin
    wait for bit_time * 2;
    reset <= '0';
    wait for bit_time * 2;

    ask("#RLC", "#CNF:01,04,20,02,03e8,02,10,02");
    ask("#W:02000000FF", "#S_W");
    ask("#W:01000000A5", "#S_W");
    ask("$W:01000000FF*00", "?f4"); -- a wrong checksum changes nothing
    ask("#R:00", "#S_R:000000a5");
    ask("#W:0300000042", "#S_W");
    ask("#R:00", "#S_R:000000e7");
    check_equal(pins, std_ulogic_vector'(x"E7"), "pins");
    check_equal(drive, std_ulogic_vector'(x"FF"), "drive");
    ask("#W:0000000000", "#?E_FBW");
    ask("#R:07", "#?E_FBR"); -- no slave at this address
    ask("#W:4012345678", "#S_W");
    ask("#RM:024041", "#S_RM:12345678edcba987");

    -- Nothing is visible before its commit.
    ask("#W:1011111111", "#S_W");
    ask("#R:10", "#S_R:00000000");
    ask("#W:1800000000", "#S_W");
    ask("#RM:021018", "#S_RM:1111111100000001");

    ask("#W:3200001000", "#S_W");
    ask("#W:3300000000", "#S_W");
    ask("#W:3000000001", "#S_W");
    wait for 2 us;
    check_equal(pwm_pins, std_ulogic_vector'("01"), "pwm pins: always, and never");

    ask("#W:08CAFE0001", "#S_W");
    check_equal(get_valid & get_data, std_ulogic_vector'('1' & x"CAFE0001"), "the word the FPGA got");
    ask("#R:08", "#?E_FBR");

    -- Two moving encoders are read one after the other, and give one moment. They started together and turn in opposite
    -- directions.
    for index in 1 to 10 loop
      send("#RM:022024" & LF);
      receive;
      check(received(1 to 6) = "#S_RM:" and length = 22, "reply of the encoders: " & received(1 to length));
      check(word_received(1) > 0, "the first encoder turns forward");
      check_equal(word_received(0), -word_received(1), "the second encoder in the moment of the first");
    end loop;

    -- Noise in a message costs only that message.
    send("#R:40" & LF & "#R:4");
    wait for bit_time * 10 * 14;
    cut <= '0';
    wait for bit_time * 20;
    cut <= '1';
    wait for bit_time * 4;
    send("1" & LF & "#R:41" & LF);
    expect("#S_R:12345678");
    expect("?f7");
    expect("#S_R:edcba987");

    -- Every word of irregular data is published once and in order, although the queue fills faster than the wire. Words
    -- that came before the subscription are published too.
    puts_on <= true;
    wait until put_ready = '0';
    ask("#WSA:010108", "#S_WSA");
    ask("#WIC:0002", "#S_WIC");
    ask("#EPS", "#S_EPS");
    for index in 0 to words - 1 loop
      expect("%PUB:0101" & digits(word_of(index)));
    end loop;
    ask("#DPS", "#S_DPS");
    ask("#R:09", "#S_R:00000000");

    report_passed("stack_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, bit_time * 60000, "stack_tb");

end architecture;
