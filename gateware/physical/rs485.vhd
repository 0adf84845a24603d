-- SPDX-License-Identifier: BSD-3-Clause
--
-- RS-485 physical layer: one of up to 63 nodes on a pair, on the framed protocol. The PC is the master; a node speaks when
-- it is polled.
--
--   master   00 | select 3 | frame 00 … | poll 3 |
--   drive    ___________________________________/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____
--   node 3                                       | 00 | select 3 | frame 00 … | poll 0 |
--
-- Tokens    Three bytes, the last 00, between frames (docs/protocol.md, section 10). One with up to three flipped bits is none.
-- Turn      Begins `turnaround_bits` behind a poll, so that the master can let the pair go. Ends at the first end of a message
--           at which there is no byte waiting or `turn_bytes` have been sent; or, the message broken, when the core has said
--           nothing within one for 255 bits. drive rises a bit before the first start bit and falls a bit behind the last
--           stop bit.
-- Echo      While drive is high nothing is heard: transceivers that listen to themselves do no harm.
-- Errors    In their place between the bytes, as of uart; those outside of our own frames are nobody's.
-- Pressure  tx_ready is low while the buffer is full. Messages wait for their turn: the buffer is best as long as a turn.
--           rx_depth + 2 characters may wait, further ones are lost and an overrun stands in their place.
-- Latency   Receive: 7 clocks from the middle of the stop bit to rx_valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;
  use work.protocol_pkg.all;

entity rs485 is
  generic (
    clock_hz        : positive := 50_000_000;
    baud_hz         : positive := 3_000_000;
    rx_depth        : positive := 64;  -- bytes, a power of two
    tx_depth        : positive := 256; -- bytes, a power of two
    turn_bytes      : positive := 256; -- said in a turn, but for the rest of the last message
    turnaround_bits : positive := 10
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    node    : in  std_ulogic_vector(5 downto 0); -- 1 to 63; a constant, or switches that stand still
    rx_line : in  std_ulogic; -- asynchronous
    tx_line : out std_ulogic;
    drive   : out std_ulogic; -- DE of the transceiver, and RE# where that is a wire of its own

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);
    rx_error : out receive_error_t;

    tx_valid : in  std_ulogic;
    tx_ready : out std_ulogic;
    tx_data  : in  std_ulogic_vector(7 downto 0);
    tx_last  : in  std_ulogic
  );
end entity;

architecture rtl of rs485 is

  subtype byte_t is std_ulogic_vector(7 downto 0);
  -- A character or an error in place of one: error above data.
  subtype item_t is std_ulogic_vector(receive_error_t'length + 7 downto 0);

  constant border       : byte_t   := (others => '0');
  constant to_master    : byte_t   := std_ulogic_vector(to_unsigned(rs485_poll_bit_c, 8)); -- poll 0
  constant bit_clocks   : positive := (clock_hz + baud_hz - 1) / baud_hz;
  constant silence_bits : positive := 255; -- of the core, within a message

  type hearing_t is (
    between,   -- messages: the next byte tells what comes
    frame,     -- of ours
    token,     -- its second byte is next
    end_token, -- both were right, so far
    skip       -- to the next border
  );

  type turn_t is (
    idle,
    turnaround,
    begin_border,
    select_node, select_check, select_border,
    saying,
    broken_border, -- the core has left a message unfinished
    poll_master, poll_check, poll_border,
    ending -- the last character is on the line
  );

  -- The characters around the messages, one behind the other.
  function behind (turn : turn_t) return turn_t is
  begin
    case turn is
      when begin_border                  => return select_node;
      when select_node                   => return select_check;
      when select_check                  => return select_border;
      when select_border                 => return saying;
      when saying | broken_border        => return poll_master;
      when poll_master                   => return poll_check;
      when poll_check                    => return poll_border;
      when poll_border | ending          => return ending;
      when idle | turnaround             => return idle;
    end case;
  end function;

  signal line_valid, line_ready : std_ulogic;
  signal room                   : std_ulogic;
  signal line_item              : item_t;
  signal hearing                : hearing_t := between;
  signal first                  : byte_t := border;
  signal selected               : std_ulogic := '0';
  signal ours                   : std_ulogic; -- the character on line_item is for the core
  signal polled                 : std_ulogic := '0';
  signal write_valid            : std_ulogic;
  signal item_valid, item_ready : std_ulogic;
  signal item                   : item_t;
  signal is_byte                : std_ulogic;

  signal said, send             : std_ulogic_vector(8 downto 0); -- the byte; above it: the last of a message
  signal send_valid, send_take  : std_ulogic;
  signal turn                   : turn_t := idle;
  signal inside                 : std_ulogic := '0'; -- a message that goes out
  signal left                   : natural range 0 to turn_bytes := 0;
  signal bits_left              : natural range 0 to maximum(silence_bits, turnaround_bits) := 0;
  signal clocks_left            : natural range 0 to bit_clocks - 1 := 0;
  signal out_valid, out_ready   : std_ulogic;
  signal out_data               : byte_t;
  signal may_say                : std_ulogic;
  signal driving                : std_ulogic := '0'; -- a register: no spike may take the pair

begin

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, line => rx_line, line_break => open,
      rx_valid => line_valid, rx_ready => line_ready,
      rx_data => line_item(7 downto 0), rx_error => line_item(item_t'high downto 8));

  -- What the master says: frames of ours go on, and the border in front of the first.

  hear : process (all) is
    variable whole : boolean;
  begin
    whole := line_item(item_t'high downto 8) = no_receive_error;
    ours  <= '0';
    case hearing is
      when between =>
        if selected = '1' and (not whole or line_item(7) = '1') then
          ours <= '1';
        end if;
      when frame =>
        ours <= '1';
      when end_token =>
        if whole and line_item(7 downto 0) = border and first = "00" & node then
          ours <= '1';
        end if;
      when token | skip =>
        ours <= '0';
    end case;
    if driving = '1' then
      ours <= '0';
    end if;
  end process;

  write_valid <= line_valid and ours;
  line_ready  <= room or not ours;

  understand : process (clock) is
    variable whole : boolean;
    variable byte  : byte_t;
  begin
    if rising_edge(clock) then
      polled <= '0';
      if line_valid = '1' and line_ready = '1' then
        whole := line_item(item_t'high downto 8) = no_receive_error;
        byte  := line_item(7 downto 0);
        if not whole then
          hearing <= skip;
          if hearing /= frame then
            selected <= '0'; -- it may have been another's token
          end if;
        elsif byte = border then
          hearing <= between;
          if hearing = end_token then
            selected <= '0';
            if first(5 downto 0) = node then
              selected <= not first(6);
              polled   <= first(6);
            end if;
          elsif hearing = token then
            selected <= '0';
          end if;
        else
          case hearing is
            when between =>
              first   <= byte;
              hearing <= skip;
              if byte(7) = '0' then
                hearing <= token;
              elsif selected = '1' then
                hearing <= frame;
              end if;
            when token =>
              hearing <= skip;
              if byte = token_check(first) then
                hearing <= end_token;
              else
                selected <= '0';
              end if;
            when end_token =>
              hearing  <= skip;
              selected <= '0';
            when frame | skip =>
              null;
          end case;
        end if;
      end if;

      if reset = '1' or driving = '1' then
        hearing  <= between;
        selected <= '0';
        polled   <= '0';
      end if;
    end if;
  end process;

  receive_buffer : entity work.fifo
    generic map (width => item_t'length, depth => rx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => write_valid, write_ready => room, write_data => line_item,
      read_valid => item_valid, read_ready => item_ready, read_data => item);

  is_byte    <= '1' when item(item_t'high downto 8) = no_receive_error else '0';
  rx_valid   <= item_valid and is_byte;
  rx_data    <= item(7 downto 0);
  item_ready <= rx_ready or not is_byte;
  rx_error   <= item(item_t'high downto 8) when item_valid = '1' else no_receive_error;

  -- Our turn.

  said <= tx_last & tx_data;

  transmit_buffer : entity work.fifo
    generic map (width => 9, depth => tx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => tx_valid, write_ready => tx_ready, write_data => said,
      read_valid => send_valid, read_ready => send_take, read_data => send);

  with turn select out_data <=
    "00" & node              when select_node,
    token_check("00" & node) when select_check,
    send(7 downto 0)         when saying,
    to_master                when poll_master,
    token_check(to_master)   when poll_check,
    border                   when others;

  may_say <= '1' when inside = '1' or left > 0 else '0';

  with turn select out_valid <=
    '0'                    when idle | turnaround | ending,
    send_valid and may_say when saying,
    '1'                    when others;

  send_take <= out_ready and may_say when turn = saying else '0';
  drive     <= driving;

  take_turns : process (clock) is
    variable next_bit : boolean;
  begin
    if rising_edge(clock) then
      next_bit := clocks_left = 0;
      if next_bit then
        clocks_left <= bit_clocks - 1;
        if bits_left > 0 then
          bits_left <= bits_left - 1;
        end if;
      else
        clocks_left <= clocks_left - 1;
      end if;

      driving <= '1';
      if turn = idle or (turn = turnaround and bits_left > 1) then
        driving <= '0';
      end if;

      case turn is
        when idle =>
          bits_left   <= turnaround_bits;
          clocks_left <= bit_clocks - 1;
          if polled = '1' then
            turn <= turnaround;
          end if;
        when turnaround =>
          if next_bit and bits_left = 1 then
            turn <= begin_border;
          end if;
          left   <= turn_bytes;
          inside <= '0';
        when saying =>
          if send_take = '1' and send_valid = '1' then
            inside    <= not send(8);
            bits_left <= silence_bits;
            if left > 0 then
              left <= left - 1;
            end if;
          elsif inside = '0' and out_ready = '1' then -- the last message is nearly out: a late one may join
            turn <= poll_master;
          elsif inside = '1' and send_valid = '0' and bits_left = 0 then
            turn <= broken_border;
          end if;
        when ending =>
          if out_ready = '0' then
            bits_left   <= 1;
            clocks_left <= bit_clocks - 1;
          elsif next_bit then
            turn <= idle;
          end if;
        when others =>
          if out_ready = '1' then
            turn <= behind(turn);
          end if;
      end case;

      if reset = '1' then
        turn    <= idle;
        driving <= '0';
        inside  <= '0';
        left    <= 0;
      end if;
    end if;
  end process;

  transmitter : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, tx_valid => out_valid, tx_ready => out_ready, tx_data => out_data, line => tx_line);

end architecture;
