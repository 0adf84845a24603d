-- SPDX-License-Identifier: BSD-3-Clause
--
-- A ring of TosNet nodes, each with a clock of its own: it starts whatever the order of resets, exchanges words and
-- messages, and comes through bit errors, a cut and resets. Each tosnet_bench_node checks all that it receives.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use ieee.math_real.all;
  use std.textio.all;
  use work.bench_pkg.all;
  use work.tosnet_bench_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_ring_tb is
  generic (
    nodes             : positive range 2 to 15 := 3;
    kind              : string   := "plain"; -- registers: "plain", "mixed" or "full"
    clocks_per_bit    : positive := 4;
    samples_per_clock : positive := 1;
    hop_bits          : positive := 75;
    watchdog_bits     : positive := 20000;
    apart_ppm         : natural  := 200; -- the most that a clock is off
    cycles            : positive := 20;
    error_bits        : natural  := 0;   -- one bit of so many is wrong, in one part of the run; 0: none
    cut               : boolean  := true;
    resets            : natural  := 2;
    messages          : boolean  := true;
    only_first_master : boolean  := false; -- only the lowest id may be master
    two_rings         : boolean  := false; -- of two nodes each at first, which are joined later
    refused           : string   := "";    -- "same_id", "no_master" or "too_many": a ring that must not start
    check_bytes       : positive := 1;
    exact_hops        : boolean := false;
    seed              : positive := 1;
    log_file          : string   := ""     -- what is on the line of the first node, one sample per clock
  );
end entity;

architecture test of tosnet_ring_tb is

  constant clock_period : time   := 20 ns;
  constant ring         : ring_t := ring_of(nodes, kind);
  constant bit_time     : time   := clock_period * clocks_per_bit;

  function all_registers return natural is
    variable count : natural := 0;
  begin
    for place in ring'range loop
      for number in 0 to 7 loop
        if ring(place).registers(number) = '1' then
          count := count + 1;
        end if;
      end loop;
    end loop;
    return count;
  end function;

  function lowest_id return natural is
    variable lowest : natural := 15;
  begin
    for place in ring'range loop
      lowest := minimum(lowest, ring(place).id);
    end loop;
    return lowest;
  end function;

  function expected_trouble return trouble_t is
  begin
    if refused = "same_id" then
      return trouble_same_id;
    elsif refused = "no_master" then
      return trouble_no_master;
    end if;
    return trouble_too_many;
  end function;

  constant cycle_bits : positive := 10 * (17 + check_bytes + 32 * all_registers) + hop_bits * nodes; -- docs/tosnet.md
  constant cycle_time : time     := cycle_bits * bit_time;
  -- Elections, two lists and their sets, each once round, and one lost start.
  constant start_limit : time := 20 * 16 * hop_bits * bit_time + 10 * nodes * hop_bits * bit_time
                                 + 2 * watchdog_bits * bit_time;
  constant oldest     : time     := watchdog_bits * bit_time + 4 * cycle_time;

  type naturals_t is array (natural range <>) of natural;
  type words_t is array (natural range <>) of std_ulogic_vector(31 downto 0);
  type times_t is array (natural range <>) of unsigned(31 downto 0);
  type troubles_t is array (natural range <>) of trouble_t;

  function periods return time_vector is
    variable result : time_vector(ring'range);
    variable apart  : integer;
  begin
    for place in ring'range loop
      apart := ((place * 7 + seed * 3) mod 5 - 2) * apart_ppm / 2;
      result(place) := (20000000 + 20 * apart) * 1 fs;
    end loop;
    return result;
  end function;

  function most_nodes return positive is
  begin
    if refused = "too_many" then
      return nodes - 1;
    end if;
    return 15;
  end function;

  function sum (numbers : naturals_t) return natural is
    variable result : natural := 0;
  begin
    for place in numbers'range loop
      result := result + numbers(place);
    end loop;
    return result;
  end function;

  function all_ids return naturals_t is
    variable result : naturals_t(ring'range);
  begin
    for place in ring'range loop
      result(place) := ring(place).id;
    end loop;
    if refused = "same_id" then
      result(nodes - 1) := ring(0).id;
    end if;
    return result;
  end function;

  constant ids           : naturals_t(ring'range)  := all_ids;
  constant clock_periods : time_vector(ring'range) := periods;

  signal done     : boolean := false;
  signal reset    : std_ulogic_vector(ring'range) := (others => '1');
  signal lines    : std_ulogic_vector(ring'range); -- as they leave the node
  signal entries  : std_ulogic_vector(ring'range); -- as they come to it
  signal cut_line : std_ulogic_vector(ring'range) := (others => '0');
  signal running, is_master, strobe : std_ulogic_vector(ring'range);
  signal trouble  : troubles_t(ring'range);
  signal time_valid : std_ulogic_vector(ring'range);
  signal time_bits  : times_t(ring'range);
  signal strobe_at  : time_vector(ring'range) := (others => 0 ns);
  signal fresh, stale, restarts, address : naturals_t(ring'range);
  signal oldest_set, age : time_vector(ring'range);
  signal split      : boolean := two_rings;
  signal bits_wrong : boolean := false;
  signal wrong_bits : naturals_t(ring'range) := (others => 0);
  signal flips      : std_ulogic_vector(ring'range) := (others => '0');

  signal post_message : std_ulogic_vector(ring'range) := (others => '0');
  signal post_words   : std_ulogic_vector(95 downto 0);
  signal post_bytes   : natural range 0 to 12 := 0;
  signal post_id      : natural range 0 to 15 := 0;
  signal heard_bytes, heard_from : naturals_t(ring'range);
  signal heard_words : words_t(ring'range);

begin

  around : for place in ring'range generate

    signal before_this : std_ulogic;

  begin

    node : entity work.tosnet_bench_node
      generic map (
        ring => ring, place => place, clock_period => clock_periods(place), clocks_per_bit => clocks_per_bit,
        samples_per_clock => samples_per_clock, hop_bits => hop_bits, watchdog_bits => watchdog_bits,
        may_be_master => (not only_first_master or ring(place).id = lowest_id) and refused /= "no_master",
        most_nodes => most_nodes, two_rings => two_rings, check_bytes => check_bytes, exact_hops => exact_hops,
        oldest => oldest)
      port map (
        ended => done, reset => reset(place), id => ids(place), line_in => entries(place),
        line_out => lines(place), running => running(place), is_master => is_master(place),
        trouble => trouble(place), strobe => strobe(place), fresh => fresh(place), stale => stale(place),
        restarts => restarts(place), oldest_set => oldest_set(place), age => age(place), address => address(place),
        time_valid => time_valid(place), time_bits => time_bits(place),
        post_message => post_message(place), post_words => post_words, post_bytes => post_bytes, post_id => post_id,
        heard_bytes => heard_bytes(place),
        heard_words => heard_words(place), heard_from => heard_from(place));

    before_this    <= lines((place + 1 - 2 * (place mod 2)) mod nodes) when split else lines((place - 1) mod nodes);
    entries(place) <= (before_this xor flips(place)) and not cut_line(place);

    noise : if error_bits > 0 generate
      process is
        variable random : random_t;
      begin
        random.seed(seed + 100 * place);
        while not done loop
          wait for random.integer_between(1, 2 * error_bits * nodes) * bit_time;
          if bits_wrong then
            flips(place) <= '1';
            wrong_bits(place) <= wrong_bits(place) + 1;
          end if;
          wait for bit_time;
          flips(place) <= '0';
        end loop;
        wait;
      end process;
    end generate;

  end generate;

  strobes : for place in ring'range generate
    strobe_at(place) <= now when rising_edge(strobe(place));
  end generate;

  log : if log_file /= "" generate
    process is
      file samples  : text open write_mode is log_file;
      variable one  : line;
    begin
      wait for clock_periods(0) * 3 / 4;
      while not done loop
        write(one, to_bit(lines(0)));
        if one'length = 100 then
          writeline(samples, one);
        end if;
        wait for clock_periods(0);
      end loop;
      writeline(samples, one);
      wait;
    end process;
  end generate;

  play : process is

    variable random : random_t;
    variable master : natural range ring'range; -- its place

    procedure check_equal (got : boolean; expected : boolean; what : string) is
    begin
      check(got = expected, what);
    end procedure;

    -- Waits until the whole ring runs, and for fresh cycles at each node.
    procedure all_run (limit : time; what : string) is
      constant began  : time := now;
      variable before : naturals_t(ring'range);
    begin
      while (and running) = '0' loop
        check(now - began < limit, what & ": the ring does not start");
        wait for 1 us;
      end loop;
      report "tosnet_ring_tb: " & what & ": the ring runs after " & time'image(now - began);
      before := fresh;
      wait for 4 * cycle_time;
      check((and running) = '1', what & ": the ring does not go on");
      for place in ring'range loop
        check(fresh(place) > before(place) + 1, what & ": node " & integer'image(ring(place).id) & " gets no cycles");
        check_equal(is_master(place) = '1', ring(place).id = lowest_id, "the master");
      end loop;
    end procedure;

    procedure measure_cycle is
      variable began  : time;
      variable before : naturals_t(ring'range);
    begin
      before := stale;
      wait until strobe'event and strobe(master) = '1';
      began := now;
      for count in 1 to cycles loop
        wait until strobe(master) = '0';
        wait until strobe(master) = '1';
      end loop;
      report "tosnet_ring_tb: cycle " & time'image((now - began) / cycles) & ", expected " & time'image(cycle_time);
      check(abs ((now - began) / cycles - cycle_time) < cycle_time / 20, "the length of a cycle");
      for place in ring'range loop
        check_equal(stale(place), before(place), "cycles that are not fresh without a fault");
        -- A sensor waits a cycle at most until it is sampled. With the cycle after that, this is the bound of
        -- docs/budget.md: two cycles to the master. The others have it a cycle later.
        report "tosnet_ring_tb: node " & integer'image(ring(place).id) & " has sets of " & time'image(age(place));
        if place = master then
          check(age(place) <= cycle_time + nodes * 10 * bit_time, "the age of a value at the master");
        else
          check(age(place) <= 2 * cycle_time + nodes * 10 * bit_time, "the age of a value at a slave");
        end if;
      end loop;
    end procedure;

    -- How far the strobes and the clocks of the nodes are apart, over some cycles.
    procedure measure_moments is
      variable early, late    : time;
      variable apart          : time    := 0 ns;
      variable differ         : integer := 0; -- bits
      variable most_bits      : natural := 0;
      constant limit          : time    := 1 us;
    begin
      check((and time_valid) = '1', "a clock of the ring is not valid");
      for count in 1 to cycles loop
        wait until strobe'event and strobe(master) = '1';
        wait for cycle_time / 3;
        early := strobe_at(master);
        late  := strobe_at(master);
        for place in ring'range loop
          early := minimum(early, strobe_at(place));
          late  := maximum(late, strobe_at(place));
        end loop;
        apart := maximum(apart, late - early);
        for sample in 1 to 20 loop
          wait for cycle_time / 50;
          for place in ring'range loop
            differ    := to_integer(signed(time_bits(place) - time_bits(master)));
            most_bits := maximum(most_bits, abs differ);
          end loop;
        end loop;
      end loop;
      report "tosnet_ring_tb: strobes are " & time'image(apart) & " apart, clocks " & integer'image(most_bits)
             & " bits of " & time'image(bit_time);
      check(apart < limit, "strobes are too far apart");
      check((most_bits + 1) * bit_time < limit, "clocks are too far apart");
    end procedure;

    -- Sends a message of so many bytes, and waits until it has come. Target 0 means all other nodes.
    procedure exchange_message (place : natural; target : natural; size : positive) is
      variable message : std_ulogic_vector(95 downto 0);
      variable bytes   : naturals_t(ring'range);
      variable words   : words_t(ring'range);
      variable goes    : boolean;
    begin
      message := random.vector(96);
      for byte in size to 11 loop
        message(95 - 8 * byte downto 88 - 8 * byte) := x"00";
      end loop;
      bytes      := heard_bytes;
      words      := heard_words;
      post_words <= message;
      post_bytes <= size;
      post_id    <= target;
      post_message(place) <= not post_message(place);
      if target = 0 then
        wait for (nodes + 2) * cycle_time; -- the last message: nothing comes late, either
      else
        wait until sum(heard_bytes) >= sum(bytes) + size for (nodes + 2) * cycle_time;
      end if;
      for other in ring'range loop
        goes := other /= place and (target = 0 or ring(other).id = target);
        if goes then
          check_equal(heard_bytes(other) - bytes(other), size, "bytes of a message");
          check_equal(heard_words(other), words(other) xor message(95 downto 64) xor message(63 downto 32)
                      xor message(31 downto 0), "words of a message");
          check_equal(heard_from(other), ring(place).id, "the sender of a message");
        else
          check_equal(heard_bytes(other), bytes(other), "bytes of a message to another node");
        end if;
      end loop;
    end procedure;

    variable victim : natural range ring'range;
    variable found  : boolean := false;

  begin
    random.seed(seed);
    for place in ring'range loop
      if ring(place).id = lowest_id then
        master := place;
      end if;
    end loop;
    wait for 10 * clock_period;
    for count in 1 to 2 * nodes loop
      victim := random.integer_between(0, nodes - 1);
      reset(victim) <= '0';
      wait for random.integer_between(0, 60) * 1 us;
    end loop;
    reset <= (others => '0');

    if refused /= "" then
      wait for start_limit; -- a ring that may run does within it: see all_run
      check((or running) = '0' and fresh = naturals_t'(ring'range => 0), "a ring runs that must not");
      for place in ring'range loop
        found := found or trouble(place) = expected_trouble;
      end loop;
      check(found, "no node says what is wrong");
      report_passed("tosnet_ring_tb");
      done <= true;
      wait;
    end if;

    if two_rings then
      wait for start_limit;
      check((and running) = '1', "two rings run");
      check_equal(is_master = (is_master'range => '0'), false, "two masters");
      wait for random.integer_between(0, 1000) * cycle_time / 1000;
      split <= false;
      wait for 3 * cycle_time;
      for place in ring'range loop
        check(restarts(place) > 0, "node " & integer'image(ring(place).id) & " does not notice another ring");
      end loop;
    end if;

    all_run(start_limit, "after reset");
    measure_cycle;
    if exact_hops then
      measure_moments;
    end if;

    if messages then
      for place in ring'range loop
        if place /= master then
          exchange_message(master, ring(place).id, random.integer_between(1, 12));
          exchange_message(place, ring(master).id, random.integer_between(1, 12));
        end if;
      end loop;
      exchange_message(master, 0, 12);
    end if;

    if error_bits > 0 then
      bits_wrong <= true;
      wait for 4 * cycles * cycle_time;
      bits_wrong <= false;
      wait for 1 us;
      all_run(start_limit + watchdog_bits * bit_time, "after bit errors");
    end if;

    if cut then
      victim := random.integer_between(0, nodes - 1);
      wait for random.integer_between(0, 1000) * cycle_time / 1000;
      cut_line(victim) <= '1';
      wait for 2 * cycle_time + watchdog_bits * bit_time;
      check((or running) = '0', "a node runs in a ring that is cut");
      wait for random.integer_between(0, 100) * 1 us;
      cut_line(victim) <= '0';
      all_run(start_limit, "after a cut");
    end if;

    for count in 1 to resets loop
      victim := random.integer_between(0, nodes - 1);
      wait for random.integer_between(0, 1000) * cycle_time / 1000;
      reset(victim) <= '1';
      wait for random.integer_between(1, 100) * 1 us;
      reset(victim) <= '0';
      wait for 20 us;
      all_run(start_limit + watchdog_bits * bit_time, "after a reset");
    end loop;

    for place in ring'range loop
      report "tosnet_ring_tb: node " & integer'image(ring(place).id) & " at " & integer'image(address(place)) & ": "
             & integer'image(fresh(place)) & " fresh, " & integer'image(stale(place)) & " not, "
             & integer'image(restarts(place)) & " restarts, " & integer'image(wrong_bits(place)) & " wrong bits,"
             & " oldest " & time'image(oldest_set(place));
    end loop;
    report_passed("tosnet_ring_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 2 sec, "tosnet_ring_tb");

end architecture;
