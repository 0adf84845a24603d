-- SPDX-License-Identifier: BSD-3-Clause
--
-- A serial line (UART, RS-485) behind two queues: bytes that are written go out, and bytes that came are read.
--
--   +0  write: puts one byte (bits 7:0) into the queue to the line. Read: bytes for which it still has room
--   +1  read: takes the oldest byte from the line out of its queue. Bits 7:0 byte, bit 8 gap: something before it was
--       lost or broken, bit 9 valid: there was a byte                                                       (read only)
--   +2  baud: 0 baud_hz, 1 4800, 2 9600, 3 19200, 4 38400, 5 57600, 6 115200, 7 230400, 8 460800, 9 921600
--   +3  state: bits 7:0 broken characters, bits 14:8 bytes that found no room, both wrap, bit 15 it sends   (read only)
--
--   tx         ‾‾‾‾‾‾‾‾‾\_start_/ d0 X … X d7 X‾stop‾‾‾‾‾‾‾‾‾‾
--   tx_enable  ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\_____
--                 |hold |                            |hold |
--
-- Generics  parity: 0 none, 1 even, 2 odd. half_duplex 1: the receiver is off while tx_enable is high, so it does not
--           hear what this side sends. hold_us: for so long tx_enable is high before the first start bit and behind the
--           last stop bit, rounded up to whole clocks. depth: bytes in each queue, a power of two.
-- Baud      A rate for which a bit would be shorter than 8 clocks is that of baud_hz. A new rate waits until nothing is
--           to be sent. A byte that comes in just then is lost.
-- Event     arrival: for each byte that may be read, a pulse, the next one behind the read of the byte before. If none
--           has been read since the last byte came, it pulses again with each byte. So a publish of +1 on arrival gives
--           every byte, and also those that came before it was enabled.
-- Latency   2 clocks per access (register_slave). From the write of a byte to its start bit 6 clocks and hold_us, if
--           nothing is sent. From the middle of a stop bit to arrival 8 clocks.
-- Errors    err for a write to +0 without room, for a write to +1 and +3, and for addresses from 4 on. A byte from
--           the line without room is lost and counted: the newest one.
-- Reset     Empties the queues and sets all registers to 0. A byte on the line is cut short.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.physical_pkg.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity uart_bridge is
  generic (
    clock_hz    : positive                         := 50_000_000;
    baud_hz     : positive range 300 to 10_000_000 := 115_200;
    parity      : natural range 0 to 2             := 0;
    stop_bits   : positive range 1 to 2            := 1;
    half_duplex : natural range 0 to 1             := 0;
    hold_us     : natural range 0 to 1000          := 0;
    depth       : positive range 2 to 1024         := 64;
    data_width  : positive range 16 to 32          := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    arrival      : out std_ulogic;

    rx           : in  std_ulogic; -- asynchronous
    tx           : out std_ulogic;
    tx_enable    : out std_ulogic := '0'
  );
end entity;

architecture rtl of uart_bridge is

  constant is_half_duplex : std_ulogic := to_bit(half_duplex = 1);
  constant rate_bits      : positive   := 4;
  constant slowest_hz     : positive   := minimum(baud_hz, 4800);
  constant bits           : positive   := phase_bits(clock_hz, slowest_hz);
  constant hold_clocks    : natural    := (hold_us * ((clock_hz + 999) / 1000) + 999) / 1000;

  subtype index_t is std_ulogic_vector(rate_bits - 1 downto 0);
  type increments_t is array (0 to 2 ** rate_bits - 1) of unsigned(bits - 1 downto 0);
  type rates_t is array (natural range <>) of positive;
  type state_t is (idle, leading, sending, holding);

  function increments return increments_t is
    constant rates : rates_t := (
      baud_hz, 4800, 9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 921_600);
    variable rate  : positive;
    variable found : increments_t;
  begin
    for index in found'range loop
      rate := baud_hz;
      if index < rates'length and rates(index) <= clock_hz / 8 then
        rate := rates(index);
      end if;
      found(index) := shift_left(to_unsigned(phase_increment(clock_hz, rate), bits), bits - phase_bits(clock_hz, rate));
    end loop;
    return found;
  end function;

  constant increment_of : increments_t := increments;

  signal gated_m2s   : wishbone_m2s_t;
  signal read_words  : word_vector_t(0 to 3);
  signal write_words : word_vector_t(0 to 3);
  signal written     : std_ulogic_vector(0 to 3);
  signal was_read    : std_ulogic_vector(0 to 3);

  signal room      : natural range 0 to depth := depth; -- in the queue to the line
  signal index     : index_t := (others => '0');        -- of the rate on the line
  signal asked     : index_t;                           -- of the rate that is written
  signal increment : unsigned(bits - 1 downto 0);
  signal changes   : std_ulogic;                        -- the rate does, behind this clock

  signal state     : state_t := idle;
  signal timer     : natural range 0 to hold_clocks := 0;
  signal to_send   : std_ulogic;                        -- a byte is ready for the line
  signal send_data : std_ulogic_vector(7 downto 0);
  signal sends     : std_ulogic;
  signal tx_ready  : std_ulogic;
  signal sent      : std_ulogic;                        -- the line takes a byte

  signal deaf      : std_ulogic;
  signal rx_valid  : std_ulogic;
  signal rx_data   : std_ulogic_vector(7 downto 0);
  signal rx_error  : receive_error_t;
  signal right     : std_ulogic;                        -- it is a byte
  signal may_put   : std_ulogic;
  signal put, take : std_ulogic;
  signal gap       : std_ulogic := '0';                 -- something was lost since the last byte
  signal came      : std_ulogic;                        -- a byte may be read
  signal came_1    : std_ulogic := '0';                 -- a clock ago, which is when a read took its word
  signal oldest    : std_ulogic_vector(8 downto 0);
  signal told      : std_ulogic := '0';                 -- of the byte that may be read
  signal unread    : std_ulogic := '0';                 -- nothing was read since the last byte came
  signal broken    : unsigned(7 downto 0) := (others => '0');
  signal lost      : unsigned(6 downto 0) := (others => '0');

begin

  assert clock_hz / 8 >= baud_hz
    report "uart_bridge: a bit needs 8 clocks or more; " & integer'image(baud_hz) & " baud needs a clock of "
           & integer'image(baud_hz) & " * 8 Hz"
    severity failure;

  -- A write without room looks as if it had no bytes, which register_slave refuses.
  process (all) is
  begin
    gated_m2s <= wishbone_m2s;
    if room = 0 and unsigned(wishbone_m2s.adr) = 0 then
      gated_m2s.sel <= (others => '0');
    end if;
  end process;

  registers : entity work.register_slave
    generic map (writable => "1010", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => gated_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written, was_read => was_read);

  read_words <= (
    0 => std_ulogic_vector(to_unsigned(room, 32)),
    1 => extended(came & (oldest and came)),
    2 => extended(write_words(2)(index_t'range)),
    3 => extended((to_bit(room /= depth) or tx_enable) & std_ulogic_vector(lost) &
                  std_ulogic_vector(broken)));

  increment <= increment_of(to_integer(unsigned(index)));
  asked     <= write_words(2)(index_t'range);
  changes   <= to_bit(state = idle) and not to_send and to_bit(index /= asked);

  to_line : entity work.fifo
    generic map (width => 8, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => written(0), write_ready => open, write_data => write_words(0)(7 downto 0),
      read_valid => to_send, read_ready => sent, read_data => send_data);

  sends <= to_send when state = sending else '0';
  sent  <= sends and tx_ready;

  transmitter : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => slowest_hz, parity => parity_t'val(parity), stop_bits => stop_bits)
    port map (
      clock => clock, reset => reset, increment => increment,
      tx_valid => sends, tx_ready => tx_ready, tx_data => send_data, line => tx);

  deaf <= reset or changes or (is_half_duplex and tx_enable);

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => slowest_hz, parity => parity_t'val(parity))
    port map (
      clock => clock, reset => deaf, increment => increment, line => rx, line_break => open,
      rx_valid => rx_valid, rx_ready => '1', rx_data => rx_data, rx_error => rx_error);

  right <= rx_valid and to_bit(rx_error = no_receive_error);
  put   <= right and may_put;
  take  <= was_read(1) and came_1;

  from_line : entity work.fifo
    generic map (width => 9, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => right, write_ready => may_put, write_data => gap & rx_data,
      read_valid => came, read_ready => take, read_data => oldest);

  process (clock) is
  begin
    if rising_edge(clock) then
      if written(0) = '1' and sent = '0' then
        room <= room - 1;
      elsif written(0) = '0' and sent = '1' then
        room <= room + 1;
      end if;

      if changes = '1' then
        index <= asked;
      end if;

      case state is
        when idle =>
          timer <= hold_clocks;
          if to_send = '1' then
            tx_enable <= '1';
            state     <= leading;
          end if;

        when leading =>
          if timer = 0 then
            state <= sending;
          else
            timer <= timer - 1;
          end if;

        when sending =>
          timer <= hold_clocks;
          if to_send = '0' and tx_ready = '1' then
            state <= holding;
          end if;

        when holding =>
          if to_send = '1' then
            state <= sending;
          elsif timer = 0 then
            tx_enable <= '0';
            state     <= idle;
          else
            timer <= timer - 1;
          end if;
      end case;

      if rx_valid = '1' then
        gap <= not put;
        if right = '0' then
          broken <= broken + 1;
        elsif may_put = '0' then
          lost <= lost + 1;
        end if;
      end if;

      came_1  <= came;
      arrival <= came and not told and not take;
      told    <= came and not take and not (put and unread);
      unread  <= (unread or put) and not take;

      if reset = '1' then
        room      <= depth;
        index     <= (others => '0');
        state     <= idle;
        tx_enable <= '0';
        gap       <= '0';
        broken    <= (others => '0');
        lost      <= (others => '0');
        came_1    <= '0';
        arrival   <= '0';
        told      <= '0';
        unread    <= '0';
      end if;
    end if;
  end process;

end architecture;
