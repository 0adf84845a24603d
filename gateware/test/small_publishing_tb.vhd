-- SPDX-License-Identifier: BSD-3-Clause
--
-- small_publishing: strobes at their period, how many can wait, events by level and by edge, and its marks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.protocol_pkg.all;
use work.small_instruction_pkg.all;

entity small_publishing_tb is
  generic (
    base_hz : positive := 100
  );
end entity;

architecture bench of small_publishing_tb is

  constant period : positive := 10;

  constant edges : std_ulogic_vector(255 downto 0) := (1 => '1', others => '0');  -- group 0: level, group 1: edge

  signal clock  : std_ulogic := '0';
  signal reset  : std_ulogic := '1';
  signal ended  : boolean := false;
  signal events : std_ulogic_vector(1 downto 0) := "00";
  signal notes  : small_actions_t := (others => '0');
  signal given  : byte_t := (others => '0');
  signal sent   : std_ulogic := '0';
  signal wants  : std_ulogic_vector(6 downto 0);
  signal alert, hold, is_publish : std_ulogic;

begin

  clock <= not clock after 5 ns when not ended;

  small_publishing : entity work.small_publishing
    generic map (clock_hz => 1000, base_hz => base_hz, groups => 2, edge_events => edges)
    port map (
      clock => clock, reset => reset, events => events, notes => notes, given => given, sent => sent, wants => wants,
      alert => alert, hold => hold, is_publish => is_publish);

  play : process

    -- An action of the program, in one clock.
    procedure note (action : natural; data : natural := 0) is
    begin
      notes(action) <= '1';
      given <= byte_t(to_unsigned(data, 8));
      wait until rising_edge(clock);
      notes <= (others => '0');
      given <= x"00";
    end procedure;

    -- Take all strobes that wait.
    procedure take_strobes (count : natural; what : string) is
      variable taken : natural := 0;
    begin
      wait_clocks(clock, 2);
      while wants(6) = '1' loop
        taken := taken + 1;
        note(note_strobe_taken);
        wait_clocks(clock, 1);
      end loop;
      check(taken = count, what & ": " & integer'image(taken) & " strobes");
    end procedure;

    procedure expect (events_wait : std_ulogic_vector(1 downto 0); what : string) is
    begin
      wait_clocks(clock, 2);
      check_equal(wants(5 downto 0), "0000" & events_wait, what);
    end procedure;

    variable clocks : natural;
  begin
    wait_clocks(clock, 3);
    reset <= '0';
    wait_clocks(clock, 2 * period);
    check_equal(alert, '0', "nothing while publishing is off");
    note(note_publishing, 1);
    wait_clocks(clock, 2);
    check_equal(wants(6), '1', "the first strobe comes at once");
    note(note_strobe_taken);
    for turn in 1 to 5 loop
      clocks := 0;
      loop
        wait_clocks(clock, 1);
        clocks := clocks + 1;
        exit when wants(6) = '1';
      end loop;
      check(turn = 1 or clocks = period - 1, "the period: " & integer'image(clocks));
      note(note_strobe_taken);
    end loop;
    note(note_publishing, 0);
    note(note_publishing, 1);
    wait_clocks(clock, 3 * period + 3);
    note(note_publishing, 0);
    take_strobes(0, "those that waited are over when publishing is off");
    note(note_publishing, 1);
    wait_clocks(clock, 3 * period + 5);
    take_strobes(4 + 1, "four wait, and one comes while they are taken");
    note(note_publishing, 0);
    note(note_publishing, 1);
    wait_clocks(clock, 20 * period);
    take_strobes(15 + 3, "fifteen wait, and three come while they are taken");
    note(note_publishing, 0);

    events <= "11";
    expect("00", "events that do not count");
    events <= "00";
    note(note_enabled, 3);
    expect("00", "no event before");
    events <= "11";
    expect("11", "events wait");
    check_equal(alert, '0', "they alert nobody while publishing is off");
    note(note_publishing, 1);
    wait_clocks(clock, 4);
    note(note_strobe_taken);
    wait_clocks(clock, 2);
    check_equal(alert, '1', "then they do");
    note(note_events_taken, 3);
    expect("01", "a level comes again, an edge does not");
    events <= "00";
    wait_clocks(clock, 1);
    note(note_events_taken, 2);
    expect("01", "an event of another group stays");
    note(note_events_taken, 1);
    expect("00", "taken");
    events <= "10";
    note(note_enabled, 0);
    note(note_events_taken, 255);
    events <= "11";
    expect("00", "switched off");
    events <= "00";
    note(note_strobe_taken);
    note(note_strobe_taken);

    reset <= '1';
    wait_clocks(clock, 1);
    reset <= '0';
    note(note_publishing, 1);
    wait_clocks(clock, 2);
    note(note_strobe_taken);
    wait_clocks(clock, 2);
    check_equal(alert, '0', "nothing to do");
    note(note_due, 16#20#);
    wait_clocks(clock, 2);
    check_equal(alert, '1', "the program has something to publish");
    note(note_due, 0);
    wait_clocks(clock, 2);
    check_equal(alert, '0', "no more");

    note(note_hold, 1);
    note(note_publish);
    wait_clocks(clock, 2);
    check_equal(hold & is_publish, "11", "marks");
    note(note_hold, 0);
    wait_clocks(clock, 1);
    check_equal(hold & is_publish, "01", "the bus is free");
    sent <= '1';
    wait_clocks(clock, 1);
    sent <= '0';
    wait_clocks(clock, 1);
    check_equal(is_publish, '0', "sent");
    report_passed("small_publishing_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "small_publishing_tb");

end architecture;
