-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_clock: a master and a slave whose clocks drift apart. The bench gives both their strobes, and carries the word
-- from one to the other. Packets are lost, the ring stops, and the clock of the slave may run ahead or behind.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity tosnet_clock_tb is
  generic (
    clocks_per_bit : positive := 4;
    apart_ppm      : integer  := 300; -- by which the slave's clock is slower than the master's
    cycle_bits     : positive := 1000;
    cycles         : positive := 60;
    seed           : positive := 1
  );
end entity;

architecture test of tosnet_clock_tb is

  constant hold_bits : positive := 16;
  constant period    : time     := 20 ns;
  constant slower    : time     := (20000000 + 20 * apart_ppm) * 1 fs;
  constant bit_time  : time     := period * clocks_per_bit;

  signal clock, other_clock : std_ulogic := '0';
  signal ended        : boolean := false;
  signal reset        : std_ulogic := '1';
  signal running      : std_ulogic := '0';
  signal is_master    : std_ulogic := '1'; -- of the node that is one in the end
  signal to_master    : std_ulogic := '0'; -- a word for it, while it is none
  signal strobe, fresh : std_ulogic := '0';
  signal arrives      : std_ulogic := '0'; -- the word of the master, of the cycle before
  signal arrives_word : std_ulogic_vector(31 downto 0) := (others => '0');
  signal arrives_at   : std_ulogic_vector(9 downto 0) := (others => '0');
  signal word         : std_ulogic_vector(31 downto 0);
  signal valid, other_valid : std_ulogic;
  signal bits, other_bits   : unsigned(31 downto 0);

  -- The same in the slave's clock.
  signal other_strobe, other_fresh, other_arrives, strobe_seen, arrives_seen : std_ulogic := '0';

  signal last_bits  : unsigned(31 downto 0) := (others => '0');
  signal last_valid : std_ulogic := '0';

begin

  clock       <= not clock after period / 2 when not ended;
  other_clock <= not other_clock after slower / 2 when not ended;

  master : entity work.tosnet_clock
    generic map (address => 16#43#, clocks_per_bit => clocks_per_bit, hold_bits => hold_bits)
    port map (
      clock => clock, reset => reset, running => running, is_master => is_master, strobe => strobe,
      strobe_fresh => fresh, received_valid => to_master, received_address => arrives_at,
      received_word => arrives_word, word => word,
      valid => valid, now_bits => bits);

  slave : entity work.tosnet_clock
    generic map (address => 16#43#, clocks_per_bit => clocks_per_bit, hold_bits => hold_bits)
    port map (
      clock => other_clock, reset => reset, running => running, is_master => '0', strobe => other_strobe,
      strobe_fresh => other_fresh, received_valid => other_arrives, received_address => arrives_at,
      received_word => arrives_word, word => open, valid => other_valid, now_bits => other_bits);

  to_slave : process (other_clock) is
  begin
    if rising_edge(other_clock) then
      strobe_seen   <= strobe;
      other_strobe  <= strobe and not strobe_seen;
      other_fresh   <= fresh;
      arrives_seen  <= arrives;
      other_arrives <= arrives and not arrives_seen;
    end if;
  end process;

  never_backwards : process (other_clock) is
  begin
    if rising_edge(other_clock) then
      last_bits  <= other_bits;
      last_valid <= other_valid;
      check(last_valid = '0' or other_valid = '0' or signed(other_bits - last_bits) >= 0,
            "the clock of the ring runs backwards");
    end if;
  end process;

  play : process is

    variable random : random_t;

    -- `comes`: the packet of this cycle reaches the slave.
    procedure cycle (comes : boolean := true) is
      constant sent : std_ulogic_vector(31 downto 0) := word;
    begin
      wait for cycle_bits * bit_time / 2;
      arrives_word <= sent;
      arrives_at   <= "0001000011";
      wait for 4 * period;
      arrives      <= '1' when comes;
      wait for 3 * period;
      arrives      <= '0';
      arrives_at   <= random.vector(10) or "1000000000";
      wait for 4 * period;
      arrives_word <= random.vector(32);
      wait for 4 * period;
      arrives      <= '1'; -- a word of another address
      wait for 3 * period;
      arrives      <= '0';
      wait for cycle_bits * bit_time / 2 - 18 * period;
      wait until rising_edge(clock);
      fresh  <= '1' when comes else '0';
      strobe <= '1';
      wait until rising_edge(clock);
      strobe <= '0';
      wait for 3 * bit_time;
    end procedure;

    procedure check_near (what : string) is
    begin
      check_equal(other_valid, '1', "valid: " & what);
      check(abs to_integer(signed(bits - other_bits)) <= 2, what & ": the clocks are "
            & integer'image(to_integer(signed(bits - other_bits))) & " bits apart");
    end procedure;

  begin
    random.seed(seed);
    wait for 10 * period;
    reset <= '0';
    check_equal(valid & other_valid, "00", "valid while no ring runs");
    wait for random.integer_between(0, 500) * bit_time;
    running <= '1';
    wait for 2 * period;
    check_equal(valid, '1', "the master's clock");
    check_equal(word, x"00000000", "the word before the first cycles");
    cycle;
    cycle;
    check_equal(other_valid, '0', "the slave's clock before the first word");
    cycle;
    cycle;
    for count in 1 to cycles loop
      cycle;
      check_near("a cycle");
    end loop;

    -- Of a packet that is lost, the word is not used, and the clocks go on.
    cycle(false);
    check_near("a lost packet");
    cycle;
    check_near("after a lost packet");
    cycle;
    check_near("after that");

    running <= '0';
    wait for 20 * period;
    check_equal(valid & other_valid, "00", "valid in a ring that has stopped");
    check_equal(word, x"00000000", "the word of a ring that has stopped");
    wait for 50 * cycle_bits * bit_time;
    running <= '1';
    for count in 1 to 5 loop
      cycle;
    end loop;
    check_near("a ring that runs again");

    -- A slave that has the time of another ring becomes the master, some cycles before the time wraps.
    is_master    <= '0';
    arrives_word <= x"FFFFD800";
    arrives_at   <= "0001000011";
    wait until rising_edge(clock);
    to_master    <= '1';
    wait until rising_edge(clock);
    to_master    <= '0';
    strobe       <= '1';
    wait until rising_edge(clock);
    strobe       <= '0';
    wait for 2 * period;
    check(bits - unsigned(arrives_word) < 2, "the time that came");
    running      <= '0';
    is_master    <= '1';
    wait for 20 * period;
    running      <= '1';
    for count in 1 to 4 loop
      cycle;
    end loop;
    check(bits(31) = '1', "the time is over too early");
    for count in 1 to 12 loop
      cycle;
      check_near("about the wrap");
    end loop;
    check(bits(31) = '0', "the time has not wrapped");

    reset <= '1';
    wait for 4 * period;
    check_equal(std_ulogic_vector(bits), x"00000000", "the time in the reset");
    report_passed("tosnet_clock_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 sec, "tosnet_clock_tb");

end architecture;
