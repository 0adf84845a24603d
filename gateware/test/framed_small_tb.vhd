-- SPDX-License-Identifier: BSD-3-Clause
--
-- framed_small by itself: a session, a read, a write and its repeat, a frame that is damaged, CLOSE. The bytes are the
-- same as in framed_tb. replay_tb tests everything else, against the reference.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.settings_pkg.all;
use work.stream_bench_pkg.all;

entity framed_small_tb is
  generic (
    window       : positive := 8;
    lists        : boolean  := false;
    publish_mode : natural  := 0;
    groups       : positive := 16;
    group_size   : positive := 32;
    rate_bytes   : positive := 2
  );
end entity;

architecture bench of framed_small_tb is

  constant settings : settings_t := core_settings(
    protocol => protocol_framed, publish_mode => publish_mode, exchanges => 0, lists => lists,
    groups => groups, group_size => group_size, rate_bytes => rate_bytes, deadman => false, window => window);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;

  signal frame_valid, frame_ready : std_ulogic := '0';
  signal frame_data : std_ulogic_vector(7 downto 0) := x"00";
  signal wire_valid, wire_last : std_ulogic;
  signal wire_data : std_ulogic_vector(7 downto 0);
  signal bii_request  : bii_request_t;
  signal bii_response : bii_response_t := bii_response_idle;

  signal wired      : std_ulogic_vector(0 to 8 * 400 - 1);
  signal wired_most : natural := 0;
  signal frames     : natural := 0;
  signal writes     : natural := 0;
  signal word       : std_ulogic_vector(31 downto 0) := x"00000007";  -- at every address

begin

  clock <= not clock after 5 ns when not ended;

  framed_small : entity work.framed_small
    generic map (settings => settings)
    port map (
      clock => clock, reset => reset, frame_valid => frame_valid, frame_ready => frame_ready, frame_data => frame_data,
      tx_valid => wire_valid, tx_ready => '1', tx_data => wire_data, tx_last => wire_last,
      dead_man_request => open, bii_request => bii_request, bii_response => bii_response);

  serve : process (clock)
  begin
    if rising_edge(clock) then
      bii_response <= bii_response_idle;
      if bii_request.valid = '1' and bii_response.done = '0' then
        bii_response <= (done => '1', status => ok, data => word);
        if bii_request.write = '1' then
          word   <= bii_request.data;
          writes <= writes + 1;
        end if;
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
    check_equal(wired(0 to 7), x"D0", "HELLO is answered");
    send(x"81010401123401A1DF8200");
    wait_frames(1);
    send(x"82010102209E968300");  -- id 0, address 20
    wait_frames(1);
    check_equal(tail(14), x"C001010101010101020788888000", "READ");
    send(x"830107012011223344E1CD8200");
    wait_frames(1);
    check_equal(tail(10), x"C00102010101F8A48000", "WRITE");
    check_equal(word, x"11223344", "the word");
    send(x"830107012011223344E1CD8200");
    wait_frames(1);
    check_equal(tail(10), x"C00102010101F8A48000", "the same WRITE again");
    check(writes = 1, "it is executed once");
    send(x"8201030221A6FD8100");  -- a bit is wrong
    send(x"8201030220A6FD8100");
    wait_frames(1);
    check_equal(tail(14), x"C0010202010511223344BDF78300", "the READ behind a damaged one");
    send(x"8D01020AE4DD8100");  -- CLOSE
    send(x"8201030220A6FD8100");
    wait_frames(2);
    check_equal(tail(6), x"D301E2A88200", "CLOSED, behind the session");
    report_passed("framed_small_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "framed_small_tb");

end architecture;
