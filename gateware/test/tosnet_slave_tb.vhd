-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_slave under random traffic from all sides. Its actions are written to log_file, one per line, and the twin
-- checks them (tests/gateware/test_tosnet.py). What the twin does not model is checked here.
--
-- A line is KIND CLOCK STATE PLACE WORD. CLOCK counts from the end of the reset, and the event happens at the end of
-- that clock.
--   r, w  the PC reads, writes address PLACE. STATE 0: err     g  the nodes see WORD at address PLACE
--   b     cyc changes to STATE                                 s  a node puts WORD at address PLACE
--   o     the network is online, or not                        d  a cycle was damaged
--   t, p  a node takes, puts an asynchronous WORD, PLACE is last * 16 + id

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.textio.all;
  use work.bench_pkg.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_slave_tb is
  generic (
    log_file           : string   := "tosnet_slave_tb.log";
    seed               : positive := 1;
    accesses           : positive := 3000;
    words              : natural  := 6; -- words that the nodes see, and words that they give
    cycle_clocks       : positive := 37;
    max_skipped_writes : natural  := 0;
    whole_memory       : boolean  := true;
    async_depth        : natural  := 128;
    network_faults     : boolean  := false;
    wrong_addresses    : natural  := 0
  );
end entity;

architecture test of tosnet_slave_tb is

  constant clock_period : time := 20 ns;

  constant nodes      : tosnet_node_vector_t := ((id => 2, registers => x"03"), (id => 5, registers => x"80"));
  constant all_writes : tosnet_address_vector_t(0 to 5) := (16#84#, 16#87#, 16#8C#, 16#17F#, 16#40#, 16#44#);
  constant all_reads  : tosnet_address_vector_t(0 to 5) := (16#80#, 16#83#, 16#88#, 16#178#, 16#179#, 16#17B#);

  function write_addresses return tosnet_address_vector_t is
    variable result : tosnet_address_vector_t(0 to words - 1) := all_writes(0 to words - 1);
  begin
    if wrong_addresses = 1 then
      result(words - 1) := result(0); -- twice
    end if;
    return result;
  end function;

  function read_addresses return tosnet_address_vector_t is
    variable result : tosnet_address_vector_t(0 to words - 1) := all_reads(0 to words - 1);
  begin
    if wrong_addresses = 2 then
      result(words - 1) := 16#84#; -- the PC's own word
    end if;
    return result;
  end function;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;
  signal quiet : boolean := false; -- the nodes and the ring do nothing

  signal cycle, committed, halted : std_ulogic;
  signal write_words              : word_vector_t(0 to words - 1);
  signal read_words               : word_vector_t(0 to words - 1) := (others => (others => '0'));
  signal online                   : std_ulogic := '1';
  signal damaged                  : std_ulogic := '0';

  signal to_node_valid, to_node_ready     : std_ulogic := '0';
  signal from_node_valid, from_node_ready : std_ulogic := '0';
  signal to_node_data, from_node_data     : std_ulogic_vector(31 downto 0) := (others => '0');
  signal to_node_last, from_node_last     : std_ulogic_vector(1 downto 0)  := "00";
  signal to_node_id, from_node_id         : std_ulogic_vector(3 downto 0)  := "0000";

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.tosnet_slave
    generic map (
      master_id => 1, master_registers => x"0F", nodes => nodes, write_addresses => write_addresses,
      read_addresses => read_addresses, cycle_clocks => cycle_clocks, max_skipped_writes => max_skipped_writes,
      whole_memory => whole_memory, async_depth => async_depth)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m,
      cycle => cycle, committed => committed, halted => halted, write_words => write_words, read_words => read_words,
      online => online, damaged => damaged,
      to_node_valid => to_node_valid, to_node_ready => to_node_ready, to_node_data => to_node_data,
      to_node_last => to_node_last, to_node_id => to_node_id,
      from_node_valid => from_node_valid, from_node_ready => from_node_ready, from_node_data => from_node_data,
      from_node_last => from_node_last, from_node_id => from_node_id);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  record_all : process (clock) is

    file log             : text open write_mode is log_file;
    variable text_line   : line;
    variable now_clock   : natural := 0;
    variable cyc_before  : std_ulogic := '0';
    variable was_online  : std_ulogic := '1';
    variable seen        : word_vector_t(0 to words - 1) := (others => (others => '0'));
    variable given       : word_vector_t(0 to words - 1) := (others => (others => '0'));

    procedure put (
      kind  : character;
      at    : natural;
      state : std_ulogic;
      place : natural;
      word  : std_ulogic_vector(31 downto 0)
    ) is
    begin
      write(text_line, kind & " " & integer'image(at) & " " & to_string(state) & " " & integer'image(place) & " "
                       & to_hstring(word));
      writeline(log, text_line);
    end procedure;

  begin
    if rising_edge(clock) and reset = '0' then
      now_clock := now_clock + 1;
      if m2s.cyc = '1' and m2s.stb = '1' and (s2m.ack = '1' or s2m.err = '1') and m2s.sel = "1111" then
        -- It was decided one clock ago.
        if m2s.we = '1' then
          put('w', now_clock - 1, s2m.ack, to_integer(unsigned(m2s.adr)), m2s.dat);
        else
          put('r', now_clock - 1, s2m.ack, to_integer(unsigned(m2s.adr)), s2m.dat);
        end if;
      end if;
      if m2s.cyc /= cyc_before then
        put('b', now_clock, m2s.cyc, 0, x"00000000");
      end if;
      cyc_before := m2s.cyc;
      for place in given'range loop
        if read_words(place) /= given(place) then
          put('s', now_clock, '1', read_addresses(place), read_words(place));
        end if;
        if cycle = '1' then
          put('g', now_clock, '1', write_addresses(place), write_words(place));
        end if;
        check(quiet or committed = '1' or write_words(place) = seen(place), "a word changed without a commit");
      end loop;
      given := read_words;
      seen  := write_words;
      if online /= was_online then
        put('o', now_clock, online, 0, x"00000000");
      end if;
      was_online := online;
      if damaged = '1' then
        put('d', now_clock, '1', 0, x"00000000");
      end if;
      if to_node_valid = '1' and to_node_ready = '1' then
        put('t', now_clock, '1', to_integer(unsigned'(unsigned(to_node_last) & unsigned(to_node_id))), to_node_data);
      end if;
      if from_node_valid = '1' and from_node_ready = '1' then
        put('p', now_clock, '1',
            to_integer(unsigned'(unsigned(from_node_last) & unsigned(from_node_id))), from_node_data);
      end if;
    end if;
  end process;

  around : process (clock) is
    variable random : random_t;
    variable seeded : boolean := false;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(seed + 5000);
        seeded := true;
      end if;
      damaged       <= '0';
      to_node_ready <= '0';
      if from_node_ready = '1' then
        from_node_valid <= '0';
      end if;
      if quiet then
        online <= '1';
      elsif reset = '0' then
        if words > 0 and random.chance(20) then
          read_words(random.integer_between(0, words - 1)) <= random.vector(32);
        end if;
        to_node_ready <= '1' when random.chance(10) else '0';
        if random.chance(10) and (from_node_valid = '0' or from_node_ready = '1') then
          from_node_valid <= '1';
          from_node_data  <= random.vector(32);
          from_node_last  <= random.vector(2);
          from_node_id    <= random.vector(4);
        end if;
        if network_faults then
          damaged <= '1' when random.chance(2) else '0';
          if random.chance(1) then
            online <= not online;
          end if;
        end if;
      end if;
    end if;
  end process;

  master : process is

    variable random   : random_t;
    variable answer   : bus_answer_t;
    variable count    : natural;

    impure function some_address (we : boolean) return natural is
    begin
      case random.integer_between(0, 15) is
        when 0 to 5 =>
          if words > 0 then
            return write_addresses(random.integer_between(0, words - 1));
          end if;
          return 16#84#;
        when 6 to 8 =>
          if words > 0 and not we then
            return read_addresses(random.integer_between(0, words - 1));
          end if;
          return random.integer_between(0, 1023);
        when 9 => return random.integer_between(0, 1023);
        when 10 => return tosnet_async_tx_control_c - 1 + random.integer_between(0, 3);
        when 11 => return tosnet_async_tx_data_c;
        when 12 => return tosnet_async_rx_status_c + 2 * random.integer_between(0, 1);
        when 13 => return tosnet_network_registers_c - 1 + random.integer_between(0, 17);
        when 14 => return tosnet_status_c + random.integer_between(0, 4);
        when others => return tosnet_status_c;
      end case;
    end function;

    procedure traffic (number : positive) is
    begin
      for index in 1 to number loop
        if random.chance(50) then
          bus_write(clock, m2s, s2m, some_address(true), random.vector(32), answer);
        elsif random.chance(80) then
          bus_read(clock, m2s, s2m, some_address(false), answer);
        else
          for step in 1 to random.integer_between(1, 2 * cycle_clocks) loop
            bus_read(clock, m2s, s2m, some_address(false), answer, keep => true);
            if random.chance(10) then
              wait_clocks(clock, random.integer_between(1, 20));
            end if;
          end loop;
          bus_read(clock, m2s, s2m, tosnet_status_c, answer);
        end if;
        if random.chance(50) then
          wait_clocks(clock, random.integer_between(1, cycle_clocks));
        end if;
      end loop;
    end procedure;

    procedure restart is
    begin
      wait until rising_edge(clock);
      reset <= '1';
      wait_clocks(clock, 3);
      reset <= '0';
    end procedure;

    -- Waits until the memory is cleared: the first access waits for that.
    procedure wait_for_memory is
    begin
      m2s <= (cyc => '1', stb => '1', we => '0', adr => std_ulogic_vector(to_unsigned(tosnet_status_c, 32)),
              dat => x"00000000", sel => "1111");
      wait until rising_edge(clock) and s2m.ack = '1' for clock_period * 2200;
      check_equal(s2m.ack, '1', "an answer after a reset");
      m2s <= wishbone_m2s_idle;
      wait_clocks(clock, 2);
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 5);
    reset <= '0';
    wait_clocks(clock, 1);
    wait_for_memory;
    traffic(accesses);

    -- What the twin does not model. Its check ends here, with a reset.
    quiet <= true;
    bus_read(clock, m2s, s2m, 16#FFFF#, answer); -- the last line of the log
    restart;
    wait_clocks(clock, 1);
    check_equal(halted, '0', "halted after a reset");
    wait_for_memory;
    if words > 0 then
      bus_read(clock, m2s, s2m, write_addresses(0), answer);
      check_equal(answer.word, std_ulogic_vector'(x"00000000"), "a word of the PC after a reset");
      check_equal(write_words(0), std_ulogic_vector'(x"00000000"), "a word of the nodes after a reset");
      bus_access(clock, m2s, s2m, '1', to_unsigned(write_addresses(0), 32), x"00000001", answer, sel => "0111");
      check(answer.refused, "a write that leaves a byte out was taken");
      check_equal(answer.clocks, 2, "clocks of a write");
      bus_write(clock, m2s, s2m, write_addresses(0), x"00000007", answer);
      bus_write(clock, m2s, s2m, tosnet_status_c, x"00000001", answer);
      wait_clocks(clock, 2 * cycle_clocks + 2);
      check_equal(write_words(0), std_ulogic_vector'(x"00000007"), "a committed word");
    end if;
    bus_refuse(clock, m2s, s2m, '1', tosnet_status_c, "a commit that leaves a byte out", sel => "1110");
    bus_refuse(clock, m2s, s2m, '0', 2048 + tosnet_status_c, "a read beyond the map");
    count := 0;
    loop
      bus_write(clock, m2s, s2m, tosnet_async_tx_data_c, std_ulogic_vector(to_unsigned(count, 32)), answer);
      exit when answer.refused;
      count := count + 1;
    end loop;
    check_equal(count, async_depth, "asynchronous words there is room for");
    bus_read(clock, m2s, s2m, tosnet_async_tx_status_c, answer);
    check_equal(answer.word(6), '1', "FULL");

    wait_clocks(clock, 2);
    report_passed("tosnet_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 3000000, "tosnet_slave_tb");

end architecture;
