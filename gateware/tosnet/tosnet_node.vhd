-- SPDX-License-Identifier: BSD-3-Clause
--
-- A node of a TosNet ring: up to 15 nodes mirror each other's registers, in cycles that are the same for all.
--
--   line from the node before --> | receiver, start, exchange, transmitter | --> line to the node after
--
-- Line      NRZ, 8b10b. It may be plastic fibre, LVDS, RS-485 or a wire: the line is one bit each way. clocks_per_bit
--           4 at 50 MHz are the 12.5 Mbit/s of the 2010 network. See tosnet_line_in for more samples per clock.
-- Ring      The node with the lowest id is master. docs/tosnet.md tells the phases and the packets. `running`: the ring
--           is complete, and data are exchanged. Bring outputs to a safe state while it is low.
-- Words     Each enabled register has four OUT words, which the node gives, and four IN words, which the master gives.
--           Addresses are those of the shared memory: [9:6] id, [5:3] register, [2] IN, [1:0] word. A slave receives
--           its own IN words and all OUT words of others, the master all OUT words of others. received_valid shows
--           each once a cycle. They belong to one moment, and are for good if strobe_fresh is high at the strobe.
-- Sending   The node asks for a word by send_address, and takes send_word one to two clocks later. A slave sends its
--           OUT words. The master sends its OUT words, the IN words of others, and the OUT words of others that it
--           last received with a fresh strobe. Words to send must not change but with a strobe.
-- Cycle     `strobe` is high for one clock in each cycle, in all nodes within a symbol for each hop. A cycle takes
--           10 bits * (18 + 32 * registers of all nodes) + hop_bits * nodes.
-- Hop       The time from a packet at the input to the packet at the output is hop_bits on average. It varies by half
--           a symbol, because the transmitter does not shift its symbols. All nodes of a ring need the same hop_bits.
-- Faults    A damaged packet is passed on poisoned and gives a strobe that is not fresh. One that is lost, or has not
--           its whole length, gives no strobe to a slave; the master goes on with the next. `damaged` is high for one
--           clock for each. Without any good packet for watchdog_bits, or without an edge on the line for 32 bits,
--           the ring starts again: `restarted`, and `trouble` says why.
-- Channel   With `channel`, messages of up to 12 bytes travel beside the words (tosnet_mailbox). A message in a damaged
--           packet is lost.
-- Reset     The node is silent for 128 clocks and then joins the ring, which starts again.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;
  use work.width_pkg.all;

entity tosnet_node is
  generic (
    clocks_per_bit    : positive               := 4;
    samples_per_clock : positive               := 1;
    hop_bits          : positive               := tosnet_ring_hop_bits_c;
    watchdog_bits     : positive               := tosnet_watchdog_bits;
    may_be_master     : boolean                := true;
    most_nodes        : positive range 2 to 15 := 15;
    channel           : boolean                := true;
    check_bytes       : positive range 1 to 2  := 1;
    exact_hops        : boolean                := false;
    spec_word         : std_ulogic_vector(31 downto 0) := x"00000000"; -- tosnet_exchange
    line_clocks       : natural                := 2 -- of exact_hops: a synchroniser, and what the line itself takes
  );
  port (
    clock     : in  std_ulogic;
    reset     : in  std_ulogic; -- synchronous
    line_in   : in  std_ulogic_vector(samples_per_clock - 1 downto 0); -- of `clock`: from a synchroniser
    line_out  : out std_ulogic;
    id        : in  std_ulogic_vector(3 downto 0); -- 1 to 15
    registers : in  std_ulogic_vector(7 downto 0); -- bit r: register r is enabled

    running      : out std_ulogic;
    is_master    : out std_ulogic;
    own_address  : out unsigned(3 downto 0); -- in the ring; the master's is 0
    nodes        : out unsigned(3 downto 0);
    trouble      : out trouble_t;
    restarted    : out std_ulogic;
    damaged      : out std_ulogic;
    strobe       : out std_ulogic;
    strobe_fresh : out std_ulogic;

    -- Of the master, for two rings in step (tosnet_timing).
    hold    : in  std_ulogic := '0';
    give_up : in  std_ulogic := '0';
    due     : out std_ulogic;
    sends   : out std_ulogic;

    received_valid   : out std_ulogic;
    received_address : out std_ulogic_vector(9 downto 0);
    received_word    : out std_ulogic_vector(31 downto 0);
    send_address     : out std_ulogic_vector(9 downto 0);
    send_word        : in  std_ulogic_vector(31 downto 0);

    -- Of the master: the answer of a member, and who the members are (tosnet_exchange, tosnet_start).
    told      : out std_ulogic;
    told_id   : out std_ulogic_vector(3 downto 0);
    told_word : out std_ulogic_vector(31 downto 0);
    members   : out std_ulogic_vector(15 downto 0);

    table_index : in  unsigned(3 downto 0) := "0000"; -- network registers of the ring, one clock later
    table_entry : out std_ulogic_vector(7 downto 0);
    table_mask  : out std_ulogic_vector(7 downto 0);

    to_ring_valid   : in  std_ulogic                     := '0';
    to_ring_ready   : out std_ulogic;
    to_ring_data    : in  std_ulogic_vector(31 downto 0) := (others => '0');
    to_ring_last    : in  std_ulogic_vector(1 downto 0)  := "00";
    to_ring_id      : in  std_ulogic_vector(3 downto 0)  := "0000";
    from_ring_valid : out std_ulogic;
    from_ring_ready : in  std_ulogic                     := '0';
    from_ring_data  : out std_ulogic_vector(31 downto 0);
    from_ring_last  : out std_ulogic_vector(1 downto 0);
    from_ring_id    : out std_ulogic_vector(3 downto 0);
    message_lost    : out std_ulogic
  );
end entity;

architecture rtl of tosnet_node is

  constant hop_clocks : positive := hop_bits * clocks_per_bit;
  function way return positive is
    constant middle : natural := (clocks_per_bit * samples_per_clock - 1) / 2 / samples_per_clock; -- tosnet_line_in
  begin
    if exact_hops then
      return 9 * clocks_per_bit + middle + 6 + line_clocks;
    end if;
    return 27 * clocks_per_bit + 5;
  end function;

  -- What a packet needs through the node beside the wait. It is the symbol K28.5, two symbols of the transmitter, half
  -- a symbol on average until it begins one, and some registers. With exact_hops, the transmitter does not wait.
  constant way_clocks  : positive := way;
  -- The least wait: the first byte must be there, and two more, because the clocks of two nodes differ. Behind it are
  -- as many as the checksum has.
  constant least_wait  : positive := 10 * (1 + check_bytes) * clocks_per_bit + 9;
  constant wait_clocks : positive := maximum(hop_clocks - way_clocks, 1);
  -- In the election, a node says its id once in so many clocks: tosnet_start rounds them up to a power of two.
  constant election_clocks : positive := 16 * hop_clocks;
  constant least_watchdog  : positive := (2 ** bits_for(election_clocks) + 2 * hop_clocks) / clocks_per_bit;

  signal symbol_valid, control, wrong, line_lost : std_ulogic;
  signal symbol_data : byte_t;
  signal start, valid, done, good : std_ulogic;
  signal data        : byte_t;
  signal good_packet : std_ulogic;

  signal start_item_valid, exchange_item_valid, exchange_item_ready : std_ulogic;
  signal start_item, exchange_item : item_t;
  signal put_valid, put_ready      : std_ulogic;
  signal put_item, out_item        : item_t;
  signal out_valid, out_ready      : std_ulogic;
  signal go                        : std_ulogic;
  signal held_clocks               : natural range 0 to wait_clocks;
  signal take, cut, out_control    : std_ulogic;
  signal out_data                  : byte_t;

  signal begins, restart, flush, was_lost, silence, foreign, way_changed : std_ulogic;
  signal cause     : trouble_t;
  signal master_id : std_ulogic_vector(3 downto 0);

  signal write_entry, write_mask : std_ulogic;
  signal write_index          : unsigned(3 downto 0);
  signal write_data           : byte_t;
  signal in_index, out_index  : unsigned(3 downto 0);
  signal in_entry, out_entry  : std_ulogic_vector(7 downto 0);
  signal in_mask, out_mask    : std_ulogic_vector(7 downto 0);

  signal send, sent, packet_done, fresh, broken, lost : std_ulogic;

  signal send_begin, send_step, take_valid, take_keep : std_ulogic;
  signal send_data, take_data   : byte_t;
  signal send_count, take_count : unsigned(3 downto 0);
  signal take_id                : std_ulogic_vector(3 downto 0);
  signal send_waiting           : std_ulogic;
  signal send_id                : std_ulogic_vector(3 downto 0);

begin

  assert hop_clocks - way_clocks >= least_wait
    report "tosnet_node: hop_bits of " & integer'image(hop_bits) & " are too few; at least "
           & integer'image((way_clocks + least_wait + clocks_per_bit - 1) / clocks_per_bit) & " are needed"
    severity failure;

  assert watchdog_bits >= least_watchdog
    report "tosnet_node: watchdog_bits of " & integer'image(watchdog_bits) & " are too few for the election; at least "
           & integer'image(least_watchdog) & " are needed"
    severity failure;

  receiver : entity work.tosnet_line_in
    generic map (clocks_per_bit => clocks_per_bit, samples_per_clock => samples_per_clock)
    port map (
      clock => clock, reset => reset, samples => line_in,
      symbol_valid => symbol_valid, data => symbol_data, control => control, wrong => wrong, lost => line_lost);

  packets : entity work.tosnet_packet_in
    generic map (check_bytes => check_bytes)
    port map (
      clock => clock, reset => reset, symbol_valid => symbol_valid, symbol_data => symbol_data, control => control,
      wrong => wrong, start => start, valid => valid, data => data, done => done, good => good);

  starter : entity work.tosnet_start
    generic map (
      may_be_master => may_be_master, most_nodes => most_nodes, election_clocks => election_clocks)
    port map (
      clock => clock, reset => reset, id => id, registers => registers, restart => restart, cause => cause,
      start => start, valid => valid, data => data, done => done, good => good,
      item_valid => start_item_valid, item_data => start_item,
      running => running, begins => begins, restarted => restarted, is_master => is_master, master_id => master_id,
      own_address => own_address, nodes => nodes, members => members, trouble => trouble,
      write_entry => write_entry, write_mask => write_mask, write_index => write_index, write_data => write_data);

  exchange : entity work.tosnet_exchange
    generic map (may_be_master => may_be_master, spec_word => spec_word)
    port map (
      clock => clock, reset => reset, id => id, running => running, is_master => is_master, master_id => master_id,
      own_address => own_address, nodes => nodes, members => members,
      start => start, valid => valid, data => data, done => done, good => good,
      item_valid => exchange_item_valid, item_ready => exchange_item_ready, item_data => exchange_item,
      in_index => in_index, in_entry => in_entry, in_mask => in_mask,
      out_index => out_index, out_entry => out_entry, out_mask => out_mask,
      received_valid => received_valid, received_address => received_address, received_word => received_word,
      send_address => send_address, send_word => send_word, send => send, sent => sent,
      packet_done => packet_done, fresh => fresh, broken => broken, foreign => foreign,
      told => told, told_id => told_id, told_word => told_word,
      send_waiting => send_waiting, send_id => send_id, send_begin => send_begin, send_step => send_step,
      send_data => send_data, send_count => send_count, take_valid => take_valid, take_data => take_data,
      take_keep => take_keep, take_count => take_count, take_id => take_id);

  timing : entity work.tosnet_timing
    generic map (
      hop_clocks => hop_clocks, pause_clocks => wait_clocks, watchdog_clocks => watchdog_bits * clocks_per_bit)
    port map (
      clock => clock, reset => reset, running => running, begins => begins, is_master => is_master,
      own_address => own_address, nodes => nodes, good_packet => good_packet, packet_done => packet_done,
      fresh => fresh, sent => sent, hold => hold, give_up => give_up, due => due, strobe => strobe,
      strobe_fresh => strobe_fresh, send => send, lost => lost,
      way_changed => way_changed, silence => silence);

  sends       <= send;
  good_packet <= done and good;
  damaged     <= (packet_done and not fresh) or broken or lost;
  restart     <= silence or foreign or way_changed or (line_lost and not was_lost);
  cause       <= trouble_line when line_lost = '1' else
                 trouble_foreign when foreign = '1' else
                 trouble_way when way_changed = '1' else
                 trouble_silence;

  -- For what comes, for what the master sends, and for the user.
  in_table : entity work.tosnet_table
    port map (
      clock => clock, write_entry => write_entry, write_mask => write_mask, write_index => write_index,
      write_data => write_data, read_index => in_index, entry => in_entry, mask => in_mask);

  out_table : if may_be_master generate
    to_send : entity work.tosnet_table
      port map (
        clock => clock, write_entry => write_entry, write_mask => write_mask, write_index => write_index,
        write_data => write_data, read_index => out_index, entry => out_entry, mask => out_mask);
    to_user : entity work.tosnet_table
      port map (
        clock => clock, write_entry => write_entry, write_mask => write_mask, write_index => write_index,
        write_data => write_data, read_index => table_index, entry => table_entry, mask => table_mask);
  end generate;

  no_out_table : if not may_be_master generate
    out_entry   <= x"00";
    out_mask    <= x"00";
    table_entry <= in_entry;
    table_mask  <= in_mask;
  end generate;

  mailbox : if channel generate
    letters : entity work.tosnet_mailbox
      port map (
        clock => clock, reset => reset,
        to_ring_valid => to_ring_valid, to_ring_ready => to_ring_ready, to_ring_data => to_ring_data,
        to_ring_last => to_ring_last, to_ring_id => to_ring_id,
        from_ring_valid => from_ring_valid, from_ring_ready => from_ring_ready, from_ring_data => from_ring_data,
        from_ring_last => from_ring_last, from_ring_id => from_ring_id, lost => message_lost,
        send_begin => send_begin, send_step => send_step, send_data => send_data, send_count => send_count,
        take_valid => take_valid, take_data => take_data, take_keep => take_keep, take_count => take_count,
        take_id => take_id);
    send_waiting <= to_ring_valid;
    send_id      <= to_ring_id;
  end generate;

  no_mailbox : if not channel generate
    to_ring_ready   <= '0';
    from_ring_valid <= '0';
    from_ring_data  <= (others => '0');
    from_ring_last  <= "00";
    from_ring_id    <= "0000";
    message_lost    <= '0';
    send_data       <= x"00";
    send_count      <= "0000";
    send_waiting    <= '0';
    send_id         <= "0000";
  end generate;

  exchange_item_ready <= put_ready and not start_item_valid and not put_valid;

  -- A packet that was under way when the ring starts again has no end. So nothing of it stays. But what tosnet_start
  -- sends in that clock is new: it is in put_item, and is queued in the next one.
  flush <= reset or restarted;

  put : process (clock) is
  begin
    if rising_edge(clock) then
      put_valid <= start_item_valid or (exchange_item_valid and exchange_item_ready);
      put_item  <= start_item when start_item_valid = '1' else exchange_item;
      if reset = '1' then
        put_valid <= '0';
      end if;
    end if;
  end process;

  -- A packet that comes waits here until the hop's time has come.
  queue : entity work.fifo
    generic map (width => item_t'length, depth => 16)
    port map (
      clock => clock, reset => flush, write_valid => put_valid, write_ready => put_ready, write_data => put_item,
      read_valid => out_valid, read_ready => out_ready, read_data => out_item);

  wait_a_hop : process (clock) is
  begin
    if rising_edge(clock) then
      was_lost <= line_lost;
      if start = '1' then
        held_clocks <= wait_clocks;
      elsif held_clocks > 0 then
        held_clocks <= held_clocks - 1;
      end if;
      if reset = '1' then
        held_clocks <= 0;
        was_lost    <= '1';
      end if;
    end if;
  end process;

  go <= '1' when held_clocks = 0 else '0';

  sender : entity work.tosnet_packet_out
    generic map (check_bytes => check_bytes, exact_start => exact_hops)
    port map (
      clock => clock, reset => flush, go => go, item_valid => out_valid, item_ready => out_ready,
      item_data => out_item, busy => open, take => take, cut => cut, data => out_data,
      control => out_control);

  transmitter : entity work.tosnet_line_out
    generic map (clocks_per_bit => clocks_per_bit)
    port map (
      clock => clock, reset => reset, take => take, data => out_data, control => out_control, cut => cut,
      line => line_out);

end architecture;
