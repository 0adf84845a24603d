-- SPDX-License-Identifier: BSD-3-Clause
--
-- TosNet's memory map on the Wishbone bus: the shared memory of the ring's nodes, its commits, and its status. By
-- itself it has no ring: the logic around this entity takes the place of the nodes, and a counter gives the network
-- cycle. tosnet_bridge puts a ring behind it. docs/gateware/tosnet_slave.md has the bits.
--
--   000-3FF  shared memory, node * 64 + register * 8 + 4 if IN + word. The PC writes IN words and its own node's OUT
--            words
--   400      read: status. write any value: commit              401, 402, 403  packet, reset and error counter
--   500-50F  network registers                                  600-602, 700, 702  asynchronous channel
--
-- Cycle     Every cycle_clocks a pending commit takes effect, and read_words are sampled. `cycle` is high in the first
--           clock of each. So the written words belong to one moment, and so do the read words.
-- Commit    write_words are the last committed words of write_addresses. All change in one clock, in which `committed`
--           is high. A write to the memory while a commit is pending aborts the commit (CWA). The write itself takes
--           effect.
-- Hazard    A commit swaps two banks and does not copy. A word that is not rewritten has its value of two commits ago.
-- Block     While cyc is high, the PC reads words of one moment. A cycle that ends meanwhile is seen after the block.
-- Memory    whole_memory: every word exists, as in TosNet, in 64 Kibit of block RAM. Otherwise only the words of
--           write_addresses and read_addresses exist. Words that no node reads are kept for the PC. Words that no node
--           gives are zero.
-- Halt      More than max_skipped_writes cycles without a commit (0: any number) raise `halted`, until the network or
--           the gateware starts again.
-- Ring      online and damaged take the place of the ring. While online is low, nothing is exchanged, and commits wait.
--           One clock of damaged is one cycle with an error. With cycle_clocks = 0 there is a ring. Then network_cycle
--           is high for one clock when read_words are new, and the network registers are those of its table.
-- Latency   ack or err one clock after strobe: 2 clocks per access. After a reset, accesses wait until the memory is
--           cleared, one clock per word, two banks. A read waits one clock for an asynchronous word that just arrived.
-- Errors    err for a word that may not be written or read, an address without meaning, a write whose sel lacks bytes,
--           a full or empty asynchronous queue. Such an access changes only the error bits of the status.
-- Reset     All words are zero, and no commit is pending.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_slave is
  generic (
    master_id          : natural range 0 to 15        := 1; -- the PC's own node
    master_registers   : std_ulogic_vector(7 downto 0) := x"FF";
    nodes              : tosnet_node_vector_t         := tosnet_no_nodes_c;
    write_addresses    : tosnet_address_vector_t      := tosnet_no_addresses_c;
    read_addresses     : tosnet_address_vector_t      := tosnet_no_addresses_c;
    cycle_clocks       : natural                      := 5000; -- 0: a ring gives the cycle
    max_skipped_writes : natural range 0 to 65535     := 0;
    whole_memory       : boolean                      := true;
    async_depth        : natural range 0 to 2 ** 16   := 128 -- words each way, a power of two; 0: no channel
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    cycle       : out std_ulogic;
    committed   : out std_ulogic;
    halted      : out std_ulogic;
    write_words : out word_vector_t(0 to write_addresses'length - 1);
    read_words  : in  word_vector_t(0 to read_addresses'length - 1);

    online     : in std_ulogic           := '1';
    damaged    : in std_ulogic           := '0';
    other_spec : in unsigned(3 downto 0) := "0000"; -- the id of a node that was built from another spec
    rings_down : in std_ulogic_vector(1 downto 0) := "00"; -- of a network of two rings: which one does not run
    network_cycle : in  std_ulogic := '0';
    is_master     : in  std_ulogic := '1';
    own_address   : in  unsigned(3 downto 0) := "0000"; -- in the ring
    ring_nodes    : in  unsigned(3 downto 0) := "0000";
    table_index   : out unsigned(3 downto 0);
    table_entry   : in  std_ulogic_vector(7 downto 0) := x"00"; -- one clock later
    table_mask    : in  std_ulogic_vector(7 downto 0) := x"00";

    -- Asynchronous channel: a word, the index of its last valid byte (the first byte is in bits 31-24), the other node.
    to_node_valid   : out std_ulogic;
    to_node_ready   : in  std_ulogic                     := '0';
    to_node_data    : out std_ulogic_vector(31 downto 0);
    to_node_last    : out std_ulogic_vector(1 downto 0);
    to_node_id      : out std_ulogic_vector(3 downto 0);
    from_node_valid : in  std_ulogic                     := '0';
    from_node_ready : out std_ulogic;
    from_node_data  : in  std_ulogic_vector(31 downto 0) := (others => '0');
    from_node_last  : in  std_ulogic_vector(1 downto 0)  := "00";
    from_node_id    : in  std_ulogic_vector(3 downto 0)  := "0000"
  );
end entity;

architecture rtl of tosnet_slave is

  constant writes    : natural := write_addresses'length;
  constant reads     : natural := read_addresses'length;
  constant ring      : word_vector_t(0 to 15)
    := network_registers(master_id, master_registers, nodes, known => cycle_clocks > 0);
  constant write_map : tosnet_address_vector_t(0 to writes - 1) := write_addresses;
  constant read_map  : tosnet_address_vector_t(0 to reads - 1)  := read_addresses;

  function stored_words return positive is
  begin
    if whole_memory then
      return tosnet_memory_words_c;
    end if;
    return maximum(writes, 1);
  end function;

  constant index_bits : positive := bits_for(stored_words);

  subtype place_t is std_ulogic_vector(37 downto 0); -- of the asynchronous channel: last, id, data
  type banks_t is array (0 to 2 ** (index_bits + 1) - 1) of word_t;

  -- The access.
  signal address      : unsigned(10 downto 0);
  signal asked        : std_ulogic;
  signal within       : std_ulogic; -- the address is in the map
  signal is_memory    : std_ulogic;
  signal may_write    : std_ulogic;
  signal write_hits   : std_ulogic_vector(0 to writes - 1);
  signal read_hits    : std_ulogic_vector(0 to reads - 1);
  signal exists       : std_ulogic;
  signal index        : unsigned(index_bits - 1 downto 0);
  signal whole_write  : std_ulogic; -- a write within the map that selects all bytes
  signal store        : std_ulogic; -- … to the memory
  signal commit       : std_ulogic; -- … to the status
  signal ack, err     : std_ulogic;
  signal from_memory  : std_ulogic; -- the answer is in memory_word
  signal from_table   : std_ulogic; -- the answer is in the ring's table
  signal word         : word_t;
  signal memory_word  : word_t;

  -- The PC writes one bank of a pair, and the nodes see the other. `banks` is for the PC, registers for the nodes.
  signal banks         : banks_t;
  signal bank          : std_ulogic;
  signal write_bank    : std_ulogic := '0';
  signal shown_bank    : std_ulogic := '1';
  signal hidden        : word_vector_t(0 to writes - 1);
  signal seen          : word_vector_t(0 to reads - 1);
  signal memory_write  : std_ulogic;
  signal memory_index  : unsigned(index_bits downto 0);
  signal memory_data   : word_t;
  signal clearing      : std_ulogic := '1';
  signal clear_index   : unsigned(index_bits downto 0) := (others => '0');

  -- The network.
  signal cycle_ends, exchange      : std_ulogic; -- in this clock a cycle ends; in this clock words are exchanged
  signal was_online, packet_error  : std_ulogic;
  signal read_pointer              : std_ulogic;
  signal packets, resets, errors   : unsigned(31 downto 0);
  signal pending                   : std_ulogic; -- a commit is pending, including the access of this clock
  signal commit_pending            : std_ulogic;
  signal commit_aborted            : std_ulogic;
  signal read_refused              : std_ulogic;
  signal write_refused             : std_ulogic;
  signal in_block                  : std_ulogic; -- cyc was already high
  signal stale                     : std_ulogic; -- a cycle ended during the block, and its words are not shown yet

  -- The asynchronous channel.
  signal tx_control                    : std_ulogic_vector(5 downto 0); -- last, id
  signal tx_steer, tx_valid, tx_ready  : std_ulogic;
  signal rx_pending, rx_valid, rx_take : std_ulogic;
  signal rx_word                       : place_t;

begin

  assert misfit(write_map, master_id, true) = 0
    report "tosnet_slave: write_addresses(" & integer'image(misfit(write_map, master_id, true) - 1)
           & ") is there twice, or not the PC's to write"
    severity failure;
  assert misfit(read_map, master_id, false) = 0
    report "tosnet_slave: read_addresses(" & integer'image(misfit(read_map, master_id, false) - 1)
           & ") is there twice, or the PC's to write"
    severity failure;
  assert nodes'length <= 15 report "tosnet_slave: a ring has at most 15 nodes beside its master" severity failure;
  address    <= unsigned(wishbone_m2s.adr(10 downto 0));
  within     <= '1' when unsigned(wishbone_m2s.adr(31 downto 11)) = 0 else '0';
  is_memory  <= within and not address(10);
  may_write  <= address(tosnet_in_bit_c) or to_bit(address(9 downto tosnet_node_shift_c) = master_id);
  asked      <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not clearing
                and (not rx_pending or rx_valid);
  store      <= whole_write and is_memory and may_write and exists;
  commit     <= whole_write when address = tosnet_status_c else '0';
  whole_write <= asked and within and wishbone_m2s.we and (and wishbone_m2s.sel);

  compare_writes : for place in write_hits'range generate
    write_hits(place) <= is_memory when address(9 downto 0) = write_map(place) else '0';
  end generate;

  compare_reads : for place in read_hits'range generate
    read_hits(place) <= is_memory when address(9 downto 0) = read_map(place) else '0';
  end generate;

  whole : if whole_memory generate
    exists <= '1';
    index  <= address(9 downto 0);
  end generate;

  listed : if not whole_memory generate
    process (all) is
      variable hit   : std_ulogic;
      variable found : unsigned(index_bits - 1 downto 0);
    begin
      hit   := '0';
      found := (others => '0');
      for place in write_hits'range loop
        if write_hits(place) = '1' then
          hit   := '1';
          found := found or to_unsigned(place, index_bits);
        end if;
      end loop;
      for place in read_hits'range loop
        hit := hit or read_hits(place);
      end loop;
      exists <= hit;
      index  <= found;
    end process;
  end generate;

  table_index  <= address(3 downto 0);
  memory_write <= store or clearing;
  memory_index <= clear_index when clearing = '1' else write_bank & index;
  memory_data  <= wishbone_m2s.dat and (31 downto 0 => not clearing);

  memory : process (clock) is
  begin
    if rising_edge(clock) then
      if memory_write = '1' then
        banks(to_integer(memory_index)) <= memory_data;
      end if;
      memory_word <= banks(to_integer(unsigned'(shown_bank & index)));
    end if;
  end process;

  clear : process (clock) is
  begin
    if rising_edge(clock) then
      if clearing = '1' then
        clear_index <= clear_index + 1;
        clearing    <= nand clear_index;
      end if;
      if reset = '1' then
        clear_index <= (others => '0');
        clearing    <= '1';
      end if;
    end if;
  end process;

  answer : process (clock) is
    variable status : word_t;
    variable given  : word_t;
    variable good   : std_ulogic;
  begin
    if rising_edge(clock) then
      status := (
        tosnet_status_online_bit_c         => was_online,
        tosnet_status_master_bit_c         => was_online and is_master,
        tosnet_status_packet_error_bit_c   => packet_error,
        tosnet_status_system_halt_bit_c    => halted,
        tosnet_status_read_error_bit_c     => read_refused,
        tosnet_status_write_error_bit_c    => write_refused,
        tosnet_status_commit_aborted_bit_c => commit_aborted,
        tosnet_status_read_pointer_bit_c   => read_pointer,
        tosnet_status_write_pointer_bit_c  => write_bank,
        tosnet_status_read_frozen_bit_c    => in_block,
        tosnet_status_commit_pending_bit_c => commit_pending,
        others                             => '0');
      status(tosnet_status_node_id_shift_c + 5 downto tosnet_status_node_address_shift_c) :=
        rings_down & std_ulogic_vector(to_unsigned(master_id, 4)) & std_ulogic_vector(own_address);
      status(tosnet_status_read_error_bit_c + 4 downto tosnet_status_read_error_bit_c + 1)
        := std_ulogic_vector(other_spec);

      good  := '0';
      given := (others => '0');
      if is_memory = '1' then
        good := exists;
        for place in read_hits'range loop
          given := given or (seen(place) and (31 downto 0 => read_hits(place)));
        end loop;
      elsif within = '1' then
        good := '1';
        if address = tosnet_status_c then
          given := status;
        elsif address = tosnet_packet_counter_c then
          given := std_ulogic_vector(packets);
        elsif address = tosnet_reset_counter_c then
          given := std_ulogic_vector(resets);
        elsif address = tosnet_error_counter_c then
          given := std_ulogic_vector(errors);
        elsif address(10 downto 4) = tosnet_network_registers_c / 16 then
          given := ring(to_integer(address(3 downto 0)));
        elsif address = tosnet_async_tx_status_c then
          given(6 downto 0) := not tx_ready & tx_control;
        elsif address = tosnet_async_rx_status_c then
          given(7 downto 6) := not rx_pending & rx_pending;
          if rx_pending = '1' then
            given(5 downto 0) := rx_word(37 downto 32);
          end if;
        elsif address = tosnet_async_rx_data_c then
          given := rx_word(31 downto 0);
          good  := rx_pending;
        else
          good := '0';
        end if;
      end if;
      word        <= given;
      from_memory <= is_memory and may_write;
      from_table  <= to_bit(cycle_clocks = 0 and address(10 downto 4) = tosnet_network_registers_c / 16
                            and address(3 downto 0) < ring_nodes);

      if wishbone_m2s.we = '1' then
        good := store or commit or tx_steer or tx_valid;
      end if;
      ack <= asked and good and not reset;
      err <= asked and not good and not reset;

      -- The error bits are about the last access to the memory, or about a refused access elsewhere.
      if asked = '1' and wishbone_m2s.we = '0' and (is_memory = '1' or good = '0') then
        read_refused <= not good;
      end if;
      if asked = '1' and wishbone_m2s.we = '1' and (is_memory = '1' or good = '0') then
        write_refused <= not good;
      end if;
      if tx_steer = '1' then
        tx_control <= wishbone_m2s.dat(5 downto 0);
      end if;
      if reset = '1' then
        read_refused  <= '0';
        write_refused <= '0';
        tx_control    <= "110000";
      end if;
    end if;
  end process;

  network : entity work.tosnet_cycle
    generic map (cycle_clocks => cycle_clocks, max_skipped_writes => max_skipped_writes)
    port map (
      clock => clock, reset => reset, online => online, damaged => damaged, pending => pending,
      network_cycle => network_cycle,
      ends => cycle_ends, exchange => exchange, was_online => was_online, packet_error => packet_error,
      halted => halted, read_pointer => read_pointer, packets => packets, resets => resets, errors => errors);

  -- In the clock that ends a cycle, the access comes first: a commit takes effect, and a write still aborts one.
  pending <= commit or (commit_pending and not store);

  exchange_banks : process (clock) is
    variable late : std_ulogic;
  begin
    if rising_edge(clock) then
      if store = '1' then
        commit_aborted <= commit_aborted or commit_pending;
      elsif commit = '1' then
        commit_aborted <= '0';
      end if;
      for place in write_hits'range loop
        if store = '1' and write_hits(place) = '1' then
          hidden(place) <= wishbone_m2s.dat;
        end if;
      end loop;

      cycle          <= cycle_ends;
      committed      <= exchange and pending;
      commit_pending <= pending and not exchange;
      write_bank     <= bank;
      if exchange = '1' and pending = '1' then
        write_words <= hidden;
        hidden      <= write_words;
      end if;

      in_block <= wishbone_m2s.cyc;
      late     := stale or exchange;
      if late = '1' and wishbone_m2s.cyc = '0' then
        seen       <= read_words;
        shown_bank <= not bank;
        late       := '0';
      end if;
      stale <= late;

      if reset = '1' then
        cycle          <= '0';
        committed      <= '0';
        in_block       <= '0';
        commit_aborted <= '0';
        commit_pending <= '0';
        write_bank     <= '0';
        shown_bank     <= '1';
        stale          <= '0';
        hidden         <= (others => (others => '0'));
        write_words    <= (others => (others => '0'));
        seen           <= (others => (others => '0'));
      end if;
    end if;
  end process;

  bank <= write_bank xor (exchange and pending); -- the bank of the next clock

  tx_steer <= whole_write when address = tosnet_async_tx_control_c else '0';
  tx_valid <= whole_write and tx_ready when address = tosnet_async_tx_data_c else '0';
  rx_take  <= asked and within and not wishbone_m2s.we and to_bit(address = tosnet_async_rx_data_c);

  channel : if async_depth > 0 generate

    signal to_node : place_t;

  begin

    to_nodes : entity work.tosnet_channel
      generic map (depth => async_depth, width => place_t'length)
      port map (
        clock => clock, reset => reset, cycle => exchange,
        write_valid => tx_valid, write_ready => tx_ready, write_data => tx_control & wishbone_m2s.dat,
        pending => open, read_valid => to_node_valid, read_ready => to_node_ready, read_data => to_node);

    from_nodes : entity work.tosnet_channel
      generic map (depth => async_depth, width => place_t'length)
      port map (
        clock => clock, reset => reset, cycle => exchange,
        write_valid => from_node_valid, write_ready => from_node_ready,
        write_data => from_node_last & from_node_id & from_node_data,
        pending => rx_pending, read_valid => rx_valid, read_ready => rx_take, read_data => rx_word);

    (to_node_last, to_node_id, to_node_data) <= to_node;

  end generate;

  no_channel : if async_depth = 0 generate
    tx_ready        <= '0';
    rx_pending      <= '0';
    rx_valid        <= '0';
    rx_word         <= (others => '0');
    to_node_valid   <= '0';
    to_node_data    <= (others => '0');
    to_node_last    <= "00";
    to_node_id      <= "0000";
    from_node_ready <= '0';
  end generate;

  process (all) is
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.dat <= memory_word when from_memory = '1' else
                        x"00" & table_mask & table_mask & table_entry when from_table = '1' else
                        word;
  end process;

end architecture;
