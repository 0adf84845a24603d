-- SPDX-License-Identifier: BSD-3-Clause
--
-- A node of a TosNet ring that is not its master: what a joint, a drive or an I/O box needs.
--
--   line --> tosnet_rings --> line        tosnet_rings <--> read_words, write_words
--
-- Words     read_words are the node's own IN words, or OUT words of others, at read_addresses. write_words are its OUT
--           words, at write_addresses. docs/gateware/tosnet_words.md tells when they change.
-- Safe      While `running` is low, no PC commands this node. Then the words of safe_addresses have their safe_values.
--           The PC's program ends and the ring goes on? Then the PC's dead-man writes them.
-- Rings     One, or two for redundancy (tosnet_rings). The first one is in the low bits of line_in and line_out.
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
    watchdog_bits     : positive                     := tosnet_watchdog_bits;
    check_bytes       : positive range 1 to 2        := 1;
    exact_hops        : boolean                      := false;
    line_clocks       : natural                      := 2;
    rings             : positive range 1 to 2        := 1;   -- tosnet_rings
    time_address      : natural range 0 to 1024      := 1024;
    spec_word         : std_ulogic_vector(31 downto 0) := x"00000000" -- tosnet_exchange
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic; -- synchronous
    line_in     : in  std_ulogic_vector(rings * samples_per_clock - 1 downto 0); -- of `clock`: from a synchroniser
    line_out    : out std_ulogic_vector(rings - 1 downto 0);
    running     : out std_ulogic; -- any ring
    strobe      : out std_ulogic;
    exchange    : out std_ulogic; -- read_words are new
    troubles    : out trouble_vector_t(0 to rings - 1);
    read_words  : out word_vector_t(0 to read_addresses'length - 1);
    write_words : in  word_vector_t(0 to write_addresses'length - 1);
    time_valid  : out std_ulogic; -- tosnet_clock
    time_bits   : out unsigned(31 downto 0)
  );
end entity;

architecture rtl of tosnet_slave_node is

begin

  nodes : entity work.tosnet_rings
    generic map (
      id => id, registers => registers, read_addresses => read_addresses, write_addresses => write_addresses,
      safe_addresses => safe_addresses, safe_values => safe_values, rings => rings, time_address => time_address,
      may_be_master => false, most_nodes => most_nodes, clocks_per_bit => clocks_per_bit,
      samples_per_clock => samples_per_clock, hop_bits => hop_bits, watchdog_bits => watchdog_bits, channel => false,
      check_bytes => check_bytes, exact_hops => exact_hops, line_clocks => line_clocks,
      spec_word => spec_word)
    port map (
      clock => clock, reset => reset, line_in => line_in, line_out => line_out, running => running,
      rings_running => open, is_master => open, own_address => open, nodes => open, troubles => troubles,
      damaged => open, strobe => strobe, exchange => exchange, missing => open, read_words => read_words,
      write_words => write_words,
      judged => open, other_spec => open, time_valid => time_valid, time_bits => time_bits, table_entry => open,
      table_mask => open, to_ring_ready => open, from_ring_valid => open, from_ring_data => open,
      from_ring_last => open, from_ring_id => open);

end architecture;
