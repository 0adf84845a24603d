-- SPDX-License-Identifier: BSD-3-Clause
--
-- frame_application alone, with requests as from the receiver and replies as to the transmitter. Repeated writes,
-- repeated posts, and ids beyond the window open the bus exactly as often as they may.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.subscription_pkg.all;

entity frame_application_tb is
end entity;

architecture bench of frame_application_tb is

  constant settings : frame_settings_t := (
    address_width => 12, data_width => 16, address_bytes => 2, data_bytes => 2, clock_hz => 50_000_000, base_hz => 1000,
    groups => 0, group_size => 0, rate_bytes => 2, exchanges => 0, exchange_size => 0, window => 4, cache_bytes => 16,
    request_max => 250, reply_max => 250, credit => 512, classic => false, lists => false, deadman => false,
    gateware_version => x"00000000", build => x"00000000", spec_hash => x"0000000000000000");

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;
  signal request : frame_request_t := (entry => "00000", length => x"00", left => x"00", data => x"00", others => '0');
  signal take, rewind, request_done : std_ulogic;
  signal reply        : frame_reply_t;
  signal reply_ready  : std_ulogic := '1';
  signal epoch        : crc16_t;
  signal bii_request  : bii_request_t;
  signal bii_response : bii_response_t := bii_response_idle;

  signal payload : std_ulogic_vector(0 to 8 * 32 - 1) := (others => '0');
  signal place   : natural := 0;  -- the next byte of it
  signal answer  : std_ulogic_vector(8 * 64 - 1 downto 0) := (others => '0');  -- bytes shift in
  signal answers, reads, writes : natural := 0;
  signal word    : std_ulogic_vector(31 downto 0) := x"00000000";
  signal changed : std_ulogic := '0';  -- the word, changed by the other side

begin

  clock <= not clock after 5 ns when not ended;

  application : entity work.frame_application
    generic map (settings => settings)
    port map (
      clock => clock, reset => reset, request => request, take => take, rewind => rewind, request_done => request_done,
      reply => reply, reply_ready => reply_ready, reply_idle => '1', epoch => epoch, wants => open, busy => open,
      subscription_request => open, bii_request => bii_request, bii_response => bii_response);

  request.data    <= payload(8 * place to 8 * place + 7);
  request.left    <= request.length - place when place <= request.length else x"00";
  request.missing <= '1' when place >= request.length else '0';

  surroundings : process (clock)
    variable random : random_t;
  begin
    if rising_edge(clock) then
      if rewind = '1' then
        place <= 0;
      elsif take = '1' then
        place <= place + 1;
      end if;
      if reply_ready = '1' then
        if reply.put = '1' or reply.kind = '1' then
          answer <= answer(answer'left - 8 downto 0) & reply.data;
        end if;
        if reply.finish = '1' then
          answers <= answers + 1;
        end if;
      end if;
      if changed = '1' then
        word <= x"00001111";
      end if;
      reply_ready  <= '1' when random.chance(70) else '0';
      bii_response <= bii_response_idle;
      if bii_request.valid = '1' and bii_response.done = '0' and random.chance(50) then
        bii_response <= (done => '1', status => ok, data => word);
        if bii_request.address = x"00000666" then
          bii_response.status <= error;
        elsif bii_request.write = '1' then
          word <= bii_request.data;
        end if;
        if bii_request.write = '1' then
          writes <= writes + 1;
        else
          reads <= reads + 1;
        end if;
      end if;
    end if;
  end process;

  play : process

    procedure ask (entry : natural; data : std_ulogic_vector; chained : std_ulogic := '0') is
    begin
      request.entry   <= std_ulogic_vector(to_unsigned(entry, 5));
      request.chained <= chained;
      request.length  <= to_unsigned(data'length / 8, 8);
      payload(0 to data'length - 1) <= data;
      request.valid <= '1';
      wait until rising_edge(clock) and request_done = '1';
      request.valid <= '0';
      tick(clock);
    end procedure;

    procedure answered (count : natural; data : std_ulogic_vector; what : string) is
    begin
      check_equal(answers, count, "answers, with " & what);
      check_equal(answer(data'length - 1 downto 0), data, what);
    end procedure;

    procedure opened (read_count, write_count : natural; what : string) is
    begin
      check_equal(reads, read_count, "reads of the bus, with " & what);
      check_equal(writes, write_count, "writes of the bus, with " & what);
    end procedure;
  begin
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    ask(entry_session, x"");
    answered(1, x"D3", "CLOSED");
    ask(entry_session, x"");
    answered(1, x"D3", "no second CLOSED");
    ask(entry_hello, x"0101");
    answered(2, x"D0" & x"01" & x"0001" & x"FFFF" & x"02" & x"02" & x"0200" & x"00FA" & x"00FA" & x"04" & x"10" &
             x"0000" & x"0000000000000000", "HELLO");
    ask(entry_open, x"00011234" & x"01");
    check_equal(answers, 2, "no answer to an OPEN that asks for what there is not");
    ask(entry_open, x"0001123400");
    check_equal(answers, 3, "OPEN");
    check_equal(epoch, x"1234", "the epoch");
    ask(3, x"0000" & x"0020" & x"BEEF");
    answered(4, x"C0" & x"0000" & x"0000", "WRITE");
    opened(0, 1, "WRITE");
    check_equal(word(15 downto 0), x"BEEF", "the word");
    ask(3, x"0000" & x"0020" & x"BEEF");
    answered(5, x"C0" & x"0000" & x"0000", "the same again");
    opened(0, 1, "the same again");
    ask(2, x"0001" & x"0020");
    answered(6, x"C0" & x"0001" & x"0000" & x"BEEF", "READ");
    pulse(clock, changed);
    ask(2, x"0001" & x"0020");
    answered(7, x"C0" & x"0001" & x"0000" & x"BEEF", "its kept answer");
    opened(1, 1, "its kept answer");
    ask(4, x"0000" & x"0020" & x"0001");
    ask(4, x"0000" & x"0020" & x"0001");
    ask(4, x"0002" & x"0020" & x"0001");
    opened(1, 2, "a post, the same again, and one too far");
    ask(2, x"0001" & x"0020");
    answered(8, x"C0" & x"0001" & x"0001" & x"BEEF", "the kept answer with the posts of now");
    ask(3, x"0004" & x"0666" & x"0001", chained => '1');
    answered(9, x"C8" & x"0004" & x"0001", "order");
    opened(1, 2, "order");
    ask(3, x"0004" & x"0666" & x"0001");
    answered(10, x"C1" & x"0004" & x"0001", "bus error");
    ask(3, x"0000" & x"0020" & x"0001");
    answered(10, x"C1" & x"0004" & x"0001", "nothing for a stale id");
    opened(1, 3, "a stale id");
    ask(3, x"0004" & x"0020" & x"0001");
    answered(11, x"C1" & x"0004" & x"0001", "the bus error again");
    ask(13, x"0005");
    answered(12, x"C0" & x"0005" & x"0001", "CLOSE");
    check_equal(epoch, x"FFFF", "no epoch");
    opened(1, 3, "CLOSE");
    report_passed("frame_application_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "frame_application_tb");

end architecture;
