-- SPDX-License-Identifier: BSD-3-Clause
--
-- The small entities of the framed application, each alone: frame_clock, frame_memory, frame_bus, frame_dispatcher,
-- frame_sequencer.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;

entity frame_units_tb is
end entity;

architecture bench of frame_units_tb is

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;

  signal time_now : unsigned(31 downto 0);
  signal half, look, turned : std_ulogic := '0';

  constant content : word_memory_t(0 to 7) := (3 => x"FFFFFFFE", 5 => x"0000FFFF", others => x"00000000");
  signal index : unsigned(2 downto 0) := "000";
  signal store : std_ulogic_vector(1 downto 0) := store_nothing;
  signal enable : std_ulogic := '1';
  signal put_word, word : word32_t := x"00000000";

  signal reads, writes, hold, free, found, over, failed, silent_bus, denied_write : std_ulogic := '0';
  signal address      : std_ulogic_vector(11 downto 0) := x"123";
  signal written      : word32_t := x"89ABCDEF";
  signal bii_request  : bii_request_t;
  signal bii_response : bii_response_t := bii_response_idle;

  signal d_turned, tripped, publish, room, rx_overrun, publish_overrun, frame_valid, asks, begins, wants, pending,
         counted : std_ulogic := '0';
  signal frame_entry, choice : entry_t := "00010";

  function program return frame_program_t is
    variable p : frame_program_t(0 to 127) := (others => nothing_done);

    procedure set (place : natural; i : frame_instruction_t; following, condition, target : natural) is
    begin
      p(place) := i;
      p(place)(following_f) := std_ulogic_vector(to_unsigned(following, 9));
      p(place)(target_f)    := std_ulogic_vector(to_unsigned(target, 9));
      p(place)(condition_f) := std_ulogic_vector(to_unsigned(condition, 5));
    end procedure;
  begin
    for place in p'range loop
      p(place)(number_f) := std_ulogic_vector(to_unsigned(place, 8));  -- so that the position can be seen
    end loop;
    set(0, number(1) or act(do_begin), 0, never, 0);
    set(34, number(34) or times(3), 5, if_failed, 9);
    set(5, number(5) or for_size(times_size), 6, never, 0);
    set(6, number(6) or for_size(times_rest), 7, never, 0);
    set(7, number(7) or act(do_call), 20, never, 8);
    set(20, number(20), 21, never, 0);
    set(21, number(21) or act(do_return), 0, never, 0);
    set(8, number(8) or act(do_dispatch), 64, never, 0);
    set(66, number(66) or times(2) or act(do_begin), 0, never, 0);
    set(9, number(9), 12, if_low, 0);
    set(12, number(12) or act(do_begin), 0, never, 0);
    return p;
  end function;

  type entries_t is array (1 to 5) of natural;
  constant says_nothing : entries_t := (4, 6, entry_check, entry_long, entry_kind);

  signal act_now, holds, s_begins, rests, judges, steps, waits, first, last : std_ulogic := '0';
  signal size        : unsigned(2 downto 0) := "011";
  signal instruction : frame_instruction_t;

begin

  clock <= not clock after 5 ns when not ended;

  timer : entity work.frame_clock
    port map (clock => clock, reset => reset, time_now => time_now, half => half, look => look, turned => turned);

  memory : entity work.frame_memory
    generic map (content => content)
    port map (clock => clock, index => index, store => store, enable => enable, data => put_word, word => word);

  bus_access : entity work.frame_bus
    generic map (address_width => 12, data_width => 16)
    port map (
      clock => clock, reset => reset, read => reads, write => writes, hold => hold, free => free, address => address,
      data => written, found => found, done => over, failed => failed, silent_bus => silent_bus,
      denied_write => denied_write, bii_request => bii_request, bii_response => bii_response);

  dispatcher : entity work.frame_dispatcher
    port map (
      clock => clock, reset => reset, turned => d_turned, tripped => tripped, publish => publish, room => room,
      receive_overrun => rx_overrun, publish_overrun => publish_overrun, frame_valid => frame_valid,
      frame_entry => frame_entry, asks => asks, begins => begins, wants => wants, choice => choice, pending => pending,
      counted => counted);

  sequencer : entity work.frame_sequencer
    generic map (program => program, sizes => true)
    port map (
      clock => clock, reset => reset, act => act_now, holds => holds, begins => s_begins, entry => "00010",
      operation => "0010", size => size, instruction => instruction, rests => rests, judges => judges, steps => steps,
      waits => waits, first => first, last => last);

  play : process


    procedure at_place (place : natural; repetition_last : std_ulogic; is_first : std_ulogic := '0';
                        nothing_yet : std_ulogic := '0') is
    begin
      act_now <= not nothing_yet;
      wait for 1 ns;
      check_equal(to_integer(unsigned(instruction(number_f))), place, "the instruction");
      check_equal(last, repetition_last, "its last time, at " & integer'image(place));
      check_equal(judges, is_first, "its first clock, at " & integer'image(place));
      check_equal(waits, nothing_yet, "it does nothing yet, at " & integer'image(place));
      tick(clock);
    end procedure;

    -- An instruction that is executed once.
    procedure at_once (place : natural) is
    begin
      at_place(place, '1', '1', '1');
      at_place(place, '1');
    end procedure;

    procedure at_rest (clocks : positive) is
    begin
      for count in 1 to clocks loop
        wait for 1 ns;
        check_equal(rests & judges, "10", "no work yet");
        check_equal(instruction, nothing_done, "nothing is done");
        tick(clock);
      end loop;
    end procedure;

    procedure expects (number : natural; what : string) is
    begin
      asks <= '1';
      wait for 1 ns;
      check_equal(wants, '1', what & " is wanted");
      check_equal(to_integer(unsigned(choice)), number, what);
      tick(clock);
      check_equal(pending, '1', what & " is pending");
    end procedure;

  begin
    tick(clock, 2);
    reset <= '0';

    -- frame_clock
    tick(clock, 4);
    check_equal(to_integer(time_now), 4, "clocks since reset");
    check_equal(turned, '0', "half a turn");
    pulse(clock, look);
    check_equal(half, '0', "half");

    -- frame_memory
    index <= "011";
    tick(clock, 2);
    check_equal(word, x"FFFFFFFE", "a word of the content, two clocks later");
    store <= store_count;
    tick(clock);
    store <= store_nothing;
    tick(clock, 3);
    check_equal(word, x"FFFFFFFF", "one more");
    store <= store_count;
    tick(clock);
    store <= store_nothing;
    tick(clock, 3);
    check_equal(word, x"FFFFFFFF", "no more than full");
    store <= store_next;
    tick(clock);
    store <= store_nothing;
    tick(clock, 3);
    check_equal(word, x"00000000", "and around");
    put_word <= x"CAFE0123";
    index    <= "101";
    tick(clock);
    store <= store_count;
    tick(clock);
    store <= store_nothing;
    tick(clock, 3);
    check_equal(word, x"00010000", "the word that was addressed in the clock before is counted up");
    enable   <= '0';
    store    <= store_data;
    tick(clock);
    store    <= store_nothing;
    enable   <= '1';
    tick(clock, 3);
    check_equal(word, x"00010000", "nothing is stored unless it is enabled");
    store    <= store_data;
    tick(clock);
    index    <= "011";
    store    <= store_nothing;
    tick(clock, 2);
    check_equal(word, x"00000000", "another word is read while one is stored");
    index    <= "101";
    tick(clock, 2);
    check_equal(word, x"CAFE0123", "what was stored");

    -- frame_bus
    check_equal(bii_request.valid, '0', "no access");
    pulse(clock, hold);
    pulse(clock, reads);
    tick(clock, 3);
    check_equal(bii_request.valid & bii_request.write & bii_request.block_hold, "101", "a read, held");
    check_equal(bii_request.address, x"00000123", "address");
    check_equal(over, '0', "not done");
    bii_response <= (done => '1', status => ok, data => x"00005555");
    wait for 1 ns;
    check_equal(found, '1', "found");
    tick(clock);
    bii_response <= bii_response_idle;
    tick(clock);
    check_equal(bii_request.valid & over & failed & silent_bus, "0100", "done");
    pulse(clock, writes);
    check_equal(bii_request.valid & bii_request.write, "11", "a write");
    check_equal(bii_request.data, x"0000CDEF", "data, as wide as the bus");
    bii_response <= (done => '1', status => error, data => x"00000000");
    wait for 1 ns;
    check_equal(found, '0', "nothing found by a write");
    tick(clock);
    bii_response <= bii_response_idle;
    check_equal(over & failed & silent_bus, "110", "refused");
    pulse(clock, free);
    check_equal(bii_request.block_hold, '0', "free");
    pulse(clock, reads);
    check_equal(over, '0', "another one");
    bii_response <= (done => '1', status => silent, data => x"00000000");
    tick(clock);
    bii_response <= bii_response_idle;
    check_equal(over & failed & silent_bus, "111", "nobody answered");
    pulse(clock, reads);
    bii_response <= (done => '1', status => ok, data => x"00000000");
    tick(clock);
    bii_response <= bii_response_idle;
    check_equal(over & failed & silent_bus, "100", "all is well again");
    pulse(clock, writes);
    bii_response <= (done => '1', status => denied, data => x"00000000");
    tick(clock);
    bii_response <= bii_response_idle;
    check_equal(over & failed & silent_bus & denied_write, "1101", "the dead-man has tripped");
    pulse(clock, reads);
    bii_response <= (done => '1', status => error, data => x"00000000");
    tick(clock);
    bii_response <= bii_response_idle;
    check_equal(over & failed & silent_bus & denied_write, "1100", "refused, by a slave");
    pulse(clock, hold);
    pulse(clock, reads);
    pulse(clock, reset);
    check_equal(bii_request.valid & bii_request.block_hold, "00", "a reset ends the access and the hold");

    -- frame_dispatcher
    wait for 1 ns;
    check_equal(wants, '0', "nothing is wanted");
    tick(clock);
    check_equal(pending, '0', "nothing is pending");
    frame_valid <= '1';
    publish     <= '1';
    tripped     <= '1';
    d_turned    <= '1';
    pulse(clock, rx_overrun);
    pulse(clock, publish_overrun);
    expects(entry_half_turn, "half a turn");
    d_turned <= '0';
    expects(entry_receive_overrun, "an overrun");
    pulse(clock, begins);
    expects(entry_publish_overrun, "an overrun of publishes");
    pulse(clock, begins);
    expects(entry_trip, "a trip");
    begins <= '1';
    wait for 1 ns;
    check_equal(counted, '1', "the trip is counted");
    begins  <= '0';
    tripped <= '0';
    wait for 1 ns;
    check_equal(wants, '0', "neither a publish nor a request while there is no room");
    for silent in 1 to 5 loop
      frame_entry <= std_ulogic_vector(to_unsigned(says_nothing(silent), 5));
      expects(says_nothing(silent), "what says nothing");
    end loop;
    frame_entry <= "00010";
    room <= '1';
    expects(entry_publish, "a publish");
    publish <= '0';
    expects(2, "a frame");
    room <= '0';
    expects(2, "a frame, which waits by itself");

    -- frame_sequencer
    pulse(clock, reset);
    at_place(0, '1', '1', '1');  -- nothing is executed, and the first instruction is fetched
    at_place(0, '1');
    at_place(1, '1', '1');       -- it ends the work, so it has one clock
    at_rest(3);
    for bytes in 1 to 4 loop
      size     <= to_unsigned(bytes, 3);
      s_begins <= '1';
      at_rest(1);
      s_begins <= '0';
      at_place(34, '0', '1');
      at_place(34, '0');
      act_now <= '0';
      wait for 1 ns;
      check_equal(last, '1', "the last time, but it waits");
      tick(clock);
      at_place(34, '1');
      at_place(5, '0', '1', '1');  -- its number of times is loaded
      for count in 2 to bytes loop
        at_place(5, '0');
      end loop;
      at_place(5, '1');
      at_place(6, '0', '1', '1');
      for count in 2 to (3 - bytes) mod 4 + 1 loop
        at_place(6, '0');
      end loop;
      at_place(6, '1');
      at_once(7);
      at_once(20);
      at_once(21);
      at_once(8);
      at_place(66, '0', '1');
      at_place(66, '1');
      at_rest(1);        -- the entry is fetched
    end loop;
    s_begins <= '1';
    at_rest(1);
    s_begins <= '0';
    at_place(34, '0', '1');
    at_place(34, '0');
    holds <= '1';
    at_place(34, '1');
    holds <= '0';
    at_place(0, '1');  -- a jump costs a clock
    at_once(9);
    at_place(12, '1', '1');
    at_rest(1);

    report_passed("frame_units_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "frame_units_tb");

end architecture;
