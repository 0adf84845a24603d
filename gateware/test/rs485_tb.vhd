-- SPDX-License-Identifier: BSD-3-Clause
--
-- Three nodes and a master on one pair. Only the addressed node answers. No node drives unless it is polled, and two
-- never drive at once. A turn ends in time. A token with a flipped bit is ignored. The pair is pulled high, and a node
-- that drives also receives its own signal.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity rs485_tb is
  generic (
    clock_hz : positive := 50_000_000;
    baud_hz  : positive := 3_000_000;
    rounds   : positive := 30;
    seed     : positive := 1
  );
end entity;

architecture test of rs485_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant bit_time     : time     := 1 sec / baud_hz;
  constant nodes        : positive := 3;
  constant turn_bytes   : positive := 256;  -- as in the entity: a netlist has no other

  subtype byte_t is std_ulogic_vector(7 downto 0);
  type numbers_t is array (1 to nodes) of natural;
  constant number : numbers_t := (3, 2, 63); -- 3 and 2 differ in one bit

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean    := false;

  signal pair           : std_logic;
  signal master_line    : std_ulogic := '1';
  signal master_drive   : std_ulogic := '0';
  signal drive, tx_line : std_ulogic_vector(1 to nodes);
  signal driven         : natural := 0; -- the node that may drive, as an index

  signal stuck  : boolean := false; -- the nodes stop within a message
  signal chatty : boolean := false; -- the nodes always have more to send
  signal heard  : numbers_t := (others => 0); -- bytes received by each node
  signal told   : numbers_t := (others => 0); -- errors reported by each node

begin

  clock <= not clock after clock_period / 2 when not done;

  pair <= 'H';
  pair <= master_line when master_drive = '1' else 'Z';

  each : for index in 1 to nodes generate

    signal rx_valid, rx_ready, tx_valid, tx_ready, tx_last : std_ulogic := '0';
    signal rx_data, tx_data : byte_t := x"00";
    signal rx_error         : receive_error_t;
    signal rx_line          : std_ulogic;

  begin

    rx_line <= to_x01(pair);
    pair    <= tx_line(index) when drive(index) = '1' else 'Z';

    dut : entity work.rs485
      generic map (clock_hz => clock_hz, baud_hz => baud_hz)
      port map (
        clock => clock, reset => reset,
        node => std_ulogic_vector(to_unsigned(number(index), 6)),
        rx_line => rx_line, tx_line => tx_line(index), drive => drive(index),
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last);

    -- Answers each message with its bytes, after C0 and its own number.
    core : process is
      variable moments : random_t;

      procedure say (byte : byte_t; last : std_ulogic := '0') is
      begin
        pause(clock, moments, 20);
        tx_last  <= last;
        send(clock, tx_valid, tx_ready, tx_data, byte);
      end procedure;

      variable within : boolean := false;
    begin
      moments.seed(seed + index);
      loop
        rx_ready <= '1';
        wait until rising_edge(clock) and (rx_valid = '1' or chatty or stuck);
        if stuck then
          say(x"C1");
          wait until not stuck;
        elsif chatty then
          for place in 1 to 7 loop
            say(std_ulogic_vector(to_unsigned(16#C0# + place, 8)));
          end loop;
          say(x"00", '1');
        else
          rx_ready     <= '0';
          heard(index) <= heard(index) + 1;
          if rx_data /= x"00" then
            if not within then
              check_equal(rx_data(7 downto 6), "10", "first byte of a message");
              say(x"C0");
              say(std_ulogic_vector(to_unsigned(number(index), 8)));
              within := true;
            end if;
            say(rx_data);
          elsif within then
            say(x"00", '1');
            within := false;
          end if;
        end if;
      end loop;
    end process;

    count_errors : process (clock) is
    begin
      if rising_edge(clock) and reset = '0' and rx_error /= no_receive_error then
        told(index) <= told(index) + 1;
      end if;
    end process;

    drives_when_asked : process (drive(index)) is
    begin
      if drive(index) = '1' then
        check_equal(driven, index, "the node that drives");
      end if;
    end process;

  end generate;

  one_at_a_time : process (clock) is
    variable drivers : natural;
  begin
    if rising_edge(clock) then
      drivers := 0;
      for index in 1 to nodes loop
        if drive(index) = '1' then
          drivers := drivers + 1;
        end if;
      end loop;
      check(drivers = 0 or (drivers = 1 and master_drive = '0'), "two drive the pair");
      check(to_x01(pair) /= 'X', "level of the pair");
    end if;
  end process;

  master : process is

    variable random : random_t;

    procedure say (byte : byte_t; stop : std_ulogic := '1') is
    begin
      master_drive <= '1';
      master_line  <= '0';
      wait for bit_time;
      for place in 0 to 7 loop
        master_line <= byte(place);
        wait for bit_time;
      end loop;
      master_line <= stop;
      wait for bit_time;
      master_line <= '1';
    end procedure;

    procedure token (first : byte_t; flips : byte_t := x"00"; check_flips : byte_t := x"00") is
    begin
      say(first xor flips);
      say(token_check(first) xor check_flips);
      say(x"00");
    end procedure;

    procedure let_go is
    begin
      wait for bit_time;
      master_drive <= '0';
    end procedure;

    -- Receives one byte from the pair. `silence`: none came within so many bits.
    procedure hear (byte : out byte_t; silence : out boolean; patience : positive := 60) is
    begin
      byte    := x"00";
      silence := false;
      if to_x01(pair) /= '0' then
        wait until to_x01(pair) = '0' for patience * bit_time;
      end if;
      if to_x01(pair) /= '0' then
        silence := true;
        return;
      end if;
      wait for 1.5 * bit_time;
      for place in 0 to 7 loop
        byte(place) := to_x01(pair);
        wait for bit_time;
      end loop;
      check_equal(to_x01(pair), '1', "stop bit");
    end procedure;

    procedure expect (byte : byte_t; what : string) is
      variable got     : byte_t;
      variable silence : boolean;
    begin
      hear(got, silence, 400);
      check(not silence, "silence instead of " & what);
      check_equal(got, byte, what);
    end procedure;

    procedure expect_silence is
      variable got     : byte_t;
      variable silence : boolean;
    begin
      hear(got, silence);
      check(silence, "nobody was asked");
    end procedure;

    procedure poll (index : positive) is
    begin
      driven <= index;
      token(std_ulogic_vector(to_unsigned(16#40# + number(index), 8)));
      let_go;
      expect(x"00", "border");
      expect(std_ulogic_vector(to_unsigned(number(index), 8)), "number");
      expect(token_check(std_ulogic_vector(to_unsigned(number(index), 8))), "its check");
      expect(x"00", "end of the token");
    end procedure;

    procedure expect_end is
    begin
      expect(x"40", "the master's turn");
      expect(x"C0" or token_check(x"40"), "its check");
      expect(x"00", "end of the token");
      wait for 3 * bit_time;
      check_equal(drive, "000", "drive behind a turn");
      driven <= 0;
    end procedure;

    -- Sends a message to a node, and receives its answer.
    procedure ask (index : positive; size : positive) is
      type bytes_t is array (1 to 60) of byte_t;
      variable bytes : bytes_t;
      variable count : natural;
    begin
      count := heard(index);
      say(x"00");
      token(std_ulogic_vector(to_unsigned(number(index), 8)));
      for place in 1 to size loop
        bytes(place) := std_ulogic_vector(to_unsigned(random.integer_between(1, 255), 8));
        if place = 1 then
          bytes(1)(7 downto 6) := "10";
        end if;
        say(bytes(place));
      end loop;
      say(x"00");
      poll(index);
      expect(x"C0", "kind");
      expect(std_ulogic_vector(to_unsigned(number(index), 8)), "whose answer it is");
      for place in 1 to size loop
        expect(bytes(place), "byte " & integer'image(place));
      end loop;
      expect(x"00", "end of the message");
      expect_end;
      check_equal(heard(index) - count, size + 2, "bytes that node " & integer'image(number(index)) & " heard");
    end procedure;

    variable before         : numbers_t;
    variable flips          : byte_t;
    variable got            : byte_t;
    variable silence, ended : boolean;
    variable count          : natural;
  begin
    random.seed(seed);
    wait for 10 * clock_period;
    reset <= '0';
    wait for 20 * bit_time;

    -- No node sends before it is polled, not even after its own messages.
    say(x"81");
    say(x"00");
    token(x"02");
    let_go;
    expect_silence;

    for round in 1 to rounds loop
      ask(random.integer_between(1, nodes), random.integer_between(1, 30));
    end loop;
    poll(2);
    expect_end;

    -- All flips of one bit in a token to node 3: neither node 3 nor node 2 takes the following bytes, or sends.
    before := heard;
    for place in 0 to 7 loop
      flips        := x"00";
      flips(place) := '1';
      token(x"03", flips => flips);
      say(x"81");
      say(x"00");
      token(x"03", check_flips => flips);
      say(x"81");
      say(x"00");
      token(x"43", flips => flips);
      let_go;
      expect_silence;
      say(x"00");
      token(x"43", check_flips => flips);
      let_go;
      expect_silence;
    end loop;
    check(heard = before, "bytes behind tokens that were none");

    -- A token is followed by another token, by garbage, or by nothing; or a byte is broken.
    say(x"03");
    say(x"00");
    say(x"03");
    say(token_check(x"03"));
    say(x"07");
    say(x"00");
    say(x"81");
    say(x"00");
    token(x"03");
    token(x"02");
    say(x"FF", stop => '0');
    wait for 10 * bit_time;
    say(x"00");
    let_go;
    expect_silence;
    check_equal(heard(1), before(1) + 1, "bytes of node 3"); -- the border of the right token
    check_equal(heard(2), before(2) + 1, "bytes of node 2");
    check(told = (0, 1, 0), "the node that was spoken to is told of the broken byte");
    ask(1, 5);

    -- A node that always has more to send ends its turn at the end of a message.
    chatty <= true;
    wait for 300 * bit_time;
    chatty <= false;
    poll(3);
    count := 0;
    ended := false;
    while not ended loop
      hear(got, silence);
      check(not silence, "a turn that ends");
      ended := got = x"40";
      count := count + 1;
    end loop;
    check_equal(count - 1, turn_bytes, "bytes of a turn"); -- 32 messages of 8
    hear(got, silence);
    hear(got, silence);
    wait for 3 * bit_time;
    driven <= 0;

    -- A node that stops within a message releases the pair.
    for index in 1 to 2 * nodes loop
      poll(1 + index mod nodes);
      count := 0;
      ended := false;
      while not ended loop
        hear(got, silence);
        check(not silence, "a turn that ends");
        ended := got = x"40";
      end loop;
      hear(got, silence);
      hear(got, silence);
      wait for 3 * bit_time;
      driven <= 0;
    end loop;
    stuck <= true;
    wait for 20 * bit_time;
    poll(1);
    expect(x"C1", "the beginning of a message");
    expect(x"00", "border behind what is broken");
    expect_end;

    report_passed("rs485_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, (rounds + 60) * 2000 * bit_time, "rs485_tb");

end architecture;
