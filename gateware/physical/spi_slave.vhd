-- SPDX-License-Identifier: BSD-3-Clause
--
-- SPI slave physical layer. The PC is the master, and clocks one byte each way at once. Mode 0, most significant bit
-- first.
--
--   cs_n  ‾‾\________________________________/‾‾     sampled at rising edges of sck,
--   sck   _____/‾\_/‾\_/‾\_ … _/‾\_/‾\__________     changed at falling edges
--   mosi  -----< 7 X 6 X 5 X … X 1 X 0 >--------
--   miso  -----< 7 X 6 X 5 X … X 1 X 0 >--------     filler if there is nothing to send
--
-- Clocks    sck clocks the bits itself, up to 25 MHz and beyond. clock must be at least as fast as sck. Put sck on a
--           clock net. A byte crosses between the clocks beside a toggle that goes through a synchroniser. The byte
--           does not change meanwhile.
-- Filler    Each side sends zeros as filler when it has nothing to send. Framed messages have zeros at their ends, and
--           classic messages have none. Filler must not come within a framed message. So a message is sent when all of
--           it is in the buffer, or when the buffer is full. Filler from the PC reaches rx_data like any byte.
-- Waiting   `waiting` is high while there is something for the PC. The PC may poll this line or use it as an interrupt.
-- Latency   From the last edge of a byte to rx_valid: 5 clocks. A byte that is ready is sent as the next byte but one.
-- Errors    A byte without room (rx_depth + 2 wait) is lost, and an overrun takes its place (rx_error as in uart).
--           Other errors never occur. If a transfer ends within a byte, the PC's byte is dropped, and the FPGA's byte
--           is sent again.
-- Pressure  tx_ready is low while the buffer is full.
-- Reset     Empties the buffers. A byte that is already offered to sck is still sent.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;

entity spi_slave is
  generic (
    rx_depth : positive := 64; -- bytes, a power of two
    tx_depth : positive := 64; -- bytes, a power of two; the longest message, if filler must never come within one
    filler   : std_ulogic_vector(7 downto 0) := x"00"
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    sck        : in  std_ulogic;
    cs_n       : in  std_ulogic;
    mosi       : in  std_ulogic;
    miso       : out std_ulogic;
    miso_drive : out std_ulogic; -- for a pad on a shared line
    waiting    : out std_ulogic;

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);
    rx_error : out receive_error_t;

    tx_valid : in  std_ulogic;
    tx_ready : out std_ulogic;
    tx_data  : in  std_ulogic_vector(7 downto 0);
    tx_last  : in  std_ulogic := '1'
  );
end entity;

architecture rtl of spi_slave is

  subtype byte_t is std_ulogic_vector(7 downto 0);

  -- In the clock domain of sck.
  signal place       : unsigned(2 downto 0) := "000";   -- of the bit on the lines; 0 is the highest
  signal shift       : std_ulogic_vector(6 downto 0);   -- received bits of this byte
  signal came        : byte_t := (others => '0');       -- the last whole byte
  signal came_toggle : std_ulogic := '0';               -- toggles with it
  signal miso_crossed : byte_t := filler;               -- the byte on miso
  signal took_toggle : std_ulogic := '0';               -- a copy of offer_toggle, of the offer that was taken
  signal goes_one    : std_ulogic := '0';               -- … which is not filler
  signal offer_2      : std_ulogic;                     -- offer_toggle, synchronised

  -- In the clock domain of the streams.
  signal offer        : byte_t := (others => '0');
  signal offer_toggle : std_ulogic := '0';
  signal told, seen            : std_ulogic_vector(2 downto 0); -- goes_one, took_toggle, came_toggle; synchronised
  signal one_2, took_2, came_2 : std_ulogic;
  signal came_3                : std_ulogic := '0';

  signal item_valid, item_room : std_ulogic := '0';
  signal item_crossed          : byte_t;
  signal item_error            : receive_error_t := no_receive_error; -- an overrun in place of the byte
  signal lost                  : std_ulogic := '0';

  signal said, send            : std_ulogic_vector(8 downto 0); -- the byte, with a bit above it: the last of a message
  signal room, may_go          : std_ulogic;
  signal send_valid, send_take : std_ulogic;
  signal whole                 : natural range 0 to tx_depth + 1 := 0; -- messages in the buffer
  signal inside                : std_ulogic := '0';              -- a message is being sent

begin

  miso       <= miso_crossed(7 - to_integer(place));
  miso_drive <= not cs_n;

  offer_synchroniser : entity work.synchroniser
    port map (clock => sck, asynchronous(0) => offer_toggle, levels(0) => offer_2);

  told <= goes_one & took_toggle & came_toggle;

  told_synchroniser : entity work.synchroniser
    generic map (width => 3)
    port map (clock => clock, asynchronous => told, levels => seen);

  one_2  <= seen(2);
  took_2 <= seen(1);
  came_2 <= seen(0);

  receive_bits : process (sck) is
  begin
    if rising_edge(sck) then
      shift <= shift(5 downto 0) & mosi;
      if place = 7 then
        came        <= shift & mosi;
        came_toggle <= not came_toggle;
      end if;
    end if;
  end process;

  count_bits : process (sck, cs_n) is
  begin
    if cs_n = '1' then
      place <= "000";
    elsif falling_edge(sck) then
      place <= place + 1;
    end if;
  end process;

  next_byte : process (sck) is
  begin
    if falling_edge(sck) then
      if place = 7 then
        miso_crossed <= filler;
        goes_one     <= '0';
        if offer_2 /= took_toggle then
          miso_crossed <= offer;
          goes_one     <= '1';
          took_toggle  <= offer_2;
        end if;
      end if;
    end if;
  end process;

  -- From the PC.

  take_over : process (clock) is
    variable new_byte : std_ulogic;
  begin
    if rising_edge(clock) then
      came_3   <= came_2;
      new_byte := came_2 xor came_3;

      if item_room = '1' then
        item_valid   <= new_byte or lost;
        item_crossed <= came;
        item_error   <= (overrun_error_bit => lost, others => '0');
        lost         <= '0'; -- a byte that comes in this clock is part of the overrun
      elsif item_valid = '1' then
        lost <= lost or new_byte;
      else
        item_valid   <= new_byte;
        item_crossed <= came;
        item_error   <= no_receive_error;
      end if;

      if reset = '1' then
        item_valid <= '0';
        lost       <= '0';
      end if;
    end if;
  end process;

  received : entity work.receive_buffer
    generic map (rx_depth => rx_depth)
    port map (
      clock => clock, reset => reset,
      line_valid => item_valid, line_ready => item_room, line_data => item_crossed, line_error => item_error,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

  -- To the PC.

  said     <= tx_last & tx_data;
  tx_ready <= room;

  transmit_buffer : entity work.fifo
    generic map (width => 9, depth => tx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => tx_valid, write_ready => room, write_data => said,
      read_valid => send_valid, read_ready => send_take, read_data => send);

  may_go    <= '1' when whole > 0 or inside = '1' or room = '0' else '0';
  send_take <= '1' when send_valid = '1' and took_2 = offer_toggle and may_go = '1' else '0';
  waiting   <= '1' when one_2 = '1' or took_2 /= offer_toggle or send_take = '1' else '0';

  give : process (clock) is
    variable comes, goes_away : natural range 0 to 1;
  begin
    if rising_edge(clock) then
      comes     := 0;
      goes_away := 0;
      if tx_valid = '1' and room = '1' and tx_last = '1' then
        comes := 1;
      end if;
      if send_take = '1' then
        offer        <= send(7 downto 0);
        offer_toggle <= not offer_toggle;
        inside       <= not send(8);
        if send(8) = '1' then
          goes_away := 1;
        end if;
      end if;
      whole <= whole + comes - goes_away;

      if reset = '1' then
        whole  <= 0;
        inside <= '0';
      end if;
    end if;
  end process;

end architecture;
