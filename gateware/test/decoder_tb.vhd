-- SPDX-License-Identifier: BSD-3-Clause
--
-- decoder: the meaning of each of the 256 bytes, from an independent table, under random stalls.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.datalink_pkg.all;

entity decoder_tb is
end entity;

architecture bench of decoder_tb is

  signal clock           : std_ulogic := '0';
  signal reset           : std_ulogic := '1';
  signal ended           : boolean := false;
  signal rx_valid        : std_ulogic := '0';
  signal rx_ready        : std_ulogic;
  signal rx_data         : std_ulogic_vector(7 downto 0) := x"00";
  signal character_valid : std_ulogic;
  signal character_ready : std_ulogic := '0';
  signal character_data  : character_t;

  function among(c : character; set : string) return std_ulogic is
  begin
    for place in set'range loop
      if set(place) = c then
        return '1';
      end if;
    end loop;
    return '0';
  end function;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.decoder
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      character_valid => character_valid, character_ready => character_ready, character_data => character_data);

  source : process
    variable random : random_t;
  begin
    random.seed(3);
    wait until rising_edge(clock) and reset = '0';
    for byte in 0 to 255 loop
      pause(clock, random, 30);
      send(clock, rx_valid, rx_ready, rx_data, std_ulogic_vector(to_unsigned(byte, 8)));
    end loop;
    wait;
  end process;

  judge : process
    variable random : random_t;
    variable c      : character;
    variable value  : natural;
    constant digits  : string := "0123456789abcdefABCDEF";
    constant letters : string := "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
  begin
    random.seed(4);
    wait until rising_edge(clock);
    reset <= '0';
    for byte in 0 to 255 loop
      while random.chance(30) loop
        character_ready <= '0';
        wait until rising_edge(clock);
      end loop;
      character_ready <= '1';
      wait until rising_edge(clock) and character_valid = '1';
      character_ready <= '0';
      c := character'val(byte);
      check_equal(to_integer(unsigned(character_data.data)), byte, "byte");
      check_equal(character_data.request, among(c, "#$"), "request of " & integer'image(byte));
      check_equal(character_data.checked, among(c, "$"), "checked of " & integer'image(byte));
      check_equal(character_data.publish, among(c, "%&"), "publish of " & integer'image(byte));
      check_equal(character_data.colon, among(c, ":"), "colon of " & integer'image(byte));
      check_equal(character_data.star, among(c, "*"), "star of " & integer'image(byte));
      check_equal(character_data.line_end, among(c, LF & CR), "line_end of " & integer'image(byte));
      check_equal(character_data.separator, among(c, HT & " ,."), "separator of " & integer'image(byte));
      check_equal(character_data.letter, among(c, letters), "letter of " & integer'image(byte));
      check_equal(character_data.digit, among(c, digits), "digit of " & integer'image(byte));
      value := 0;
      if among(c, digits) = '1' then
        value := digit_value(c);
      end if;
      check_equal(to_integer(unsigned(character_data.value)), value, "value of " & integer'image(byte));
    end loop;
    report_passed("decoder_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "decoder_tb");

end architecture;
