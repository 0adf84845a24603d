-- SPDX-License-Identifier: BSD-3-Clause
--
-- A strip of LEDs with WS2812, SK6812 or what understands them. Their colours are in block RAM, and are sent when
-- asked.
--
--   0  __/‾350 ns‾\_____________     a bit takes 1250 ns, and the highest bit of a colour is the first
--   1  __/‾‾‾700 ns‾‾‾\_________
--
--   +0      control: bit 0 on; without it the strip is dark. A write sends.
--   +1      a write sends. Read: bit 0 busy
--   +2 + n  the colour of LED n in bits 8*channels-1:0, in the order of the line: green, red, blue, white
--
-- Frame     All LEDs, and then the line is low for reset_us or up to an LED longer, so that they take it. What is asked
--           for meanwhile is sent behind it: so the strip ends with what was last written. Without `on` all colours
--           are sent as 0, and the memory keeps them. Behind a reset come a pause and such a dark frame: the strip may
--           be lit, or in the middle of a frame.
-- Times     350 ns is rounded down to whole clocks, 700 and 1250 ns to the nearest. With a clock of 8 MHz or more,
--           chips of all kinds understand them.
-- Memory    One block RAM, which the bus and the strip read in turn. The bus goes first, and never waits.
-- Event     sent: a frame and its pause are over, and nothing else is asked for.
-- Latency   2 clocks per access. From a write to the first bit 4 clocks and 550 ns. An LED takes 30 us, with white
--           40 us.
-- Errors    err for addresses from 2 + leds on, and for writes that do not select all bytes.
-- Reset     The line is low, and from power-up on. The colours stay. At power-up they are 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity ws2812 is
  generic (
    clock_hz   : positive                   := 50_000_000;
    leds       : positive range 1 to 4094   := 60;
    channels   : positive range 3 to 4      := 3;          -- 4: with white
    reset_us   : positive range 1 to 10_000 := 280;
    data_width : positive range 24 to 32    := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sent         : out std_ulogic := '0';

    data         : out std_ulogic := '0'
  );
end entity;

architecture rtl of ws2812 is

  constant khz          : positive := (clock_hz + 500) / 1000;
  constant zero_clocks  : natural  := 350 * khz / 1_000_000;
  constant one_clocks   : natural  := (700 * khz + 500_000) / 1_000_000;
  constant bit_clocks   : natural  := (1250 * khz + 500_000) / 1_000_000;
  constant colour_bits  : positive := 8 * channels;
  constant first_place  : positive := 2;
  constant end_place    : positive := first_place + leds;
  -- The pause is so many LEDs long.
  constant pause        : positive := 1 + (reset_us * khz + 999) / 1000 / maximum(1, bit_clocks * colour_bits);
  constant index_bits   : positive := bits_for(end_place);
  constant all_bytes    : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  subtype colour_t is std_ulogic_vector(colour_bits - 1 downto 0);
  subtype index_t is unsigned(index_bits - 1 downto 0);
  subtype ahead_t is unsigned(bits_for(end_place + pause + 1) - 1 downto 0);
  type memory_t is array (0 to 2 ** index_bits - 1) of colour_t;

  -- A memory is never read and written at once: what such a read gives depends on the chip. Its words 0 and 1 stay 0.
  signal memory : memory_t := (others => (others => '0'));
  signal place  : index_t; -- that is read
  signal found  : colour_t;

  -- The bus.
  signal index                : index_t;
  signal asked, known, writes : std_ulogic;
  signal ack, err             : std_ulogic := '0';
  signal flag                 : std_ulogic := '0'; -- bit 0 of +0 and +1
  signal on_now               : std_ulogic := '0';

  -- The frame.
  signal pending  : std_ulogic := '1'; -- one is asked for
  signal sending  : std_ulogic := '1'; -- at power-up and behind a reset it begins with the pause
  signal clocks   : unsigned(bits_for(bit_clocks) - 1 downto 0) := (others => '0'); -- of the bit
  signal left     : unsigned(4 downto 0) := to_unsigned(colour_bits - 1, 5);            -- bits behind this one
  signal ahead    : ahead_t := to_unsigned(end_place + 1, ahead_t'length);           -- the next LED
  signal quiet    : std_ulogic := '1';                                              -- the pause
  signal fetch    : std_ulogic := '0';                                              -- the next colour is wanted
  signal fetches  : std_ulogic;                                                     -- and is read in this clock
  signal fetched  : std_ulogic := '0';                                              -- and is there
  signal shift    : colour_t := (others => '0');
  signal bit_ends : std_ulogic;
  signal rest     : std_ulogic;                                                     -- the low end of a bit begins

begin

  assert clock_hz >= 8_000_000 and clock_hz <= 200_000_000
    report "ws2812: clock_hz must be 8 to 200 MHz, got " & integer'image(clock_hz)
    severity failure;
  assert bit_clocks >= one_clocks + 4 and one_clocks > zero_clocks and zero_clocks > 0
    report "ws2812: the next colour cannot be read in the low end of a bit"
    severity failure;
  assert colour_bits <= data_width
    report "ws2812: " & integer'image(channels) & " channels need words of " & integer'image(colour_bits) & " bits"
    severity failure;

  -- The bus.
  index  <= unsigned(wishbone_m2s.adr(index_t'range));
  asked  <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  known  <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto index_bits)) = 0 and
                     unsigned('0' & index) < end_place and
                     (wishbone_m2s.we = '0' or wishbone_m2s.sel(all_bytes'range) = all_bytes) else '0';
  writes <= asked and known and wishbone_m2s.we;

  fetches <= fetch and not asked;
  place   <= resize(ahead, index_bits) when fetches = '1' else index;

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack  <= asked and known;
      err  <= asked and not known;
      flag <= (on_now and to_bit(index = 0)) or ((pending or sending) and to_bit(index = 1));
      if writes = '1' and index >= first_place then
        memory(to_integer(index)) <= wishbone_m2s.dat(colour_t'range);
      end if;
      if writes = '0' then
        found <= memory(to_integer(place));
      end if;
      if writes = '1' and index = 0 then
        on_now <= wishbone_m2s.dat(0);
      end if;
      if reset = '1' then
        ack    <= '0';
        err    <= '0';
        on_now <= '0';
      end if;
    end if;
  end process;

  reply : process (all) is
  begin
    wishbone_s2m                     <= wishbone_s2m_idle;
    wishbone_s2m.ack                 <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err                 <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.dat(colour_t'range) <= found;
    wishbone_s2m.dat(0)              <= found(0) or flag;
  end process;

  -- The frame. It begins at the low end of a bit, in which the first colour is read. Each further one is read at that
  -- of the last bit before it.
  bit_ends <= to_bit(clocks = bit_clocks - 1);
  rest     <= to_bit(clocks = one_clocks);

  send : process (clock) is
  begin
    if rising_edge(clock) then
      sent    <= '0';
      fetched <= fetches;
      if fetches = '1' then
        fetch <= '0';
      end if;
      if fetched = '1' then
        shift <= found and (colour_t'range => on_now);
      end if;

      if sending = '0' then
        clocks <= to_unsigned(one_clocks, clocks'length);
        left   <= (others => '0');
        ahead  <= to_unsigned(first_place, ahead'length);
        quiet  <= '0';
        if pending = '1' then
          pending <= '0';
          sending <= '1';
        end if;
      else
        clocks <= clocks + 1;
        if clocks = 0 then
          data <= not quiet;
        elsif rest = '1' or (clocks = zero_clocks and shift(shift'high) = '0') then
          data <= '0';
        end if;
        if rest = '1' and left = 0 then
          fetch <= '1';
        end if;
        if bit_ends = '1' then
          clocks <= (others => '0');
          left   <= left - 1;
          if left /= 0 then
            shift <= shift(shift'high - 1 downto 0) & '0';
          else
            left  <= to_unsigned(colour_bits - 1, left'length);
            ahead <= ahead + 1;
            if ahead = end_place then
              quiet <= '1';
            end if;
            if ahead = end_place + pause then
              sending <= '0';
              sent    <= not pending;
            end if;
          end if;
        end if;
      end if;

      if writes = '1' and index < first_place then
        pending <= '1';
      end if;
      if reset = '1' then
        sent    <= '0';
        fetch   <= '0';
        fetched <= '0';
        pending <= '1';
        data    <= '0';
        -- A pause first, because the reset may have cut a frame.
        sending <= '1';
        quiet   <= '1';
        clocks  <= (others => '0');
        left    <= to_unsigned(colour_bits - 1, left'length);
        ahead   <= to_unsigned(end_place + 1, ahead'length);
      end if;
    end if;
  end process;

end architecture;
