-- SPDX-License-Identifier: BSD-3-Clause
--
-- Exchanges bytes with a device on SPI, the most significant bit first.
--
--   select_n  ‾‾\_________________________________/‾‾‾‾‾
--   sclk      ______/‾\_/‾\_/‾\_/‾\_/‾\_ ... _______        mode 0
--   mosi      xx<  7 ><6 ><5 ><4 ><3 > ...
--               |---|                         |---|---|     select_ns each: before, behind, and until the next frame
--
-- mode      The usual numbers: bit 1 is the level of sclk at rest, bit 0 says that the second edge of a bit samples.
-- Clock     Half a period of sclk is a whole number of clocks, at least 2. So sclk is never faster than sclk_hz, nor
--           than clock_hz / 4. miso is taken at the end of a bit, so a device may be late by almost a bit.
-- Latency   A byte takes 16 half periods and 3 clocks, and the pauses around a frame.
-- Back-pressure  `go` comes only after the `done` of the byte before, and `last` stands until then. A frame stays open
--           until a byte with `last`.
-- Errors    None: SPI has no answer that could be missing, so `failed` is always 0.
-- Reset     select_n goes high at once, and sclk to rest.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.sequencer_pkg.all;
  use work.width_pkg.all;

entity spi_master is
  generic (
    clock_hz  : positive                := 50_000_000;
    sclk_hz   : positive                := 1_000_000;
    mode      : natural range 0 to 3    := 0;
    select_ns : natural range 0 to 2000 := 100
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic; -- synchronous
    request  : in  bus_request_t;
    reply    : out bus_reply_t;

    select_n : out std_ulogic;
    sclk     : out std_ulogic;
    mosi     : out std_ulogic;
    miso     : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of spi_master is

  constant half_clocks  : positive := maximum(2, (clock_hz - 1) / (2 * sclk_hz) + 1);
  constant pause_clocks : positive := maximum(3, clocks_lasting(select_ns, clock_hz));
  constant mode_bits    : unsigned(1 downto 0) := to_unsigned(mode, 2);
  constant at_rest      : std_ulogic := mode_bits(1);
  constant second_edge  : std_ulogic := mode_bits(0);

  -- A byte goes through places: -1 the pause before the frame, 0 to 15 half a period of sclk each, two for each bit,
  -- 16 what is behind them, 17 the pause between frames.
  subtype place_t is unsigned(4 downto 0);

  signal busy              : std_ulogic; -- a byte is under way
  signal place, next_place : place_t := (others => '0');
  signal count, next_count : unsigned(bits_for(maximum(half_clocks, pause_clocks)) - 1 downto 0) := (others => '0');
  signal shift             : byte_t := (others => '0');
  signal level             : std_ulogic_vector(0 downto 0);
  signal take              : std_ulogic_vector(1 downto 0); -- a bit has ended, 1 and 2 clocks ago

  signal over, steps, is_behind, bit_ends, deselects, ends : std_ulogic;

begin

  line_synchroniser : entity work.synchroniser
    port map (clock => clock, asynchronous(0) => miso, levels => level);

  reply.failed <= '0';
  reply.reason <= failure_no_answer;
  reply.data   <= shift;

  mosi <= shift(7);

  -- What ends with this clock: each place lasts until the counter is zero.
  over      <= busy and nor count;
  steps     <= over or request.go;
  bit_ends  <= over and place(0) and not place(4);
  is_behind <= place(4) and not place(3); -- not in the pause before the frame
  deselects <= over and is_behind and not place(0) and request.last;
  ends      <= is_behind and ((over and place(0)) or (take(1) and not request.last));

  -- A sum has an operand that says nothing while its counter is loaded. So counting and loading share a cell of an
  -- iCE40, whose LUT has the operands of its carry as inputs.
  next_place <= (others => request.first) when request.go = '1' else
                place - unsigned'(4 downto 0 => not request.go);
  next_count <= count + unsigned'(count'range => not steps);

  process (clock) is
  begin
    if rising_edge(clock) then
      reply.done <= ends;
      take       <= take(0) & bit_ends;

      -- The reply to a bit comes two clocks after its end.
      if request.go = '1' then
        shift <= request.data;
      elsif bit_ends = '1' then
        shift(7 downto 1) <= shift(6 downto 0);
      end if;
      if take(1) = '1' then
        shift(0) <= level(0);
      end if;

      count <= next_count;
      if steps = '1' then
        place <= next_place;
        if next_place(4) = '1' then
          count <= to_unsigned(pause_clocks - 1, count'length);
        else
          count <= to_unsigned(half_clocks - 1, count'length);
        end if;
        sclk <= at_rest xor (not next_place(4) and (second_edge xor next_place(0)));
      end if;

      if request.go = '1' then
        busy <= '1';
      elsif ends = '1' then
        busy <= '0';
      end if;

      if request.go = '1' and request.first = '1' then
        select_n <= '0';
      elsif deselects = '1' then
        select_n <= '1';
      end if;

      if reset = '1' then
        reply.done <= '0';
        busy       <= '0';
        take       <= "00";
        select_n   <= '1';
        sclk       <= at_rest;
      end if;
    end if;
  end process;

end architecture;
