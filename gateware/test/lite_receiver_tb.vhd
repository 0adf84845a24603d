-- SPDX-License-Identifier: BSD-3-Clause
--
-- lite_receiver after the decoder: its events for good and bad texts, with digits and without. Events are written as
-- text: ( start, the letter, : colon, two digits for a byte, ) good, !xx bad.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.datalink_pkg.all;

entity lite_receiver_tb is
  generic (
    digits : boolean := true
  );
end entity;

architecture bench of lite_receiver_tb is

  signal clock           : std_ulogic := '0';
  signal reset           : std_ulogic := '1';
  signal ended           : boolean := false;
  signal rx_valid        : std_ulogic := '0';
  signal rx_ready        : std_ulogic;
  signal rx_data         : std_ulogic_vector(7 downto 0) := x"00";
  signal character_valid : std_ulogic;
  signal character_ready : std_ulogic;
  signal character_data  : character_t;
  signal room            : std_ulogic := '1';
  signal message_end     : std_ulogic;
  signal receive         : receive_t;

begin

  clock <= not clock after 1 ns when not ended;

  -- Without digits the byte Z ends a message.
  message_end <= '1' when receive.event = byte and receive.data = x"5A" else '0';

  decoder : entity work.decoder
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      character_valid => character_valid, character_ready => character_ready, character_data => character_data);

  dut : entity work.lite_receiver
    generic map (digits => digits)
    port map (
      clock => clock, reset => reset,
      character_valid => character_valid, character_ready => character_ready, character_data => character_data,
      room => room, message_end => message_end, receive => receive);

  play : process

    variable random : random_t;
    variable seen   : string(1 to 80);
    variable length : natural := 0;

    procedure add(text : string) is
    begin
      seen(length + 1 to length + text'length) := text;
      length := length + text'length;
    end procedure;

    -- One clock. There is room in half of the clocks, and no event may come in the others.
    procedure tick is
    begin
      wait until rising_edge(clock);
      if room = '0' then
        check(receive.event = nothing, "an event without room");
      end if;
      case receive.event is
        when nothing => null;
        when start => add("(");
        when letter => add((1 => character_of(receive.data)));
        when colon => add(":");
        when byte => add(to_hstring(receive.data));
        when good => add(")");
        when bad => add("!" & to_hstring(receive.data));
      end case;
      room <= '1';
      if random.chance(50) then
        room <= '0';
      end if;
    end procedure;

    procedure try(text : string; events : string) is
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
      for c in 1 to 20 loop
        tick;
      end loop;
      assert seen(1 to length) = events
        report text & ": " & seen(1 to length) & " instead of " & events severity failure;
      length := 0;
    end procedure;

  begin
    random.seed(1);
    tick;
    reset <= '0';
    try("noise 12:*" & LF, "");
    try("#RLC" & LF, "(RLC)");
    try("#R C," & CR, "(RC)");
    try("#R5LC" & LF, "(R");
    try("#R#W:", "(R(W:");
    if digits then
      try("12" & LF, "12)");
      try("#r: Ab,C0.d1" & HT & "e2" & LF, "(r:ABC0D1E2)");
      try("#R:1 2" & CR, "(R:12)");
      try("#R:1" & LF, "(R:)");
      try("#R:", "(R:");
      try("#R:12" & LF, ")");  -- the head ends the message before, and begins no other
      try("$R:12*58" & LF, "!F1");
      try("%&", "!F1!F1");
      -- A character that should be a digit but is not leaves the message open.
      try("#R:1Z2" & LF, "(R:");
      try("12:*" & LF, "");
      try("#R:12" & LF, ")");
      try("#R:12:34" & LF, "(R:12");
      try("$", ")");
      try("#R:12" & LF, "(R:12)");
    else
      try("12#:" & LF & "*Z", "3132233A0A2A5A");
      try("12" & LF & "$R:%&", "");
      try("#R:" & NUL & character'val(255) & "Z#R" & LF, "(R:00FF5A(R)");
      try("#R*#R" & LF, "(R(R)");
    end if;
    report_passed("lite_receiver_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "lite_receiver_tb");

end architecture;
