-- SPDX-License-Identifier: BSD-3-Clause
--
-- Turns payloads into frames: kind, COBS, check and closing 00 of the framed protocol.
--
--   kind ------------------------------> tx   at once, if the frame before has been sent
--   put --> | payload, two of them |  -> tx   as soon as it is complete
--
-- A zero is not stored. When the next zero or the end comes, the distance to it is stored in the place of the zero.
-- That is its COBS code. So each byte is one write, and the payload is encoded when its last byte has come.
--
-- Ports     reply: see frame_pkg; given only while `ready`, otherwise it waits. idle: nothing is being sent.
--           tx: valid/ready/data. tx_last is high with the closing 00, and tx_publish with all bytes of a publish.
-- Latency   A kind is on tx two clocks later. The rest begins four clocks after finish, with one byte per clock: the
--           payload, 1 code, 3 bytes of check, 00. The next payload may be put meanwhile.
-- Errors    None. A payload of more than 254 bytes must not be put.
-- Pressure  tx_ready stalls the frame that is being sent. `ready` is low while a whole payload waits for it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_transmitter is
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic;
    epoch      : in  crc16_t;
    reply      : in  frame_reply_t;
    ready      : out std_ulogic;
    idle       : out std_ulogic;
    tx_valid   : out std_ulogic;
    tx_ready   : in  std_ulogic;
    tx_data    : out byte_t;
    tx_last    : out std_ulogic;
    tx_publish : out std_ulogic
  );
end entity;

architecture rtl of frame_transmitter is

  type memory_t is array (0 to 511) of byte_t;

  signal memory : memory_t;

  -- The payload that is being put.
  signal bank     : std_ulogic := '0';
  signal position : unsigned(7 downto 0) := x"01";  -- of its next byte; its encoding begins at 0
  signal zero     : unsigned(7 downto 0) := x"00";  -- place of the next code
  signal whole    : std_ulogic := '0';              -- it waits to be sent
  signal complete : std_ulogic := '0';              -- and it is all in the memory
  signal puts, ends, drops : std_ulogic := '0';     -- put, finish and restart, a clock later
  signal codes    : std_ulogic;                     -- a code is written
  signal data     : byte_t;                         -- else this byte
  signal writes   : std_ulogic;
  signal written  : byte_t;
  signal write_index : unsigned(7 downto 0);

  signal kind        : byte_t := (others => '0');
  signal kind_waits  : std_ulogic := '0';

  type state_t is (
    resting,   -- ends with a kind
    opened,    -- the kind is sent; ends when the payload is complete
    filling,   -- the first byte of the payload comes from the memory
    sending,   -- the payload; ends after its last byte
    checking,  -- three bytes of check
    closing    -- the 00
  );

  signal state      : state_t := resting;
  signal read_index : unsigned(7 downto 0) := (others => '0');
  signal read_up, read_next : unsigned(7 downto 0);
  signal read_bank  : std_ulogic;
  signal unsent     : unsigned(7 downto 0) := (others => '0');  -- bytes of the encoded payload
  signal looked     : byte_t;                        -- the byte behind the next one
  signal encoded    : byte_t := (others => '0');     -- the next byte, in a register: a block RAM may be slow
  signal advances   : std_ulogic;
  signal crc        : crc16_t := (others => '0');    -- without the byte on tx
  signal turn       : natural range 0 to 2 := 0;     -- which byte of the check
  signal full       : std_ulogic := '0';             -- tx has a byte
  signal free       : std_ulogic;                    -- tx is empty, or its byte is taken
  signal starts     : std_ulogic;                    -- a kind is sent
  signal outside    : std_ulogic;                    -- a kind that belongs to no session
  signal other      : byte_t;                        -- the next byte on tx, if it is not of the payload
  signal loads      : std_ulogic;                    -- it goes to tx
  signal crc_now    : crc16_t;                       -- the CRC with the byte on tx
  signal opens      : std_ulogic;                    -- a payload begins

begin

  assert device_kind_hello_c mod 16 = 0 and device_kind_open_c mod 16 = 1 and device_kind_publish_c mod 16 = 2 and
         device_kind_closed_c mod 16 = 3
    report "frame_transmitter: the kinds are told apart by these bits" severity failure;

  ready    <= not whole;
  free     <= not full or tx_ready;
  tx_valid <= full;
  idle     <= '1' when state = resting and kind_waits = '0' and full = '0' else '0';

  -- The payload.

  note : process (clock)
  begin
    if rising_edge(clock) then
      puts  <= reply.put and not whole and not reset;
      ends  <= reply.finish and not whole and not reset;
      drops <= reply.restart and not whole and not reset;
      data  <= reply.data;
      if opens = '1' or reset = '1' then
        whole <= '0';
      elsif reply.finish = '1' then
        whole <= '1';
      end if;
    end if;
  end process;

  writes <= puts or ends;
  codes  <= ends or nor data;

  place : process (all)
  begin
    written     <= data;
    write_index <= position;
    if codes = '1' then
      written     <= byte_t(position - zero);
      write_index <= zero;
    end if;
  end process;

  put : process (clock)
  begin
    if rising_edge(clock) then
      if writes = '1' then
        memory(to_integer(unsigned'(bank & write_index))) <= written;
      end if;
      if puts = '1' then
        position <= position + 1;
        if codes = '1' then
          zero <= position;
        end if;
      end if;
      if opens = '1' then
        bank <= not bank;
      end if;
      if opens = '1' or drops = '1' or reset = '1' then
        position <= x"01";
        zero     <= x"00";
      end if;
      complete <= (ends or complete) and not (opens or reset);
    end if;
  end process;

  -- The frame.

  starts  <= kind_waits and free when state = resting else '0';
  outside <= kind(4) and not (kind(1) and not kind(0));  -- D0 to D3 without D2
  crc_now <= next_crc16(crc, tx_data);

  with state select other <=
    check_byte(crc, turn) when checking,
    kind                  when resting,
    (others => '0')       when others;
  loads <= starts when state = resting else '0' when state = opened or state = filling else free;

  opens  <= '1' when state = opened and complete = '1' else '0';

  read_bank <= bank when state = opened else not bank;
  advances  <= '1' when state = filling or (state = sending and free = '1') else '0';
  -- `advances` comes late in the clock, because it waits for tx_ready. So it only chooses, and the sum is made
  -- without it.
  read_up   <= read_index + 1;
  read_next <= (others => '0') when state = opened else read_up when advances = '1' else read_index;

  fetch : process (clock)
  begin
    if rising_edge(clock) then
      read_index <= read_next;
      looked     <= memory(to_integer(unsigned'(read_bank & read_next)));
      if advances = '1' then
        encoded <= looked;
      end if;
      if writes = '1' and read_bank = bank and read_next = write_index then
        looked <= (others => '-');  -- the last byte that is written here is read again later
      end if;
    end if;
  end process;

  send : process (clock)
  begin
    if rising_edge(clock) then
      if whole = '0' and reply.kind = '1' then
        kind       <= reply.data;
        kind_waits <= '1';
      end if;
      if free = '1' then
        full    <= '0';
        tx_last <= '0';
      end if;

      case state is
        when resting =>
          turn <= 0;
          if starts = '1' then
            kind_waits <= '0';
            full       <= '1';
            tx_publish <= kind(4) and not outside;
            crc        <= epoch or (crc16_t'range => outside);
            state <= opened;
          end if;
        when opened =>
          unsent <= position;
          if complete = '1' then
            state <= filling;
          end if;
        when filling =>
          state <= sending;
        when sending =>
          if free = '1' then
            full    <= '1';
            crc     <= crc_now;
            unsent  <= unsent - 1;
            if unsent = 1 then
              state <= checking;
            end if;
          end if;
        when checking =>
          if free = '1' then
            full    <= '1';
            if turn = 0 then
              crc <= crc_now;
            end if;
            if turn = 2 then
              state <= closing;
            else
              turn <= turn + 1;
            end if;
          end if;
        when closing =>
          if free = '1' then
            full    <= '1';
            tx_last <= '1';
            state   <= resting;
          end if;
      end case;

      if loads = '1' then
        tx_data <= other;
        if state = checking and turn = 0 then
          tx_data <= check_byte(crc_now, 0);
        elsif state = sending then
          tx_data <= encoded;
        end if;
      end if;

      if reset = '1' then
        state      <= resting;
        full       <= '0';
        kind_waits <= '0';
      end if;
    end if;
  end process;

end architecture;
