-- SPDX-License-Identifier: BSD-3-Clause
-- tosnet_node with all features, without the ports that show the ring.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;

entity narrow_tosnet_node is
  port (
    clock            : in  std_ulogic;
    reset            : in  std_ulogic;
    line_in          : in  std_ulogic;
    line_out         : out std_ulogic;
    id               : in  std_ulogic_vector(3 downto 0);
    registers        : in  std_ulogic_vector(7 downto 0);
    running          : out std_ulogic;
    is_master        : out std_ulogic;
    restarted        : out std_ulogic;
    damaged          : out std_ulogic;
    strobe           : out std_ulogic;
    strobe_fresh     : out std_ulogic;
    received_valid   : out std_ulogic;
    received_address : out std_ulogic_vector(9 downto 0);
    received_word    : out std_ulogic_vector(31 downto 0);
    send_address     : out std_ulogic_vector(9 downto 0);
    send_word        : in  std_ulogic_vector(31 downto 0);
    to_ring_valid    : in  std_ulogic;
    to_ring_ready    : out std_ulogic;
    to_ring_data     : in  std_ulogic_vector(31 downto 0);
    to_ring_last     : in  std_ulogic_vector(1 downto 0);
    to_ring_id       : in  std_ulogic_vector(3 downto 0);
    from_ring_valid  : out std_ulogic;
    from_ring_ready  : in  std_ulogic;
    from_ring_data   : out std_ulogic_vector(31 downto 0);
    from_ring_last   : out std_ulogic_vector(1 downto 0);
    from_ring_id     : out std_ulogic_vector(3 downto 0);
    message_lost     : out std_ulogic
  );
end entity;

architecture rtl of narrow_tosnet_node is
begin
  whole : entity unitylink.tosnet_node
    generic map (most_nodes => 15)
    port map (
      clock => clock, reset => reset, line_in(0) => line_in, line_out => line_out, id => id, registers => registers,
      running => running, is_master => is_master, own_address => open, nodes => open, trouble => open,
      restarted => restarted, damaged => damaged, strobe => strobe, strobe_fresh => strobe_fresh,
      received_valid => received_valid, received_address => received_address, received_word => received_word,
      send_address => send_address, send_word => send_word, table_entry => open, table_mask => open,
      to_ring_valid => to_ring_valid, to_ring_ready => to_ring_ready, to_ring_data => to_ring_data,
      to_ring_last => to_ring_last, to_ring_id => to_ring_id, from_ring_valid => from_ring_valid,
      from_ring_ready => from_ring_ready, from_ring_data => from_ring_data, from_ring_last => from_ring_last,
      from_ring_id => from_ring_id, message_lost => message_lost);
end architecture;
