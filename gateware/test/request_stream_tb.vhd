-- SPDX-License-Identifier: BSD-3-Clause
--
-- request_stream: events as from a lite_receiver, in and out at random speeds; commands, bytes, ends. Events are
-- written as text: ( start, letters, : colon, one digit for a byte of that value, ) good, ! bad.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bench_pkg.all;
use work.datalink_pkg.all;

entity request_stream_tb is
  generic (
    seed : positive := 1
  );
end entity;

architecture bench of request_stream_tb is

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal ended        : boolean := false;
  signal receive      : receive_t := (event => nothing, checked => '0', data => x"00");
  signal room         : std_ulogic;
  signal message_end  : std_ulogic;
  signal request      : request_t;
  signal take         : std_ulogic := '0';
  signal request_done : std_ulogic := '0';
  signal told_end     : natural := 0;  -- events up to message_end; 0: there was none

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.request_stream
    generic map (address_bytes => 2, data_bytes => 3, rate_bytes => 2, mask_bytes => 4)
    port map (
      clock => clock, reset => reset, receive => receive, room => room, message_end => message_end,
      request => request, take => take, request_done => request_done);

  play : process

    variable random : random_t;
    variable bytes  : string(1 to 20);
    variable count  : natural;

    -- Sends the events of `text`, and takes the request: at most `most` bytes, and then the request is done.
    procedure try(
      text : string; command : natural; expected : string := ""; most : natural := 20; ends_at : natural := 0) is
      variable next_event : natural := 1;
      variable done       : boolean := false;
      variable begun      : boolean := false;
      variable gone       : boolean := false;
      variable clocks     : natural := 0;

      function event_of(c : character) return receive_t is
      begin
        case c is
          when '(' => return (event => start, checked => '0', data => x"23");
          when ':' => return (event => colon, checked => '0', data => x"3A");
          when ')' => return (event => good, checked => '0', data => x"0A");
          when '!' => return (event => bad, checked => '0', data => x"F1");
          when '0' to '9' =>
            return (event => byte, checked => '0',
                    data => std_ulogic_vector(to_unsigned(character'pos(c) - character'pos('0'), 8)));
          when others =>
            return (event => letter, checked => '0', data => byte_of(c));
        end case;
      end function;
    begin
      count    := 0;
      told_end <= 0;
      while not done or next_event <= text'length loop
        clocks := clocks + 1;
        assert clocks < 1000 report text & ": stuck" severity failure;
        receive.event <= nothing;
        take         <= '0';
        request_done <= '0';
        wait until falling_edge(clock);  -- all outputs of the clock before are stable
        if request.valid = '1' and not gone then
          if not begun then
            check(request.error = '0' xor command = command_error, text & ": error");
            if command = command_error then
              check_equal(request.data, x"F1", "code");
            elsif command = command_unknown then
              assert unsigned(request.command) = command_unknown or unsigned(request.command) >= command_spelling
                report text & ": " & to_string(request.command) severity failure;
            else
              check_equal(to_integer(unsigned(request.command)), command, text & ": command");
            end if;
            begun := true;
            take <= '1';
          elsif command = command_error or count = most or (request.missing = '1' and random.chance(50)) then
            request_done <= '1';
            gone := true;
          elsif request.ready = '1' and request.missing = '0' and random.chance(50) then
            count := count + 1;
            bytes(count) := character'val(to_integer(unsigned(request.data)) + character'pos('0'));
            take <= '1';
          end if;
        end if;
        if next_event <= text'length and room = '1' and random.chance(50) then
          receive    <= event_of(text(next_event));
          next_event := next_event + 1;
        end if;
        wait for 100 ps;
        if message_end = '1' and told_end = 0 then
          told_end <= next_event - 1;
        end if;
        wait until rising_edge(clock);
        done := gone;
      end loop;
      receive.event <= nothing;
      take          <= '0';
      request_done  <= '0';
      wait until rising_edge(clock);
      check_equal(request.valid, '0', text & ": valid at the end");
      assert bytes(1 to count) = expected
        report text & ": bytes " & bytes(1 to count) & " instead of " & expected severity failure;
      check_equal(told_end, ends_at, text & ": message_end");
    end procedure;

  begin
    random.seed(seed);
    wait until rising_edge(clock);
    reset <= '0';
    for round in 1 to 20 loop
      try("(R:12)", command_read, "12", 20, 5);
      try("(r:12", command_read, "12", 2, 5);
      try("(R:1)", command_read, "1");
      try("(R:)", command_read, "");
      try("(R)", command_unknown);
      try("(RX:)", command_unknown, "", 20, 4);
      try("(R:12345)", command_read, "12", 2, 5);
      try("(W:12345)", command_write, "12345", 20, 8);
      try("(RM:2123499", command_read_many, "21234", 5, 9);
      try("(RM:0)", command_read_many, "0", 20, 5);
      try("(WSA:121234)", command_write_group_addresses, "121234", 20, 11);
      try("(WSA:12123)", command_write_group_addresses, "12123");
      try("(WSA:1244444", command_write_group_addresses, "", 0, 11);  -- refused at once
      try("(WSR:123)", command_write_group_rate, "123", 20, 8);
      try("(RSI:1)", command_read_group, "1", 20, 6);
      try("(WIC:1234)", command_write_event_mask, "1234", 20, 9);
      try("(RIC)", command_read_event_mask);
      try("(RLC)", command_read_configuration);
      try("(RLCX)", command_read_configuration);
      try("(EPS)", command_enable_publishing);
      try("(EPC)", command_unknown);
      try("(DPS:", command_disable_publishing, "", 20, 5);
      try("(DPS:12)", command_disable_publishing, "", 0, 5);
      try("(WXYZ(DPS)", command_disable_publishing);
      try("!", command_error);
    end loop;
    report_passed("request_stream_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "request_stream_tb");

end architecture;
