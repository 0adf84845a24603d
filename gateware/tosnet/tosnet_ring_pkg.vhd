-- SPDX-License-Identifier: BSD-3-Clause
--
-- What the parts of a TosNet node tell each other.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;
  use work.tosnet_wire_pkg.all;

package tosnet_ring_pkg is

  -- A byte to send, or the end of its packet (tosnet_packet_out).
  subtype item_t is std_ulogic_vector(8 downto 0);

  constant item_end    : item_t := "100000000";
  constant item_poison : item_t := "100000001";

  -- The watchdog of the published network, in bits of its line.
  constant tosnet_watchdog_bits : positive := tosnet_ring_watchdog_us_c * (tosnet_ring_baud_hz_c / 100000) / 10;

  -- Why a ring is not, or no longer, running.
  subtype trouble_t is std_ulogic_vector(3 downto 0);

  constant trouble_none       : trouble_t := x"0";
  constant trouble_silence    : trouble_t := x"1"; -- the watchdog: no good packet came
  constant trouble_line       : trouble_t := x"2"; -- the line from the node before has no edges
  constant trouble_restart    : trouble_t := x"3"; -- another node began the election again
  constant trouble_no_master  : trouble_t := x"4"; -- the lowest id is that of a node that may not be master
  constant trouble_same_id    : trouble_t := x"5"; -- two nodes have the same id
  constant trouble_too_many   : trouble_t := x"6"; -- there are more nodes than this one has room for
  constant trouble_other_list : trouble_t := x"7"; -- the list of nodes does not have this node at its address
  constant trouble_masks      : trouble_t := x"8"; -- the two masks of a node differ, or one is missing
  constant trouble_foreign    : trouble_t := x"9"; -- a DATA packet is of another ring
  constant trouble_way        : trouble_t := x"A"; -- a packet came back earlier or later than the one before

  type trouble_vector_t is array (natural range <>) of trouble_t;

  -- What tosnet_node tells the one who keeps the words, tosnet_words.
  type from_node_t is record
    running          : std_ulogic;
    is_master        : std_ulogic;
    sends            : std_ulogic;
    strobe           : std_ulogic;
    strobe_fresh     : std_ulogic;
    received_valid   : std_ulogic;
    received_address : std_ulogic_vector(9 downto 0);
    received_word    : std_ulogic_vector(31 downto 0);
    send_address     : std_ulogic_vector(9 downto 0);
  end record;

  type from_node_vector_t is array (natural range <>) of from_node_t;

  -- A byte of two halves: a command or the kind of a slot, and what it is about.
  function halves (high : natural range 0 to 15; low : std_ulogic_vector(3 downto 0)) return byte_t;

end package;

package body tosnet_ring_pkg is

  function halves (high : natural range 0 to 15; low : std_ulogic_vector(3 downto 0)) return byte_t is
  begin
    return std_logic_vector(to_unsigned(high, 4)) & low;
  end function;

end package body;
