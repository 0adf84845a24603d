-- SPDX-License-Identifier: BSD-3-Clause
--
-- Gives pulses on one line: a steady frequency, a number of pulses, or a pulse for each edge of a trigger.
--
--   +0  frequency in 1/256 Hz; 0 stops behind the pulse and ends the burst                    write
--   +1  width of a pulse in 1/time_hz s, at most 24 bits; 0: half a period                     write
--   +2  pulses of a burst, 16 bits; 0: there are no bursts, pulses come without an end         write
--   +3  pulses that are to go in this burst                                                    write: sets it
--   +4  pulses that have begun since the reset; wraps at the word
--   +5  bits 7:0 pulses that were skipped, they wrap; bit 8 running; bit 9 stopped by the pin
--
--   frequency ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\_____
--   line      _____/‾‾‾‾\_____/‾‾‾‾\_____/‾‾‾‾\____
--                  |width|
--                  |  period  |
--
-- Rate      exact: in the long run there are as many pulses as the frequency says, by this clock. Each comes at most
--           one clock later than it should. A new frequency is in force at once, in the midst of a period.
-- Width     exact, rounded up to whole clocks. A pulse has the width of the moment when it began. It is never cut or
--           doubled, but by `stop` and the reset.
-- Burst     With +2 not zero, pulses come while +3 is not zero. A write of +3 begins a burst of any length, or ends it
--           behind the pulse with 0. A rising edge of `trigger` sets +3 to +2, if +3 is 0 and the frequency is not. The
--           first pulse of a burst comes at once, but two pulses are never closer than a period.
-- Skipped   A pulse that is due while the last one is not over is left out, and counted in +5.
-- Stop      While `stop` is high the line rests, at once. Then +3 is 0, and a write of +0 starts again.
-- Events    begun: a pulse has begun. finished: the last pulse of a burst is over.
-- Filter    A level of `trigger` and `stop` counts when it has been stable for filter_ns, rounded up to whole clocks.
-- Latency   2 clocks per access (register_slave). From a write to the first pulse 3 clocks, from `trigger` 5 and the
--           filter, from `stop` 3 and the filter. Each event comes with its edge.
-- Errors    err for a frequency above maximum_hz, for a write of +4 and +5, and for addresses from 6 on.
-- Reset     All words are 0, and the line rests from power-up on.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity pulse_generator is
  generic (
    clock_hz     : positive                              := 50_000_000;
    maximum_hz   : positive range 1 to 8_000_000         := 1_000_000;
    time_hz      : positive range 1000 to 100_000_000    := 1_000_000;
    active_level : natural range 0 to 1                  := 1; -- of a pulse
    filter_ns    : natural range 0 to 2000               := 100;
    data_width   : positive range 16 to 32               := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    begun        : out std_ulogic := '0';
    finished     : out std_ulogic := '0';

    trigger      : in  std_ulogic := '0'; -- asynchronous, like the next one
    stop         : in  std_ulogic := '0';
    line         : out std_ulogic
  );
end entity;

architecture rtl of pulse_generator is

  function greatest_divisor (first : positive; second : positive) return positive is
    variable a : natural := first;
    variable b : natural := second;
    variable c : natural;
  begin
    while b /= 0 loop
      c := a mod b;
      a := b;
      b := c;
    end loop;
    return a;
  end function;

  constant frequency_most : positive := 256 * maximum_hz;
  constant frequency_bits : positive := bits_for(maximum_hz + 1) + 8;
  constant width_bits     : positive := minimum(24, data_width);
  constant burst_bits     : positive := 16;

  -- Half a period is over when the frequencies of its clocks sum up to half a second. The sum begins at -half_second,
  -- and ends below the largest frequency. So its sign tells, and one adder does it.
  constant sum_bits    : positive := bits_for(clock_hz) + 8;
  constant half_second : signed(sum_bits - 1 downto 0) := signed(shift_left(to_unsigned(clock_hz, sum_bits), 7));

  -- The same for the ticks of the width: both rates over their greatest divisor.
  constant divisor     : positive := greatest_divisor(clock_hz, time_hz);
  constant tick_add    : positive := time_hz / divisor;
  constant tick_clocks : positive := clock_hz / divisor;

  subtype frequency_t is unsigned(frequency_bits - 1 downto 0);
  subtype sum_t is signed(sum_bits - 1 downto 0);
  subtype word_t is unsigned(data_width - 1 downto 0);

  signal gated_m2s   : wishbone_m2s_t;
  signal read_words  : word_vector_t(0 to 5);
  signal write_words : word_vector_t(0 to 5);
  signal written     : std_ulogic_vector(0 to 5);

  signal levels                        : std_ulogic_vector(1 downto 0);
  signal pulled, stopped, triggers     : std_ulogic; -- the pin stops; the trigger rises
  signal trigger_before                : std_ulogic := '1';
  signal halted                        : std_ulogic := '0';

  signal asked       : frequency_t;
  signal burst       : unsigned(burst_bits - 1 downto 0);
  signal bursts      : std_ulogic;                    -- pulses come only in bursts
  signal off         : std_ulogic;                    -- the frequency is 0
  signal rate        : frequency_t := (others => '0'); -- in force
  signal rate_less   : sum_t := (others => '0');      -- less half a second
  signal rests       : std_ulogic := '1';             -- it is 0
  signal wants       : std_ulogic;                    -- a pulse
  signal running     : std_ulogic := '0';
  signal sum         : sum_t := (others => '0');
  signal half        : std_ulogic;                    -- half a period is over
  signal second      : std_ulogic := '0';             -- it is the first half
  signal due, begins : std_ulogic;
  signal ends        : std_ulogic;
  signal active      : std_ulogic := '0';
  signal to_go       : word_t := (others => '0');
  signal pulses      : word_t := (others => '0');
  signal skipped     : unsigned(7 downto 0) := (others => '0');

  signal left        : unsigned(width_bits - 1 downto 0) := (others => '0'); -- ticks of this pulse; 0: half a period
  signal fine        : signed(bits_for(tick_clocks + 1) downto 0) := (others => '0');

begin

  assert clock_hz < 2 ** 30 and clock_hz / 4 >= maximum_hz
    report "pulse_generator: " & integer'image(maximum_hz) & " Hz needs a clock of 4 times that rate, got "
           & integer'image(clock_hz)
    severity failure;
  assert time_hz <= clock_hz
    report "pulse_generator: time_hz is at most clock_hz, got " & integer'image(time_hz)
    severity failure;
  assert frequency_bits <= data_width
    report "pulse_generator: a word of " & integer'image(data_width) & " bits is too short for maximum_hz "
           & integer'image(maximum_hz)
    severity failure;

  -- A frequency that is too high looks as if it had no bytes, which register_slave refuses.
  process (all) is
  begin
    gated_m2s <= wishbone_m2s;
    if unsigned(wishbone_m2s.adr) = 0 and unsigned(wishbone_m2s.dat(data_width - 1 downto 0)) > frequency_most then
      gated_m2s.sel <= (others => '0');
    end if;
  end process;

  registers : entity work.register_slave
    generic map (writable => "111100", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => gated_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  read_words <= (
    0 => extended(std_ulogic_vector(asked)),
    1 => extended(write_words(1)(width_bits - 1 downto 0)),
    2 => extended(std_ulogic_vector(burst)),
    3 => extended(std_ulogic_vector(to_go)),
    4 => extended(std_ulogic_vector(pulses)),
    5 => extended(halted & running & std_ulogic_vector(skipped)));

  inputs : entity work.input_filter
    generic map (width => 2, stable_clocks => clocks_lasting(filter_ns, clock_hz))
    port map (clock => clock, reset => reset, pins => stop & trigger, levels => levels);

  pulled   <= levels(1);
  stopped  <= pulled or halted;
  triggers <= levels(0) and not trigger_before;

  asked  <= unsigned(write_words(0)(asked'range));
  off    <= nor write_words(0)(asked'range);
  burst  <= unsigned(write_words(2)(burst'range));
  bursts <= or write_words(2)(burst'range);

  half   <= running and not sum(sum'high);
  due    <= half and not second;
  wants  <= not off and not rests and not stopped and (not bursts or to_bit(to_go /= 0));
  begins <= due and wants and not active;
  ends   <= active and ((to_bit(left = 0) and half and second) or (to_bit(left = 1) and not fine(fine'high)));

  process (clock) is
    variable more : sum_t;        -- what this clock adds to `sum`
    variable step : signed(fine'range);
  begin
    if rising_edge(clock) then
      trigger_before <= levels(0);
      halted         <= pulled or (halted and not written(0));

      -- The frequency. A pulse that lasts half a period needs it to its end.
      if stopped = '1' then
        rate  <= (others => '0');
        rests <= '1';
      elsif off = '0' or active = '0' then
        rate      <= asked;
        rate_less <= signed(resize(asked, sum_bits)) - half_second;
        rests     <= off;
      end if;

      -- The period.
      running <= not rests and (wants or (running and not due) or active);
      if running = '0' then
        sum    <= (others => '0');
        second <= '0';
      else
        more := signed(resize(rate, sum_bits));
        if half = '1' then
          more := rate_less;
        end if;
        sum    <= sum + more;
        second <= second xor half;
      end if;

      -- The pulse.
      step := to_signed(tick_add, fine'length);
      if fine(fine'high) = '0' then
        step := to_signed(tick_add - tick_clocks, fine'length);
        if left /= 0 then
          left <= left - 1;
        end if;
      end if;
      fine <= fine + step;
      if begins = '1' then
        left <= unsigned(write_words(1)(left'range));
        fine <= to_signed(tick_add - tick_clocks, fine'length);
      end if;
      active   <= (begins or (active and not ends)) and not stopped;
      begun    <= begins;
      finished <= ends and bursts and to_bit(to_go = 0);
      if begins = '1' then
        pulses <= pulses + 1;
      end if;
      if (due and wants and active) = '1' then
        skipped <= skipped + 1;
      end if;

      -- The burst.
      if (begins and bursts) = '1' then
        to_go <= to_go - 1;
      end if;
      if triggers = '1' and off = '0' and to_go = 0 then
        to_go <= resize(burst, data_width);
      end if;
      if written(3) = '1' then
        to_go <= unsigned(write_words(3)(to_go'range));
      end if;
      if (written(0) and off) = '1' or stopped = '1' then
        to_go <= (others => '0');
      end if;

      if reset = '1' then
        trigger_before <= '1';
        halted         <= '0';
        rests          <= '1';
        running        <= '0';
        active         <= '0';
        begun          <= '0';
        finished       <= '0';
        to_go          <= (others => '0');
        pulses         <= (others => '0');
        skipped        <= (others => '0');
      end if;
    end if;
  end process;

  line <= active xnor to_bit(active_level = 1);

end architecture;
