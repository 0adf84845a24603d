-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_node: a master and a joint in a ring of two lines, from reset to exchanged words; then the joint alone,
-- which may not be master. Larger rings, faults and messages are in tosnet_ring_tb.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_node_tb is
  generic (
    clocks_per_bit : positive := 4;
    hop_bits       : positive := 75;
    watchdog_bits  : positive := 20000
  );
end entity;

architecture test of tosnet_node_tb is

  type ids_t is array (0 to 1) of std_ulogic_vector(3 downto 0);
  type words_t is array (0 to 1) of std_ulogic_vector(31 downto 0);
  type addresses_t is array (0 to 1) of std_ulogic_vector(9 downto 0);
  type troubles_t is array (0 to 1) of trouble_t;
  type counts_t is array (0 to 1) of natural;

  constant ids        : ids_t := (x"4", x"9");
  constant cycle_bits : positive := 10 * (18 + 64) + 2 * hop_bits;
  constant cycle_time : time     := cycle_bits * clocks_per_bit * 20 ns;

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic_vector(0 to 1) := "11";
  signal done        : boolean := false;
  signal alone       : boolean := false;
  signal line, entry : std_ulogic_vector(0 to 1);
  signal running, is_master, strobe, strobe_fresh, damaged : std_ulogic_vector(0 to 1);
  signal received_valid   : std_ulogic_vector(0 to 1);
  signal received_address : addresses_t;
  signal received_word    : words_t;
  signal send_address     : addresses_t;
  signal send_word        : words_t;
  signal trouble          : troubles_t;
  signal cycles           : counts_t := (0, 0);
  signal faults           : counts_t := (0, 0);

begin

  clock    <= not clock after 10 ns when not done;
  entry(0) <= line(1);
  entry(1) <= line(1) when alone else line(0);

  both : for place in 0 to 1 generate
    signal samples     : std_ulogic_vector(0 downto 0);
    signal table_entry : std_ulogic_vector(7 downto 0);
  begin
    input : entity work.synchroniser
      port map (clock => clock, asynchronous(0) => entry(place), levels => samples);

    dut : entity work.tosnet_node
      generic map (
        clocks_per_bit => clocks_per_bit, hop_bits => hop_bits, watchdog_bits => watchdog_bits,
        may_be_master => place = 0, most_nodes => 5, channel => place = 0)
      port map (
        clock => clock, reset => reset(place), line_in => samples, line_out => line(place), id => ids(place),
        registers => x"01", running => running(place), is_master => is_master(place), own_address => open,
        nodes => open, trouble => trouble(place), restarted => open, damaged => damaged(place),
        strobe => strobe(place), strobe_fresh => strobe_fresh(place), received_valid => received_valid(place),
        received_address => received_address(place), received_word => received_word(place),
        send_address => send_address(place), send_word => send_word(place), told => open, told_id => open,
        told_word => open, members => open, table_entry => table_entry,
        table_mask => open, to_ring_ready => open, from_ring_valid => open, from_ring_data => open,
        from_ring_last => open, from_ring_id => open, message_lost => open);

    user : process is
      variable words : natural := 0;
      variable owner : std_ulogic_vector(4 downto 0); -- id, IN
    begin
      wait until rising_edge(clock);
      send_word(place) <= x"ABCDE" & "00" & send_address(place);
      if received_valid(place) = '1' then
        words := words + 1;
        -- A word of its own at each address: the node's IN words, or the OUT words of the other one.
        check_equal(received_word(place)(9 downto 0), received_address(place), "the address in a word");
        owner := ids(1 - place) & '0';
        if place = 1 and received_address(place)(2) = '1' then
          owner := ids(place) & '1';
        end if;
        check_equal(received_address(place)(9 downto 6) & received_address(place)(2), owner, "of whom a word is");
      end if;
      if strobe(place) = '1' and not alone then
        check_equal(strobe_fresh(place), '1', "a cycle without a fault");
        check_equal(words, 4 + 4 * place, "words of a cycle");
        words         := 0;
        cycles(place) <= cycles(place) + 1;
      end if;
      if damaged(place) = '1' then
        faults(place) <= faults(place) + 1;
      end if;
    end process;
  end generate;

  play : process is
    variable began : time;
  begin
    wait_clocks(clock, 5);
    reset <= "00";
    wait until running = "11" for 100 * 16 * hop_bits * clocks_per_bit * 20 ns;
    check_equal(running, "11", "both run");
    check_equal(is_master, "10", "the master");
    wait until strobe(0) = '1';
    began := now;
    wait for 5 * cycle_time + cycle_time / 2;
    check_equal(cycles(0), 6, "cycles of the master");
    check(cycles(1) >= 5, "cycles of the joint");
    check_equal(faults(0) + faults(1), 0, "faults");
    wait until strobe(0) = '1';
    check(abs (now - began - 6 * cycle_time) < cycle_time / 4, "the length of a cycle");

    -- The joint alone hears itself.
    alone <= true;
    wait until running(1) = '0' for 2 * watchdog_bits * clocks_per_bit * 20 ns;
    check_equal(running(1), '0', "a joint without a master runs");
    wait for 100 * hop_bits * clocks_per_bit * 20 ns;
    check_equal(trouble(1), trouble_no_master, "a joint without a master");
    report_passed("tosnet_node_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "tosnet_node_tb");

end architecture;
