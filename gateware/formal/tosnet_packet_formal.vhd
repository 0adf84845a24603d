-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of tosnet_packet_out and tosnet_packet_in together, over a line without errors that carries a symbol in
-- each clock: what goes in comes out, and is judged as it was meant. Any one byte is followed from its taking to its
-- giving.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.protocol_pkg.all;

entity tosnet_packet_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    go         : in std_ulogic;
    item_valid : in std_ulogic;
    item_data  : in std_ulogic_vector(8 downto 0);
    mark       : in std_ulogic  -- follow the byte that is taken now
  );
end entity;

architecture properties of tosnet_packet_formal is

  signal begun        : std_ulogic := '0'; -- the reset of power-up is over
  signal item_ready   : std_ulogic;
  signal data         : byte_t;
  signal control      : std_ulogic;
  signal symbol       : byte_t     := x"3C";
  signal is_control   : std_ulogic := '1';
  signal start, valid, done, good : std_ulogic;
  signal byte_out     : byte_t;

  -- The packet that goes in, and how the one before ended.
  signal dry          : std_ulogic := '0'; -- no item was there in its middle
  signal taken        : unsigned(4 downto 0) := "00000";
  signal meant_good   : std_ulogic := '0';
  signal meant_bytes  : unsigned(4 downto 0) := "00000";

  -- The packet that comes out.
  signal given        : unsigned(4 downto 0) := "00000";

  -- The followed byte.
  signal follows      : std_ulogic := '0';
  signal place        : unsigned(4 downto 0) := "00000";
  signal followed     : byte_t := x"00";

begin

  default clock is rising_edge(clk);

  sender : entity work.tosnet_packet_out
    port map (
      clock => clk, reset => reset, go => go, item_valid => item_valid, item_ready => item_ready,
      item_data => item_data, busy => open, take => '1', data => data, control => control);

  receiver : entity work.tosnet_packet_in
    port map (
      clock => clk, reset => reset, symbol_valid => '1', symbol_data => symbol, control => is_control, wrong => '0',
      start => start, valid => valid, data => byte_out, done => done, good => good);

  process (clk) is
  begin
    if rising_edge(clk) then
      begun      <= '1';
      symbol     <= data;
      is_control <= control;
      if item_ready = '1' and (item_valid = '0' or item_data(8) = '1') and dry = '0' then
        meant_good  <= item_valid and not item_data(0) and to_bit(taken /= 0);
        meant_bytes <= taken;
        taken       <= "00000";
        dry         <= not item_valid;
      elsif item_ready = '1' and item_valid = '1' and dry = '1' then
        dry <= not item_data(8);
      elsif item_ready = '1' and item_valid = '1' then
        taken <= taken + 1;
        if mark = '1' and follows = '0' then
          follows  <= '1';
          place    <= taken;
          followed <= item_data(7 downto 0);
        end if;
      end if;
      if start = '1' then
        given <= "00000";
      elsif valid = '1' then
        given <= given + 1;
      end if;
      if done = '1' then
        follows <= '0';
      end if;
      if reset = '1' then
        symbol     <= x"3C";
        is_control <= '1';
        dry        <= '0';
        taken      <= "00000";
        follows    <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up.
  reset_first : assume always reset = not begun;

  -- An item that is offered stays until it is taken.
  items_stay : assume always item_valid = '1' and item_ready = '0' and reset = '0' ->
               next (item_valid = '1' and item_data = prev(item_data));

  -- A packet is judged good if, and only if, it had a byte, was not poisoned, and did not run dry.
  judged : assert always done = '1' and begun = '1' and reset = '0' -> good = meant_good;

  -- It has as many bytes as went in until then.
  none_lost : assert always done = '1' and begun = '1' and reset = '0' -> given = meant_bytes;

  -- A byte that went in comes out at its place.
  byte_kept : assert always valid = '1' and follows = '1' and given = place and begun = '1' and reset = '0' ->
              byte_out = followed;

  -- A good packet of two bytes comes through.
  good_packet : cover {done = '1' and good = '1' and meant_bytes = 2};

  -- A poisoned packet comes through.
  poisoned_packet : cover {done = '1' and good = '0' and meant_bytes = 2};

end architecture;
