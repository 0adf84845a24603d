-- SPDX-License-Identifier: BSD-3-Clause
--
-- servo_bus with two servos: known frames, torques and goals that they get, what they measure with stuffed bytes and
-- signs, hold, servos that are silent, wrong, slow or never stop, blocks of accesses, errors, stop and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.servo_bus_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity servo_bus_tb is
  generic (
    clock_hz : positive := 16_000_000;
    protocol : natural  := 0;
    baud_hz  : positive := 2_000_000;
    seed     : positive := 1
  );
end entity;

architecture test of servo_bus_tb is

  constant servos       : positive := 2;
  constant cycle_hz     : positive := 1000;
  constant clock_period : time     := 1 sec / clock_hz;
  constant bit_time     : time     := 1 sec / baud_hz;
  constant cycle_clocks : positive := clock_hz / cycle_hz;
  constant control      : natural  := 8 * servos;
  constant is_feetech   : boolean  := protocol = 1;

  type numbers_t is array (0 to servos - 1) of integer;
  type times_t is array (0 to servos - 1) of time;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal cycled, failed : std_ulogic;
  signal cycles, losses : natural := 0;
  signal rx, tx, tx_enable : std_ulogic;
  signal wire : std_logic;

  signal positions, speeds, loads, alarms, faults, goals, packets : numbers_t := (others => 0);
  signal crowded : boolean := false;
  signal delays  : times_t := (others => 30 us);
  signal torques : std_ulogic_vector(servos - 1 downto 0);

  -- What the master sent since tx_enable rose.
  signal sent  : bytes_t(0 to 63) := (others => x"00");
  signal count : natural := 0;

  -- A check of its own, for known frames.
  signal begins, takes, busy : std_ulogic := '0';
  signal data  : byte_t := x"00";
  signal check_word : std_ulogic_vector(15 downto 0);

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.servo_bus
    generic map (
      clock_hz => clock_hz, protocol => protocol, servos => servos, first_id => 1, baud_hz => baud_hz,
      cycle_hz => cycle_hz, timeout_us => 200, gap_us => 20, failures_most => 3)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, cycled => cycled, failed => failed,
      rx => rx, tx => tx, tx_enable => tx_enable);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  checks : entity work.servo_bus_check
    generic map (feetech => is_feetech)
    port map (clock => clock, begins => begins, takes => takes, data => data, busy => busy, check => check_word);

  wire <= tx when tx_enable = '1' else 'Z';
  wire <= 'H';
  rx   <= to_x01(wire);

  models : for number in 0 to servos - 1 generate
    servo : entity work.servo_bus_servo_model
      generic map (protocol => protocol, id => 1 + number, bit_time => bit_time)
      port map (
        wire => wire, delay => delays(number), position => positions(number), speed => speeds(number),
        load => loads(number), alarm => alarms(number), fault => faults(number),
        crowded => crowded, torque => torques(number),
        goal => goals(number), packets => packets(number));
  end generate;

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if cycled = '1' then
        cycles <= cycles + 1;
      end if;
      if failed = '1' then
        losses <= losses + 1;
      end if;
    end if;
  end process;

  record_bytes : process is
    variable bits : byte_t;
  begin
    wait until tx = '0' or rising_edge(tx_enable);
    if tx = '0' then
      check_equal(tx_enable, '1', "the driver is on while bytes are sent");
      wait for bit_time / 2;
      for place in 0 to 7 loop
        wait for bit_time;
        bits(place) := tx;
      end loop;
      wait for bit_time;
      sent(count) <= bits;
      count       <= count + 1;
    else
      count <= 0;
    end if;
  end process;

  master : process is

    variable random : random_t;
    variable before : natural;
    variable answer, again : bus_answer_t;

    procedure next_cycle (number : positive := 1) is
      constant target : natural := cycles + number;
    begin
      while cycles < target loop
        wait until rising_edge(clock);
      end loop;
    end procedure;

    function low_half (value : integer) return std_ulogic_vector is
    begin
      return x"0000" & std_ulogic_vector(to_signed(value, 32)(15 downto 0));
    end function;

    impure function expected_status (number : natural; valid : natural; reason : natural) return natural is
    begin
      return alarms(number) * 8 + reason * 2 + valid;
    end function;

    procedure expect_servo (number : natural) is
    begin
      bus_expect(clock, m2s, s2m, 8 * number + position_field, low_half(positions(number)));
      bus_expect(clock, m2s, s2m, 8 * number + speed_field, low_half(speeds(number)));
      bus_expect(clock, m2s, s2m, 8 * number + load_field, low_half(loads(number)));
      bus_expect(clock, m2s, s2m, 8 * number + status_field, expected_status(number, 1, 0));
    end procedure;

    procedure set_goal (number : natural; goal : integer; keep : boolean := false) is
    begin
      bus_write(clock, m2s, s2m, 8 * number + goal_field, low_half(goal), keep);
    end procedure;

    procedure expect_check (frame : bytes_t; expected : std_ulogic_vector) is
    begin
      begins <= '1';
      wait_clocks(clock, 1);
      begins <= '0';
      for place in frame'range loop
        takes <= '1';
        data  <= frame(place);
        wait_clocks(clock, 1);
        takes <= '0';
        wait_clocks(clock, 9);
      end loop;
      check_equal(check_word(expected'length - 1 downto 0), expected, "the check of a known frame");
    end procedure;

    procedure expect_sent (frame : bytes_t; what : string) is
    begin
      check_equal(count, frame'length, what & ": bytes");
      for place in frame'range loop
        check_equal(sent(place - frame'low), frame(place), what & ": byte " & integer'image(place));
      end loop;
    end procedure;

    procedure expect_lost (number : natural; fault : positive) is
      constant reason   : positive := 1 + boolean'pos(fault > 1);
      variable position : integer;
    begin
      next_cycle;
      faults(number) <= fault;
      position := positions(number);
      bus_read(clock, m2s, s2m, 8 * number + failures_field, answer);
      before := to_integer(unsigned(answer.word));
      for round in 1 to 3 loop
        bus_expect(clock, m2s, s2m, 8 * number + status_field,
                   expected_status(number, 1, reason * boolean'pos(round > 1)));
        positions(number)     <= positions(number) + 1;
        positions(1 - number) <= positions(1 - number) - 1;
        next_cycle;
        bus_expect(clock, m2s, s2m, 8 * number + position_field, low_half(position));
        expect_servo(1 - number);
      end loop;
      bus_expect(clock, m2s, s2m, 8 * number + status_field, expected_status(number, 0, reason));
      bus_expect(clock, m2s, s2m, 8 * number + age_field, x"000FFFFF");
      bus_expect(clock, m2s, s2m, 8 * number + failures_field, (before + 3) mod 256);
      faults(number) <= 0;
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    -- Known frames of the reference.
    if is_feetech then
      expect_check((x"01", x"02", x"01"), x"FB");
      expect_check((x"01", x"04", x"02", x"38", x"02"), x"BE");
      expect_check((x"01", x"04", x"00", x"00", x"08"), x"F2");
      expect_check((x"01", x"09", x"03", x"2A", x"00", x"08", x"00", x"00", x"E8", x"03"), x"D5");
      expect_check((x"FE", x"06", x"82", x"38", x"04", x"01", x"02"), x"3A");
    else
      expect_check((x"00", x"01", x"03", x"00", x"01"), x"4E19");
      expect_check((x"00", x"01", x"07", x"00", x"55", x"00", x"06", x"04", x"26"), x"5D65");
      expect_check((x"00", x"01", x"07", x"00", x"02", x"84", x"00", x"04", x"00"), x"151D");
      expect_check((x"00", x"01", x"08", x"00", x"55", x"00", x"A6", x"00", x"00", x"00"), x"C08C");
      expect_check((x"00", x"01", x"09", x"00", x"03", x"74", x"00", x"00", x"02", x"00", x"00"), x"89CA");
      expect_check((x"00", x"01", x"0A", x"00", x"03", x"74", x"00", x"FF", x"FF", x"FD", x"FD", x"00"), x"E721");
    end if;

    bus_expect(clock, m2s, s2m, control, 1);
    bus_expect(clock, m2s, s2m, status_field, 0);
    bus_expect(clock, m2s, s2m, age_field, x"000FFFFF");

    -- Without a word from the PC: torques off, and positions come.
    positions <= (2048, 1000);
    speeds    <= (5, -7);
    loads     <= (100, -100);
    alarms    <= (0, 16#20#);
    next_cycle;
    expect_servo(0);
    expect_servo(1);
    check_equal(torques, "00", "torques of the reset");
    check_equal(packets(0), 2, "a packet with torques and a question, no goals");

    -- Goals: the frame of the reference.
    set_goal(0, 150, keep => true);
    bus_write(clock, m2s, s2m, drive_field, x"00000002", keep => true);
    set_goal(1, 170, keep => true);
    bus_write(clock, m2s, s2m, 8 + drive_field, x"00000002");
    bus_expect(clock, m2s, s2m, drive_field, 2);
    bus_expect(clock, m2s, s2m, goal_field, 150);
    for packet in 1 to 2 loop
      wait until falling_edge(tx_enable);
      if packet = 1 and is_feetech then
        expect_sent((x"FF", x"FF", x"FE", x"08", x"83", x"28", x"01", x"01", x"01", x"02", x"01", x"48"), "torques");
      elsif packet = 2 and is_feetech then
        expect_sent((x"FF", x"FF", x"FE", x"0A", x"83", x"2A", x"02", x"01", x"96", x"00", x"02", x"AA", x"00", x"05"),
                    "goals");
      elsif packet = 2 then
        expect_sent((x"FF", x"FF", x"FD", x"00", x"FE", x"11", x"00", x"83", x"74", x"00", x"04", x"00",
                     x"01", x"96", x"00", x"00", x"00", x"02", x"AA", x"00", x"00", x"00", x"82", x"87"), "goals");
      end if;
    end loop;
    next_cycle;
    check_equal(torques, "11", "torques");
    check_equal(goals(0), 150, "the goal of servo 0");
    check_equal(goals(1), 170, "the goal of servo 1");

    -- Numbers with signs, and data that look like a header.
    for round in 1 to 6 loop
      for number in 0 to servos - 1 loop
        positions(number) <= random.integer_between(-30_000, 30_000);
        speeds(number)    <= random.integer_between(-3000, 3000);
        loads(number)     <= random.integer_between(-1000, 1000);
        alarms(number)    <= random.integer_between(0, 255);
        delays(number)    <= random.integer_between(1, 60) * 1 us;
      end loop;
      if round < 4 then
        loads     <= (-1, -1);
        speeds    <= (-3, -3);
        positions <= (-1, -3);
      end if;
      if round < 3 and not is_feetech then
        positions(0) <= 16#00FD_FFFF#; -- its low half is read
        speeds(1)    <= 16#00FD_FFFF#;
      end if;
      set_goal(0, random.integer_between(-32_767, 32_767), keep => true);
      set_goal(1, -513);
      next_cycle(2);
      expect_servo(0);
      expect_servo(1);
      bus_expect(clock, m2s, s2m, 8 + goal_field, x"0000FDFF");
      check_equal(goals(1), -513, "a goal behind zero");
      bus_read(clock, m2s, s2m, goal_field, answer);
      check_equal(goals(0), to_integer(signed(answer.word(15 downto 0))), "a goal");
    end loop;
    if is_feetech then
      set_goal(0, -32_768);
      next_cycle(2);
      check_equal(goals(0), -32_767, "the most negative goal");
    end if;
    check_equal(losses, 0, "no reply was lost");
    bus_read(clock, m2s, s2m, control + 1, answer);
    check(unsigned(answer.word) > 350 and unsigned(answer.word) < 1000, "the length of a cycle");
    bus_read(clock, m2s, s2m, age_field, answer);
    wait for 100 us;
    bus_read(clock, m2s, s2m, age_field, again);
    check_equal(to_integer(unsigned(again.word) - unsigned(answer.word)), 100, "age grows with time");

    -- Hold: the position of the moment, whatever the servo does then. Off: no goal goes there.
    positions <= (-500, 700);
    delays    <= (others => 20 us);
    alarms    <= (0, 0);
    next_cycle(2);
    bus_write(clock, m2s, s2m, drive_field, 1);
    bus_write(clock, m2s, s2m, 8 + drive_field, 0);
    next_cycle(2);
    check_equal(torques, "01", "one holds, one is off");
    positions <= (-400, 800);
    next_cycle(2);
    check_equal(goals(0), -500, "hold");
    check_equal(goals(1), -513, "no goal for a servo that is off");
    bus_write(clock, m2s, s2m, 8 + drive_field, 1);
    next_cycle(2);
    check_equal(torques, "11", "both hold");
    check_equal(goals(1), 800, "hold of the second servo");

    -- A servo that fails in any way loses only its own values.
    for fault in 1 to 6 loop
      if fault = 4 then -- noise before a reply is no fault
        faults(0) <= fault;
        before := losses;
        next_cycle(3);
        check_equal(losses, before, "noise before a reply");
        faults(0) <= 0;
      else
        expect_lost(0, fault);
      end if;
      check_equal(torques, "11", "both hold all the time");
      next_cycle(2);
      expect_servo(0);
    end loop;
    expect_lost(1, 1);
    next_cycle(2);

    -- One that never stops takes the line from all. They come back behind it.
    faults(0) <= 7;
    crowded   <= true;
    next_cycle(4);
    bus_expect(clock, m2s, s2m, status_field, 4);
    bus_expect(clock, m2s, s2m, 8 + status_field, 4);
    faults(0) <= 0;
    next_cycle(3);
    crowded <= false;
    expect_servo(0);
    expect_servo(1);

    -- All servos are gone, one comes back.
    faults <= (1, 1);
    next_cycle(4);
    bus_expect(clock, m2s, s2m, status_field, 2);
    bus_expect(clock, m2s, s2m, 8 + status_field, 2);
    faults <= (0, 1);
    next_cycle(2);
    expect_servo(0);
    faults <= (0, 0);
    next_cycle(2);

    -- While a block is open nothing changes, and nothing is lost.
    before := losses;
    positions(1) <= 55;
    bus_read(clock, m2s, s2m, 8 + position_field, answer, keep => true);
    wait_clocks(clock, 2 * cycle_clocks);
    bus_read(clock, m2s, s2m, 8 + position_field, again);
    check_equal(again.word, answer.word, "the position within a block");
    next_cycle(2);
    bus_expect(clock, m2s, s2m, 8 + position_field, 55);
    check_equal(losses, before, "nothing was lost by a block");

    bus_refuse(clock, m2s, s2m, '1', position_field, "a write of a position");
    bus_refuse(clock, m2s, s2m, '1', 8 + status_field, "a write of a status");
    bus_refuse(clock, m2s, s2m, '1', control + 1, "a write of the time of a cycle");
    bus_refuse(clock, m2s, s2m, '0', control + 2, "a read behind the last word");
    bus_refuse(clock, m2s, s2m, '1', goal_field, "a part of a goal", sel => "0011");
    bus_refuse(clock, m2s, s2m, '0', 128 + goal_field, "a read far behind");

    -- Stop, and go on: no torque is lost by it.
    bus_write(clock, m2s, s2m, control, 0);
    wait_clocks(clock, cycle_clocks);
    before := packets(0);
    wait_clocks(clock, 3 * cycle_clocks);
    check_equal(packets(0), before, "nothing is sent");
    bus_expect(clock, m2s, s2m, status_field, 0);
    bus_write(clock, m2s, s2m, control, 1);
    wait until packets(0) /= before;
    check_equal(torques, "11", "torques while it starts");
    next_cycle(2);
    check_equal(torques, "11", "torques when it goes on");
    expect_servo(0);

    -- A reset takes the torques off.
    reset <= '1';
    wait_clocks(clock, 6);
    check_equal(tx_enable, '0', "the driver of the line in reset");
    reset <= '0';
    next_cycle(2);
    check_equal(torques, "00", "torques behind a reset");

    report_passed("servo_bus_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * cycle_clocks * 300, "servo_bus_tb");

end architecture;
