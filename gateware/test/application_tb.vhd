-- SPDX-License-Identifier: BSD-3-Clause
--
-- application: tokens of replies, bus cycles and their blocks, errors in the middle, turns between requests and publishes,
-- stalls. The bus and the subscription manager are played by the bench; what everything together answers is in
-- tests/gateware (recordings, the twin).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bench_pkg.all;
use work.bii_pkg.all;
use work.subscription_pkg.all;

entity application_tb is
  generic (
    publish_mode : natural := 2;
    stalls       : natural := 0  -- percent of the clocks in which no token is taken
  );
end entity;

architecture bench of application_tb is

  signal clock                 : std_ulogic := '0';
  signal reset                 : std_ulogic := '1';
  signal ended                 : boolean := false;
  signal request               : request_t := (
    valid => '0', error => '0', code => x"00", checked => '0', command => unknown, length => (others => '0'));
  signal data                  : std_ulogic_vector(7 downto 0) := x"00";
  signal take                  : std_ulogic;
  signal request_done          : std_ulogic;
  signal subscription_request  : subscription_request_t;
  signal subscription_response : subscription_response_t := subscription_response_idle;
  signal bii_request           : bii_request_t;
  signal bii_response          : bii_response_t := bii_response_idle;
  signal token_valid           : std_ulogic;
  signal token_ready           : std_ulogic := '1';
  signal token_data            : token_t;

  signal bytes      : std_ulogic_vector(63 downto 0) := (others => '0');  -- of the request, the first one highest
  signal taken      : natural := 0;
  signal heard      : string(1 to 400);                                   -- replies and publishes as text
  signal length     : natural := 0;
  signal clear      : boolean := false;
  signal accesses   : natural := 0;
  signal blocks     : natural := 0;                                       -- that have ended
  signal outside    : natural := 0;                                       -- accesses of no block
  signal writes     : natural := 0;
  signal last_write : std_ulogic_vector(63 downto 0) := (others => '0');  -- address, data
  signal publishes  : natural := 0;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.application
    generic map (publish_mode => publish_mode)
    port map (
      clock => clock, reset => reset, request => request, data => data, take => take, request_done => request_done,
      subscription_request => subscription_request, subscription_response => subscription_response,
      bii_request => bii_request, bii_response => bii_response,
      token_valid => token_valid, token_ready => token_ready, token_data => token_data);

  data <= bytes(63 - 8 * (taken mod 8) downto 56 - 8 * (taken mod 8));

  -- The bus: two clocks an access; word a is a in all four bytes; EE refuses, FF is silent.
  serve : process (clock)
    variable held : std_ulogic := '0';
  begin
    if rising_edge(clock) then
      bii_response.done <= '0';
      if bii_request.valid = '1' and bii_response.done = '0' then
        bii_response.done   <= '1';
        bii_response.status <= ok;
        bii_response.data   <= bii_request.address(7 downto 0) & bii_request.address(7 downto 0) &
                               bii_request.address(7 downto 0) & bii_request.address(7 downto 0);
        if bii_request.address(7 downto 0) = x"EE" then
          bii_response.status <= error;
        elsif bii_request.address(7 downto 0) = x"FF" then
          bii_response.status <= silent;
        end if;
        accesses <= accesses + 1;
        if bii_request.block_hold = '0' then
          outside <= outside + 1;
        end if;
        if bii_request.write = '1' then
          writes     <= writes + 1;
          last_write <= bii_request.address & bii_request.data;
        end if;
      end if;
      if held = '1' and bii_request.block_hold = '0' then
        blocks <= blocks + 1;
      end if;
      held := bii_request.block_hold;
    end if;
  end process;

  listen : process (clock)
    variable random : random_t;

    procedure add(text : string) is
    begin
      heard(length + 1 to length + text'length) <= text;
      length <= length + text'length;
    end procedure;
  begin
    if rising_edge(clock) then
      if clear then
        length <= 0;
        taken  <= 0;
      else
        if take = '1' then
          taken <= taken + 1;
        end if;
        if token_valid = '1' and token_ready = '1' then
          case token_data(9 downto 8) is
            when token_head => add((1 => character'val(to_integer(unsigned(token_data(7 downto 0))))));
            when token_text => add(spelling(text_t'val(to_integer(unsigned(token_data(7 downto 0))))));
            when token_byte => add(to_hstring(token_data(7 downto 0)));
            when others => add(";");
          end case;
        end if;
      end if;
      if subscription_request.publish_take = '1' then
        publishes <= publishes + 1;
      end if;
      token_ready <= '1';
      if random.chance(stalls) then
        token_ready <= '0';
      end if;
    end if;
  end process;

  play : process

    procedure tick(clocks : positive := 1) is
    begin
      for c in 1 to clocks loop
        wait until rising_edge(clock);
      end loop;
      wait for 1 ps;
    end procedure;

    procedure ask(command : command_t; data_bytes : natural; content : std_ulogic_vector(63 downto 0); reply : string;
                  checked : std_ulogic := '0'; error : std_ulogic := '0') is
    begin
      clear <= true;
      tick;
      clear <= false;
      bytes   <= content;
      request <= (valid => '1', error => error, code => x"F4", checked => checked, command => command,
                  length => to_unsigned(data_bytes, 11));
      wait until rising_edge(clock) and request_done = '1';
      request.valid <= '0';
      tick(2);
      assert heard(1 to length) = reply
        report command_t'image(command) & ": " & heard(1 to length) & " instead of " & reply severity failure;
    end procedure;

    variable before : natural;
  begin
    tick(2);
    reset <= '0';
    tick;
    ask(read, 1, x"1200000000000000", "#S_R:12121212;");
    ask(read, 2, x"3456000000000000", "$S_R:34343434;", checked => '1');
    check_equal(outside, 2, "single accesses are no block");
    ask(write, 5, x"20DEADBEEF000000", "#S_W;");
    check_equal(last_write(39 downto 0), std_ulogic_vector'(x"20DEADBEEF"), "what was written");
    ask(read, 1, x"EE00000000000000", "#?E_FBR;");
    ask(read, 1, x"FF00000000000000", "#?E_BAT;");
    ask(write, 5, x"EE00000000000000", "#?E_FBW;");
    -- What is refused leaves the bus alone.
    before := accesses;
    ask(unknown, 0, x"0000000000000000", "#?E_ICC;");
    ask(read, 0, x"0000000000000000", "#?E_MAB;");
    ask(write, 0, x"0000000000000000", "#?E_MAB;");
    ask(write, 4, x"2000000000000000", "#?E_MDB;");
    ask(read_many, 0, x"0000000000000000", "#?E_MDB;");
    ask(read_many, 1, x"0000000000000000", "#?E_IBS;");
    ask(read_many, 1, x"2100000000000000", "#?E_IBS;");
    ask(read_many, 1, x"0100000000000000", "#S_RM:?E_MAB;");
    ask(unknown, 0, x"0000000000000000", "?F4;", error => '1');
    check_equal(accesses, before, "bus accesses of refused requests");
    -- One block a read-many, which an error ends.
    before := blocks;
    ask(read_many, 4, x"0301020300000000", "#S_RM:010101010202020203030303;");
    check_equal(blocks, before + 1, "blocks");
    ask(read_many, 4, x"0301EE0300000000", "#S_RM:01010101?E_FBR;");
    ask(read_many, 4, x"0301FF0300000000", "#S_RM:01010101?E_BAT;");
    ask(read_many, 3, x"0301020000000000", "#S_RM:0101010102020202?E_MAB;");
    check_equal(blocks, before + 4, "blocks that ended in an error");
    ask(read_configuration, 0, x"0000000000000000", "#CNF:01,04,20,0" & integer'image(publish_mode) & ",03E8,02,10,02;");

    if publish_mode > 0 then
      ask(read_group, 1, x"0200000000000000", "#?E_ISG;");
      ask(write_group_rate, 2, x"0000000000000000", "#?E_MDB;");
      ask(write_group_addresses, 3, x"0002010000000000", "#?E_MAB;");
      ask(write_group_addresses, 3, x"0011010000000000", "#?E_ILA;");
      subscription_response.done   <= '1';
      subscription_response.looked <= '1';
      subscription_response.rate   <= x"00000102";
      subscription_response.count  <= x"02";
      subscription_response.address <= x"00000055";
      subscription_response.mask   <= x"03";
      ask(write_group_rate, 3, x"0001020000000000", "#S_WSR;");
      ask(write_group_addresses, 4, x"0002010200000000", "#S_WSA;");
      ask(read_group, 1, x"0100000000000000", "#S_RSI:0102025555;");
      ask(write_event_mask, 2, x"0003000000000000", "#S_WIC;");
      ask(read_event_mask, 0, x"0000000000000000", "#S_RIC:0303;");
      ask(enable_checked_publishing, 0, x"0000000000000000", "#S_EPC;");
      -- A publish: one block.
      before := blocks;
      clear <= true;
      tick;
      clear <= false;
      subscription_response.publish_group <= x"01";
      subscription_response.publish <= '1';
      wait until rising_edge(clock) and subscription_request.publish_take = '1';
      subscription_response.publish <= '0';
      tick(200);
      assert heard(1 to length) = "&PUB:01025555555555555555;"
        report "publish: " & heard(1 to length) severity failure;
      check_equal(blocks, before + 1, "blocks of a publish");
      ask(disable_publishing, 0, x"0000000000000000", "#S_DPS;");
      -- Neither starves: with both always waiting, the preferred side has three of four turns.
      before := publishes;
      subscription_response.publish <= '1';
      request <= (valid => '1', error => '1', code => x"F1", checked => '0', command => unknown,
                  length => to_unsigned(0, 11));
      clear <= true;
      for turn in 1 to 8 loop
        wait until rising_edge(clock) and request_done = '1';
      end loop;
      if publish_mode = 2 then
        assert publishes - before >= 21 and publishes - before <= 25
          report "publishes beside 8 requests: " & integer'image(publishes - before) severity failure;
      else
        assert publishes - before >= 2 and publishes - before <= 3
          report "publishes beside 8 requests: " & integer'image(publishes - before) severity failure;
      end if;
    end if;
    report_passed("application_tb");
    ended <= true;
    wait;
  end process;

  watchdog : process
  begin
    wait for 1 ms;
    assert ended report "application_tb: took too long" severity failure;
    wait;
  end process;

end architecture;
