-- SPDX-License-Identifier: BSD-3-Clause
--
-- rs485_node, character by character: which bytes of the master reach the core, tokens with each bit flipped, and whole
-- turns. A turn has no message, some messages, more than fit, or a message that the core breaks off.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity rs485_node_tb is
  generic (
    seed : positive := 1
  );
end entity;

architecture test of rs485_node_tb is

  subtype byte_t is std_ulogic_vector(7 downto 0);
  type bytes_t is array (natural range <>) of byte_t;

  constant node       : std_ulogic_vector(5 downto 0) := "000101";
  constant select_us  : byte_t   := x"05";
  constant poll_us    : byte_t   := x"45";
  constant bit_clocks : positive := 4;
  constant head       : bytes_t  := (x"00", select_us, token_check(select_us), x"00");
  constant tail       : bytes_t  := (x"40", token_check(x"40"), x"00");

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean    := false;
  signal drive : std_ulogic;

  signal line_valid, line_ready : std_ulogic := '0';
  signal line_data              : byte_t := x"00";
  signal line_error             : receive_error_t := no_receive_error;
  signal rx_valid               : std_ulogic;
  signal rx_ready               : std_ulogic := '0';
  signal send_ready             : std_ulogic;
  signal send_valid, send_last  : std_ulogic := '0';
  signal send_data              : byte_t := x"00";
  signal out_valid              : std_ulogic;
  signal out_ready              : std_ulogic := '1';
  signal out_data               : byte_t;

  signal core_bytes : natural := 0;   -- bytes that reached the core
  signal has        : natural := 0;   -- bytes that the core has to send: C0, C1, …
  signal breaks     : boolean := false; -- … without an end of the message
  signal turn       : bytes_t(0 to 63) := (others => x"FF");
  signal turn_size  : natural := 0;

begin

  clock <= not clock after 5 ns when not done;

  dut : entity work.rs485_node
    generic map (bit_clocks => bit_clocks, turn_bytes => 8, turnaround_bits => 3, silence_bits => 6)
    port map (
      clock => clock, reset => reset, node => node, drive => drive,
      line_valid => line_valid, line_ready => line_ready, line_data => line_data, line_error => line_error,
      rx_valid => rx_valid, rx_ready => rx_ready,
      send_valid => send_valid, send_ready => send_ready, send_data => send_data, send_last => send_last,
      out_valid => out_valid, out_ready => out_ready, out_data => out_data);

  core : process (clock) is
    variable random : random_t;
    variable seeded : boolean := false;
    variable place  : natural := 0;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(seed);
        seeded := true;
      end if;
      rx_ready <= '0';
      if random.chance(60) then
        rx_ready <= '1';
      end if;
      if rx_valid = '1' and rx_ready = '1' then
        core_bytes <= core_bytes + 1;
      end if;
      if has = 0 then
        place := 0;
      elsif send_valid = '1' and send_ready = '1' then
        place := place + 1;
      end if;
      send_valid <= '0';
      if place < has then
        send_valid <= '1';
        send_data  <= std_ulogic_vector(to_unsigned(16#C0# + place, 8));
        send_last  <= '0';
        if place mod 5 = 4 and not breaks then -- messages of five bytes
          send_last <= '1';
        end if;
      end if;
    end if;
  end process;

  -- A frame lasts ten bits. The transmitter takes the next character in the last clock of a frame.
  transmitter : process (clock) is
    variable left : natural := 0;
  begin
    if rising_edge(clock) then
      if drive = '1' and out_valid = '1' and out_ready = '1' then
        turn(turn_size) <= out_data;
        turn_size       <= turn_size + 1;
        left            := 10 * bit_clocks;
      end if;
      check(out_valid = '0' or drive = '1', "nothing is said without drive");
      if left > 0 then
        left := left - 1;
      end if;
      out_ready <= '0';
      if left <= 1 then
        out_ready <= '1';
      end if;
      if line_valid = '1' then
        turn_size <= 0;
      end if;
    end if;
  end process;

  play : process is

    procedure hear (byte : byte_t; error : receive_error_t := no_receive_error) is
    begin
      line_error <= error;
      send(clock, line_valid, line_ready, line_data, byte);
      wait until rising_edge(clock);
    end procedure;

    procedure token (first : byte_t; flip : natural := 16) is
      variable both : std_ulogic_vector(15 downto 0) := first & token_check(first);
    begin
      if flip < 16 then
        both(flip) := not both(flip);
      end if;
      hear(both(15 downto 8));
      hear(both(7 downto 0));
      hear(x"00");
    end procedure;

    procedure silent_for_a_while (what : string) is
    begin
      for count in 1 to 20 * bit_clocks loop
        wait until rising_edge(clock);
        check_equal(drive, '0', what);
      end loop;
    end procedure;

    -- Checks the turn after a poll, with so many bytes of the core.
    procedure check_turn (bytes : natural; broken : boolean := false) is
      variable border : natural := 0;
    begin
      token(poll_us);
      wait until drive = '1' for 1 us;
      check_equal(drive, '1', "a poll is answered");
      wait until drive = '0' for 100 us;
      check_equal(drive, '0', "a turn ends");
      if broken then
        border := 1;
        check_equal(turn(4 + bytes), x"00", "the border of the broken message");
      end if;
      check_equal(turn_size, 7 + bytes + border, "characters of the turn");
      for place in head'range loop
        check_equal(turn(place), head(place), "head of the turn");
      end loop;
      for place in 0 to bytes - 1 loop
        check_equal(turn(4 + place), std_ulogic_vector(to_unsigned(16#C0# + place, 8)), "byte of the turn");
      end loop;
      for place in tail'range loop
        check_equal(turn(4 + bytes + border + place), tail(place), "tail of the turn");
      end loop;
    end procedure;

  begin
    wait until rising_edge(clock);
    reset <= '0';
    wait until rising_edge(clock);

    -- The core gets the border before it, a frame up to its error, and the next frame. Then a frame for another node
    -- comes.
    token(select_us);
    hear(x"80");
    hear(x"11");
    hear(x"12", "010");
    hear(x"00");
    check_equal(core_bytes, 4, "the border, and the frame up to its error");
    hear(x"81");
    hear(x"00");
    check_equal(core_bytes, 6, "the next frame");
    token(x"06");
    hear(x"80");
    hear(x"00");
    check_equal(core_bytes, 6, "a frame of another node");

    -- A token with an error may have selected another node. So the next frame is not for this one.
    token(select_us);
    hear(x"06");
    hear(token_check(x"06"), "010");
    hear(x"00");
    check_equal(core_bytes, 7, "the border");
    hear(x"80");
    hear(x"00");
    check_equal(core_bytes, 7, "a frame behind a token with an error");

    for flip in 0 to 15 loop
      token(poll_us, flip);
      hear(x"00");
      silent_for_a_while("a poll with a flipped bit");
    end loop;
    token(x"44");
    silent_for_a_while("a poll of another node");
    check_equal(core_bytes, 7, "tokens are not for the core");

    check_turn(0);
    has <= 5;
    check_turn(5);
    has <= 0;
    wait until rising_edge(clock);
    has <= 40; -- eight fit: the second message is the last
    check_turn(10);
    has <= 0;
    wait until rising_edge(clock);
    breaks <= true;
    has    <= 3;
    check_turn(3, true);

    report_passed("rs485_node_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 10 ms, "rs485_node_tb");

end architecture;
