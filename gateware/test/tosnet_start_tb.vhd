-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_start: the bench is the rest of the ring. It gives packets and checks what the node sends, as a slave, as the
-- master, and as a node that may not be master. All packets may be damaged, and lists may be wrong in any way.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.textio.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_bench_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_start_tb is
  generic (
    may_be_master   : boolean  := true;
    most_nodes      : positive range 2 to 15 := 5;
    election_clocks : positive := 3000;
    symbol_clocks   : positive := 10; -- from one byte to the next
    script_file     : string   := ""; -- of tests/gateware/tosnet_election.py: packets, and what must follow
    seed            : positive := 1
  );
end entity;

architecture test of tosnet_start_tb is

  type bytes_t is array (0 to 15) of byte_t;

  constant own_mask : byte_t := x"83";

  signal clock     : std_ulogic := '0';
  signal reset     : std_ulogic := '1';
  signal ended     : boolean := false;
  signal id        : std_ulogic_vector(3 downto 0) := x"7";
  signal restart   : std_ulogic := '0';
  signal cause     : trouble_t  := trouble_none;
  signal start, valid, done, good : std_ulogic := '0';
  signal data      : byte_t := x"00";
  signal item_valid : std_ulogic;
  signal item_data  : item_t;
  signal running, begins, restarted, is_master : std_ulogic;
  signal master_id   : std_ulogic_vector(3 downto 0);
  signal own_address : unsigned(3 downto 0);
  signal nodes       : unsigned(3 downto 0);
  signal members     : std_ulogic_vector(15 downto 0);
  signal trouble     : trouble_t;
  signal write_entry, write_mask : std_ulogic;
  signal write_index : unsigned(3 downto 0);
  signal write_data  : byte_t;

  shared variable sent : sent_items_t;

  signal entries, masks : bytes_t; -- of the table
  signal begun, restarts : natural := 0;

begin

  clock <= not clock after 10 ns when not ended;

  dut : entity work.tosnet_start
    generic map (may_be_master => may_be_master, most_nodes => most_nodes, election_clocks => election_clocks)
    port map (
      clock => clock, reset => reset, id => id, registers => own_mask, restart => restart, cause => cause,
      start => start, valid => valid, data => data, done => done, good => good, item_valid => item_valid,
      item_data => item_data, running => running, begins => begins, restarted => restarted,
      is_master => is_master, master_id => master_id, own_address => own_address, nodes => nodes,
      members => members, trouble => trouble, write_entry => write_entry, write_mask => write_mask,
      write_index => write_index, write_data => write_data);

  watch : process is
  begin
    wait until rising_edge(clock) and reset = '0';
    if item_valid = '1' then
      sent.add(item_data);
    end if;
    if write_entry = '1' then
      entries(to_integer(write_index)) <= write_data;
    end if;
    if write_mask = '1' then
      masks(to_integer(write_index)) <= write_data;
    end if;
    begun    <= begun + 1 when begins = '1';
    restarts <= restarts + 1 when restarted = '1';
  end process;

  play : process is

    constant cut_list : string := "5403";
    variable random : random_t;
    variable before : natural;

    procedure check_sent (expected : string; what : string) is
      constant got : string := sent.taken;
    begin
      check(got = expected, what & ": the node sends """ & got & """ instead of """ & expected & """");
    end procedure;

    -- A packet of hexadecimal digits comes, and the node answers with `expected`. What it says by itself comes before,
    -- or after a longer wait. The node is told to start again restart_clocks after byte restart_byte.
    procedure packet (
      text : string; expected : string := ""; is_good : boolean := true; restart_byte : integer := -1;
      restart_clocks : natural := 0) is
      alias digits : string(1 to text'length) is text;
      variable clocks : natural; -- until the next byte
    begin
      check_sent("", "before " & text);
      start <= '1';
      tick(clock);
      start <= '0';
      tick(clock, 2 * symbol_clocks);
      for index in 0 to text'length / 2 - 1 loop
        data  <= std_ulogic_vector(to_unsigned(16 * digit_value(digits(2 * index + 1))
                                               + digit_value(digits(2 * index + 2)), 8));
        clocks := symbol_clocks;
        valid  <= '1';
        if index = restart_byte then
          if restart_clocks > 0 then
            tick(clock);
            valid <= '0';
            tick(clock, restart_clocks - 1);
          end if;
          clocks := symbol_clocks - restart_clocks;
          restart <= '1';
        end if;
        tick(clock);
        restart <= '0';
        valid   <= '0';
        tick(clock, clocks - 1);
      end loop;
      done <= '1';
      good <= to_bit(is_good);
      tick(clock);
      done <= '0';
      good <= random.vector(1)(0);
      tick(clock, symbol_clocks);
      check_sent(expected, "after " & text);
    end procedure;

    procedure check_restart (why : trouble_t; what : string) is
    begin
      check_equal(restarts, before + 1, "restarts: " & what);
      check_equal(running & is_master, "00", "running, is_master: " & what);
      check_equal(trouble, why, "trouble: " & what);
      before := restarts;
    end procedure;

    procedure again (why : trouble_t := trouble_silence) is
    begin
      restart <= '1';
      cause   <= why;
      tick(clock);
      restart <= '0';
      tick(clock, 2);
    end procedure;

    -- Node 3 is the master, then come 9, this one, and C.
    procedure slave_counts is
    begin
      packet("33", "33.");
      check_equal(master_id, x"3", "the master's id");
      packet("420319", "43031927.");
    end procedure;

    procedure slave_registers is
    begin
      slave_counts;
      packet("540319273C", "540319273C.");
      packet("600101FFFF", "600101FFFF8383.");
    end procedure;

    procedure slave_runs is
    begin
      slave_registers;
      packet("700101FFFF83830000", "700101FFFF83830000.");
      check_equal(running, '1', "a slave runs");
    end procedure;

    procedure play_slave is
    begin
      slave_runs;
      check_equal(begun, 1, "begins");
      check_equal(is_master, '0', "a slave");
      check_equal(to_integer(nodes), 4, "the nodes");
      check_equal(to_integer(own_address), 2, "the own address");
      check_equal(members, x"1288", "the members");
      check_equal(trouble, trouble_none, "trouble of a ring that runs");
      check_equal(entries(0) & entries(1) & entries(2) & entries(3), x"0319273C", "the entries");
      check_equal(masks(0) & masks(1) & masks(2) & masks(3), x"01FF8300", "the masks");

      -- In a running ring, only MASTER_DSC and `restart` matter.
      packet("A0123456");
      packet("420319");
      packet("540319273C");
      packet("700101FFFF83830000");
      packet("23", is_good => false);
      check_equal(running, '1', "still running");
      check_equal(members, x"1288", "the members after lists that come too late");
      before := restarts;
      packet("23", "23.");
      check_restart(trouble_restart, "a lower id comes");
      slave_runs;
      packet("29", "27.");
      check_restart(trouble_restart, "a higher id comes");
      slave_runs;
      again(trouble_line);
      check_restart(trouble_line, "the node is told to");

      -- A ring that this node cannot be in.
      slave_counts;
      packet("550319273C4D", "550319273C4D.");
      check_equal(to_integer(nodes), 5, "as many nodes as there may be");
      again;
      before := restarts;
      slave_counts;
      packet("560319273C4D5E", "560319273C4D5E.");
      check_restart(trouble_too_many, "too many nodes in NET_SET");
      packet("33", "33.");
      packet("450319203C4D", "");
      check_restart(trouble_too_many, "no room for this node in NET_DSC");
      slave_counts;
      packet("540319283C", "540319283C.");
      check_restart(trouble_other_list, "another node at this address");
      slave_counts;
      packet("5403192739", "5403192739.");
      check_restart(trouble_same_id, "an id twice");
      slave_counts;
      packet("540319272C", "540319272C.");
      check_restart(trouble_other_list, "an address that is not in order");
      slave_counts;
      packet("5403192" & "7", "54031927.");
      check_restart(trouble_other_list, "a list that is too short");
      slave_counts;
      packet("520319", "520319.");
      check_restart(trouble_other_list, "a list that ends before this node");
      slave_registers;
      packet("700101FFFE83830000", "700101FFFE83830000.");
      check_restart(trouble_masks, "two masks that differ");
      slave_registers;
      packet("700101FFFF8383", "700101FFFF8383.");
      check_restart(trouble_masks, "masks that are missing");

      -- Damaged lists are passed on poisoned, and change nothing else.
      packet("33", is_good => false);
      packet("33", "33.");
      packet("420319", "430319!", false);
      packet("420319", "43031927.");
      packet("540319283C", "540319283C!", false);
      packet("540319273C", "540319273C.");
      packet("600101FFFF", "600101FFFF!", false);
      packet("600101FFFF", "600101FFFF8383.");
      packet("700101FFFE83830000", "700101FFFE83830000!", false);
      check_equal(running, '0', "running after a damaged list");
      packet("700101FFFF83830000", "700101FFFF83830000.");
      check_equal(running, '1', "running after a damaged list and a good one");
      check_equal(restarts, before, "restarts because of damage");
      again;

      -- Of a list in which the node starts again, nothing is sent behind this moment. The byte that looks like
      -- MASTER_DSC is none.
      for clocks in 0 to 4 loop
        slave_counts;
        packet("540319272C", cut_list(1 to 2 * minimum(clocks + 1, 2)), restart_byte => 1, restart_clocks => clocks);
        check_equal(is_master & running, "00", "a restart in the middle of a list");
        slave_registers;
        packet("700101FFFF83830000", "7001", restart_byte => 1, restart_clocks => 4);
      end loop;
    end procedure;

    procedure master_counts is
    begin
      packet("27", "37.");
      packet("37", "4107.");
      check_equal(is_master, '1', "the master");
      check_equal(master_id, x"7", "the master's own id");
      check_equal(to_integer(own_address), 0, "the master's address");
    end procedure;

    procedure master_registers is
    begin
      master_counts;
      packet("430719" & "2C", "530719" & "2C.");
      packet("530719" & "2C", "608383.");
      check_equal(to_integer(nodes), 3, "the nodes that the master counts");
    end procedure;

    procedure play_master is
    begin
      before := restarts;
      master_registers;
      packet("6083830101FFFF", "7083830101FFFF.");
      check_equal(running, '0', "the master does not run yet");
      packet("7083830101FFFF", "");
      check_equal(running & is_master, "11", "the master runs");
      check_equal(members, x"1280", "the members");
      check_equal(entries(0) & entries(1) & entries(2), x"07192C", "the master's entries");
      check_equal(masks(0) & masks(1) & masks(2), x"8301FF", "the master's masks");
      packet("29", "27.");
      check_restart(trouble_restart, "a higher id comes to the master");

      -- Ids that were under way when it had claimed to be master.
      packet("27", "37.");
      packet("29", "");
      packet("39", "");
      check_restart(trouble_restart, "a higher node claims to be master");
      packet("27", "37.");
      packet("23", "23.");
      packet("33", "33.");
      check_equal(is_master, '0', "a lower id wins");
      again;
      before := restarts;
      packet("37", ""); -- it has not claimed it

      master_counts;
      packet("430719" & "2C", "530719" & "2C!", false);
      packet("430719" & "2C", "530719" & "2C.");
      packet("530719" & "27", "");
      check_restart(trouble_same_id, "the master's id twice");
      master_counts;
      packet("460719" & "2C3D4E5F", "560719" & "2C3D4E5F.");
      packet("560719" & "2C3D4E5F", "");
      check_restart(trouble_too_many, "more nodes than the master has room for");
      master_registers;
      packet("6083830101FFFF", "7083830101FFFF.");
      packet("7083830101FF", "");
      check_restart(trouble_masks, "a mask is missing at the master");
    end procedure;

    -- Each line: a packet in digits, "." if it is good and "!" if not, "=" and what the node sends, and two bits:
    -- whether it runs, and is the master.
    procedure play_script is
      file script   : text open read_mode is script_file;
      variable one  : line;

      impure function word return string is
        variable result : string(1 to 200);
        variable last   : natural   := 0;
        variable letter : character := ' ';
        variable good   : boolean   := true;
      begin
        loop
          read(one, letter, good);
          exit when not good or letter = ' ';
          last := last + 1;
          result(last) := letter;
        end loop;
        return result(1 to last);
      end function;

      procedure play_line (digits : string) is
        constant mark   : string := word;
        constant answer : string := word;
        constant state  : string := word;
      begin
        packet(digits, answer(2 to answer'length), mark = ".");
        check(to_string(std_ulogic_vector'(running & is_master)) = state, "running, is_master after " & digits);
      end procedure;

    begin
      while not endfile(script) loop
        readline(script, one);
        play_line(word);
      end loop;
    end procedure;

    -- The node speaks by itself, at these distances.
    procedure hear (expected : string) is
      variable waited : natural := 0;
    begin
      check_sent("", "before the node speaks by itself");
      while item_valid = '0' loop
        tick(clock);
        waited := waited + 1;
        check(waited <= 2 * election_clocks, "the node says nothing");
      end loop;
      tick(clock, 4);
      check_sent(expected, "what a node says by itself");
    end procedure;

  begin
    random.seed(seed);
    tick(clock, 5);
    reset <= '0';
    for count in 1 to 100 loop
      tick(clock);
      check_equal(item_valid, '0', "a node speaks right after its reset");
    end loop;
    hear("27.");
    if script_file /= "" then
      play_script;
      report_passed("tosnet_start_tb");
      ended <= true;
      wait;
    end if;
    hear("27.");
    play_slave;
    hear("27.");

    -- Of 32 foreign ids, one is dropped.
    before := 0;
    for number in 1 to 64 loop
      start <= '1';
      tick(clock);
      start <= '0';
      data  <= x"22";
      valid <= '1';
      tick(clock);
      valid <= '0';
      tick(clock, 2);
      done <= '1';
      good <= '1';
      tick(clock);
      done <= '0';
      tick(clock, 4);
      if sent.taken = "" then
        before := before + 1;
      end if;
    end loop;
    check_equal(before, 2, "ids that are dropped");
    again;

    if may_be_master then
      play_master;
    else
      packet("27", "");
      check_equal(trouble, trouble_no_master, "a node that may not be master has the lowest id");
      packet("37", "");
      check_equal(is_master, '0', "a node that may not be master");
      hear("27.");
    end if;

    again; -- a reset ends all
    slave_runs;
    reset <= '1';
    tick(clock, 2);
    check_equal(running & item_valid, "00", "running, item_valid in the reset");
    check_equal(members, x"0000", "the members in the reset");
    reset <= '0';
    if 5 * symbol_clocks < 100 then
      packet("33", ""); -- it does not listen yet
    end if;
    report_passed("tosnet_start_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 sec, "tosnet_start_tb");

end architecture;
