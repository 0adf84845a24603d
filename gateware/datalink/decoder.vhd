-- SPDX-License-Identifier: BSD-3-Clause
--
-- Classifies each received byte by its meaning in the classic protocol.
--
-- Latency   One clock (a register stage). One byte per clock.
-- Pressure  valid/ready on both sides. It holds one character while character_ready is low.
-- Errors    None. A byte without a meaning has no flag set, and the receiver refuses it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity decoder is
  port (
    clock           : in  std_ulogic;
    reset           : in  std_ulogic;
    rx_valid        : in  std_ulogic;
    rx_ready        : out std_ulogic;
    rx_data         : in  byte_t;
    character_valid : out std_ulogic;
    character_ready : in  std_ulogic;
    character_data  : out character_t
  );
end entity;

architecture rtl of decoder is

  -- People put these between digits and letters. Devices send only the comma.
  constant tab   : byte_t := x"09";
  constant blank : byte_t := x"20";
  constant dot   : byte_t := x"2E";

  function classify(data : byte_t) return character_t is
    variable c     : character_t := (data => data, value => (others => '0'), others => '0');
    variable place : unsigned(4 downto 0);  -- of a letter in the alphabet; A is 1
  begin
    case data is
      when byte_plain_head_c =>
        c.request := '1';
      when byte_checked_head_c =>
        c.request := '1';
        c.checked := '1';
      when byte_plain_publish_c | byte_checked_publish_c =>
        c.publish := '1';
      when byte_data_mark_c =>
        c.colon := '1';
      when byte_checksum_mark_c =>
        c.star := '1';
      when byte_line_feed_c | byte_carriage_return_c =>
        c.line_end := '1';
      when tab | blank | dot | byte_field_separator_c =>
        c.separator := '1';
      when others =>
        place := unsigned(data(4 downto 0));
        if data(7 downto 6) = "01" and place >= 1 and place <= 26 then
          c.letter := '1';
          if place <= 6 then
            c.digit := '1';
            c.value := std_ulogic_vector(place(3 downto 0) + 9);
          end if;
        elsif data(7 downto 4) = "0011" and unsigned(data(3 downto 0)) <= 9 then
          c.digit := '1';
          c.value := data(3 downto 0);
        end if;
    end case;
    return c;
  end function;

  signal full : std_ulogic := '0';

begin

  rx_ready        <= not full or character_ready;
  character_valid <= full;

  stage : process (clock)
  begin
    if rising_edge(clock) then
      if full = '0' or character_ready = '1' then
        full <= rx_valid;
        if rx_valid = '1' then
          character_data <= classify(rx_data);
        end if;
      end if;
      if reset = '1' then
        full <= '0';
      end if;
    end if;
  end process;

end architecture;
