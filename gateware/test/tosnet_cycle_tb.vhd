-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_cycle: the length of a cycle, what it counts, and when it halts. The bench of tosnet_slave compares it with
-- the twin under random traffic.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity tosnet_cycle_tb is
  generic (
    cycle_clocks       : positive := 5;
    max_skipped_writes : natural  := 3
  );
end entity;

architecture test of tosnet_cycle_tb is

  constant clock_period : time := 20 ns;

  signal clock                    : std_ulogic := '0';
  signal reset                    : std_ulogic := '1';
  signal done                     : boolean := false;
  signal online                   : std_ulogic := '1';
  signal damaged, pending         : std_ulogic := '0';
  signal ends, exchange           : std_ulogic;
  signal was_online, packet_error : std_ulogic;
  signal halted, read_pointer     : std_ulogic;
  signal packets, resets, errors  : unsigned(31 downto 0);

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.tosnet_cycle
    generic map (cycle_clocks => cycle_clocks, max_skipped_writes => max_skipped_writes)
    port map (
      clock => clock, reset => reset, online => online, damaged => damaged, pending => pending,
      ends => ends, exchange => exchange, was_online => was_online, packet_error => packet_error, halted => halted,
      read_pointer => read_pointer, packets => packets, resets => resets, errors => errors);

  play : process is

    -- Waits for the end of a cycle, with or without a commit.
    procedure pass (commit : std_ulogic := '0') is
      variable before : std_ulogic;
    begin
      pending <= commit;
      for step in 1 to cycle_clocks - 1 loop
        check_equal(ends, '0', "the end of a cycle");
        tick(clock);
      end loop;
      check_equal(ends, '1', "the end of a cycle");
      check_equal(exchange, online, "an exchange");
      before := read_pointer;
      tick(clock);
      check_equal(read_pointer, not before, "the read pointer");
      pending <= '0';
    end procedure;

  begin
    tick(clock, 2);
    reset <= '0';
    for count in 1 to 2 loop
      pass;
      check_equal(to_integer(packets), count, "packets");
    end loop;
    pass('1');
    for count in 1 to max_skipped_writes loop
      pass;
      check_equal(halted, '0', "halted");
    end loop;
    pass;
    check(max_skipped_writes = 0 or halted = '1', "halted after too many cycles without a commit");
    pass('1');
    check(max_skipped_writes = 0 or halted = '1', "a commit does not end a halt");

    online <= '0';
    pass;
    check_equal(to_integer(packets), max_skipped_writes + 5, "packets while offline");
    check_equal(was_online, '0', "the status while offline");
    check_equal(to_integer(resets), 0, "returns");
    pulse(clock, damaged);
    check_equal(to_integer(errors), 1, "errors");
    check_equal(packet_error, '1', "packet error");
    for step in 2 to cycle_clocks loop
      tick(clock);
    end loop;
    check_equal(packet_error, '1', "packet error while nothing else came");
    online <= '1';
    pass;
    check_equal(to_integer(resets), 1, "returns");
    check_equal(halted, '0', "halted after a return");
    check_equal(packet_error, '0', "packet error after a good cycle");

    report_passed("tosnet_cycle_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 2000, "tosnet_cycle_tb");

end architecture;
