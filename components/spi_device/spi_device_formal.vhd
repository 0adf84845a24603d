-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the lines of spi_device: those of its spi_master. The sequencer may ask for any byte at any time after
-- the one before, and the device may answer anything. Half a period of sclk is 2 clocks here, and a pause 3.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.sequencer_pkg.all;

entity spi_device_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    go    : in std_ulogic;
    first : in std_ulogic;
    last  : in std_ulogic;
    data  : in byte_t;
    miso  : in std_ulogic
  );
end entity;

architecture properties of spi_device_formal is

  constant at_rest : std_ulogic := '0';

  signal request              : bus_request_t;
  signal reply                : bus_reply_t;
  signal select_n, sclk, mosi : std_ulogic;
  signal begun                : std_ulogic := '0';
  signal busy                 : std_ulogic := '0'; -- a byte is under way
  signal open_frame           : std_ulogic := '0'; -- a frame has begun, and its last byte was not asked for
  signal last_1               : std_ulogic := '0';
  signal select_1, sclk_1, reset_1, mosi_1 : std_ulogic := '1';
  signal still                : natural range 0 to 3 := 3; -- clocks for which sclk has not changed
  signal chosen               : natural range 0 to 3 := 3; -- clocks for which select_n has not changed
  signal edges                : unsigned(3 downto 0) := (others => '0'); -- of sclk in this byte

begin

  default clock is rising_edge(clk);

  request.go      <= go;
  request.first   <= first;
  request.last    <= last;
  request.receive <= '0';
  request.data    <= data;

  dut : entity work.spi_master
    generic map (clock_hz => 8_000_000, sclk_hz => 2_000_000, mode => 1, select_ns => 300)
    port map (
      clock => clk, reset => reset, request => request, reply => reply, select_n => select_n, sclk => sclk,
      mosi => mosi, miso => miso);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun    <= '1';
      reset_1  <= reset;
      select_1 <= select_n;
      sclk_1   <= sclk;
      mosi_1   <= mosi;
      last_1   <= last;

      if go = '1' then
        busy       <= '1';
        open_frame <= not last;
      elsif reply.done = '1' then
        busy <= '0';
      end if;

      still <= minimum(3, still + 1);
      if sclk /= sclk_1 then
        still <= 1;
        edges <= edges + 1;
      end if;
      chosen <= minimum(3, chosen + 1);
      if select_n /= select_1 then
        chosen <= 1;
      end if;

      if reset = '1' then
        busy       <= '0';
        open_frame <= '0';
      end if;
      if reset = '1' or reset_1 = '1' then -- a reset ends a frame at once
        still  <= 3;
        chosen <= 3;
        edges  <= (others => '0');
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A byte is asked for when the one before is done. A frame begins with `first`, and not inside of one.
  in_turn : assume always go = '1' -> busy = '0' and first = not open_frame and reply.done = '0';

  -- A request stands until it is done, as bus_sequencer_formal shows.
  request_stands : assume always busy = '1' -> last = last_1;

  -- Without select_n sclk is at rest.
  no_clock_without_select : assert always begun = '1' and select_n = '1' -> sclk = at_rest;

  -- sclk keeps a level for at least half a period.
  never_faster : assert always begun = '1' and reset_1 = '0' and sclk /= sclk_1 -> still >= 2;

  -- select_n changes only while sclk is at rest, and at least a pause behind its last edge.
  quiet_at_select : assert always
    begun = '1' and reset_1 = '0' and select_n /= select_1 -> sclk = at_rest and still = 3;

  -- A frame has whole bytes: 16 edges of sclk for each.
  whole_bytes : assert always begun = '1' and reset_1 = '0' and select_n /= select_1 -> edges = 0;

  -- When a byte is done, the frame has ended if this was its last one. Otherwise it is still open.
  ends_with_last : assert always begun = '1' and reply.done = '1' -> select_n = not open_frame;

  -- From select_n to the first edge it takes a pause, and so does the way to the next frame.
  pauses : assert always begun = '1' and reset_1 = '0' and (sclk /= sclk_1 or select_n /= select_1) -> chosen = 3;

  -- mosi does not change at the edge that the device samples.
  stable_mosi : assert always begun = '1' and reset_1 = '0' and sclk < sclk_1 -> mosi = mosi_1;

  -- A frame ends.
  frame_seen : cover {begun = '1' and reset_1 = '0' and select_1 = '0' and select_n = '1'};

end architecture;
