-- SPDX-License-Identifier: BSD-3-Clause
--
-- A user of a TosNet ring, or of two rings at once: the nodes, and the words that belong to both.
--
--   first line  --> tosnet_node --> line          both <--> tosnet_words <--> read_words, write_words
--   second line --> tosnet_node --> line
--
-- Rings     With rings = 2, the user has a node with the same id in each. The second line may go round the other way.
--           Both rings carry the same words in the same cycles, and each cycle takes them from the one that has them
--           first. So what is cut, damaged or started again in one ring costs no cycle. It needs exact_hops.
-- In step   The master sends into both rings at the same moment. If a packet comes back a hop later than that of the
--           other ring, it counts as lost. Then the next cycle begins two hops later. A ring that starts again waits
--           for the other one's next packet.
-- Running   At least one ring runs. rings_running tells which ones have brought all words of read_addresses.
-- Strobe    The first of the two in each cycle, so none is missing when a ring is cut right before it. own_address,
--           nodes and the table are those of the first ring, or of the second one while the first does not run.
-- Channel   Messages go through the first ring.
-- Spec      With spec_word, a master waits until each member has answered it once, in any ring, since it is in one that
--           runs, and tells by `judged`. So a ring that starts again or stops does not stop the other one. If a member
--           tells another word than spec_word, other_spec is its id until it is in no ring that runs.
-- Time      With time_address below 1024, the rings share a clock (tosnet_clock), whose OUT word is there.
-- Reset     All words are zero, but for those with a safe value, and the nodes join their rings.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_rings is
  generic (
    id                : natural range 1 to 15         := 2;
    registers         : std_ulogic_vector(7 downto 0) := x"01";
    read_addresses    : tosnet_address_vector_t       := tosnet_no_addresses_c; -- tosnet_words
    write_addresses   : tosnet_address_vector_t       := tosnet_no_addresses_c;
    safe_addresses    : tosnet_address_vector_t       := tosnet_no_addresses_c;
    safe_values       : word_vector_t                 := tosnet_no_words_c;
    rings             : positive range 1 to 2         := 1;
    time_address      : natural range 0 to 1024       := 1024; -- 1024: no clock
    may_be_master     : boolean                       := true; -- tosnet_node
    most_nodes        : positive range 2 to 15        := 15;
    clocks_per_bit    : positive                      := 4;
    samples_per_clock : positive                      := 1;
    hop_bits          : positive                      := tosnet_ring_hop_bits_c;
    watchdog_bits     : positive                      := tosnet_watchdog_bits;
    channel           : boolean                       := true;
    check_bytes       : positive range 1 to 2         := 1;
    exact_hops        : boolean                       := false;
    line_clocks       : natural                       := 2;
    spec_word         : std_ulogic_vector(31 downto 0) := x"00000000"
  );
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic; -- synchronous
    line_in       : in  std_ulogic_vector(rings * samples_per_clock - 1 downto 0); -- the first ring in the low bits
    line_out      : out std_ulogic_vector(rings - 1 downto 0);
    running       : out std_ulogic;
    rings_running : out std_ulogic_vector(rings - 1 downto 0);
    is_master     : out std_ulogic;
    own_address   : out unsigned(3 downto 0);
    nodes         : out unsigned(3 downto 0);
    troubles      : out trouble_vector_t(0 to rings - 1);
    damaged       : out std_ulogic;
    strobe        : out std_ulogic;
    exchange      : out std_ulogic;
    missing       : out std_ulogic;
    read_words    : out word_vector_t(0 to read_addresses'length - 1);
    write_words   : in  word_vector_t(0 to write_addresses'length - 1);
    judged        : out std_ulogic;
    other_spec    : out unsigned(3 downto 0);
    time_valid    : out std_ulogic;
    time_bits     : out unsigned(31 downto 0);

    table_index     : in  unsigned(3 downto 0) := "0000"; -- tosnet_node
    table_entry     : out std_ulogic_vector(7 downto 0);
    table_mask      : out std_ulogic_vector(7 downto 0);
    to_ring_valid   : in  std_ulogic                     := '0';
    to_ring_ready   : out std_ulogic;
    to_ring_data    : in  std_ulogic_vector(31 downto 0) := (others => '0');
    to_ring_last    : in  std_ulogic_vector(1 downto 0)  := "00";
    to_ring_id      : in  std_ulogic_vector(3 downto 0)  := "0000";
    from_ring_valid : out std_ulogic;
    from_ring_ready : in  std_ulogic                     := '0';
    from_ring_data  : out std_ulogic_vector(31 downto 0);
    from_ring_last  : out std_ulogic_vector(1 downto 0);
    from_ring_id    : out std_ulogic_vector(3 downto 0)
  );
end entity;

architecture rtl of tosnet_rings is

  constant hop_clocks   : positive := hop_bits * clocks_per_bit;
  constant apart_clocks : positive := 2 * hop_clocks; -- of the two rings' strobes, at most

  type fours_t is array (natural range <>) of unsigned(3 downto 0);
  type ids_t is array (natural range <>) of std_ulogic_vector(3 downto 0);
  type members_t is array (natural range <>) of std_ulogic_vector(15 downto 0);
  type bytes_t is array (natural range <>) of std_ulogic_vector(7 downto 0);

  signal from_nodes     : from_node_vector_t(0 to rings - 1);
  signal send_words     : word_vector_t(0 to rings - 1);
  signal words_to_send  : word_vector_t(0 to rings - 1);
  signal each_address   : fours_t(0 to rings - 1);
  signal each_nodes     : fours_t(0 to rings - 1);
  signal each_entry     : bytes_t(0 to rings - 1);
  signal each_mask      : bytes_t(0 to rings - 1);
  signal each_damaged   : std_ulogic_vector(0 to rings - 1);
  signal told           : std_ulogic_vector(0 to rings - 1);
  signal told_id        : ids_t(0 to rings - 1);
  signal told_word      : word_vector_t(0 to rings - 1);
  signal members        : members_t(0 to rings - 1);
  signal in_any         : std_ulogic_vector(15 downto 0) := (others => '0'); -- the members of rings that run
  signal lacks          : std_ulogic_vector(0 to rings - 1);
  signal answered       : std_ulogic_vector(15 downto 0) := (others => '0'); -- … that have answered in one of them
  signal strange        : std_ulogic_vector(15 downto 0) := (others => '0'); -- … and have told another spec
  signal sees           : natural range 0 to rings - 1; -- the ring whose place and table the user has

  -- Of the master's packets.
  signal due     : std_ulogic_vector(0 to rings - 1); -- it is ready to send
  signal hold    : std_ulogic_vector(0 to rings - 1); -- it waits for the other ring
  signal give_up : std_ulogic_vector(0 to rings - 1); -- its packet is later than that of the other ring

begin

  assert rings = 1 or exact_hops
    report "tosnet_rings: two rings need exact_hops"
    severity failure;

  assert time_address = 1024 or exact_hops
    report "tosnet_rings: a clock of the ring needs exact_hops"
    severity failure;

  ring : for number in 0 to rings - 1 generate

    signal own_to_ready, own_from_valid : std_ulogic;
    signal own_from_data : std_ulogic_vector(31 downto 0);
    signal own_from_last : std_ulogic_vector(1 downto 0);
    signal own_from_id   : std_ulogic_vector(3 downto 0);
    signal own_to_valid, own_from_ready : std_ulogic;

  begin

    own_to_valid   <= to_ring_valid and to_bit(number = 0);
    own_from_ready <= from_ring_ready and to_bit(number = 0);

    node : entity work.tosnet_node
      generic map (
        clocks_per_bit => clocks_per_bit, samples_per_clock => samples_per_clock, hop_bits => hop_bits,
        watchdog_bits => watchdog_bits, may_be_master => may_be_master, most_nodes => most_nodes,
        channel => channel and number = 0, check_bytes => check_bytes, exact_hops => exact_hops,
        line_clocks => line_clocks, spec_word => spec_word)
      port map (
        clock => clock, reset => reset,
        line_in => line_in((number + 1) * samples_per_clock - 1 downto number * samples_per_clock),
        line_out => line_out(number), id => std_ulogic_vector(to_unsigned(id, 4)), registers => registers,
        running => from_nodes(number).running, is_master => from_nodes(number).is_master,
        own_address => each_address(number), nodes => each_nodes(number), trouble => troubles(number),
        restarted => open, damaged => each_damaged(number), strobe => from_nodes(number).strobe,
        strobe_fresh => from_nodes(number).strobe_fresh, due => due(number), hold => hold(number),
        give_up => give_up(number), sends => from_nodes(number).sends,
        received_valid => from_nodes(number).received_valid,
        received_address => from_nodes(number).received_address,
        received_word => from_nodes(number).received_word, send_address => from_nodes(number).send_address,
        send_word => words_to_send(number), told => told(number), told_id => told_id(number),
        told_word => told_word(number), members => members(number),
        table_index => table_index, table_entry => each_entry(number), table_mask => each_mask(number),
        to_ring_valid => own_to_valid, to_ring_ready => own_to_ready, to_ring_data => to_ring_data,
        to_ring_last => to_ring_last, to_ring_id => to_ring_id, from_ring_valid => own_from_valid,
        from_ring_ready => own_from_ready, from_ring_data => own_from_data, from_ring_last => own_from_last,
        from_ring_id => own_from_id, message_lost => open);

    rings_running(number) <= from_nodes(number).running and not lacks(number);

    messages : if number = 0 generate
      to_ring_ready   <= own_to_ready;
      from_ring_valid <= own_from_valid;
      from_ring_data  <= own_from_data;
      from_ring_last  <= own_from_last;
      from_ring_id    <= own_from_id;
    end generate;

  end generate;

  one : if rings = 1 generate
    hold    <= "0";
    give_up <= "0";
    sees    <= 0;
    strobe  <= from_nodes(0).strobe;
    running <= from_nodes(0).running;
    damaged <= each_damaged(0);
  end generate;

  two : if rings = 2 generate

    signal active : std_ulogic_vector(0 to 1); -- this node is the ring's master
    signal waited : natural range 0 to hop_clocks;
    signal both   : std_ulogic := '0'; -- the last packets went into both rings, which run since then
    signal since  : natural range 0 to apart_clocks := 0; -- clocks in which the other ring's strobe may come
    signal any_strobe : std_ulogic;

  begin

    any_strobe <= (from_nodes(0).strobe and from_nodes(0).running) or (from_nodes(1).strobe and from_nodes(1).running);
    strobe     <= any_strobe and to_bit(since = 0);

    active  <= (from_nodes(0).running and from_nodes(0).is_master)
               & (from_nodes(1).running and from_nodes(1).is_master);
    hold    <= (active(1) & active(0)) and (0 to 1 => due(0) nand due(1));
    give_up <= (0 to 1 => to_bit(waited = hop_clocks)) and not due;
    sees    <= 1 when from_nodes(0).running = '0' and from_nodes(1).running = '1' else 0;
    running <= from_nodes(0).running or from_nodes(1).running;
    damaged <= each_damaged(0) or each_damaged(1);

    wait_for_other : process (clock) is
    begin
      if rising_edge(clock) then
        if (from_nodes(0).sends or from_nodes(1).sends) = '1' then
          both <= from_nodes(0).sends and from_nodes(1).sends;
        elsif (and active) = '0' then
          both <= '0';
        end if;
        if (both and (due(0) xor due(1))) = '0' then
          waited <= 0;
        elsif waited < hop_clocks then
          waited <= waited + 1;
        end if;
        if reset = '1' then
          both   <= '0';
          waited <= 0;
        end if;
      end if;
    end process;

    once_a_cycle : process (clock) is
    begin
      if rising_edge(clock) then
        if since > 0 then
          since <= since - 1;
        elsif any_strobe = '1' then
          since <= apart_clocks;
        end if;
        if reset = '1' then
          since <= 0;
        end if;
      end if;
    end process;

  end generate;

  find_members : process (all) is
    variable found : std_ulogic_vector(15 downto 0);
  begin
    found := (others => '0');
    for number in 0 to rings - 1 loop
      if from_nodes(number).running = '1' then
        found := found or members(number);
      end if;
    end loop;
    in_any <= found;
  end process;

  compare : process (clock) is
  begin
    if rising_edge(clock) then
      -- A member belongs to both rings. So what it has told in one counts as long as it is in any.
      answered <= answered and in_any;
      strange  <= strange and in_any;
      for number in 0 to rings - 1 loop
        if told(number) = '1' then
          answered(to_integer(unsigned(told_id(number)))) <= '1';
          if unsigned(told_word(number)) /= 0 and told_word(number) /= spec_word then
            strange(to_integer(unsigned(told_id(number)))) <= '1';
          end if;
        end if;
      end loop;
      answered(id) <= '1';
    end if;
  end process;

  judge : process (all) is
  begin
    other_spec <= "0000";
    for number in strange'range loop -- the lowest id is last
      if (strange(number) and in_any(number)) = '1' then
        other_spec <= to_unsigned(number, 4);
      end if;
    end loop;
    judged <= not (or (in_any and not answered)) or to_bit(unsigned(spec_word) = 0);
  end process;

  is_master   <= from_nodes(sees).is_master;
  own_address <= each_address(sees);
  nodes       <= each_nodes(sees);
  table_entry <= each_entry(sees);
  table_mask  <= each_mask(sees);

  words : entity work.tosnet_words
    generic map (
      read_addresses => read_addresses, write_addresses => write_addresses, safe_addresses => safe_addresses,
      safe_values => safe_values, rings => rings, apart_clocks => apart_clocks)
    port map (
      clock => clock, reset => reset, from_nodes => from_nodes, send_words => send_words, exchange => exchange,
      missing => missing, lacks => lacks, read_words => read_words, write_words => write_words);

  no_clock : if time_address = 1024 generate
    words_to_send <= send_words;
    time_valid    <= '0';
    time_bits     <= (others => '0');
  end generate;

  with_clock : if time_address < 1024 generate

    signal word : std_ulogic_vector(31 downto 0);
    signal seen : from_node_t;
    signal asks_time : std_ulogic_vector(0 to rings - 1); -- of send_words: a clock after the address

  begin

    seen <= from_nodes(sees);

    shared_time : entity work.tosnet_clock
      generic map (address => time_address, clocks_per_bit => clocks_per_bit)
      port map (
        clock => clock, reset => reset, running => seen.running, is_master => seen.is_master, strobe => seen.strobe,
        strobe_fresh => seen.strobe_fresh, received_valid => seen.received_valid,
        received_address => seen.received_address, received_word => seen.received_word, word => word,
        valid => time_valid, now_bits => time_bits);

    to_send : process (clock) is
    begin
      if rising_edge(clock) then
        for number in 0 to rings - 1 loop
          asks_time(number) <= seen.is_master and to_bit(unsigned(from_nodes(number).send_address) = time_address);
        end loop;
      end if;
    end process;

    choose : for number in 0 to rings - 1 generate
      words_to_send(number) <= word when asks_time(number) = '1' else send_words(number);
    end generate;

  end generate;

end architecture;
