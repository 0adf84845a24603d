-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_words at random: one or two rings bring sets of words, whole or not, good or not, in step or alone. The bench
-- knows which set must be shown in which clock, and what must be sent.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_words_tb is
  generic (
    rings     : positive range 1 to 2 := 2;
    is_master : boolean  := false;
    cycles    : positive := 400;
    seed      : positive := 1
  );
end entity;

architecture test of tosnet_words_tb is

  constant reads        : tosnet_address_vector_t(0 to 2) := (16#84#, 16#87#, 16#C0#);
  constant writes       : tosnet_address_vector_t(0 to 1) := (16#80#, 16#83#);
  constant safe_word    : word_t   := x"00C0FFEE"; -- of the second word
  constant apart_clocks : positive := 12;

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic := '1';
  signal ended       : boolean    := false;
  signal from_nodes  : from_node_vector_t(0 to rings - 1) := (others => (
    received_address => (others => '0'), received_word => (others => '0'), send_address => (others => '0'),
    others => '0'));
  signal send_words  : word_vector_t(0 to rings - 1);
  signal exchange, missing : std_ulogic;
  signal read_words  : word_vector_t(reads'range);
  signal write_words : word_vector_t(writes'range) := (others => (others => '0'));

begin

  clock <= not clock after 10 ns when not ended;

  dut : entity work.tosnet_words
    generic map (
      read_addresses => reads, write_addresses => writes, safe_addresses => (0 => reads(1)),
      safe_values => (0 => safe_word), rings => rings, apart_clocks => apart_clocks)
    port map (
      clock => clock, reset => reset, from_nodes => from_nodes, send_words => send_words, exchange => exchange,
      missing => missing, lacks => open, read_words => read_words, write_words => write_words);

  play : process is

    variable random   : random_t;
    variable shown    : word_vector_t(reads'range) := (others => (others => '0'));
    variable set      : word_vector_t(reads'range);
    variable sent     : word_vector_t(writes'range);
    variable good     : std_ulogic;
    variable whole    : std_ulogic_vector(0 to 1);
    variable has_set  : boolean; -- the cycle has one
    variable shows    : boolean; -- the master sends the words that it has
    variable first    : natural range 0 to 1;
    variable ring     : natural range 0 to 1;

    procedure look (address : natural; expected : word_t; what : string) is
    begin
      for number in from_nodes'range loop
        from_nodes(number).send_address <= std_ulogic_vector(to_unsigned(address, 10));
      end loop;
      tick(clock);
      for number in from_nodes'range loop
        check_equal(send_words(number), expected, what);
      end loop;
    end procedure;

  begin
    random.seed(seed);
    tick(clock, 3);
    check_equal(read_words(0), x"00000000", "a word in the reset");
    check_equal(read_words(1), safe_word, "a safe word in the reset");
    reset <= '0';
    shows := false;
    for number in from_nodes'range loop
      from_nodes(number).is_master <= to_bit(is_master);
    end loop;

    for cycle in 1 to cycles loop
      for number in from_nodes'range loop
        if random.chance(10) then
          from_nodes(number).running <= random.vector(1)(0);
        end if;
      end loop;
      write_words <= (random.vector(32), random.vector(32));
      tick(clock, 2);
      if from_nodes(0).running = '0' and from_nodes(rings - 1).running = '0' then
        check_equal(missing, '1', "missing in a ring that has stopped");
        shown(1) := safe_word;
        shows    := false;
        sent     := write_words;
      end if;

      -- The set of this cycle comes in each ring, one behind the other. It may lack a word.
      for word in set'range loop
        set(word) := random.vector(32);
      end loop;
      first   := random.integer_between(0, rings - 1);
      has_set := false;
      for turn in 0 to rings - 1 loop
        ring := (first + turn) mod rings;
        whole(ring) := '1';
        for word in reads'range loop
          if random.chance(95) then
            from_nodes(ring).received_valid   <= '1';
            from_nodes(ring).received_address <= std_ulogic_vector(to_unsigned(reads(word), 10));
            from_nodes(ring).received_word    <= set(word);
            tick(clock);
            from_nodes(ring).received_address <= std_ulogic_vector(to_unsigned(reads(word) + 1, 10));
            from_nodes(ring).received_word    <= random.vector(32);
            from_nodes(ring).received_valid   <= to_bit(reads(word) + 1 /= reads(1));
            tick(clock);
            from_nodes(ring).received_valid   <= '0';
          else
            whole(ring) := '0';
          end if;
        end loop;
        check_equal(exchange, '0', "an exchange without a strobe");
      end loop;
      for turn in 0 to rings - 1 loop
        ring := (first + turn) mod rings;
        good := to_bit(random.chance(80));
        from_nodes(ring).strobe       <= '1';
        from_nodes(ring).strobe_fresh <= good;
        tick(clock);
        from_nodes(ring).strobe <= '0';
        if has_set or from_nodes(ring).running = '0' then
          check_equal(exchange, '0', "an exchange, although there was one, or the ring does not run");
        else
          check_equal(exchange, good and whole(ring), "an exchange of a good set");
        end if;
        if exchange = '1' then
          has_set := true;
          shown   := set;
          shows   := true;
        end if;
        for word in reads'range loop
          check_equal(read_words(word), shown(word), "a word of the cycle");
        end loop;
        tick(clock, random.integer_between(1, apart_clocks / 2));
        check_equal(exchange, '0', "an exchange is longer than a clock");
      end loop;
      tick(clock, 5);

      -- What is sent: a slave's words as they were after its strobe, the master's as they were when it sends.
      if from_nodes(0).running = '1' or from_nodes(rings - 1).running = '1' then
        sent := write_words;
        if is_master then
          write_words <= (random.vector(32), random.vector(32));
          tick(clock);
          from_nodes(0).sends <= '1';
          tick(clock);
          from_nodes(0).sends <= '0';
          sent := write_words;
        end if;
        write_words <= (random.vector(32), random.vector(32));
        tick(clock);
        look(writes(0), sent(0), "the first word to send");
        look(writes(1), sent(1), "the second word to send");
        look(16#81#, x"00000000", "a word that nobody gives");
        if not shows or missing = '1' then
          look(reads(2), x"00000000", "a word of another node that is not there");
        else
          look(reads(2), shown(2), "a word of another node");
        end if;
      end if;
      tick(clock, apart_clocks);
    end loop;
    report_passed("tosnet_words_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 sec, "tosnet_words_tb");

end architecture;
