-- SPDX-License-Identifier: BSD-3-Clause
--
-- Exchanges bytes with a device on SPI, the most significant bit first.
--
--   select_n  ‾‾\_________________________________/‾‾‾‾‾
--   sclk      ______/‾\_/‾\_/‾\_/‾\_/‾\_ ... _______        mode 0
--   mosi      xxxx<7 ><6 ><5 ><4 ><3 > ...
--               |---|                         |---|---|     select_ns each: before, behind, and until the next frame
--
-- mode      The usual numbers: bit 1 is the level of sclk at rest, bit 0 says that the second edge of a bit samples.
-- Clock     Half a period of sclk is a whole number of clocks, at least 2. So sclk is never faster than sclk_hz, nor
--           than clock_hz / 4. miso is taken at the end of a bit, so a device may be late by almost a bit.
-- Latency   A byte takes 16 half periods and 3 clocks, and the pauses around a frame.
-- Back-pressure  `go` comes only after the `done` of the byte before. A frame stays open until a byte with `last`.
-- Errors    None: SPI has no answer that could be missing, so `failed` is always 0.
-- Reset     select_n goes high at once, and sclk to rest.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.sequencer_pkg.all;

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

  type state_t is (idle, selecting, shifting, ending, resting);

  signal state : state_t;
  signal count : natural range 0 to maximum(half_clocks, pause_clocks) - 1; -- clocks that are left
  signal half  : unsigned(3 downto 0);                                      -- of the byte: two for each bit
  signal shift : byte_t := (others => '0');
  signal last  : std_ulogic := '0';
  signal level : std_ulogic_vector(0 downto 0);
  signal take  : std_ulogic_vector(1 downto 0);                             -- a bit has ended, 1 and 2 clocks ago

  signal begins, opens, over, starts, turns, ends, selected : std_ulogic;

begin

  line : entity work.synchroniser
    port map (clock => clock, asynchronous(0) => miso, levels => level);

  reply.failed <= '0';
  reply.reason <= failure_no_answer;
  reply.data   <= shift;

  -- What ends with this clock: each state but idle lasts until the counter is zero.
  begins <= request.go when state = idle else '0';
  opens  <= begins and request.first;
  over   <= '1' when count = 0 and state /= idle else '0';
  starts <= (begins and not request.first) or (over and selected);
  turns  <= over when state = shifting else '0';
  ends   <= turns and (and half);

  selected <= '1' when state = selecting else '0';

  process (clock) is
  begin
    if rising_edge(clock) then
      reply.done <= '0';
      take       <= take(0) & (turns and half(0));

      if begins = '1' then
        shift <= request.data;
        last  <= request.last;
      elsif take(1) = '1' then
        shift <= shift(6 downto 0) & level;
      end if;

      if opens = '1' or (last = '1' and (ends = '1' or state = ending)) then
        count <= pause_clocks - 1;
      elsif ends = '1' then
        count <= 1;
      elsif starts = '1' or turns = '1' then
        count <= half_clocks - 1;
      end if;
      if over = '0' and state /= idle then
        count <= count - 1;
      end if;

      if starts = '1' then
        half <= (others => '0');
        sclk <= at_rest xor second_edge;
        mosi <= shift(7) when selected = '1' else request.data(7);
      elsif turns = '1' then
        half <= half + 1;
        sclk <= (at_rest xor second_edge xor not half(0)) when ends = '0' else at_rest;
        if half(0) = '1' then
          mosi <= shift(6); -- the reply to this bit is shifted in two clocks later
        end if;
      end if;

      if opens = '1' then
        select_n <= '0';
        state    <= selecting;
      elsif starts = '1' then
        state <= shifting;
      elsif ends = '1' then
        state <= ending;
      elsif over = '1' and state = ending and last = '1' then
        select_n <= '1';
        state    <= resting;
      elsif over = '1' and turns = '0' then
        reply.done <= '1';
        state      <= idle;
      end if;

      if reset = '1' then
        reply.done <= '0';
        state      <= idle;
        take       <= "00";
        select_n   <= '1';
        sclk       <= at_rest;
        mosi       <= '0';
      end if;
    end if;
  end process;

end architecture;
