-- SPDX-License-Identifier: BSD-3-Clause
--
-- The classic and the framed side on one bus through application_switch, each with its own stream: a session, reads
-- from both at once, writes that only the framed side may make. replay_tb tests everything else, against the reference.
--
-- The frames are from the reference: HELLO, OPEN with nonce 1 and epoch 1234, a READ, a WRITE, eight READs, CLOSE.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.settings_pkg.all;
use work.stream_bench_pkg.all;
use work.subscription_pkg.all;

entity framed_tb is
end entity;

architecture bench of framed_tb is

  constant settings : settings_t := core_settings(
    protocol => protocol_both, publish_mode => 0, exchanges => 0, lists => false, deadman => false);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;

  signal classic_valid, classic_ready, frame_valid, frame_ready : std_ulogic := '0';
  signal classic_data, frame_data : std_ulogic_vector(7 downto 0) := x"00";
  signal text_valid, wire_valid, wire_last : std_ulogic;
  signal text_data, wire_data : std_ulogic_vector(7 downto 0);
  signal session_open, classic_busy, classic_may_begin, framed_busy, framed_wants, framed_may_begin : std_ulogic;
  signal classic_subscription, framed_subscription, subscription : subscription_request_t;
  signal classic_bii, framed_bii, bii_request : bii_request_t;
  signal classic_bii_response, framed_bii_response : bii_response_t;
  signal bii_response : bii_response_t := bii_response_idle;

  signal heard      : string(1 to 2000);
  signal heard_most : natural := 0;
  signal wired      : std_ulogic_vector(0 to 8 * 400 - 1);
  signal wired_most : natural := 0;
  signal frames     : natural := 0;
  signal word       : std_ulogic_vector(31 downto 0) := x"00000007";  -- at every address
  constant answer   : string := "#S_R:11223344" & LF & "#?E_FBW" & LF;
  signal talk, talking : boolean := false;
  signal texts      : natural := 0;
  signal both_busy  : boolean := false;
  signal asked_both : boolean := false;

begin

  clock <= not clock after 5 ns when not ended;

  classic : entity work.classic
    generic map (settings => settings)
    port map (
      clock => clock, reset => reset, rx_valid => classic_valid, rx_ready => classic_ready, rx_data => classic_data,
      tx_valid => text_valid, tx_ready => '1', tx_data => text_data, tx_last => open, tx_publish => open,
      locked => session_open, may_begin => classic_may_begin, busy => classic_busy,
      subscription_request => classic_subscription, bii_request => classic_bii, bii_response => classic_bii_response);

  framed : entity work.framed
    generic map (settings => settings)
    port map (
      clock => clock, reset => reset, frame_valid => frame_valid, frame_ready => frame_ready, frame_data => frame_data,
      tx_valid => wire_valid, tx_ready => '1', tx_data => wire_data, tx_last => wire_last, tx_publish => open,
      session_open => session_open, may_begin => framed_may_begin, wants => framed_wants, busy => framed_busy,
      subscription_request => framed_subscription, bii_request => framed_bii, bii_response => framed_bii_response);

  switch : entity work.application_switch
    port map (
      classic_busy => classic_busy, classic_may_begin => classic_may_begin,
      classic_subscription => classic_subscription, classic_bii => classic_bii,
      classic_bii_response => classic_bii_response,
      framed_busy => framed_busy, framed_wants => framed_wants, framed_may_begin => framed_may_begin,
      framed_subscription => framed_subscription, framed_bii => framed_bii, framed_bii_response => framed_bii_response,
      subscription_request => subscription, bii_request => bii_request, bii_response => bii_response);

  serve : process (clock)
  begin
    if rising_edge(clock) then
      bii_response <= bii_response_idle;
      if bii_request.valid = '1' and bii_response.done = '0' then
        bii_response <= (done => '1', status => ok, data => word);
        if bii_request.write = '1' then
          word <= bii_request.data;
        end if;
      end if;
      if session_open = '1' and classic_busy = '1' and framed_busy = '1' then
        both_busy <= true;
      end if;
      if classic_valid = '1' and frame_valid = '1' then
        asked_both <= true;
      end if;
      if text_valid = '1' then
        heard(heard_most + 1) <= character_of(text_data);
        heard_most            <= heard_most + 1;
      end if;
      if wire_valid = '1' then
        wired(8 * wired_most to 8 * wired_most + 7) <= wire_data;
        wired_most <= wired_most + 1;
        if wire_last = '1' then
          frames <= frames + 1;
        end if;
      end if;
    end if;
  end process;

  talking_host : process
    constant text : string := "#R:20" & LF & "#W:2000000000" & LF;
  begin
    wait until talk;
    talking <= true;
    while talk loop
      for index in text'range loop
        send(clock, classic_valid, classic_ready, classic_data, byte_of(text(index)));
      end loop;
      texts         <= texts + 1;
      wait until rising_edge(clock);
    end loop;
    talking <= false;
    wait;
  end process;

  play : process

    procedure send (data : std_ulogic_vector) is
    begin
      send_all(clock, frame_valid, frame_ready, frame_data, data);
    end procedure;

    variable expected : natural := 0;

    procedure wait_frames (count : positive) is
    begin
      expected := expected + count;
      wait_count(clock, frames, expected);
    end procedure;

    -- The last bytes sent.
    impure function tail (bytes : positive) return std_ulogic_vector is
    begin
      return wired(8 * (wired_most - bytes) to 8 * wired_most - 1);
    end function;
  begin
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    send(x"80030101FA928300");
    wait_frames(1);
    check_equal(tail(31)(0 to 7), x"D0", "HELLO is answered");
    check_equal(session_open, '0', "no session yet");
    send(x"81010401123401A1DF8200");
    wait_frames(1);
    check_equal(session_open, '1', "a session");
    send(x"82010102209E968300");  -- id 0, address 20
    wait_frames(1);
    check_equal(tail(14), x"C001010101010101020788888000", "READ");
    send(x"830107012011223344E1CD8200");
    wait_frames(1);
    check_equal(tail(10), x"C00102010101F8A48000", "WRITE");
    check_equal(word, x"11223344", "the word");

    -- Both sides at once: eight reads, and text without end.
    talk <= true;
    send(x"8201030220A6FD8100"
         & x"8201030320FECE8100"
         & x"8201030420F6D48000"
         & x"8201030520AEE78000"
         & x"8201030620C6B38000"
         & x"82010307209E808000"
         & x"8201030820D6878200"
         & x"82010309208EB48200");
    wait_frames(8);
    check_equal(tail(14), x"C0010209010511223344BF9A8200", "the last of eight reads");
    talk <= false;
    wait until not talking;
    wait_clocks(clock, 100);
    check(asked_both, "both sides were asked at the same time");
    check(not both_busy, "but never in a message at the same time");
    check_equal(word, x"11223344", "no text has written");
    check(texts > 1 and heard_most = texts * answer'length, "every text is answered");
    for number in 0 to texts - 1 loop
      check(heard(answer'length * number + 1 to answer'length * (number + 1)) = answer,
            "text " & integer'image(number));
    end loop;
    send(x"8D01020AE4DD8100");
    wait_frames(1);
    for pause in 1 to 100 loop
      exit when session_open = '0';
      tick(clock);
    end loop;
    check_equal(session_open, '0', "the session is over");
    report_passed("framed_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "framed_tb");

end architecture;
