-- SPDX-License-Identifier: BSD-3-Clause
--
-- Pulse-density modulation on the Wishbone bus: outputs whose share of high time is a value, for an RC filter.
--
--   +n  channel n: the density of ones in 1/2**bits; 0 is never high, 2**bits and more is always high
--
--   pin  ___/‾‾‾\___________/‾‾‾\___________/‾‾‾\____    a density of 1/4
--           |bit|
--
-- Each channel is a sigma-delta modulator of first order. For each bit its density is added to its total, and the carry
-- is the bit. So in any row of bits the number of ones is less than one off from the sum of the densities. A total
-- keeps what was not yet given when a density changes. At 0 and at 2**bits the pin has no edge.
--
-- The channels take turns of 2 clocks at one adder, and channel n is 2 * n clocks behind channel 0. Densities and
-- totals are in block RAM. A word has bits + 1 bits; more bits are not stored and read as zero.
--
-- Generics  A bit lasts clock_hz / rate_hz clocks, rounded up, and at least 2 clocks for each channel. pulse_ns is the
--           shortest pulse that the output stage passes; 0 is any. A bit is not shorter. start is the density of all
--           channels from a reset on.
-- Latency   2 clocks per access. A density holds from the next bit on: it is at the pin at most a bit and 2 clocks
--           after its strobe.
-- Errors    err for addresses from `channels` on, and for writes that do not select all bytes. They change nothing.
-- Reset     All pins are low. Then all densities become `start` and all totals 0, one in a clock, and accesses wait for
--           these 8 clocks. The first bits follow a bit later.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity pdm is
  generic (
    clock_hz   : positive                       := 50_000_000;
    channels   : positive range 1 to 8          := 4;
    rate_hz    : positive                       := 1_000_000;
    bits       : positive range 4 to 16         := 15;
    start      : natural range 0 to 65536       := 0;
    pulse_ns   : natural range 0 to 100_000_000 := 0;
    data_width : positive range 8 to 32         := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    pins         : out std_ulogic_vector(channels - 1 downto 0)
  );
end entity;

architecture rtl of pdm is

  constant period     : positive := 1 + (clock_hz - 1) / rate_hz; -- clocks of a bit
  constant word_bits  : positive := bits + 1;
  constant index_bits : positive := 3; -- whatever `channels` is: yosys puts no fewer words into a block RAM

  constant all_bytes : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  subtype word_t is unsigned(word_bits - 1 downto 0);
  subtype total_t is unsigned(bits - 1 downto 0);
  subtype index_t is unsigned(index_bits - 1 downto 0);
  subtype left_t is unsigned(bits_for(period) - 1 downto 0);
  type words_t is array (0 to 2 ** index_bits - 1) of word_t;
  type totals_t is array (0 to 2 ** index_bits - 1) of total_t;

  -- The first two hold the same. A memory is never read and written at once: what such a read gives depends on the
  -- chip.
  signal memory, bus_memory : words_t  := (others => (others => '0'));
  signal totals             : totals_t := (others => (others => '0'));

  -- The bus.
  signal asked, known, writes : std_ulogic;
  signal late                 : std_ulogic := '0';              -- the word is written in the clock of its ack
  signal ack, err             : std_ulogic := '0';
  signal clearing             : std_ulogic := '1';
  signal place                : index_t;                        -- that is written
  signal data                 : word_t;
  signal found                : word_t;

  -- The turns.
  signal left    : left_t     := to_unsigned(period - 1, left_t'length); -- clocks until the next bits begin
  signal turning : std_ulogic := '0';
  signal second  : std_ulogic := '0';             -- the second clock of a turn
  signal channel : index_t    := (others => '0'); -- whose turn it is
  signal reads   : std_ulogic;
  signal keeps   : std_ulogic;                    -- a total is written
  signal word    : word_t;
  signal total   : total_t;
  signal sum     : word_t;

begin

  assert period >= 2 * channels
    report "pdm: bits of " & integer'image(channels) & " channels take at least " & integer'image(2 * channels) &
           " clocks, and rate_hz gives " & integer'image(period)
    severity failure;
  assert pulse_ns = 0 or rate_hz <= 1_000_000_000 / maximum(pulse_ns, 1)
    report "pdm: a bit at rate_hz " & integer'image(rate_hz) & " is shorter than pulse_ns " & integer'image(pulse_ns)
    severity failure;
  assert start <= 2 ** bits
    report "pdm: start is at most " & integer'image(2 ** bits) & ", got " & integer'image(start)
    severity failure;
  assert word_bits <= data_width
    report "pdm: " & integer'image(bits) & " bits and one need a data_width of at least " & integer'image(word_bits)
    severity failure;

  -- The bus.
  asked  <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not clearing;
  known  <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto index_bits)) = 0 and
                     unsigned('0' & wishbone_m2s.adr(index_t'range)) < channels and
                     (wishbone_m2s.we = '0' or wishbone_m2s.sel(all_bytes'range) = all_bytes) else '0';
  writes <= clearing or (asked and known and wishbone_m2s.we);
  place  <= channel when clearing = '1' else unsigned(wishbone_m2s.adr(index_t'range));
  data   <= to_unsigned(start, word_bits) when clearing = '1' else unsigned(wishbone_m2s.dat(word_t'range));

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack  <= asked and known;
      err  <= asked and not known;
      late <= writes and reads;
      if writes = '1' then
        bus_memory(to_integer(place)) <= data;
      end if;
      -- Not an `else` of the line above: GHDL 2.0 synthesises its condition without the `not`.
      if writes = '0' then
        found <= bus_memory(to_integer(unsigned(wishbone_m2s.adr(index_t'range))));
      end if;
      if (writes or late) = '1' and reads = '0' then
        memory(to_integer(place)) <= data;
      end if;
      if reads = '1' then
        word <= memory(to_integer(channel));
      end if;

      if reset = '1' then
        ack <= '0';
        err <= '0';
      end if;
    end if;
  end process;

  reply : process (all) is
  begin
    wishbone_s2m                   <= wishbone_s2m_idle;
    wishbone_s2m.ack               <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err               <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.dat(word_t'range) <= std_ulogic_vector(found);
  end process;

  -- A turn: the first clock reads density and total, the second one adds them. A density of 2**bits and more gives a
  -- one and leaves the total as it is.
  reads <= turning and not second;
  sum   <= ('0' & total) + ('0' & word(total_t'range));
  keeps <= clearing or (second and not word(word'high));

  run : process (clock) is
  begin
    if rising_edge(clock) then
      if reads = '1' then
        total <= totals(to_integer(channel));
      end if;
      if keeps = '1' and reads = '0' then
        totals(to_integer(channel)) <= sum(total_t'range) and (total_t'range => not clearing);
      end if;

      second <= reads;
      left   <= left - 1;
      if second = '1' then
        pins(to_integer(channel)) <= sum(sum'high) or word(word'high);
        channel                   <= channel + 1;
        if channel = channels - 1 then
          turning <= '0';
        end if;
      end if;
      if left = 0 then
        turning <= '1';
        channel <= (others => '0');
      end if;
      if left = 0 or clearing = '1' or reset = '1' then
        left <= to_unsigned(period - 1, left'length);
      end if;

      if clearing = '1' then
        channel  <= channel + 1;
        clearing <= nand channel;
      end if;
      if reset = '1' then
        turning  <= '0';
        second   <= '0';
        channel  <= (others => '0');
        clearing <= '1';
        pins     <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
