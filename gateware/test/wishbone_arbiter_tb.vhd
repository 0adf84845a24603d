-- SPDX-License-Identifier: BSD-3-Clause
--
-- wishbone_arbiter: every master adds to a word of one memory, reading and writing it within one bus cycle. Nothing is
-- lost if the cycle is indivisible. And while all of them ask all the time, they get the bus equally often.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_arbiter_tb is
  generic (
    masters : positive := 3;
    pauses  : natural  := 30; -- percent, between the blocks of a master
    seed    : positive := 1
  );
end entity;

architecture test of wishbone_arbiter_tb is

  constant clock_period : time     := 20 ns;
  constant blocks       : positive := 100; -- of each master

  type counts_t is array (0 to masters - 1) of natural;

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic := '1';
  signal done        : boolean    := false;
  signal masters_m2s : wishbone_m2s_vector_t(0 to masters - 1) := (others => wishbone_m2s_idle);
  signal masters_s2m : wishbone_s2m_vector_t(0 to masters - 1);
  signal slave_m2s   : wishbone_m2s_t;
  signal slave_s2m   : wishbone_s2m_t;
  signal made        : counts_t := (others => 0); -- blocks so far
  signal total       : natural;
  signal summed      : std_ulogic_vector(0 to masters - 1) := (others => '0');

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.wishbone_arbiter
    generic map (masters => masters)
    port map (
      clock => clock, reset => reset, masters_m2s => masters_m2s, masters_s2m => masters_s2m,
      slave_m2s => slave_m2s, slave_s2m => slave_s2m);

  memory : entity work.wishbone_memory
    generic map (words => 4)
    port map (clock => clock, reset => reset, wishbone_m2s => slave_m2s, wishbone_s2m => slave_s2m);

  ask : for master in 0 to masters - 1 generate

    signal m2s : wishbone_m2s_t := wishbone_m2s_idle;

  begin

    masters_m2s(master) <= m2s;

    monitor : entity work.wishbone_monitor
      port map (
        clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => masters_s2m(master));

    process is
      variable random : random_t;
      variable answer : bus_answer_t;
    begin
      random.seed(seed + master);
      wait until falling_edge(reset);
      for block_number in 1 to blocks loop
        pause(clock, random, pauses);
        bus_read(clock, m2s, masters_s2m(master), 1, answer, keep => true);
        bus_write(
          clock, m2s, masters_s2m(master), 1, std_ulogic_vector(unsigned(answer.word) + 1));
        made(master) <= made(master) + 1;
        wait until rising_edge(clock);
      end loop;
      if pauses > 0 then -- a refusal goes to the one that asked
        bus_refuse(clock, m2s, masters_s2m(master), '0', 4 + master, "a word beyond the memory");
      end if;
      if master = 0 then
        while total < blocks * masters loop
          wait until rising_edge(clock);
        end loop;
        bus_expect(clock, m2s, masters_s2m(master), 1, blocks * masters);
        summed(master) <= '1';
      end if;
      wait;
    end process;

  end generate;

  sum : process (all) is
    variable found : natural;
  begin
    found := 0;
    for master in made'range loop
      found := found + made(master);
    end loop;
    total <= found;
  end process;

  watch : process is
  begin
    tick(clock, 3);
    reset <= '0';
    while total < blocks * masters loop
      wait until rising_edge(clock);
      if pauses = 0 then
        for master in made'range loop
          check(abs (made(master) - made(0)) <= 1, "the turns of master " & integer'image(master));
        end loop;
      end if;
    end loop;
    wait until summed(0) = '1';
    report_passed("wishbone_arbiter_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * blocks * masters * 60, "wishbone_arbiter_tb");

end architecture;
