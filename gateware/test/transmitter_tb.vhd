-- SPDX-License-Identifier: BSD-3-Clause
--
-- transmitter: turns words of every kind into characters, with every checksum, under random stalls. Without stalls, one
-- byte per clock.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.datalink_pkg.all;
use work.instruction_pkg.all;

entity transmitter_tb is
  generic (
    checksum : string  := "crc8";
    stalls   : natural := 40  -- percent
  );
end entity;

architecture bench of transmitter_tb is

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic := '1';
  signal ended       : boolean := false;
  signal word_valid  : std_ulogic := '0';
  signal word_ready  : std_ulogic;
  signal word_data   : word_t := (others => '0');
  signal tx_valid    : std_ulogic;
  signal tx_ready    : std_ulogic := '1';
  signal tx_data     : std_ulogic_vector(7 downto 0);
  signal tx_last     : std_ulogic;
  signal tx_publish  : std_ulogic;
  signal head_heard  : character := ' ';

  signal heard  : string(1 to 200);
  signal length : natural := 0;
  signal clear  : boolean := false;
  signal first, last, now_clock : natural := 0;

begin

  clock     <= not clock after 1 ns when not ended;
  now_clock <= now_clock + 1 when rising_edge(clock);

  transmit : entity work.transmitter
    generic map (checksum => checksum)
    port map (
      clock => clock, reset => reset,
      word_valid => word_valid, word_ready => word_ready, word_data => word_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  listen : process (clock)
    variable random   : random_t;
    variable heard_of : character;
  begin
    if rising_edge(clock) then
      if clear then
        length <= 0;
      elsif tx_valid = '1' and tx_ready = '1' then
        heard_of := head_heard;
        if length = 0 then
          first      <= now_clock;
          heard_of   := character_of(tx_data);
          head_heard <= heard_of;
        end if;
        check((tx_last = '1') = (tx_data = x"0A"), "tx_last with " & to_hstring(tx_data));
        check((tx_publish = '1') = (heard_of = '%' or heard_of = '&'), "tx_publish of " & heard_of);
        last <= now_clock;
        heard(length + 1) <= character_of(tx_data);
        length <= length + 1;
      end if;
      tx_ready <= '1';
      if random.chance(stalls) then
        tx_ready <= '0';
      end if;
    end if;
  end process;

  play : process

    procedure give(kind : std_ulogic_vector(2 downto 0); content : std_ulogic_vector(7 downto 0)) is
    begin
      send(clock, word_valid, word_ready, word_data, kind & content);
    end procedure;

    -- Sends letters and marks, as the application does.
    procedure give(text : string) is
    begin
      for place in text'range loop
        give(letter(text(place))(kind_f), letter(text(place))(number_f));
      end loop;
    end procedure;

    procedure head(c : character) is
    begin
      give(word_head, byte_of(c));
    end procedure;

    procedure bytes(data : std_ulogic_vector) is
      constant flat : std_ulogic_vector(data'length - 1 downto 0) := data;
    begin
      for byte in data'length / 8 - 1 downto 0 loop
        give(word_byte, flat(8 * byte + 7 downto 8 * byte));
      end loop;
    end procedure;

    procedure expect(text : string) is
    begin
      give(word_tail, x"00");
      wait_clocks(clock, 40);
      assert heard(1 to length) = text & LF
        report "transmitter_tb: " & heard(1 to length) & " instead of " & text severity failure;
      if stalls = 0 then
        check_equal(last - first + 1, length, "clocks of " & text);
      end if;
      clear <= true;
      wait until rising_edge(clock);
      clear <= false;
      wait until rising_edge(clock);
    end procedure;

    function sum(crc8 : string; xor8 : string) return string is
    begin
      if checksum = "crc8" then
        return "*" & crc8;
      elsif checksum = "xor" then
        return "*" & xor8;
      end if;
      return "";
    end function;

  begin
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    wait until rising_edge(clock);
    head('#');
    give("S_R:");
    bytes(x"40DE1212");
    expect("#S_R:40de1212");
    head('$');
    give("S_R:");
    bytes(x"40DE1212");
    expect("$S_R:40de1212" & sum("2d", "c0"));
    head('&');
    give("PUB:");
    bytes(x"000240de101040de1111");
    expect("&PUB:000240de101040de1111" & sum("ba", "45"));
    head('%');
    give("PUB:");
    bytes(x"00");
    expect("%PUB:00");
    -- A message that ends with an error has no checksum, and the next message has its own.
    head('$');
    give("S_RM:");
    bytes(x"A9");
    give("?E_BAT");
    expect("$S_RM:a9?E_BAT");
    head('$');
    give("S_W");
    expect("$S_W" & sum("f4", "5b"));
    head('?');
    bytes(x"F4");
    expect("?f4");
    head('#');
    give(",");
    bytes(x"2C0123456789ABCDEF");
    expect("#,2c0123456789abcdef");
    report_passed("transmitter_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "transmitter_tb");

end architecture;
