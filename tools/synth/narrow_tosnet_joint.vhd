-- SPDX-License-Identifier: BSD-3-Clause
-- tosnet_node as a joint has it: never master, in a ring of at most five, without messages. Its words are outside.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.tosnet_ring_pkg.all;

entity narrow_tosnet_joint is
  port (
    clock            : in  std_ulogic;
    reset            : in  std_ulogic;
    line_in          : in  std_ulogic;
    line_out         : out std_ulogic;
    id               : in  std_ulogic_vector(3 downto 0);
    registers        : in  std_ulogic_vector(7 downto 0);
    running          : out std_ulogic;
    is_master        : out std_ulogic;
    own_address      : out unsigned(3 downto 0);
    nodes            : out unsigned(3 downto 0);
    trouble          : out trouble_t;
    restarted        : out std_ulogic;
    damaged          : out std_ulogic;
    strobe           : out std_ulogic;
    strobe_fresh     : out std_ulogic;
    received_valid   : out std_ulogic;
    received_address : out std_ulogic_vector(9 downto 0);
    received_word    : out std_ulogic_vector(31 downto 0);
    send_address     : out std_ulogic_vector(9 downto 0);
    send_word        : in  std_ulogic_vector(31 downto 0)
  );
end entity;

architecture rtl of narrow_tosnet_joint is
begin
  whole : entity unitylink.tosnet_node
    generic map (may_be_master => false, most_nodes => 5, channel => false)
    port map (
      clock => clock, reset => reset, line_in(0) => line_in, line_out => line_out, id => id, registers => registers,
      running => running, is_master => is_master, own_address => own_address, nodes => nodes, trouble => trouble,
      restarted => restarted, damaged => damaged, strobe => strobe, strobe_fresh => strobe_fresh,
      received_valid => received_valid, received_address => received_address, received_word => received_word,
      send_address => send_address, send_word => send_word, table_entry => open, table_mask => open,
      to_ring_ready => open, from_ring_valid => open, from_ring_data => open, from_ring_last => open,
      from_ring_id => open, message_lost => open);
end architecture;
