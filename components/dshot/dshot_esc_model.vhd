-- SPDX-License-Identifier: BSD-3-Clause
--
-- A speed controller with DShot, for benches. It checks the times of what it hears, and answers if it is bidirectional.
--
-- Generics  bit_time: of a bit. bidirectional: the line is inverted, and each frame gets a reply 30 us behind it.
-- Ports     frames counts the frames. frame is the last one.
--           period is sent back: 3 bits of an exponent, then 9 of a mantissa.
--           bit_length is the length of a bit of the reply, in parts of 1/1000 of the right one.
--           silent: there is no reply. flipped: one bit of the reply is wrong.
-- Errors    Assertions fail for a wrong checksum, and if the line is driven while the reply is on it. They also fail
--           if a high time is neither 3/8 nor 3/4 of a bit. A twelfth more or less is right.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity dshot_esc_model is
  generic (
    bit_time      : time;
    bidirectional : natural
  );
  port (
    wire       : inout std_logic;
    period     : in    unsigned(11 downto 0);
    bit_length : in    positive := 1000;
    silent     : in    boolean  := false;
    flipped    : in    boolean  := false;
    frame      : out   std_ulogic_vector(15 downto 0);
    frames     : out   natural := 0
  );
end entity;

architecture model of dshot_esc_model is

  type codes_t is array (0 to 15) of std_ulogic_vector(4 downto 0);
  constant codes : codes_t := (
    "11001", "11011", "10010", "10011", "11101", "10101", "10110", "10111",
    "11010", "01001", "01010", "01011", "11110", "01101", "01110", "01111");
  constant actives : std_logic_vector(0 to 1) := "10";
  constant active  : std_logic := actives(bidirectional);

begin

  process is
    variable data  : std_ulogic_vector(15 downto 0);
    variable rose, fell : time;
    variable sum   : std_ulogic_vector(3 downto 0);
    variable reply : std_ulogic_vector(15 downto 0);
    variable bits  : std_ulogic_vector(19 downto 0);
    variable level : std_ulogic;

    procedure check_time (found : time; right : time; what : string) is
    begin
      assert abs (found - right) <= right / 12
        report "dshot_esc_model: " & what & " takes " & time'image(found) & ", not " & time'image(right)
        severity error;
    end procedure;

  begin
    wire <= 'Z';
    wait until to_x01(wire) = active;
    for place in 15 downto 0 loop
      rose := now;
      wait until to_x01(wire) /= active for bit_time;
      fell := now;
      data(place) := '1' when fell - rose > bit_time * 9 / 16 else '0';
      if data(place) = '1' then
        check_time(fell - rose, bit_time * 3 / 4, "a one");
      else
        check_time(fell - rose, bit_time * 3 / 8, "a zero");
      end if;
      if place > 0 then
        wait until to_x01(wire) = active for bit_time;
        check_time(now - rose, bit_time, "a bit");
      end if;
    end loop;
    sum := data(15 downto 12) xor data(11 downto 8) xor data(7 downto 4) xor data(3 downto 0);
    assert sum = (3 downto 0 => not active)
      report "dshot_esc_model: the checksum is wrong: x" & to_hstring(data)
      severity error;
    frame  <= data;
    frames <= frames + 1;
    if bidirectional = 1 and not silent then
      wait for rose + bit_time + 30 us - now;
      assert wire = 'H' report "dshot_esc_model: the line is driven before the reply" severity error;
      reply := std_ulogic_vector(period) &
               not std_ulogic_vector(period(11 downto 8) xor period(7 downto 4) xor period(3 downto 0));
      for nibble in 3 downto 0 loop
        bits(5 * nibble + 4 downto 5 * nibble) := codes(to_integer(unsigned(reply(4 * nibble + 3 downto 4 * nibble))));
      end loop;
      if flipped then
        bits(7) := not bits(7);
      end if;
      level := '0';
      wire  <= '0';
      wait for bit_time * 4 / 5 * bit_length / 1000;
      for place in 19 downto 0 loop
        level := level xor bits(place);
        wire  <= level;
        wait for 1 ps;
        assert wire = level report "dshot_esc_model: both drive the line" severity error;
        wait for bit_time * 4 / 5 * bit_length / 1000 - 1 ps;
      end loop;
      wire <= 'Z';
      wait for 1 ps;
    end if;
  end process;

end architecture;
