-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_bridge in a ring with slaves that answer: what the PC writes reaches all nodes in one cycle, what it reads
-- is of one cycle, messages come back, and a cut or an absent node is seen in the status.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;
  use work.wishbone_pkg.all;
  use work.wishbone_bench_pkg.all;

entity tosnet_bridge_tb is
  generic (
    slaves             : positive range 2 to 14 := 2;
    max_skipped_writes : natural  := 0;
    rounds             : positive := 5;
    watchdog_bits      : positive := 8000;
    rings              : positive range 1 to 2 := 1; -- the second one goes round the other way
    check_bytes        : positive := 1;
    clocks_per_bit     : positive := 4;
    exact              : boolean  := true;
    other_spec         : natural range 0 to 15 := 0; -- the id of a node that was built from another spec; 0: none
    seed               : positive := 1
  );
end entity;

architecture test of tosnet_bridge_tb is

  constant clock_period  : time     := 20 ns;
  constant bit_time      : time     := clocks_per_bit * clock_period;
  constant hop_time      : time     := tosnet_ring_hop_bits_c * bit_time;
  constant cycle_time    : time     := (10 * (17 + check_bytes + 32 * slaves)
                                     + tosnet_ring_hop_bits_c * (slaves + 1)) * bit_time;

  -- The words 0 to 3 of register 0 of each slave.
  function words_of (direction : natural) return tosnet_address_vector_t is
    variable result : tosnet_address_vector_t(0 to 4 * slaves - 1);
  begin
    for place in result'range loop
      result(place) := (2 + place / 4) * 64 + 4 * direction + place mod 4;
    end loop;
    return result;
  end function;

  type lines_t is array (natural range <>) of std_ulogic_vector(0 to slaves);

  -- The first slave is one that does not tell.
  function spec_of (slave : positive) return std_ulogic_vector is
  begin
    if slave + 1 = other_spec then
      return x"FEDCBA98";
    elsif slave = 1 then
      return x"00000000";
    end if;
    return x"12345678";
  end function;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean := false;
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal cycle, committed, halted, online : std_ulogic;
  signal troubles   : trouble_vector_t(0 to rings - 1);
  signal bridge_out : std_ulogic_vector(rings - 1 downto 0);
  signal lines   : lines_t(0 to rings - 1);            -- of the bridge and the slaves, as they leave the node
  signal entries : lines_t(0 to rings - 1);            -- as they come to it
  signal cut     : lines_t(0 to rings - 1) := (others => (others => '0'));
  signal absent  : std_ulogic := '0';                  -- the last slave is not in the ring
  signal last_line : std_ulogic;
  signal entry   : std_ulogic_vector(rings - 1 downto 0);
  signal watch   : std_ulogic := '0';
  signal longest_gap : time := 0 ns;
  signal slave_reset, slave_running : std_ulogic_vector(1 to slaves);

begin

  clock <= not clock after clock_period / 2 when not done;

  last_line <= lines(0)(slaves - 1) when absent = '1' else lines(0)(slaves);

  -- The first ring goes from the bridge to slave 1, the second one to the last slave.
  way : for place in 0 to slaves generate
    entries(0)(place) <= (last_line and not cut(0)(place)) when place = 0 else
                         (lines(0)(maximum(place, 1) - 1) and not cut(0)(place));
    back : if rings = 2 generate
      entries(1)(place) <= lines(1)((place + 1) mod (slaves + 1)) and not cut(1)(place);
    end generate;
  end generate;

  input : for ring in 0 to rings - 1 generate
    synchronised : entity work.synchroniser
      port map (clock => clock, asynchronous(0) => entries(ring)(0), levels(0) => entry(ring));
  end generate;

  dut : entity work.tosnet_bridge
    generic map (
      write_addresses => words_of(1), read_addresses => words_of(0), max_skipped_writes => max_skipped_writes,
      watchdog_bits => watchdog_bits, clocks_per_bit => clocks_per_bit, rings => rings, check_bytes => check_bytes,
      exact_hops => rings = 2 and exact, spec_word => x"12345678")
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, line_in => entry,
      line_out => bridge_out, cycle => cycle, committed => committed, halted => halted, online => online,
      troubles => troubles, time_valid => open, time_bits => open);

  output : for ring in 0 to rings - 1 generate
    lines(ring)(0) <= bridge_out(ring);
  end generate;

  -- With one ring of two, and while the other one starts again, it stays online.
  stays_online : process (clock) is
  begin
    if rising_edge(clock) then
      check(watch = '0' or online = '1', "offline with one of two rings");
    end if;
  end process;

  -- The longest time from one cycle to the next.
  watch_gaps : process is
    variable last : time := 0 ns;
  begin
    wait until rising_edge(cycle) or watch'event;
    if watch = '1' and cycle = '1' and last > 0 ns then
      longest_gap <= maximum(longest_gap, now - last);
    elsif watch = '0' then
      longest_gap <= 0 ns;
    end if;
    last := now when cycle = '1' and watch = '1' else 0 ns when watch = '0' else last;
  end process;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  around : for slave in 1 to slaves generate

    constant own_reads  : tosnet_address_vector_t(0 to 3) := words_of(1)(4 * slave - 4 to 4 * slave - 1);
    constant own_writes : tosnet_address_vector_t(0 to 3) := words_of(0)(4 * slave - 4 to 4 * slave - 1);

    signal own_clock : std_ulogic := '0';
    signal own_entry : std_ulogic_vector(rings - 1 downto 0);
    signal own_exit  : std_ulogic_vector(rings - 1 downto 0);
    signal inputs, outputs    : word_vector_t(0 to 3);
    signal strobe             : std_ulogic;
    signal strobes            : unsigned(31 downto 0) := (others => '0');
    signal from_valid, from_ready, to_valid, to_ready : std_ulogic;
    signal from_word, to_word : std_ulogic_vector(37 downto 0);

  begin

    own_clock          <= not own_clock after clock_period / 2 + slave * 1 ps when not done;
    slave_reset(slave) <= reset when slave < slaves else reset or absent;

    own_input : for ring in 0 to rings - 1 generate
      entry : entity work.synchroniser
        port map (clock => own_clock, asynchronous(0) => entries(ring)(slave), levels(0) => own_entry(ring));
      lines(ring)(slave) <= own_exit(ring);
    end generate;

    whole : if slave < slaves generate
      node : entity work.tosnet_rings
        generic map (
          id => slave + 1, read_addresses => own_reads, write_addresses => own_writes, may_be_master => false,
          most_nodes => slaves + 1, watchdog_bits => watchdog_bits, clocks_per_bit => clocks_per_bit, rings => rings,
          check_bytes => check_bytes, exact_hops => rings = 2 and exact, spec_word => spec_of(slave))
        port map (
          clock => own_clock, reset => slave_reset(slave), line_in => own_entry, line_out => own_exit,
          running => slave_running(slave), rings_running => open, is_master => open, own_address => open,
          nodes => open, troubles => open, damaged => open, judged => open, other_spec => open,
          strobe => strobe, exchange => open, missing => open,
          read_words => inputs, write_words => outputs, time_valid => open, time_bits => open, table_entry => open,
          table_mask => open,
          to_ring_valid => to_valid, to_ring_ready => to_ready, to_ring_data => to_word(31 downto 0),
          to_ring_last => to_word(37 downto 36), to_ring_id => to_word(35 downto 32),
          from_ring_valid => from_valid, from_ring_ready => from_ready, from_ring_data => from_word(31 downto 0),
          from_ring_last => from_word(37 downto 36), from_ring_id => from_word(35 downto 32));

      echo : entity work.fifo
        generic map (width => 38, depth => 4)
        port map (
          clock => own_clock, reset => slave_reset(slave), write_valid => from_valid, write_ready => from_ready,
          write_data => from_word, read_valid => to_valid, read_ready => to_ready, read_data => to_word);
    end generate;

    small : if slave = slaves generate
      node : entity work.tosnet_slave_node
        generic map (
          id => slave + 1, registers => x"01", read_addresses => own_reads, write_addresses => own_writes,
          most_nodes => slaves + 1, watchdog_bits => watchdog_bits, clocks_per_bit => clocks_per_bit, rings => rings,
          check_bytes => check_bytes, exact_hops => rings = 2 and exact, spec_word => spec_of(slave))
        port map (
          clock => own_clock, reset => slave_reset(slave), line_in => own_entry, line_out => own_exit,
          running => slave_running(slave), strobe => strobe, exchange => open, troubles => open, read_words => inputs,
          write_words => outputs, time_valid => open, time_bits => open);
    end generate;

    outputs(0) <= inputs(0);
    outputs(1) <= not inputs(1);
    outputs(2) <= std_ulogic_vector(strobes);
    outputs(3) <= std_ulogic_vector(unsigned(inputs(2)) + unsigned(inputs(3)) + slave);

    count : process (own_clock) is
    begin
      if rising_edge(own_clock) then
        if strobe = '1' then
          strobes <= strobes + 1;
        end if;
        if slave_running(slave) = '0' then
          strobes <= (others => '0');
        end if;
      end if;
    end process;

  end generate;

  play : process is

    variable random : random_t;
    variable word   : std_ulogic_vector(31 downto 0);

    procedure read (address : natural; keep : boolean := false) is
      variable answer : bus_answer_t;
    begin
      bus_read(clock, m2s, s2m, address, answer, keep);
      check(not answer.refused, "a read is refused");
      word := answer.word;
    end procedure;

    procedure write (address : natural; data : std_ulogic_vector(31 downto 0)) is
      variable answer : bus_answer_t;
    begin
      bus_write(clock, m2s, s2m, address, data, answer);
      check(not answer.refused, "a write is refused");
    end procedure;

    procedure await_online (level : std_ulogic; limit : time; what : string) is
      constant began : time := now;
    begin
      loop
        read(tosnet_status_c);
        exit when word(tosnet_status_online_bit_c) = level;
        check(now - began < limit, what);
        wait for 1 us;
      end loop;
      wait until rising_edge(clock);
    end procedure;

    -- Writes one number to all nodes, and reads all until it is there. Before that, they all have the number before.
    procedure round (number : natural) is
      variable first : natural;
      variable count : natural;
      variable looks : natural := 0;
    begin
      for slave in 1 to slaves loop
        for lane in 0 to 3 loop
          write((slave + 1) * 64 + 4 + lane, std_ulogic_vector(to_unsigned(number + lane, 32)));
        end loop;
      end loop;
      write(tosnet_status_c, x"00000001");
      loop
        looks := looks + 1;
        check(looks < 10000, "what the PC wrote does not come back");
        for slave in 1 to slaves loop
          read((slave + 1) * 64, true);
          if slave = 1 then
            first := to_integer(unsigned(word));
            check(first = number or first = number - 10 or number = 10, "a number that nobody wrote");
          end if;
          check_equal(to_integer(unsigned(word)), first, "the nodes have words of two commits");
          read((slave + 1) * 64 + 1, true);
          if first > 0 then
            check_equal(word, not std_ulogic_vector(to_unsigned(first + 1, 32)), "a torn set of words");
          end if;
          read((slave + 1) * 64 + 3, true);
          if first > 0 then
            check_equal(to_integer(unsigned(word)), 2 * first + 5 + slave, "the sum of two words");
          end if;
          read((slave + 1) * 64 + 2, slave < slaves);
          if slave = 1 then
            count := to_integer(unsigned(word));
          end if;
          check_equal(to_integer(unsigned(word)), count, "words of two cycles in a block");
        end loop;
        exit when first = number;
        wait for 2 us;
        wait until rising_edge(clock);
      end loop;
    end procedure;

    -- The table of the nodes. In the second ring, `backwards`, the last slave is next to the bridge.
    procedure check_table (backwards : boolean := false) is
      variable id : natural;
    begin
      for place in 0 to 15 loop
        read(tosnet_network_registers_c + place);
        id := slaves + 2 - place when backwards and place > 0 and place <= slaves else place + 1;
        if place = 0 then
          check_equal(word, x"00000001", "the network register of the bridge");
        elsif place <= slaves then
          check_equal(word, x"000101" & std_ulogic_vector(to_unsigned(16 * place + id, 8)), "a network register");
        else
          check_equal(word, x"00000000", "a network register without a node");
        end if;
      end loop;
    end procedure;

    procedure send (slave : positive) is
    begin
      write(tosnet_async_tx_control_c, std_ulogic_vector(to_unsigned(16#10# + slave + 1, 32)));
      write(tosnet_async_tx_data_c, x"A5C30000");
    end procedure;

    procedure await_message (slave : positive) is
    begin
      loop
        read(tosnet_async_rx_status_c);
        exit when word(6) = '1';
        tick(clock, 50);
      end loop;
      check_equal(word(5 downto 0), std_ulogic_vector(to_unsigned(16#10# + slave + 1, 6)), "length and sender");
      read(tosnet_async_rx_data_c);
      check_equal(word, x"A5C30000", "a message that came back");
    end procedure;

    variable before : natural;
    variable mended : time;
    variable place  : natural range 0 to slaves;

  begin
    random.seed(seed);
    tick(clock, 4);
    reset <= '0';
    wait for 42 us; -- the memory is cleared
    tick(clock);
    read(tosnet_status_c);
    check_equal(word(tosnet_status_online_bit_c), '0', "online before the ring runs");
    if other_spec > 0 then
      wait until slave_running = (slave_running'range => '1') for 5 ms;
      for count in 1 to 200 loop
        read(tosnet_status_c);
        check_equal(word(tosnet_status_online_bit_c), '0', "online with a node of another spec");
        wait for cycle_time / 10;
        wait until rising_edge(clock);
      end loop;
      word := word srl tosnet_status_read_error_bit_c + 1;
      check_equal(to_integer(unsigned(word(3 downto 0))), other_spec, "the node of another spec");
      report_passed("tosnet_bridge_tb");
      done <= true;
      wait;
    end if;
    await_online('1', 10 ms, "the ring does not start");
    read(tosnet_status_c);
    check_equal(word(tosnet_status_master_bit_c), '1', "the master");
    check_equal(word(23 downto 16), x"10", "its id and address");
    check_table;
    for number in 1 to rounds loop
      round(10 * number);
    end loop;

    -- A message to each slave with a channel, which sends it back.
    for slave in 1 to slaves - 1 loop
      send(slave);
      await_message(slave);
    end loop;

    -- A cut of one of two rings costs no cycle, nor does its mending.
    if rings = 2 then
      for ring in 0 to 1 loop
        place := random.integer_between(0, slaves);
        wait for random.integer_between(0, 1000) * cycle_time / 1000;
        watch <= '1';
        cut(ring)(place) <= '1';
        wait for 4 * cycle_time + watchdog_bits * bit_time;
        check_equal(online, '1', "online with one ring");
        check((and slave_running) = '1', "a slave does not run with one ring");
        wait until rising_edge(clock);
        read(tosnet_status_c);
        check_equal(word(25 downto 24), std_ulogic_vector(to_unsigned(2 ** ring, 2)), "the ring that does not run");
        check_table(backwards => ring = 0);
        -- Messages go through the first ring. One that is sent while it is cut waits for it.
        send(1);
        if ring = 1 then
          await_message(1);
        end if;
        round(10 * (rounds + 1 + ring));
        cut(ring)(place) <= '0';
        mended := now;
        loop
          read(tosnet_status_c);
          exit when word(25 downto 24) = "00";
          check(now - mended < 1 ms + watchdog_bits * bit_time, "a ring does not start again");
          wait until rising_edge(clock);
        end loop;
        if ring = 0 then
          await_message(1);
        end if;
        check(longest_gap <= cycle_time + 2 * hop_time + 10 * bit_time, "a cycle is lost: " & time'image(longest_gap));
        report "tosnet_bridge_tb: cycles of " & time'image(cycle_time) & ", and of " & time'image(longest_gap)
               & " at a cut";
        watch <= '0';
      end loop;
      wait until rising_edge(clock);
    end if;

    -- A cut.
    read(tosnet_reset_counter_c);
    before := to_integer(unsigned(word));
    for ring in cut'range loop
      cut(ring)(0) <= '1';
    end loop;
    await_online('0', 2 * cycle_time + watchdog_bits * bit_time, "a cut is not noticed");
    check_equal(troubles(0), trouble_line, "why the ring stopped");
    wait for 4 * cycle_time + watchdog_bits * bit_time;
    check((or slave_running) = '0', "a slave runs in a ring that is cut");
    cut <= (others => (others => '0'));
    await_online('1', 10 ms, "the ring does not start again");
    read(tosnet_reset_counter_c);
    check_equal(to_integer(unsigned(word)), before + 1, "starts of the network");
    round(10 * (rounds + 2 * rings - 1));

    -- A ring without its last node.
    if rings = 1 then
      absent <= '1';
      wait for 2 * cycle_time + watchdog_bits * bit_time;
      await_online('0', 1 us, "an absent node is not noticed");
      wait for 3 ms;
      check((and slave_running(1 to slaves - 1)) = '1', "the rest of the ring runs");
      await_online('0', 1 us, "the ring is online without a node");
      read(tosnet_network_registers_c + slaves);
      check_equal(word, x"00000000", "the network register of an absent node");
      absent <= '0';
      await_online('1', 10 ms, "the ring does not start with its node again");
      tick(clock, 3 * (cycle_time / clock_period)); -- its words are zero until it has those that were committed
      round(10 * (rounds + 2 * rings));
    end if;

    report_passed("tosnet_bridge_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 200 ms, "tosnet_bridge_tb");

end architecture;
