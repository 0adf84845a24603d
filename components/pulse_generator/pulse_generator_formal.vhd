-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the pulses. Halves of a period and widths may end at any clock, the bus may do anything, and so may
-- both pins.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity pulse_generator_formal is
  port (
    clk       : in std_ulogic;
    reset     : in std_ulogic;
    m2s       : in wishbone_m2s_t;
    trigger   : in std_ulogic;
    stop      : in std_ulogic;
    frequency : in std_ulogic_vector(14 downto 0); -- these three show words of the design
    burst     : in std_ulogic_vector(15 downto 0);
    to_go     : in std_ulogic_vector(15 downto 0)
  );
end entity;

architecture properties of pulse_generator_formal is

  subtype word_t is unsigned(15 downto 0);

  signal s2m                   : wishbone_s2m_t;
  signal begun, finished, line : std_ulogic;
  signal clocks        : natural range 0 to 6 := 0;      -- since power-up
  signal reset_1       : std_ulogic := '1';              -- a clock ago, as all that ends in _1
  signal answered      : std_ulogic;
  signal write         : std_ulogic;                     -- a write ends in this clock
  signal is_off        : std_ulogic;                     -- it is a frequency of 0
  signal is_burst      : std_ulogic;                     -- it begins a burst, or ends it
  signal is_off_1, is_burst_1 : std_ulogic := '0';
  signal frequency_1   : std_ulogic_vector(frequency'range) := (others => '0');
  signal burst_1       : std_ulogic_vector(burst'range) := (others => '0');
  signal to_go_1       : word_t := (others => '0');
  signal stop_1, stop_2, stop_3, halted : std_ulogic := '0';
  signal stopped, stopped_1 : std_ulogic := '0';         -- the pin has stopped it
  signal line_1        : std_ulogic := '0';
  signal counts        : std_ulogic;                     -- a pulse of a burst begins

begin

  default clock is rising_edge(clk);

  dut : entity work.pulse_generator
    generic map (
      clock_hz => 4000, maximum_hz => 100, time_hz => 1000, filter_ns => 0, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, begun => begun, finished => finished,
      trigger => trigger, stop => stop, line => line);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  answered <= s2m.ack or s2m.err;
  write    <= s2m.ack and m2s.we;
  is_off   <= '1' when write = '1' and unsigned(m2s.adr) = 0 and unsigned(frequency) = 0 else '0';
  is_burst <= '1' when write = '1' and unsigned(m2s.adr) = 3 else '0';
  stopped  <= stop_3 or halted;
  counts   <= begun and or burst_1;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      reset_1 <= reset;
      if clocks < 6 then
        clocks <= clocks + 1;
      end if;
      is_off_1    <= is_off;
      is_burst_1  <= is_burst;
      frequency_1 <= frequency;
      burst_1     <= burst;
      to_go_1     <= unsigned(to_go);
      stop_1      <= stop;
      stop_2      <= stop_1;
      stop_3      <= stop_2;
      stopped_1   <= stopped;
      line_1      <= line;
      halted      <= stop_3 or halted;
      if write = '1' and unsigned(m2s.adr) = 0 then
        halted <= stop_3;
      end if;
      if reset = '1' then
        halted    <= '0';
        line_1    <= '0';
        stopped_1 <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up until the synchronisers have settled, and may be reset at any later clock.
  reset_first : assume always clocks >= 6 or reset = '1';

  -- There is no block during power-up.
  quiet_first : assume always clocks >= 6 or (m2s.cyc = '0' and m2s.stb = '0');

  -- The master waits for the answer to each access.
  patient : assume always m2s.stb = '1' and answered = '0' and reset = '0' -> next (m2s.stb = '1');

  -- begun is high in the first clock of a pulse, and only there.
  begun_is_the_edge : assert always clocks < 6 or begun = (line and not line_1);

  -- No pulse begins while the frequency is 0.
  off_is_off : assert always clocks >= 6 and begun = '1' -> or frequency_1 = '1';

  -- Four clocks after the pin stops it, the line rests, until a frequency is written behind the stop.
  stop_cuts : assert always clocks >= 6 and stopped_1 = '1' -> line = '0';

  -- A stop and a frequency of 0 end the burst.
  burst_ends : assert always clocks >= 6 and (stopped_1 = '1' or is_off_1 = '1') -> unsigned(to_go) = 0;

  -- A pulse begins only if one is to go, when there are bursts.
  not_more : assert always clocks >= 6 and counts = '1' -> to_go_1 /= 0;

  -- What is to go is one less with each pulse, and changes by nothing else until it is 0, but by a write.
  one_less : assert always clocks >= 6 and reset_1 = '0' and stopped_1 = '0' and is_off_1 = '0' and is_burst_1 = '0' and
             to_go_1 /= 0 -> unsigned(to_go) = to_go_1 - unsigned'("" & counts);

  -- Then it stays 0, or a trigger makes it a whole burst.
  whole_burst : assert always clocks >= 6 and reset_1 = '0' and is_burst_1 = '0' and to_go_1 = 0 ->
                unsigned(to_go) = 0 or to_go = burst_1;

  -- finished comes only when a pulse is over.
  finished_is_an_end : assert always clocks >= 6 and finished = '1' -> line_1 = '1' and line = '0';

  -- A frequency above the highest one is refused, and so is a write of the pulses.
  refused : assert always clocks >= 6 and write = '1' -> unsigned(m2s.adr) < 4 and
            (unsigned(m2s.adr) /= 0 or unsigned(m2s.dat(15 downto 0)) <= 25_600);

  -- A burst comes to its end.
  burst_seen : cover {finished = '1' and stopped_1 = '0' and is_off_1 = '0'};

  -- A pulse is cut by the pin.
  cut_seen : cover {line = '1'; line = '0' and stopped_1 = '1' and reset_1 = '0'};

end architecture;
