-- SPDX-License-Identifier: BSD-3-Clause
--
-- The PC's node of a TosNet ring: tosnet_slave's memory map on the Wishbone bus, and the ring behind it.
--
--   Wishbone --> tosnet_slave <--> tosnet_rings <--> line
--
-- Map       As in tosnet_slave. The network registers, the status and the counters are those of the ring.
-- Online    The ring runs, this node is its master, and every word of read_addresses comes. The status says which of
--           the first two is not so, and the network registers say which node or register is absent. While it is low,
--           nothing is exchanged and commits wait.
-- Rings     One, or two for redundancy (tosnet_rings), the first in the low bits of line_in and line_out. One ring that
--           runs is enough to be online, and the status tells which one does not. A cycle that is damaged in either is
--           counted.
-- Spec      With spec_word, the bridge is online when all members have answered it once, and none has told another spec
--           than this one. The status names a node that has. A node that does not tell, as one of 2010, passes.
-- Cycle     `cycle` is high for one clock in each cycle of the ring whose words are good. So an event group on it
--           publishes the words of all nodes of one cycle.
-- Latency   A commit takes effect at the next strobe, and all nodes have its words at the strobe after it. A word of a
--           node is in the memory one cycle after the strobe at which the node sampled it.
-- Errors    As in tosnet_slave. A cycle with a damaged or lost packet exchanges nothing and is counted.
-- Reset     All words are zero, no commit is pending, and the node joins the ring.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_bridge is
  generic (
    master_id          : natural range 0 to 15         := 1;
    master_registers   : std_ulogic_vector(7 downto 0) := x"00";
    write_addresses    : tosnet_address_vector_t       := tosnet_no_addresses_c;
    read_addresses     : tosnet_address_vector_t       := tosnet_no_addresses_c;
    max_skipped_writes : natural range 0 to 65535      := 0;
    async_depth        : natural range 0 to 2 ** 16    := 128;
    most_nodes         : positive range 2 to 15        := 15;
    clocks_per_bit     : positive                      := 4; -- tosnet_node
    samples_per_clock  : positive                      := 1;
    hop_bits           : positive                      := tosnet_ring_hop_bits_c;
    watchdog_bits      : positive                      := tosnet_watchdog_bits;
    check_bytes        : positive range 1 to 2         := 1;
    exact_hops         : boolean                       := false;
    line_clocks        : natural                       := 2;
    rings              : positive range 1 to 2         := 1;   -- tosnet_rings
    time_address       : natural range 0 to 1024       := 1024;
    spec_word          : std_ulogic_vector(31 downto 0) := x"00000000" -- tosnet_exchange
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    line_in      : in  std_ulogic_vector(rings * samples_per_clock - 1 downto 0); -- of `clock`: from a synchroniser
    line_out     : out std_ulogic_vector(rings - 1 downto 0);

    cycle     : out std_ulogic;
    committed : out std_ulogic;
    halted    : out std_ulogic;
    online    : out std_ulogic;
    troubles  : out trouble_vector_t(0 to rings - 1);

    time_valid : out std_ulogic; -- tosnet_clock
    time_bits  : out unsigned(31 downto 0)
  );
end entity;

architecture rtl of tosnet_bridge is

  signal running, is_master, damaged, exchange, missing : std_ulogic;
  signal own_address, nodes, table_index : unsigned(3 downto 0);
  signal table_entry, table_mask         : std_ulogic_vector(7 downto 0);
  signal each_running : std_ulogic_vector(rings - 1 downto 0);
  signal rings_down   : std_ulogic_vector(1 downto 0) := "00";
  signal judged      : std_ulogic;
  signal other_spec  : unsigned(3 downto 0);
  signal write_words : word_vector_t(0 to write_addresses'length - 1);
  signal read_words  : word_vector_t(0 to read_addresses'length - 1);
  signal to_valid, to_ready, from_valid, from_ready : std_ulogic;
  signal to_data, from_data : std_ulogic_vector(31 downto 0);
  signal to_last, from_last : std_ulogic_vector(1 downto 0);
  signal to_id, from_id     : std_ulogic_vector(3 downto 0);

begin

  online <= running and is_master and not missing and judged and to_bit(other_spec = 0);

  slave : entity work.tosnet_slave
    generic map (
      master_id => master_id, master_registers => master_registers, write_addresses => write_addresses,
      read_addresses => read_addresses, cycle_clocks => 0, max_skipped_writes => max_skipped_writes,
      async_depth => async_depth)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      cycle => cycle, committed => committed, halted => halted, write_words => write_words, read_words => read_words,
      online => online, damaged => damaged, other_spec => other_spec, rings_down => rings_down,
      network_cycle => exchange, is_master => is_master, own_address => own_address, ring_nodes => nodes,
      table_index => table_index, table_entry => table_entry, table_mask => table_mask,
      to_node_valid => to_valid, to_node_ready => to_ready, to_node_data => to_data, to_node_last => to_last,
      to_node_id => to_id, from_node_valid => from_valid, from_node_ready => from_ready, from_node_data => from_data,
      from_node_last => from_last, from_node_id => from_id);

  behind : entity work.tosnet_rings
    generic map (
      id => master_id, registers => master_registers, read_addresses => read_addresses,
      write_addresses => write_addresses, rings => rings, time_address => time_address, most_nodes => most_nodes,
      clocks_per_bit => clocks_per_bit, samples_per_clock => samples_per_clock, hop_bits => hop_bits,
      watchdog_bits => watchdog_bits, channel => async_depth > 0, check_bytes => check_bytes,
      exact_hops => exact_hops, line_clocks => line_clocks, spec_word => spec_word)
    port map (
      clock => clock, reset => reset, line_in => line_in, line_out => line_out, running => running,
      rings_running => each_running, is_master => is_master, own_address => own_address, nodes => nodes,
      troubles => troubles, damaged => damaged, strobe => open, exchange => exchange, missing => missing,
      read_words => read_words, write_words => write_words, judged => judged, other_spec => other_spec,
      time_valid => time_valid, time_bits => time_bits,
      table_index => table_index, table_entry => table_entry, table_mask => table_mask,
      to_ring_valid => to_valid, to_ring_ready => to_ready, to_ring_data => to_data, to_ring_last => to_last,
      to_ring_id => to_id, from_ring_valid => from_valid, from_ring_ready => from_ready, from_ring_data => from_data,
      from_ring_last => from_last, from_ring_id => from_id);

  -- Of a single ring, ONLINE tells all.
  tell_rings : for ring in 0 to 1 generate
    rings_down(ring) <= not each_running(minimum(ring, rings - 1)) when rings = 2 else '0';
  end generate;

end architecture;
