-- SPDX-License-Identifier: BSD-3-Clause
--
-- A node of a TosNet ring that is not its master: what a joint, a drive or an I/O box needs.
--
--   line --> tosnet_node <--> tosnet_words <--> read_words, write_words        tosnet_node --> line
--
-- Words     read_words are the node's own IN words, or OUT words of others, at read_addresses. write_words are its OUT
--           words, at write_addresses. docs/gateware/tosnet_words.md tells when they change.
-- Safe      While `running` is low, no PC commands this node. Then the words of safe_addresses have their safe_values.
--           The PC's program ends and the ring goes on? Then the PC's dead-man writes them.
-- Reset     All words are zero, but for those with a safe value, and the node joins the ring.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_slave_node is
  generic (
    id                : natural range 1 to 15        := 2;
    registers         : std_ulogic_vector(7 downto 0) := x"01";
    read_addresses    : tosnet_address_vector_t      := tosnet_no_addresses_c;
    write_addresses   : tosnet_address_vector_t      := tosnet_no_addresses_c;
    safe_addresses    : tosnet_address_vector_t      := tosnet_no_addresses_c; -- tosnet_words
    safe_values       : word_vector_t                := tosnet_no_words_c;
    most_nodes        : positive range 2 to 15       := 15;
    clocks_per_bit    : positive                     := 4; -- tosnet_node
    samples_per_clock : positive                     := 1;
    hop_bits          : positive                     := tosnet_ring_hop_bits_c;
    watchdog_bits     : positive                     := tosnet_watchdog_bits
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic; -- synchronous
    line_in     : in  std_ulogic_vector(samples_per_clock - 1 downto 0); -- of `clock`: from a synchroniser
    line_out    : out std_ulogic;
    running     : out std_ulogic;
    strobe      : out std_ulogic;
    exchange    : out std_ulogic; -- read_words are new
    trouble     : out trouble_t;
    read_words  : out word_vector_t(0 to read_addresses'length - 1);
    write_words : in  word_vector_t(0 to write_addresses'length - 1)
  );
end entity;

architecture rtl of tosnet_slave_node is

  signal strobe_fresh, received_valid   : std_ulogic;
  signal received_address, send_address : std_ulogic_vector(9 downto 0);
  signal received_word, send_word       : std_ulogic_vector(31 downto 0);

begin

  node : entity work.tosnet_node
    generic map (
      clocks_per_bit => clocks_per_bit, samples_per_clock => samples_per_clock, hop_bits => hop_bits,
      watchdog_bits => watchdog_bits, may_be_master => false, most_nodes => most_nodes, channel => false)
    port map (
      clock => clock, reset => reset, line_in => line_in, line_out => line_out,
      id => std_ulogic_vector(to_unsigned(id, 4)), registers => registers, running => running, is_master => open,
      own_address => open, nodes => open, trouble => trouble, restarted => open, damaged => open, strobe => strobe,
      strobe_fresh => strobe_fresh, received_valid => received_valid, received_address => received_address,
      received_word => received_word, send_address => send_address, send_word => send_word, table_entry => open,
      table_mask => open, to_ring_ready => open, from_ring_valid => open, from_ring_data => open,
      from_ring_last => open, from_ring_id => open, message_lost => open);

  words : entity work.tosnet_words
    generic map (
      read_addresses => read_addresses, write_addresses => write_addresses, safe_addresses => safe_addresses,
      safe_values => safe_values)
    port map (
      clock => clock, reset => reset, running => running, strobe => strobe, strobe_fresh => strobe_fresh,
      received_valid => received_valid, received_address => received_address, received_word => received_word,
      send_address => send_address, send_word => send_word, exchange => exchange, missing => open,
      read_words => read_words, write_words => write_words);

end architecture;
