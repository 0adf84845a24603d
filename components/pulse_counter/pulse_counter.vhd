-- SPDX-License-Identifier: BSD-3-Clause
--
-- Counts the pulses of one line, and measures when they come: flow meters, fans, Hall sensors, any frequency.
--
--   line  ____/‾‾‾‾\______/‾‾‾‾\_____     a pulse is a rising edge
--             |  period   |
--
--   +0  pulses so far; wraps at the word                         write: preset
--   +1  bit 0 pause: pulses are not counted                      write
--   +2  time of the last pulse, in 1/time_hz s since the reset; wraps at the word
--   +3  period: the time between the last two pulses, in 1/time_hz s. 0: it is not known, see below
--   +6  frequency in 1/256 Hz                                    (with_frequency 1, else err)
--
-- The words are in block RAM: see pulse_counter_words. All are of one moment, also in a block of accesses. So the
-- difference of +0 over that of +2 is the mean frequency between two reads, as exact as the ticks (see rate_pkg). A
-- preset loses no pulse.
--
-- Period    It is 0 until two pulses have come, and again when none has come for timeout_ms: an old one is never shown.
--           It is also 0 after a pause, for what was not counted may have been a pulse.
-- Gate      with_gate 1: pulses count while the pin `gate` is high. It acts as pause does.
-- Frequency with_frequency 1: a new value for each frequency_us, by the times of the pulses. It falls while no pulse
--           comes, and is 0 after timeout_ms. It is at most 8.3 MHz, with 32 bits.
-- Events    counted: a pulse. stopped: none has come for timeout_ms.
-- Wires     count_wire has +0 and frequency_wire has +6 for other components. They follow the words by 2 clocks.
-- Filter    A level counts when it has been stable for filter_ns, rounded up to whole clocks and at least one. Below,
--           these clocks are called the filter.
-- Speed     At most one pulse in two filters. Shorter ones are not seen.
-- Latency   2 clocks for a read, at most 34 for a write: it is acknowledged when it is in force and can be read. The
--           words follow the pin at most 35 clocks and the filter later, and the events 3 clocks and the filter.
-- Errors    err for writes to other addresses than +0 and +1, and for addresses that are not listed.
-- Reset     All words are zero. The level of the line at that time is no pulse, if the reset lasts at least 5 clocks.
--           The first access waits for up to 17 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity pulse_counter is
  generic (
    clock_hz       : positive                := 50_000_000;
    filter_ns      : natural range 0 to 2000 := 100;
    time_hz        : positive range 1000 to 100_000_000 := 1_000_000;
    timeout_ms     : positive range 1 to 20_000 := 500;
    with_gate      : natural range 0 to 1    := 0;
    with_frequency : natural range 0 to 1    := 0;
    frequency_us   : positive range 100 to 100_000 := 10_000;
    data_width     : positive range 8 to 32  := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    counted      : out std_ulogic;
    stopped      : out std_ulogic;

    count_wire     : out wire_t; -- for other components
    frequency_wire : out wire_t;

    line : in std_ulogic; -- asynchronous, like the next one
    gate : in std_ulogic := '1'
  );
end entity;

architecture rtl of pulse_counter is

  function timeout_ticks return positive is
    constant time_khz : positive := time_hz / 1000;
  begin
    assert timeout_ms <= positive'high / time_khz
      report "pulse_counter: a timeout of " & integer'image(timeout_ms) & " ms is too long for time_hz"
      severity failure;
    return timeout_ms * time_khz;
  end function;

  constant stable_clocks : positive := clocks_lasting(filter_ns, clock_hz);
  constant bits          : positive := phase_bits(clock_hz, time_hz);

  signal level, before, pulse, is_open, counts : std_ulogic;
  signal phase     : unsigned(bits downto 0) := (others => '0'); -- its highest bit is a tick
  signal frequency : unsigned(data_width - 2 downto 0);
  signal hold      : std_ulogic;
  signal newest    : unsigned(data_width - 1 downto 0);

begin

  assert with_frequency = 0 or timeout_ms <= 500
    report "pulse_counter: with a frequency, timeout_ms is at most 500"
    severity failure;

  line_filter : entity work.input_filter
    generic map (stable_clocks => stable_clocks)
    port map (clock => clock, reset => reset, pins(0) => line, levels(0) => level);

  gated : if with_gate = 1 generate
    gate_filter : entity work.input_filter
      generic map (stable_clocks => stable_clocks)
      port map (clock => clock, reset => reset, pins(0) => gate, levels(0) => is_open);
  else generate
    is_open <= '1';
  end generate;

  run : process (clock) is
  begin
    if rising_edge(clock) then
      before <= level;
      phase  <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, time_hz);
      if reset = '1' then
        phase <= (others => '0');
      end if;
    end if;
  end process;

  pulse <= level and not before;

  words : entity work.pulse_counter_words
    generic map (timeout_ticks => timeout_ticks, with_frequency => with_frequency, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m, pulse => pulse,
      gate => is_open, tick => phase(bits), frequency => frequency, hold => hold, counts => counts, newest => newest,
      counted => counted, stopped => stopped);

  count_wire <= wire_of(signed(newest));

  -- The velocity of an encoder that makes a step for each pulse.
  times : if with_frequency = 1 generate
    signal a, b : std_ulogic := '0';
  begin
    turn : process (clock) is
    begin
      if rising_edge(clock) then
        if counts = '1' then
          a <= not b;
          b <= a;
        end if;
        frequency_wire <= wire_of(signed('0' & frequency));
        if reset = '1' then
          a <= '0';
          b <= '0';
          frequency_wire <= wire_of(to_signed(0, data_width));
        end if;
      end if;
    end process;

    velocity : entity work.quadrature_encoder_velocity
      generic map (
        clock_hz => clock_hz, window_us => frequency_us, stall_us => 1000 * minimum(timeout_ms, 500),
        data_width => data_width)
      port map (
        clock => clock, reset => reset, a => a, b => b, hold => hold, speed => frequency, back => open,
        stopped => open);
  else generate
    frequency      <= (others => '0');
    frequency_wire <= no_wire;
  end generate;

end architecture;
