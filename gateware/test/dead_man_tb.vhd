-- SPDX-License-Identifier: BSD-3-Clause
--
-- The dead-man between an application that reads and writes without end and a bus that answers at random, refuses, or
-- is silent. In each round the signs of life end at another clock. Each time it trips at its tick, writes its values,
-- denies all writes, lets reads through, and is armed again.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;

entity dead_man_tb is
  generic (
    count   : positive := 3;  -- safe values
    base_hz : positive := 1;  -- at a clock of 20 Hz; other values are to be refused
    seed    : positive := 1
  );
end entity;

architecture bench of dead_man_tb is

  constant period      : positive := 20;
  constant rounds      : positive := 60;
  constant access_most : positive := 6;  -- clocks
  constant written_most : positive := (count + 1) * (access_most + 1);

  function values return safe_values_t is
    variable all_values : safe_values_t(0 to count - 1);
  begin
    for number in all_values'range loop
      all_values(number) := (address => std_ulogic_vector(to_unsigned(2 * number, 32)),
                             value => std_ulogic_vector(to_unsigned(16#7000# + number, 32)));
    end loop;
    return all_values;
  end function;

  type memory_t is array (0 to 255) of natural;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;

  signal request  : dead_man_request_t := dead_man_request_idle;
  signal state    : dead_man_response_t;
  signal tripped  : std_ulogic;
  signal asked    : bii_request_t := bii_request_idle;
  signal answered, bii_response : bii_response_t := bii_response_idle;
  signal bii_request : bii_request_t;

  signal memory   : memory_t := (others => 0);
  signal deaf     : boolean := false;  -- the bus is silent
  signal since    : natural := 0;      -- clocks since the last sign of life
  signal behind   : natural := 0;      -- clocks since the trip
  signal denials, reads_behind : natural := 0;
  signal working  : boolean := true;   -- the application is running; false: it stops, and keeps its request on the bus

begin

  clock <= not clock after 5 ns when not ended;

  dut : entity work.dead_man
    generic map (address_width => 8, data_width => 16, clock_hz => period, base_hz => base_hz, safe_values => values)
    port map (
      clock => clock, reset => reset, request => request, response => state, tripped => tripped,
      asked => asked, answered => answered, bii_request => bii_request, bii_response => bii_response);

  slave : process (clock)
    variable random : random_t;
    variable waited : natural := 0;
    variable place  : natural range memory'range;
  begin
    if rising_edge(clock) then
      bii_response <= bii_response_idle;
      if bii_request.valid = '1' and bii_response.done = '0' then
        waited := waited + 1;
        if deaf and waited = access_most - 1 then
          bii_response <= (done => '1', status => silent, data => (others => '0'));
        elsif not deaf and (random.chance(40) or waited = access_most - 1) then
          place := to_integer(unsigned(bii_request.address(7 downto 0)));
          bii_response <= (done => '1', status => ok, data => std_ulogic_vector(to_unsigned(memory(place), 32)));
          if bii_request.write = '1' then
            memory(place) <= to_integer(unsigned(bii_request.data(15 downto 0)));
          end if;
        end if;
      else
        waited := 0;
      end if;
    end if;
  end process;

  application : process (clock)
    variable random : random_t;
    variable seeded : boolean := false;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(seed);
        seeded := true;
      end if;
      if asked.valid = '1' and answered.done = '1' then
        asked.valid <= '0';
        if answered.status = denied then
          denials <= denials + 1;
          check(asked.write = '1' and tripped = '1', "only writes behind a trip are denied");
        elsif tripped = '1' and asked.write = '0' then
          reads_behind <= reads_behind + 1;
        end if;
      elsif asked.valid = '0' and working and random.chance(60) then
        asked.valid   <= '1';
        asked.write   <= '1' when random.chance(70) else '0';
        asked.address <= std_ulogic_vector(to_unsigned(random.integer_between(0, 2 * count), 32));
        asked.data    <= std_ulogic_vector(to_unsigned(random.integer_between(0, 999), 32));
      end if;
      asked.block_hold <= '1' when random.chance(80) else '0';
    end if;
  end process;

  count_clocks : process (clock)
  begin
    if rising_edge(clock) then
      since <= 0 when (request.alive or request.start) = '1' else since + 1;
      behind <= behind + 1 when tripped = '1' else 0;
    end if;
  end process;

  play : process
    variable random : random_t;
    variable ticks  : positive;
    variable before : natural;


    procedure give (what : dead_man_request_t) is
    begin
      request <= what;
      tick(clock);
      request <= dead_man_request_idle;
    end procedure;

    procedure wait_trip is
    begin
      while tripped = '0' loop
        tick(clock);
        check(tripped = '1' or since <= ticks * period, "the trip is not late");
      end loop;
      check(since >= (ticks - 1) * period, "nor early");
    end procedure;

    procedure check_safe (what : string) is
    begin
      for number in 0 to count - 1 loop
        check_equal(memory(2 * number), 16#7000# + number, what & ", value " & integer'image(number));
      end loop;
    end procedure;

    function starting (number : natural) return dead_man_request_t is
      variable what : dead_man_request_t := dead_man_request_idle;
    begin
      what.start := '1';
      what.ticks := std_ulogic_vector(to_unsigned(number, 32));
      return what;
    end function;

    constant alive : dead_man_request_t := (alive => '1', ticks => (others => '0'), others => '0');
    constant trip  : dead_man_request_t := (trip => '1', ticks => (others => '0'), others => '0');
    constant renew : dead_man_request_t := (renew => '1', ticks => (others => '0'), others => '0');
    constant arm   : dead_man_request_t := (arm => '1', ticks => (others => '0'), others => '0');
    constant counted : dead_man_request_t := (counted => '1', ticks => (others => '0'), others => '0');
  begin
    random.seed(seed + 100);
    tick(clock, 3);
    reset <= '0';
    check_equal(tripped, '0', "tripped at power-up");
    tick(clock, 10 * period);
    check_equal(tripped, '0', "tripped without having been started");
    give(trip);
    check_equal(tripped, '0', "a command to trip when it does not run");

    for number in 1 to rounds loop
      ticks := random.integer_between(1, 3);
      give(starting(ticks));
      check_equal(state.running, '1', "running");
      for sign in 1 to random.integer_between(0, 3) loop
        tick(clock, random.integer_between(0, (ticks - 1) * period + 5));
        exit when tripped = '1';
        give(alive);
      end loop;
      working <= random.chance(70);
      deaf    <= number mod 5 = 0;
      if number mod 7 = 0 and tripped = '0' then
        give(trip);
        check_equal(tripped, '1', "a command to trip");
      else
        wait_trip;
      end if;
      check_equal(state.running & state.tripped & state.tripped_now & state.uncounted, "0111", "the state");
      if deaf then
        tick(clock, random.integer_between(1, 3 * written_most));
        deaf <= false;
        tick(clock, 2 * written_most + period);
        check_safe("safe once somebody answers");
      end if;
      while behind < written_most loop
        tick(clock);
      end loop;
      check_safe("safe in time");
      working <= true;
      before  := denials;
      give(arm);
      give(alive);
      give(starting(1));
      tick(clock, 5 * written_most + 3 * period);
      check_equal(tripped & state.running, "10", "neither arm nor start count in this session");
      check_safe("and stays");
      check(denials > before, "writes are denied");
      check(reads_behind > 0, "reads are not");
      give(counted);
      check_equal(state.uncounted, '0', "counted");
      give(renew);
      check_equal(tripped & state.tripped_now, "10", "in a new session");
      give(arm);
      check_equal(tripped, '0', "armed");
    end loop;

    give(starting(1));
    give(renew);
    tick(clock, 5 * period);
    check_equal(tripped, '0', "a new session stops it");
    give(starting(2));
    give(starting(0));
    tick(clock, 5 * period);
    check_equal(tripped, '0', "so does a start without ticks");
    give(starting(1));
    wait until tripped = '1';
    reset <= '1';
    tick(clock);
    check_equal(tripped, '0', "reset");
    report_passed("dead_man_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 20 ms, "dead_man_tb");

end architecture;
