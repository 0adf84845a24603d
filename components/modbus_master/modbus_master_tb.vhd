-- SPDX-License-Identifier: BSD-3-Clause
--
-- modbus_master: known frames go out, with their pauses; good replies are values, and all others are failures with
-- their reason; a register is written only when the bus has written it, whole, and with each sample from then on.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.sequencer_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity modbus_master_tb is
  generic (
    clock_hz  : positive := 2_000_000;
    baud_hz   : positive := 115_200;
    parity    : natural  := 1;
    stop_bits : positive := 1;
    seed      : positive := 1
  );
end entity;

architecture test of modbus_master_tb is

  -- Each 5 ms: three registers of the unit 17 from 6B on, then the register 1 of the unit 1 gets an output.
  constant program : string :=
    "C0E8C403C000D800C088C413C800" & "20110003" & "0000006B" & "00000003" & "481148034806" & "0D000C010D000C010D001C01"
    & "E023" & "200100060000000185008000" & "480148064800" & "480108001800" & "D004";

  constant clock_period : time     := 1 sec / clock_hz;
  constant bit_time     : time     := 1 sec / baud_hz;
  constant pause        : time     := 1750 us;
  constant timeout_us   : positive := 5000;
  constant first_output : natural  := 8;

  type bytes_t is array (0 to 15) of byte_t;
  type kind_t is (good, silent, wrong_crc, refused, short, broken, other_unit, too_long, babble, late);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;
  signal rx    : std_ulogic := '1';
  signal puts  : boolean := false; -- a device sends a character

  signal tx, tx_enable, sampled, failed : std_ulogic;

  signal kind     : kind_t := good;  -- of the replies
  signal values   : bytes_t := (x"AE", x"41", x"56", x"52", x"43", x"40", others => x"00");
  signal questions, orders : natural := 0; -- frames that came
  signal ordered  : std_ulogic_vector(15 downto 0) := (others => '0');
  signal samples, failures : natural := 0; -- events

  function crc_of (bytes : bytes_t; count : natural) return std_ulogic_vector is
    variable crc : unsigned(15 downto 0) := (others => '1');
  begin
    for place in 0 to count - 1 loop
      crc := crc xor unsigned'(x"00" & unsigned(bytes(place)));
      for bit_number in 1 to 8 loop
        if crc(0) = '1' then
          crc := shift_right(crc, 1) xor x"A001";
        else
          crc := shift_right(crc, 1);
        end if;
      end loop;
    end loop;
    return std_ulogic_vector(crc);
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.modbus_master
    generic map (
      clock_hz => clock_hz, baud_hz => baud_hz, parity => parity, stop_bits => stop_bits, timeout_us => timeout_us,
      failures_most => 3, program => program, values => 3, outputs => 1)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      rx => rx, tx => tx, tx_enable => tx_enable);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if sampled = '1' then
        samples <= samples + 1;
      end if;
      if failed = '1' then
        failures <= failures + 1;
      end if;
    end if;
  end process;

  -- The devices: they take what is sent while the driver is on, and answer.
  devices : process is
    variable bytes, answer : bytes_t;
    variable count, sends  : natural;
    variable ended         : time := 0 ns; -- of the last frame or reply
    variable crc           : std_ulogic_vector(15 downto 0);

    procedure take (byte : out byte_t) is
    begin
      wait for bit_time / 2;
      check_equal(tx, '0', "a start bit");
      for place in 0 to 7 loop
        wait for bit_time;
        byte(place) := tx;
      end loop;
      if parity /= 0 then
        wait for bit_time;
        check_equal(tx, (xor byte) xor to_bit(parity = 2), "the parity");
      end if;
      for stop_bit in 1 to stop_bits loop
        wait for bit_time;
        check_equal(tx, '1', "a stop bit");
        check_equal(tx_enable, '1', "the driver is on");
      end loop;
    end procedure;

    procedure put (byte : byte_t; wrong_parity : boolean := false) is
    begin
      rx   <= '0';
      puts <= true;
      wait for bit_time;
      for place in 0 to 7 loop
        rx <= byte(place);
        wait for bit_time;
      end loop;
      if parity /= 0 then
        rx <= (xor byte) xor to_bit(parity = 2) xor to_bit(wrong_parity);
        wait for bit_time;
      elsif wrong_parity then
        rx <= '0'; -- no stop bit
        wait for bit_time;
      end if;
      rx   <= '1';
      puts <= false;
      wait for bit_time * stop_bits;
    end procedure;

  begin
    wait until tx_enable = '1';
    check(now - ended >= pause, "a frame begins behind a pause");
    count := 0;
    while tx_enable = '1' loop
      wait on tx, tx_enable;
      if tx = '0' then
        take(bytes(count));
        count := count + 1;
      end if;
    end loop;
    ended := now;
    crc   := crc_of(bytes, count - 2);
    check_equal(count, 8, "the bytes of a request");
    check(bytes(6) = crc(7 downto 0) and bytes(7) = crc(15 downto 8), "the CRC of a request");
    if bytes(0) = x"11" then
      check(bytes(0 to 7) = (x"11", x"03", x"00", x"6B", x"00", x"03", x"76", x"87"), "the known question");
      questions <= questions + 1;
      answer := (
        x"11", x"03", x"06", values(0), values(1), values(2), values(3), values(4), values(5), others => x"00");
      sends  := 9;
      if kind = refused then
        answer(0 to 2) := (x"11", x"83", x"02");
        sends          := 3;
      elsif kind = other_unit then
        answer(0) := x"12";
      end if;
    else
      check(bytes(0 to 3) = (x"01", x"06", x"00", x"01"), "an order");
      orders  <= orders + 1;
      ordered <= bytes(4) & bytes(5);
      answer  := bytes;
      sends   := 6;
    end if;
    crc := crc_of(answer, sends);
    answer(sends)     := crc(7 downto 0);
    answer(sends + 1) := crc(15 downto 8);
    sends             := sends + 2;
    wait for 300 us;
    if bytes(0) = x"01" then
      for place in 0 to sends - 1 loop
        put(answer(place));
      end loop;
    elsif kind = late then
      -- Characters that are a pause apart: the next one has begun when the time since the last one is over.
      while kind = late loop
        put(x"FF");
        ended := now;
        wait for pause;
      end loop;
    elsif kind /= silent then
      if kind = wrong_crc then
        answer(4) := not answer(4);
      elsif kind = short then
        sends := sends - 1;
      elsif kind = too_long then
        sends := sends + 1;
      end if;
      for place in 0 to sends - 1 loop
        put(answer(place), wrong_parity => kind = broken and place = 5);
      end loop;
      if kind = babble then
        while kind = babble loop
          put(x"00");
        end loop;
      end if;
      ended := now;
    end if;
  end process;

  driver : process (tx_enable) is
  begin
    check(not rising_edge(tx_enable) or not puts, "no frame begins while a character comes in");
  end process;

  master : process is

    variable expected : bytes_t := (others => x"00");
    variable answer   : bus_answer_t;

    procedure await_end is
      constant before : natural := samples + failures;
    begin
      wait until samples + failures /= before for 60 ms;
      check(samples + failures /= before, "a try ends");
      wait_clocks(clock, 3);
    end procedure;

    procedure expect_values (what : string) is
    begin
      for number in 0 to 2 loop
        bus_read(clock, m2s, s2m, 5 + number, answer);
        check_equal(
          answer.word(15 downto 0), std_ulogic_vector'(expected(2 * number) & expected(2 * number + 1)), what);
      end loop;
    end procedure;

    procedure expect_status (valid : std_ulogic; reason, code : natural; what : string) is
    begin
      bus_read(clock, m2s, s2m, 1, answer);
      check_equal(answer.word(0), valid, what & ": valid");
      check_equal(to_integer(unsigned(answer.word(5 downto 4))), reason, what & ": the reason");
      check_equal(to_integer(unsigned(answer.word(13 downto 6))), code, what & ": the code");
    end procedure;

    variable before, before_orders : natural;

  begin
    wait_clocks(clock, 5);
    reset <= '0';
    await_end;
    check_equal(samples, 1, "a sample");
    expected := values;
    expect_values("the known reply");
    expect_status('1', 0, 0, "good");

    for round in 1 to 3 loop
      values   <= (std_ulogic_vector(to_unsigned(round, 8)), x"FF", x"80", x"00", x"01", x"FE", others => x"00");
      wait_clocks(clock, 2);
      expected := values;
      await_end;
      expect_values("a new reply");
    end loop;
    check_equal(orders, 0, "nothing is written before the bus has written it");

    -- Failures: the old values stay, and what they are is said.
    for one in silent to other_unit loop
      kind <= one;
      wait_clocks(clock, 1);
      before := failures;
      await_end;
      check_equal(failures, before + 1, "a failure");
      case one is
        when silent  => expect_status('1', 1, 0, "silence");
        when refused => expect_status('1', 3, 2, "a refusal");
        when others  => expect_status('1', 2, 2 * boolean'pos(one > refused), "a wrong reply");
      end case;
      expect_values("they stay");
      kind <= good;
      await_end;
      check_equal(failures, before + 1, "it is good again");
    end loop;
    bus_expect(clock, m2s, s2m, 2, failures);

    -- What comes behind a reply does no harm.
    kind <= too_long;
    before := failures;
    await_end;
    kind <= good;
    await_end;
    await_end;
    check_equal(failures, before, "a byte too many");

    -- Three failures in a row.
    kind <= silent;
    for round in 1 to 3 loop
      await_end;
    end loop;
    expect_status('0', 1, 2, "an absent device");
    kind <= good;
    await_end;
    expect_status('1', 1, 2, "it is back");

    -- A line that is never silent.
    kind <= babble;
    await_end;
    before := failures;
    await_end;
    check_equal(failures, before + 1, "nobody is asked over a babbling line");
    kind <= good;
    await_end;

    -- A device that answers too late.
    kind <= late;
    await_end;
    await_end;
    kind <= good;
    await_end;
    await_end;
    expect_status('1', 1, 2, "behind a late reply");

    -- The known order, again and again.
    bus_write(clock, m2s, s2m, first_output, 3);
    bus_expect(clock, m2s, s2m, first_output, 3);
    await_end;
    await_end;
    check_equal(ordered, std_ulogic_vector'(x"0003"), "the known order");
    before_orders := orders;
    await_end;
    check_equal(orders, before_orders + 1, "it goes out with each sample");

    -- A word that is written while it goes out is not torn.
    for round in 0 to 60 loop
      wait for 97 us;
      bus_write(clock, m2s, s2m, first_output, 16#0101# * (1 + round mod 2));
      check(ordered(15 downto 8) = ordered(7 downto 0) or ordered = x"0003", "all bytes are of one write");
    end loop;

    -- An order does not stop the reading when it is refused to the bus.
    bus_refuse(clock, m2s, s2m, '1', 5, "a write of a value");
    bus_refuse(clock, m2s, s2m, '1', first_output + 1, "a write behind the outputs");
    bus_refuse(clock, m2s, s2m, '0', first_output + 1, "a read behind the outputs");

    -- enable.
    bus_write(clock, m2s, s2m, 0, 0);
    wait for 60 ms;
    before := questions;
    expect_status('0', 1, 2, "off");
    wait for 60 ms;
    check_equal(questions, before, "nobody is asked");

    -- After a reset nothing is written.
    reset <= '1';
    wait_clocks(clock, 4);
    check_equal(tx_enable, '0', "the driver is off");
    reset <= '0';
    await_end;
    await_end;
    before_orders := orders;
    await_end;
    check_equal(orders, before_orders, "no old order goes out");
    bus_expect(clock, m2s, s2m, first_output, 0);

    report_passed("modbus_master_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 4 sec, "modbus_master_tb");

end architecture;
