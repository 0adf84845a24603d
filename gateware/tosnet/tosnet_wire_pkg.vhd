-- SPDX-License-Identifier: BSD-3-Clause
-- The constants of the wire protocols. Generated from protocol/protocol.toml by protocol/generate.py; edit there.
library ieee;
use ieee.std_logic_1164.all;

package tosnet_wire_pkg is

  -- tosnet_ring
  constant tosnet_ring_nodes_max_c : natural := 15;
  constant tosnet_ring_baud_hz_c : natural := 12500000;
  constant tosnet_ring_byte_bits_c : natural := 10;
  constant tosnet_ring_rest_bytes_c : natural := 18;
  constant tosnet_ring_register_bytes_c : natural := 32;
  constant tosnet_ring_hop_bits_c : natural := 75;
  constant tosnet_ring_watchdog_us_c : natural := 13107;

  -- tosnet_wire
  constant tosnet_wire_idle_c : natural := 60;
  constant tosnet_wire_begin_c : natural := 188;
  constant tosnet_wire_first_seed_c : natural := 85;
  constant tosnet_wire_crc_polynomial_c : natural := 101;
  constant tosnet_wire_crc_check_c : natural := 223;
  constant tosnet_wire_wide_crc_polynomial_c : natural := 4129;
  constant tosnet_wire_wide_crc_check_c : natural := 12739;
  constant tosnet_wire_master_discovery_c : natural := 2;
  constant tosnet_wire_master_set_c : natural := 3;
  constant tosnet_wire_network_discovery_c : natural := 4;
  constant tosnet_wire_network_set_c : natural := 5;
  constant tosnet_wire_register_discovery_c : natural := 6;
  constant tosnet_wire_register_set_c : natural := 7;
  constant tosnet_wire_data_c : natural := 10;
  constant tosnet_wire_message_from_master_c : natural := 9;
  constant tosnet_wire_no_message_from_master_c : natural := 1;
  constant tosnet_wire_message_from_node_c : natural := 10;
  constant tosnet_wire_no_message_from_node_c : natural := 2;
  constant tosnet_wire_message_bytes_c : natural := 12;

end package tosnet_wire_pkg;
