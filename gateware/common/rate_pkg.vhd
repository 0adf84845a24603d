-- SPDX-License-Identifier: BSD-3-Clause
--
-- Makes any rate from any clock: the constants of a phase accumulator. It also gives the number of clocks in a time.
--
-- A register of phase_bits + 1 bits adds phase_increment to its low phase_bits bits in every clock. Its top bit is then
-- high for one clock at `rate_hz` on average. It is never more than one clock early or late, and its rate is at most
-- 0.05 % wrong:
--
--   signal phase : unsigned(phase_bits(clock_hz, rate_hz) downto 0);
--   phase <= ('0' & phase(phase'high - 1 downto 0)) + phase_increment(clock_hz, rate_hz);
--   tick  <= phase(phase'high);
--
-- Only integers are used, so that every synthesis tool can compute it during elaboration.

package rate_pkg is

  -- Bits after the binary point of a rate: at least 1024 steps, so rounding by half a step is 0.05 %.
  constant rate_precision_bits : positive := 10;

  -- Bits of a phase. clock_hz is below 2**30, and a tick has at most 2**20 clocks.
  function phase_bits (clock_hz : positive; rate_hz : positive) return positive;

  -- The increment in each clock: rate_hz / clock_hz of a turn, rounded.
  function phase_increment (clock_hz : positive; rate_hz : positive) return positive;

  -- Clocks that last at least `time_ns`, and at least one clock. The time is at most 2 us.
  function clocks_lasting (time_ns : natural; clock_hz : positive) return positive;

end package;

package body rate_pkg is

  function phase_bits (clock_hz : positive; rate_hz : positive) return positive is
    variable clocks : positive := 1;
    variable bits   : positive := rate_precision_bits;
  begin
    assert clock_hz < 2 ** 30
      report "rate_pkg: clock_hz must be below 2**30, got " & integer'image(clock_hz)
      severity failure;
    assert rate_hz <= clock_hz
      report "rate_pkg: a rate of " & integer'image(rate_hz) & " Hz is above its clock of " & integer'image(clock_hz)
      severity failure;
    assert clock_hz / rate_hz < 2 ** 20
      report "rate_pkg: " & integer'image(rate_hz) & " Hz is too slow for a clock of " & integer'image(clock_hz)
      severity failure;
    while clocks < (clock_hz + rate_hz - 1) / rate_hz loop
      clocks := clocks * 2;
      bits   := bits + 1;
    end loop;
    return bits;
  end function;

  function phase_increment (clock_hz : positive; rate_hz : positive) return positive is
    variable remainder : natural := rate_hz;
    variable quotient  : natural := 0;
  begin
    -- Long division, a bit at a time: rate_hz * 2**bits would not fit an integer.
    for bit_index in 1 to phase_bits(clock_hz, rate_hz) loop
      quotient := quotient * 2 + (remainder / clock_hz) * 2;
      remainder := (remainder mod clock_hz) * 2;
      if remainder >= clock_hz then
        quotient  := quotient + 1;
        remainder := remainder - clock_hz;
      end if;
    end loop;
    if remainder >= clock_hz - remainder then
      quotient := quotient + 1;
    end if;
    return quotient;
  end function;

  function clocks_lasting (time_ns : natural; clock_hz : positive) return positive is
    constant clock_khz : positive := (clock_hz + 999) / 1000; -- in Hz the product would not fit an integer
  begin
    assert time_ns <= 2000
      report "rate_pkg: a time of " & integer'image(time_ns) & " ns is above 2000 ns"
      severity failure;
    return maximum(1, (time_ns * clock_khz + 999_999) / 1_000_000);
  end function;

end package body;
