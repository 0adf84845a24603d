-- SPDX-License-Identifier: BSD-3-Clause
--
-- receiver after the decoder: its events for good and bad messages, with each kind of checksum.
--
-- Events are written as text: ( start, [ checked start, the letter, : colon, two digits for a byte, ) good, !xx bad.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.datalink_pkg.all;

entity receiver_tb is
  generic (
    checksum : string := "crc8"
  );
end entity;

architecture bench of receiver_tb is

  signal clock           : std_ulogic := '0';
  signal reset           : std_ulogic := '1';
  signal ended           : boolean := false;
  signal rx_valid        : std_ulogic := '0';
  signal rx_ready        : std_ulogic;
  signal rx_data         : std_ulogic_vector(7 downto 0) := x"00";
  signal character_valid : std_ulogic;
  signal character_ready : std_ulogic;
  signal character_data  : character_t;
  signal rx_error        : std_ulogic_vector(2 downto 0) := "000";
  signal room            : std_ulogic := '1';
  signal receive         : receive_t;

begin

  clock <= not clock after 1 ns when not ended;

  decoder : entity work.decoder
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      character_valid => character_valid, character_ready => character_ready, character_data => character_data);

  dut : entity work.receiver
    generic map (message_entries => 9, checksum => checksum)
    port map (
      clock => clock, reset => reset,
      character_valid => character_valid, character_ready => character_ready, character_data => character_data,
      rx_error => rx_error, room => room, receive => receive);

  play : process

    variable seen   : string(1 to 80);
    variable length : natural := 0;

    procedure add(text : string) is
    begin
      seen(length + 1 to length + text'length) := text;
      length := length + text'length;
    end procedure;

    procedure tick is
    begin
      wait until rising_edge(clock);
      case receive.event is
        when nothing => null;
        when start =>
          if receive.checked = '1' then
            add("[");
          else
            add("(");
          end if;
        when letter => add((1 => character_of(receive.data)));
        when colon => add(":");
        when byte => add(to_hstring(receive.data));
        when good => add(")");
        when bad => add("!" & to_hstring(receive.data));
      end case;
    end procedure;

    procedure feed(text : string) is
    begin
      for place in text'range loop
        rx_valid <= '1';
        rx_data  <= byte_of(text(place));
        loop
          tick;
          exit when rx_ready = '1';
        end loop;
      end loop;
      rx_valid <= '0';
    end procedure;

    procedure expect(events : string; what : string) is
    begin
      for c in 1 to 4 loop
        tick;
      end loop;
      assert seen(1 to length) = events
        report what & ": " & seen(1 to length) & " instead of " & events severity failure;
      length := 0;
    end procedure;

    procedure try(text : string; events : string) is
    begin
      feed(text & LF);
      expect(events, text);
    end procedure;

  begin
    tick;
    reset <= '0';
    try("#R:12", "(R:12)");
    try("#r: Ab,C0.d1" & HT & "e2", "(r:ABC0D1E2)");
    try("#R:12" & CR, "(R:12)");
    try("noise 12:*", "");
    try("#", "()");
    try("%", "!F1");
    try("&PUB:00", "!F1");
    try("#R:#R:12", "(R:!F1");
    try("#R::12", "(R:!F1");
    try("#R:12*58", "(R:12!F1");
    try("#R:1", "(R:!F2");
    try("#R:1*", "(R:!F2");
    try("#R:1G", "(R:!F3");
    try("#R:1 2", "(R:!F3");
    try("#R1:12", "(R!F3");
    try("#R!", "(R!F3");
    try("#R:010203040506", "(R:0102030405!F0");
    try("#R:0102030405", "(R:0102030405)");
    try("#ABCDEFGHI", "(ABCDEFG!F0");
    if checksum = "crc8" then
      try("$R:12*58", "[R:12)");
      try("$r:12*f6", "[r:12)");
      try("$R:12*59", "[R:12!F4");
      try("$R:1258", "[R:1258!F4");
      try("$R:12*5800", "[R:12!F4");
      try("$R:12*58*00", "[R:12!F1");
      try("$R:12*", "[R:12!F4");
      try("$*", "[)");
      try("$:*", "[:)");
      try("$", "[!F4");
    elsif checksum = "xor" then
      try("$R:12*40", "[R:12)");
      try("$R:12*58", "[R:12!F4");
    else
      try("$R:12*58", "!F1");
    end if;
    -- Physical errors: outside a message, within a message, and while there is no room.
    rx_error <= "001";
    tick;
    rx_error <= "000";
    expect("!F6", "parity");
    feed("#R:");
    tick;
    tick;
    rx_error <= "110";
    tick;
    rx_error <= "000";
    feed("12" & LF);
    expect("(R:!FB", "framing and overrun");
    room <= '0';
    tick;
    rx_error <= "010";
    tick;
    rx_error <= "100";
    tick;
    rx_error <= "000";
    expect("", "without room");
    room <= '1';
    expect("!FB", "kept until there is room");
    -- Between messages the receiver waits for room.
    room <= '0';
    tick;
    rx_valid <= '1';
    rx_data  <= x"23";
    for c in 1 to 10 loop
      tick;
    end loop;
    check_equal(rx_ready, '0', "ready without room");
    check_equal(length, 0, "events without room");
    rx_valid <= '0';
    room <= '1';
    feed(LF & "");
    expect("()", "after room");
    report_passed("receiver_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "receiver_tb");

end architecture;
