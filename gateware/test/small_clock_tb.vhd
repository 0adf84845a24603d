-- SPDX-License-Identifier: BSD-3-Clause
--
-- The clock of framed_small at the moment at which its 16 bits in hardware turn. Each of several devices begins one
-- clock later than the one before, and all get the same bytes. So they read their clocks at every place around the
-- turn. What they tell never goes back.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.settings_pkg.all;
use work.stream_bench_pkg.all;

entity small_clock_tb is
  generic (
    first_start : natural := 63032  -- of the first device: it reads its clock just before the turn
  );
end entity;

architecture bench of small_clock_tb is

  constant devices   : positive := 12;
  constant turn      : positive := 65536;
  constant turn_late : positive := 8;    -- clocks behind the turn at which at least one device reads
  constant again     : positive := 600;  -- clocks in which a device counts the turn and begins the request anew

  constant settings : settings_t := core_settings(
    protocol => protocol_framed, publish_mode => 0, exchanges => 0, lists => false, deadman => false, window => 8);

  type times_t is array (0 to devices - 1) of natural;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal told  : times_t    := (others => 0);
  signal done  : std_ulogic_vector(0 to devices - 1) := (others => '0');
  signal ended : boolean    := false;

begin

  clock <= not clock after 5 ns when not ended;
  reset <= '0' after 22 ns;

  each : for number in 0 to devices - 1 generate

    signal frame_valid, frame_ready : std_ulogic := '0';
    signal frame_data : std_ulogic_vector(7 downto 0) := x"00";
    signal wire_valid, wire_last : std_ulogic;
    signal wire_data : std_ulogic_vector(7 downto 0);

  begin

    framed_small : entity work.framed_small
      generic map (settings => settings, clock_start => first_start + number)
      port map (
        clock => clock, reset => reset, frame_valid => frame_valid, frame_ready => frame_ready,
        frame_data => frame_data, tx_valid => wire_valid, tx_ready => '1', tx_data => wire_data, tx_last => wire_last,
        dead_man_request => open, bii_request => open, bii_response => bii_response_idle);

    play : process
      variable code, place : natural := 0;
      variable time_low    : unsigned(31 downto 0) := (others => '0');
    begin
      wait until falling_edge(clock) and reset = '0';
      send_all(clock, frame_valid, frame_ready, frame_data, x"80030101FA928300");
      wait until rising_edge(clock) and wire_valid = '1' and wire_last = '1';
      send_all(clock, frame_valid, frame_ready, frame_data, x"81010401123401A1DF8200");
      -- OPEN's answer: kind, COBS of the epoch (2) and the clock (4)
      wait until rising_edge(clock) and wire_valid = '1';
      check_equal(wire_data, x"D1", "OPEN is answered");
      while place < 7 loop
        wait until rising_edge(clock) and wire_valid = '1';
        if code = 0 then
          code := to_integer(unsigned(wire_data));
          if place > 0 then
            time_low := time_low(23 downto 0) & x"00";
          end if;
        else
          time_low := time_low(23 downto 0) & unsigned(wire_data);
        end if;
        code  := code - 1;
        place := place + 1;
      end loop;
      told(number) <= to_integer(time_low(30 downto 0));
      done(number) <= '1';
      wait;
    end process;

  end generate;

  judge : process
    variable before, late : integer;
  begin
    wait until and done = '1';
    before := told(0) - first_start;  -- clocks from the reset to the reading
    check(told(0) < turn and first_start + devices - 1 + before >= turn + turn_late,
      "the devices read their clocks around the turn: choose first_start so that " & integer'image(told(0))
      & " becomes " & integer'image(turn - 2));
    for number in 1 to devices - 1 loop
      late := told(number) - (first_start + number) - before;
      check(late = 0 or (told(number) >= turn and late < again), "device " & integer'image(number) & " tells "
        & integer'image(told(number)) & " behind " & integer'image(told(number - 1)));
    end loop;
    report_passed("small_clock_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "small_clock_tb");

end architecture;
