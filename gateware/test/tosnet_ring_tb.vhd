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
    only_first_master : boolean  := false; -- only the lowest id may be master
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

  constant cycle_bits : positive := 10 * (18 + 32 * all_registers) + hop_bits * nodes; -- docs/tosnet.md
  constant cycle_time : time     := cycle_bits * bit_time;
  -- Elections, two lists and their sets, each once round, and one lost start.
  constant start_limit : time := 20 * 16 * hop_bits * bit_time + 10 * nodes * hop_bits * bit_time
                                 + 2 * watchdog_bits * bit_time;
  constant oldest     : time     := watchdog_bits * bit_time + 4 * cycle_time;

  type naturals_t is array (natural range <>) of natural;
  type words_t is array (natural range <>) of std_ulogic_vector(31 downto 0);
  type troubles_t is array (natural range <>) of trouble_t;
  type pairs_t is array (natural range <>) of std_ulogic_vector(1 downto 0);
  type ids_t is array (natural range <>) of std_ulogic_vector(3 downto 0);

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

  constant clock_periods : time_vector(ring'range) := periods;

  signal done     : boolean := false;
  signal reset    : std_ulogic_vector(ring'range) := (others => '1');
  signal lines    : std_ulogic_vector(ring'range); -- as they leave the node
  signal entries  : std_ulogic_vector(ring'range); -- as they come to it
  signal cut_line : std_ulogic_vector(ring'range) := (others => '0');
  signal running, is_master, strobe : std_ulogic_vector(ring'range);
  signal trouble  : troubles_t(ring'range);
  signal fresh, stale, restarts, address : naturals_t(ring'range);
  signal oldest_set : time_vector(ring'range);
  signal bits_wrong : boolean := false;
  signal wrong_bits : naturals_t(ring'range) := (others => 0);
  signal flips      : std_ulogic_vector(ring'range) := (others => '0');

  signal to_valid   : std_ulogic_vector(ring'range) := (others => '0');
  signal to_ready   : std_ulogic_vector(ring'range);
  signal to_data    : words_t(ring'range) := (others => (others => '0'));
  signal to_last    : pairs_t(ring'range) := (others => "11");
  signal to_id      : ids_t(ring'range)   := (others => "0000");
  signal from_valid : std_ulogic_vector(ring'range);
  signal from_data  : words_t(ring'range);
  signal from_last  : pairs_t(ring'range);
  signal from_id    : ids_t(ring'range);

begin

  around : for place in ring'range generate

    node : entity work.tosnet_bench_node
      generic map (
        ring => ring, place => place, clock_period => clock_periods(place), clocks_per_bit => clocks_per_bit,
        samples_per_clock => samples_per_clock, hop_bits => hop_bits, watchdog_bits => watchdog_bits,
        may_be_master => not only_first_master or ring(place).id = lowest_id, oldest => oldest)
      port map (
        ended => done, reset => reset(place), id => ring(place).id, line_in => entries(place),
        line_out => lines(place), running => running(place), is_master => is_master(place),
        trouble => trouble(place), strobe => strobe(place), fresh => fresh(place), stale => stale(place),
        restarts => restarts(place), oldest_set => oldest_set(place), address => address(place),
        to_ring_valid => to_valid(place), to_ring_ready => to_ready(place), to_ring_data => to_data(place),
        to_ring_last => to_last(place), to_ring_id => to_id(place), from_ring_valid => from_valid(place),
        from_ring_ready => '1', from_ring_data => from_data(place), from_ring_last => from_last(place),
        from_ring_id => from_id(place));

    entries(place) <= (lines((place - 1) mod nodes) xor flips(place)) and not cut_line(place);

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
      variable late   : time_vector(ring'range);
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
      end loop;
    end procedure;

    variable victim : natural range ring'range;

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
    all_run(start_limit, "after reset");
    measure_cycle;

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
             & integer'image(restarts(place)) & " restarts, " & integer'image(wrong_bits(place)) & " wrong bits, oldest "
             & time'image(oldest_set(place));
    end loop;
    report_passed("tosnet_ring_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 2 sec, "tosnet_ring_tb");

end architecture;
