-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_channel: every word arrives once and in order, not before a cycle, and at most three per cycle. The capacity
-- is `depth`.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity tosnet_channel_tb is
  generic (
    depth : positive := 8;
    seed  : positive := 1
  );
end entity;

architecture test of tosnet_channel_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean := false;

  signal cycle                    : std_ulogic := '0';
  signal write_valid, write_ready : std_ulogic := '0';
  signal read_valid, read_ready   : std_ulogic := '0';
  signal pending                  : std_ulogic;
  signal write_data, read_data    : std_ulogic_vector(15 downto 0) := (others => '0');

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.tosnet_channel
    generic map (depth => depth, width => 16)
    port map (
      clock => clock, reset => reset, cycle => cycle,
      write_valid => write_valid, write_ready => write_ready, write_data => write_data, pending => pending,
      read_valid => read_valid, read_ready => read_ready, read_data => read_data);

  play : process is

    variable random    : random_t;
    variable sent      : natural := 0;
    variable arrived   : natural := 0; -- words that should have arrived so far
    variable taken     : natural := 0;
    variable waited    : natural := 0;

    procedure tick is
    begin
      wait until rising_edge(clock);
      check((write_ready = '1') = (sent - taken < depth), "room");
      check((pending = '1') = (arrived > taken), "pending");
      check(read_valid = '0' or pending = '1', "a word before its cycle");
      waited := waited + 1;
      if pending = '0' or read_valid = '1' then
        waited := 0;
      end if;
      check(waited < 3, "a word that has arrived does not come");
      if read_valid = '1' and read_ready = '1' then
        check_equal(read_data, std_ulogic_vector(to_unsigned(taken, 16)), "word");
        taken := taken + 1;
      end if;
      if write_valid = '1' and write_ready = '1' then
        sent := sent + 1;
      end if;
      if cycle = '1' then
        arrived := minimum(arrived + 3, sent);
      end if;
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 3);
    reset <= '0';
    for step in 1 to 6000 loop
      write_valid <= '1' when random.chance(40) else '0';
      write_data  <= std_ulogic_vector(to_unsigned(sent, 16));
      -- First the queue fills, then it drains.
      read_ready  <= '1' when random.chance(10 + 80 * ((step / 500) mod 2)) else '0';
      cycle       <= '1' when random.chance(15) else '0';
      tick;
    end loop;
    check(taken > 500, "few words have passed");

    write_valid <= '0';
    pulse(clock, reset);
    wait until rising_edge(clock);
    check_equal(pending, '0', "pending after a reset");
    check_equal(write_ready, '1', "room after a reset");
    report_passed("tosnet_channel_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 20000, "tosnet_channel_tb");

end architecture;
