-- SPDX-License-Identifier: BSD-3-Clause
--
-- application: words of replies, bus cycles and their blocks, errors within a block, turns between requests and
-- publishes, stalls. The bench plays the bus and the subscription manager. The answers of the whole core are tested in
-- tests/gateware (recordings, the twin).
-- tests/gateware (recordings, the twin).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bench_pkg.all;
use work.bii_pkg.all;
use work.datalink_pkg.all;
use work.subscription_pkg.all;

entity application_tb is
  generic (
    publish_mode : natural := 2;
    stalls       : natural := 0  -- percent of the clocks in which no word is taken
  );
end entity;

architecture bench of application_tb is

  signal clock                 : std_ulogic := '0';
  signal reset                 : std_ulogic := '1';
  signal ended                 : boolean := false;
  signal request               : request_t;
  signal take                  : std_ulogic;
  signal rewind                : std_ulogic;
  signal request_done          : std_ulogic;
  signal subscription_request  : subscription_request_t;
  signal subscription_response : subscription_response_t := subscription_response_idle;
  signal bii_request           : bii_request_t;
  signal bii_response          : bii_response_t := bii_response_idle;
  signal word_valid            : std_ulogic;
  signal word_ready            : std_ulogic := '1';
  signal word_data             : word_t;

  -- The current request.
  signal asked      : std_ulogic := '0';
  signal command    : natural := 0;
  signal checked    : std_ulogic := '0';
  signal size       : natural := 0;
  signal bytes      : std_ulogic_vector(63 downto 0) := (others => '0');  -- items taken of it, with the head item
  signal taken      : natural := 0;                                       -- how many; the first says what it is

  type words_t is array (0 to 3, 0 to 511) of std_ulogic_vector(31 downto 0);
  signal words      : words_t := (others => (others => (others => '0'))); -- of the groups
  signal heard      : string(1 to 400);                                   -- replies and publishes as text
  signal length     : natural := 0;
  signal clear      : boolean := false;
  signal accesses   : natural := 0;
  signal blocks     : natural := 0;                                       -- blocks that have ended
  signal outside    : natural := 0;                                       -- accesses outside a block
  signal writes     : natural := 0;
  signal rate       : std_ulogic_vector(31 downto 0) := (others => '0');
  signal mask       : std_ulogic_vector(15 downto 0) := (others => '0');
  signal publish_due    : std_ulogic := '0';
  signal publish_always : boolean := false;
  signal last_write : std_ulogic_vector(63 downto 0) := (others => '0');  -- address, data
  signal publishes  : natural := 0;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.application
    generic map (publish_mode => publish_mode)
    port map (
      clock => clock, reset => reset, request => request, take => take, rewind => rewind, request_done => request_done,
      subscription_request => subscription_request, subscription_response => subscription_response,
      bii_request => bii_request, bii_response => bii_response,
      word_valid => word_valid, word_ready => word_ready, word_data => word_data);

  hand_over : process (all)
    variable place : natural;
  begin
    place := (taken + 7) mod 8;
    request <= (
      valid => asked, ready => '1', missing => '0', data => bytes(63 - 8 * place downto 56 - 8 * place), error => '0',
      checked => '0', command => "10101");
    if taken = 0 then
      request.checked <= checked;
      request.command <= std_ulogic_vector(to_unsigned(command, 5));
      if command = command_error then
        request.error <= '1';
        request.data  <= x"F4";
      end if;
    elsif taken > size then
      request.missing <= '1';
    end if;
  end process;

  -- The words of the groups, one clock late. Groups are filled and active once the application says so.
  keep : process (clock)
    variable group_number, place : natural;
  begin
    if rising_edge(clock) then
      group_number := to_integer(subscription_request.group_number) mod 4;
      place := to_integer(subscription_request.place);
      subscription_response.word <= words(group_number, place);
      if subscription_request.write_word = '1' then
        words(group_number, place) <= subscription_request.word;
      end if;
      if subscription_request.fill = '1' then
        subscription_response.empty <= '0';
      end if;
      subscription_response.done <= subscription_request.write_rate and not subscription_response.done;
      if subscription_request.write_rate = '1' then
        rate <= subscription_request.rate;
        subscription_response.inactive <= '0';
      end if;
      if subscription_request.write_mask = '1' then
        mask(8 * (place mod 2) + 7 downto 8 * (place mod 2)) <= subscription_request.word(7 downto 0);
      end if;
      subscription_response.publish       <= publish_due;
      subscription_response.publish_group <= x"01";
      if publish_due = '1' and subscription_request.publish_take = '1' and not publish_always then
        subscription_response.publish <= '0';
      end if;
    end if;
  end process;

  subscription_response.mask <=
    mask(15 downto 8) when subscription_request.place = 1 else mask(7 downto 0);

  -- The bus, with two clocks per access. Word a has a in all four bytes. EE refuses, and FF is silent.
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
        if request_done = '1' or rewind = '1' then
          taken <= 0;
        elsif take = '1' then
          taken <= taken + 1;
        end if;
        if word_valid = '1' and word_ready = '1' then
          case word_data(10 downto 8) is
            when word_byte => add(to_hstring(word_data(7 downto 0)));
            when word_tail => add(";");
            when others => add((1 => character_of(word_data(7 downto 0))));
          end case;
        end if;
      end if;
      if subscription_request.publish_take = '1' then
        publishes <= publishes + 1;
      end if;
      word_ready <= '1';
      if random.chance(stalls) then
        word_ready <= '0';
      end if;
    end if;
  end process;

  play : process

    procedure ask(what : natural; data_bytes : natural; content : std_ulogic_vector(63 downto 0); reply : string;
                  sum : std_ulogic := '0') is
    begin
      clear <= true;
      tick(clock);
      clear   <= false;
      asked   <= '1';
      command <= what;
      checked <= sum;
      size    <= data_bytes;
      bytes   <= content;
      wait until rising_edge(clock) and request_done = '1';
      asked <= '0';
      tick(clock, 2);
      assert heard(1 to length) = reply
        report integer'image(what) & ": " & heard(1 to length) & " instead of " & reply severity failure;
    end procedure;

    variable before : natural;
  begin
    tick(clock, 2);
    reset <= '0';
    tick(clock);
    ask(command_read, 1, x"1200000000000000", "#S_R:12121212;");
    ask(command_read, 2, x"3456000000000000", "$S_R:34343434;", sum => '1');
    check_equal(outside, 2, "single accesses are no block");
    ask(command_write, 5, x"20DEADBEEF000000", "#S_W;");
    check_equal(last_write(39 downto 0), std_ulogic_vector'(x"20DEADBEEF"), "what was written");
    ask(command_read, 1, x"EE00000000000000", "#?E_FBR;");
    ask(command_read, 1, x"FF00000000000000", "#?E_BAT;");
    ask(command_write, 5, x"EE00000000000000", "#?E_FBW;");
    -- A refused request makes no access.
    before := accesses;
    ask(command_unknown, 0, x"0000000000000000", "#?E_ICC;");
    ask(command_read, 0, x"0000000000000000", "#?E_MAB;");
    ask(command_write, 0, x"0000000000000000", "#?E_MAB;");
    ask(command_write, 4, x"2000000000000000", "#?E_MDB;");
    ask(command_read_many, 0, x"0000000000000000", "#?E_MDB;");
    ask(command_read_many, 1, x"0000000000000000", "#?E_IBS;");
    ask(command_read_many, 1, x"2100000000000000", "#?E_IBS;");
    ask(command_read_many, 1, x"0100000000000000", "#S_RM:?E_MAB;");
    ask(command_error, 0, x"0000000000000000", "?F4;");
    check_equal(accesses, before, "bus accesses of refused requests");
    -- One block for each read-many, which an error ends.
    before := blocks;
    ask(command_read_many, 4, x"0301020300000000", "#S_RM:010101010202020203030303;");
    check_equal(blocks, before + 1, "blocks");
    ask(command_read_many, 4, x"0301EE0300000000", "#S_RM:01010101?E_FBR;");
    ask(command_read_many, 4, x"0301FF0300000000", "#S_RM:01010101?E_BAT;");
    ask(command_read_many, 3, x"0301020000000000", "#S_RM:0101010102020202?E_MAB;");
    check_equal(blocks, before + 4, "blocks that ended in an error");
    ask(command_read_configuration, 0, x"0000000000000000",
        "#CNF:01,04,20,0" & integer'image(publish_mode) & ",03E8,02,10,02;");

    if publish_mode > 0 then
      ask(command_read_group, 1, x"0200000000000000", "#?E_ISG;");
      ask(command_write_group_rate, 2, x"0000000000000000", "#?E_MDB;");
      ask(command_write_group_addresses, 3, x"0002010000000000", "#?E_MAB;");
      ask(command_write_group_addresses, 3, x"0011010000000000", "#?E_ILA;");
      ask(command_read_group, 1, x"0100000000000000", "#S_RSI:000000;");
      ask(command_write_group_rate, 3, x"0101020000000000", "#S_WSR;");
      check_equal(rate, std_ulogic_vector'(x"00000102"), "rate");
      ask(command_write_group_addresses, 4, x"0102555600000000", "#S_WSA;");
      ask(command_read_group, 1, x"0100000000000000", "#S_RSI:0102025556;");
      ask(command_write_group_addresses, 4, x"0103111200000000", "#?E_MAB;");
      ask(command_write_group_rate, 2, x"0107000000000000", "#?E_MDB;");
      ask(command_read_group, 1, x"0100000000000000", "#S_RSI:0102025556;");  -- unchanged
      ask(command_write_event_mask, 2, x"0203000000000000", "#S_WIC;");
      ask(command_write_event_mask, 1, x"0700000000000000", "#?E_MDB;");
      ask(command_read_event_mask, 0, x"0000000000000000", "#S_RIC:0203;");
      ask(command_enable_checked_publishing, 0, x"0000000000000000", "#S_EPC;");
      -- A publish: one block.
      before := blocks;
      clear <= true;
      tick(clock);
      clear <= false;
      publish_due <= '1';
      wait until rising_edge(clock) and subscription_request.publish_take = '1';
      publish_due <= '0';
      tick(clock, 200);
      assert heard(1 to length) = "&PUB:01025555555556565656;"
        report "publish: " & heard(1 to length) severity failure;
      check_equal(blocks, before + 1, "blocks of a publish");
      ask(command_disable_publishing, 0, x"0000000000000000", "#S_DPS;");
      -- Neither side starves: if both always wait, the preferred side has three of four turns.
      before := publishes;
      publish_always <= true;
      publish_due    <= '1';
      asked   <= '1';
      command <= command_error;
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

  watchdog(ended, 1 ms, "application_tb");

end architecture;
