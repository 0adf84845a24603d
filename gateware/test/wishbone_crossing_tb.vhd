-- SPDX-License-Identifier: BSD-3-Clause
--
-- wishbone_crossing between clocks of any ratio: blocks of random accesses to a memory, compared with a model, and the
-- accesses and cycles that the slave sees. Some accesses are refused, some not answered, some given up by the master.
-- A reset of the master ends some blocks and accesses. A reset of the slave comes between blocks, or during an access.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_crossing_tb is
  generic (
    master_period_ps : positive := 20_000;
    slave_period_ps  : positive := 16_667;
    timeout_clocks   : positive := 12;
    blocks           : positive := 300;
    seed             : positive := 1
  );
end entity;

architecture test of wishbone_crossing_tb is

  constant silent_c : natural := 20; -- from this address on the slave does not answer; from 16 on it refuses

  type words_t is array (0 to 15) of std_ulogic_vector(31 downto 0);

  signal master_clock, slave_clock : std_ulogic := '0';
  signal master_reset, slave_reset : std_ulogic := '1';
  signal done                      : boolean    := false;
  signal m2s                       : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m                       : wishbone_s2m_t;
  signal slave_m2s, memory_m2s     : wishbone_m2s_t;
  signal slave_s2m, memory_s2m     : wishbone_s2m_t;
  signal cycles, accesses          : natural := 0; -- that the slave has seen; accesses that it answers
  signal slave_resets              : natural := 0; -- that were asked for

begin

  master_clock <= not master_clock after master_period_ps * 500 fs when not done;
  slave_clock  <= not slave_clock after slave_period_ps * 500 fs when not done;

  dut : entity work.wishbone_crossing
    generic map (timeout_clocks => timeout_clocks)
    port map (
      master_clock => master_clock, master_reset => master_reset, master_m2s => m2s, master_s2m => s2m,
      slave_clock => slave_clock, slave_reset => slave_reset, slave_m2s => slave_m2s, slave_s2m => slave_s2m);

  master_monitor : entity work.wishbone_monitor
    port map (clock => master_clock, reset => master_reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  memory : entity work.wishbone_memory
    generic map (words => 16)
    port map (clock => slave_clock, reset => slave_reset, wishbone_m2s => memory_m2s, wishbone_s2m => memory_s2m);

  hide : process (all) is
  begin
    memory_m2s <= slave_m2s;
    slave_s2m  <= memory_s2m;
    if unsigned(slave_m2s.adr) >= silent_c then
      memory_m2s.stb <= '0';
      slave_s2m      <= wishbone_s2m_idle;
    end if;
  end process;

  count : process (slave_m2s.cyc) is
  begin
    if rising_edge(slave_m2s.cyc) then
      cycles <= cycles + 1;
    end if;
  end process;

  watch_accesses : process (slave_m2s) is
    variable block_sel : std_ulogic_vector(3 downto 0);
    variable is_first  : boolean := true;
  begin
    if slave_m2s.cyc = '0' then
      is_first := true;
    elsif slave_m2s.stb = '1' and slave_m2s.stb'event then
      check(is_first or slave_m2s.sel = block_sel, "each block has a cycle of its own");
      block_sel := slave_m2s.sel;
      is_first  := false;
      if unsigned(slave_m2s.adr) < silent_c then
        accesses <= accesses + 1;
      end if;
    end if;
  end process;

  reset_slave : process is
  begin
    wait for 220 ns;
    loop
      wait until rising_edge(slave_clock);
      wait until rising_edge(slave_clock);
      slave_reset <= '0';
      wait on slave_resets;
      for clocks in 0 to slave_resets mod 10 loop
        wait until rising_edge(slave_clock);
      end loop;
      slave_reset <= '1';
    end loop;
  end process;

  play : process is

    variable random   : random_t;
    variable words    : words_t := (others => (others => '0'));
    variable address  : natural;
    variable expected : natural := 0; -- cycles
    variable patience : natural;
    variable answer   : wishbone_s2m_t;
    variable given_up : boolean;
    variable turn     : natural := 0; -- number of the block; sel tells it to watch_accesses

    procedure go (we : std_ulogic; data : std_ulogic_vector(31 downto 0)) is
    begin
      m2s <= (
        cyc => '1', stb => '1', we => we, adr => std_ulogic_vector(to_unsigned(address, 32)), dat => data,
        sel => std_ulogic_vector(to_unsigned(turn mod 16, 4)));
      given_up := false;
      for clocks in 1 to patience loop
        wait until rising_edge(master_clock);
        if s2m.ack = '1' or s2m.err = '1' then
          answer  := s2m;
          m2s     <= wishbone_m2s_idle;
          m2s.cyc <= '1';
          return;
        end if;
      end loop;
      m2s      <= wishbone_m2s_idle;
      given_up := true;
    end procedure;

    variable data    : std_ulogic_vector(31 downto 0);
    variable we      : std_ulogic;
    variable timeout : boolean;
    variable dropped : natural := 0; -- accesses that were given up; some before they reached the slave
    variable asked   : natural := 0; -- accesses that the slave answers

  begin
    random.seed(seed);
    wait for 200 ns;
    wait until rising_edge(master_clock);
    master_reset <= '0';
    wait until rising_edge(slave_clock) and slave_reset = '0';
    wait until rising_edge(master_clock);
    for number in 1 to blocks loop
      turn     := turn + 1;
      patience := 100_000;
      expected := expected + 1;
      timeout  := false;
      for access_number in 1 to random.integer_between(1, 4) loop
        address := random.integer_between(0, 21);
        if timeout then
          expected := expected + 1; -- the crossing has ended the cycle, and begins another
          timeout  := false;
        end if;
        data := random.vector(32);
        we   := '1' when random.chance(50) else '0';
        if address < silent_c then
          asked := asked + 1;
        end if;
        go(we, data);
        if address >= silent_c then
          check(answer.err = '1', "an access without an answer is refused");
          timeout := true;
        elsif address >= 16 then
          check(answer.err = '1', "a refusal is passed on");
        else
          check(answer.ack = '1', "an access is done");
          if we = '1' then
            words(address) := data;
          else
            check_equal(answer.dat, words(address), "word " & integer'image(address));
          end if;
        end if;
        for pause in 1 to random.integer_between(0, 3) loop
          wait until rising_edge(master_clock);
        end loop;
      end loop;
      m2s <= wishbone_m2s_idle;
      master_reset <= '1' when random.chance(20) else '0'; -- it ends the block, too
      wait until rising_edge(master_clock);
      master_reset <= '0';
      if random.chance(30) then -- a master that gives up gets no answer of that access later
        address  := silent_c;
        patience := random.integer_between(1, 6);
        dropped  := dropped + 1;
        turn     := turn + 1;
        go('0', x"00000000");
        check(given_up, "a master that gives up");
        master_reset <= '1' when random.chance(50) else '0';
        wait until rising_edge(master_clock);
        master_reset <= '0';
      end if;
      for pause in 1 to random.integer_between(0, 20) loop
        wait until rising_edge(master_clock);
      end loop;
      if random.chance(20) then
        slave_resets <= slave_resets + 1;
        if random.chance(50) then -- an access that the slave forgets
          address  := silent_c;
          patience := 100_000;
          dropped  := dropped + 1;
        turn     := turn + 1;
          go('0', x"00000000");
          check(answer.err = '1', "a reset of the slave refuses the access");
          m2s <= wishbone_m2s_idle;
        end if;
        wait until rising_edge(slave_clock) and slave_reset = '1' for 20 * slave_period_ps * 1 ps;
        wait until rising_edge(slave_clock) and slave_reset = '0';
        wait until rising_edge(master_clock);
      end if;
    end loop;
    wait for 40 * (master_period_ps + slave_period_ps) * 1 ps;
    check_equal(slave_m2s.cyc, '0', "cyc at the end");
    check_equal(accesses, asked, "accesses of the slave");
    check(cycles >= expected and cycles <= expected + dropped, "cycles of the slave: " & integer'image(cycles));
    report_passed("wishbone_crossing_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, (master_period_ps + slave_period_ps) * 1 ps * blocks * 200, "wishbone_crossing_tb");

end architecture;
