-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_bridge with a node that is replaced by one of another spec, while one of two rings after the other is cut and
-- mended: the bridge is never online with that node in a ring, and it is online with the right one.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_spec_tb is
  generic (
    rings          : positive range 1 to 2 := 2;
    hand_overs     : natural  := 8; -- from one ring to the other
    talkative      : boolean  := false; -- each node always has a message to send
    watchdog_bits  : positive := 3000;
    seed           : positive := 1
  );
end entity;

architecture test of tosnet_spec_tb is

  constant clock_period : time := 20 ns;
  constant bit_time     : time := clock_period; -- four samples a clock
  constant cycle_time   : time := (10 * (18 + 32 * 2) + tosnet_ring_hop_bits_c * 3) * bit_time;
  constant longest_time : time := watchdog_bits * bit_time + 15 * cycle_time; -- until a ring is found anew
  constant spec         : std_ulogic_vector(31 downto 0) := x"12345678";

  -- The bridge, node 2, node 3 of the spec, node 3 of another one. Both nodes 3 are at place 2.
  constant places : positive := 3;

  type lines_t is array (0 to rings - 1) of std_ulogic_vector(0 to places - 1);

  signal clock   : std_ulogic := '0';
  signal reset   : std_ulogic := '1';
  signal absent  : std_ulogic_vector(2 to 4) := "111"; -- node 2, and the two nodes 3
  signal resets  : std_ulogic_vector(2 to 4);
  signal done    : boolean := false;
  signal lines   : lines_t; -- as they leave the node
  signal entries : lines_t; -- as they come to it
  signal cut     : lines_t := (others => (others => '0'));
  signal online  : std_ulogic;
  signal bridge_in  : std_ulogic_vector(4 * rings - 1 downto 0);
  signal bridge_out : std_ulogic_vector(rings - 1 downto 0);

  type exits_t is array (2 to 4) of std_ulogic_vector(rings - 1 downto 0);
  type specs_t is array (2 to 4) of std_ulogic_vector(31 downto 0);

  signal exits   : exits_t;
  constant specs : specs_t := (spec, spec, x"FEDCBA98");

begin

  clock  <= not clock after clock_period / 2 when not done;
  resets <= absent or (absent'range => reset);

  way : for ring in 0 to rings - 1 generate
    lines(ring)(0) <= bridge_out(ring);
    lines(ring)(1) <= exits(2)(ring);
    lines(ring)(2) <= exits(4)(ring) when absent(3) = '1' else exits(3)(ring);
    around : for place in 0 to places - 1 generate
      -- The second ring goes round the other way.
      entries(ring)(place) <= lines(ring)((place + 2 - ring) mod places) and not cut(ring)(place);
    end generate;
    bridge_in(4 * ring + 3 downto 4 * ring) <= (others => entries(ring)(0));
  end generate;

  dut : entity work.tosnet_bridge
    generic map (
      write_addresses => (16#084#, 16#0C4#), read_addresses => (16#080#, 16#0C0#), watchdog_bits => watchdog_bits,
      clocks_per_bit => 1, samples_per_clock => 4, rings => rings, exact_hops => rings = 2, line_clocks => 0,
      spec_word => spec)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s_idle, wishbone_s2m => open,
      line_in => bridge_in, line_out => bridge_out, cycle => open, committed => open, halted => open,
      online => online, troubles => open, time_valid => open, time_bits => open);

  nodes : for number in 2 to 4 generate

    constant id : natural := minimum(number, 3);
    signal own_entry   : std_ulogic_vector(4 * rings - 1 downto 0);
    signal own_words   : word_vector_t(0 to 0);
    signal has_message : std_ulogic;

  begin

    has_message <= to_bit(talkative);

    entry : for ring in 0 to rings - 1 generate
      own_entry(4 * ring + 3 downto 4 * ring) <= (others => entries(ring)(id - 1));
    end generate;

    node : entity work.tosnet_rings
      generic map (
        id => id, read_addresses => (0 => 64 * id + 4), write_addresses => (0 => 64 * id), may_be_master => false,
        most_nodes => places, watchdog_bits => watchdog_bits, clocks_per_bit => 1, samples_per_clock => 4,
        rings => rings, exact_hops => rings = 2, line_clocks => 0, spec_word => specs(number))
      port map (
        clock => clock, reset => resets(number), line_in => own_entry, line_out => exits(number),
        running => open, rings_running => open, is_master => open, own_address => open, nodes => open,
        troubles => open, damaged => open, strobe => open, exchange => open, missing => open, judged => open,
        other_spec => open, read_words => own_words, write_words => own_words, time_valid => open, time_bits => open,
        table_entry => open, table_mask => open, to_ring_valid => has_message, to_ring_ready => open,
        from_ring_valid => open, from_ring_ready => '1', from_ring_data => open, from_ring_last => open,
        from_ring_id => open);

  end generate;

  never : process (clock) is
  begin
    if rising_edge(clock) then
      check((online and not resets(4)) = '0', "online with a node of another spec");
    end if;
  end process;

  play : process is

    variable random : random_t;

    -- It takes longer than the rings need to notice it.
    procedure replace_by (number : positive range 3 to 4) is
    begin
      absent(3 to 4) <= "11";
      wait for random.integer_between(2500, 5000) * bit_time;
      absent(number) <= '0';
      wait for longest_time;
      check_equal(online, to_bit(number = 3), "online");
    end procedure;

    -- One ring is mended, and the other one is cut. That may be before the nodes have answered in the first, or before
    -- it runs.
    procedure hand_over (times : natural) is
    begin
      for count in 1 to times loop
        for ring in 0 to rings - 1 loop
          cut(ring) <= (others => '0');
          wait for random.integer_between(2000, 6000) * bit_time;
          cut(rings - 1 - ring)(random.integer_between(0, places - 1)) <= '1';
          wait for random.integer_between(100, 2000) * bit_time;
        end loop;
      end loop;
    end procedure;

  begin
    random.seed(seed);
    tick(clock, 4);
    reset  <= '0';
    absent <= "001";
    wait for longest_time;
    check_equal(online, '1', "online with the nodes of the spec");
    replace_by(4);
    hand_over(hand_overs);
    replace_by(3);
    hand_over(1);
    replace_by(4);
    report_passed("tosnet_spec_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 50 ms, "tosnet_spec_tb");

end architecture;
