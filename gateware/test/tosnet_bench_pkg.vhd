-- SPDX-License-Identifier: BSD-3-Clause
--
-- The rings of the benches: who is in them, and what a node has sent.

library ieee;
  use ieee.std_logic_1164.all;
  use work.tosnet_ring_pkg.all;

package tosnet_bench_pkg is

  type ring_node_t is record
    id        : natural range 0 to 15;
    registers : std_ulogic_vector(7 downto 0);
  end record;

  type ring_t is array (natural range <>) of ring_node_t; -- in the order of the line

  -- A ring of so many nodes. Its master is not the first one if it has more than two.
  function ring_of (nodes : positive; kind : string) return ring_t;

  -- What the node has sent since the last look: hexadecimal digits, and "." or "!" for the end of a good or a poisoned
  -- packet.
  type sent_items_t is protected
    procedure add (item : item_t);
    impure function taken return string;
  end protected;

end package;

package body tosnet_bench_pkg is

  function ring_of (nodes : positive; kind : string) return ring_t is
    type masks_t is array (0 to 3) of std_ulogic_vector(7 downto 0);
    constant ids    : string  := "936B2D17F4A58CE";
    constant mixed  : masks_t := (x"01", x"84", x"00", x"03");
    variable result : ring_t(0 to nodes - 1);
    variable digit  : character;
  begin
    for place in result'range loop
      digit := ids(1 + place);
      result(place).id := character'pos(digit) - character'pos('0') when digit <= '9' else
                          character'pos(digit) - character'pos('A') + 10;
      result(place).registers := x"01";
      if kind = "mixed" then
        result(place).registers := mixed(place mod 4);
      elsif kind = "full" then
        result(place).registers := x"FF";
      end if;
    end loop;
    return result;
  end function;

  type sent_items_t is protected body
    variable text : string(1 to 400);
    variable last : natural := 0;

    procedure add (item : item_t) is
    begin
      if item = item_end or item = item_poison then
        text(last + 1) := '.' when item = item_end else '!';
        last := last + 1;
      else
        text(last + 1 to last + 2) := to_hstring(item(7 downto 0));
        last := last + 2;
      end if;
    end procedure;

    impure function taken return string is
      constant result : string := text(1 to last);
    begin
      last := 0;
      return result;
    end function;
  end protected body;

end package body;
