-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_timing: the clocks of strobe, next packet, loss and silence, for the master and for each place of a slave.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;

entity tosnet_timing_tb is
  generic (
    hop_clocks      : positive := 30;
    pause_clocks    : positive := 12;
    watchdog_clocks : positive := 1500;
    seed            : positive := 1
  );
end entity;

architecture test of tosnet_timing_tb is

  constant patience : positive := 6; -- hops that a packet may be late

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal done         : boolean := false;
  signal running, begins, is_master : std_ulogic := '0';
  signal own_address, nodes         : unsigned(3 downto 0) := "0000";
  signal good_packet, packet_done, fresh, sent : std_ulogic := '0';
  signal hold, give_up, due : std_ulogic := '0';
  signal strobe, strobe_fresh, send, lost, way_changed, silence : std_ulogic;

begin

  clock <= not clock after 10 ns when not done;

  dut : entity work.tosnet_timing
    generic map (hop_clocks => hop_clocks, pause_clocks => pause_clocks, watchdog_clocks => watchdog_clocks)
    port map (
      clock => clock, reset => reset, running => running, begins => begins, is_master => is_master,
      own_address => own_address, nodes => nodes, good_packet => good_packet, packet_done => packet_done,
      fresh => fresh, sent => sent, hold => hold, give_up => give_up,
      due => due, strobe => strobe, strobe_fresh => strobe_fresh, send => send, lost => lost,
      way_changed => way_changed, silence => silence);

  play : process is

    variable random : random_t;

    procedure packet (is_fresh : std_ulogic) is
    begin
      packet_done <= '1';
      fresh       <= is_fresh;
      good_packet <= is_fresh;
      tick(clock);
      packet_done <= '0';
      good_packet <= '0';
      fresh       <= not is_fresh;
    end procedure;

    -- Nothing happens for so many clocks.
    procedure nothing (clocks : natural) is
    begin
      for count in 1 to clocks loop
        tick(clock);
        check_equal(strobe & send & lost & way_changed & silence, "00000", "what happens in a wait");
      end loop;
    end procedure;

    procedure start_ring (master : std_ulogic) is
    begin
      is_master <= master;
      running   <= '1';
      begins    <= '1';
      tick(clock);
      begins    <= '0';
    end procedure;

    procedure stop_ring is
    begin
      running <= '0';
      tick(clock);
      good_packet <= '1';
      tick(clock);
      good_packet <= '0';
    end procedure;

    -- A packet of the master goes out after this wait.
    procedure master_sends (wait_clocks : natural) is
    begin
      nothing(wait_clocks - 1);
      tick(clock);
      check_equal(send, '1', "send");
      nothing(5);
      sent <= '1';
      tick(clock);
      sent <= '0';
    end procedure;

    variable is_fresh : std_ulogic;
    variable hops     : natural;

  begin
    random.seed(seed);
    tick(clock, 3);
    reset <= '0';

    -- A slave at each place.
    for count in 2 to 15 loop
      nodes       <= to_unsigned(count, 4);
      own_address <= to_unsigned(random.integer_between(1, count - 1), 4);
      start_ring('0');
      nothing(hop_clocks);
      for number in 1 to 2 loop
        is_fresh := random.vector(1)(0);
        packet(is_fresh);
        check_equal(strobe, '0', "a strobe at once");
        hops := count - to_integer(own_address);
        nothing(hops * hop_clocks - 1);
        tick(clock);
        check_equal(strobe, '1', "the strobe of a slave");
        check_equal(strobe_fresh, is_fresh, "whether it is fresh");
        packet('1');
        nothing(hop_clocks - 1);
        packet('1'); -- a new packet begins the wait anew
        nothing(hop_clocks - 1);
        stop_ring;
        nothing(16 * hop_clocks);
        running <= '1';
      end loop;
      stop_ring;
    end loop;

    -- The master.
    for count in 1 to 15 loop
      nodes       <= to_unsigned(count, 4);
      own_address <= "0000";
      start_ring('1');
      master_sends(pause_clocks);
      for number in 1 to 3 loop
        is_fresh := random.vector(1)(0);
        nothing(random.integer_between(1, 5));
        packet(is_fresh);
        check_equal(strobe, '1', "the strobe of the master");
        check_equal(strobe_fresh, is_fresh, "whether it is fresh");
        check_equal(way_changed, '0', "the way is the same");
        master_sends(pause_clocks);
      end loop;
      nothing(hop_clocks); -- as if there were a node more
      packet('1');
      check_equal(strobe & way_changed & strobe_fresh, "110", "strobe, way_changed, strobe_fresh of a longer way");
      stop_ring;
      start_ring('1');
      master_sends(pause_clocks);
      nothing((count + patience) * hop_clocks - 1);
      tick(clock);
      check_equal(strobe & lost & strobe_fresh, "110", "strobe, lost, strobe_fresh of a packet that does not come");
      packet('1'); -- too late for a strobe
      check_equal(strobe, '0', "the strobe of a packet that is late");
      stop_ring;

      -- Beside another ring: a packet waits, and one that is late is given up.
      start_ring('1');
      hold <= '1';
      nothing(pause_clocks);
      check_equal(due, '1', "a packet that waits");
      nothing(random.integer_between(1, 50));
      hold <= '0';
      tick(clock);
      check_equal(send & due, "10", "send, due of a packet that has waited");
      nothing(5);
      sent <= '1';
      tick(clock);
      sent <= '0';
      nothing(random.integer_between(1, hop_clocks));
      give_up <= '1';
      tick(clock);
      give_up <= '0';
      check_equal(strobe & lost & strobe_fresh, "110", "strobe, lost, strobe_fresh of a packet that is given up");
      master_sends(hop_clocks);
      hold <= '1';
      packet('1');
      tick(clock, pause_clocks + 1);
      check_equal(due, '1', "a packet that waits, again");
      stop_ring;
      check_equal(due, '0', "what is due in a ring that has stopped");
      hold <= '0';
    end loop;

    for number in 1 to 3 loop
      good_packet <= '1';
      tick(clock);
      good_packet <= '0';
      nothing(watchdog_clocks - 1);
      if number = 2 then
        next;
      end if;
      tick(clock);
      check_equal(silence, '1', "silence");
      nothing(watchdog_clocks - 1);
    end loop;
    report_passed("tosnet_timing_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "tosnet_timing_tb");

end architecture;
