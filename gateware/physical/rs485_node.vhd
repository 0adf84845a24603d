-- SPDX-License-Identifier: BSD-3-Clause
--
-- A node on an RS-485 pair, character by character: what it accepts from the master, and when it sends. rs485 adds a
-- line and buffers.
--
--   line_valid/ready/data/error --> | finds tokens   | --> rx_valid/ready      frames for this node, unchanged
--                                   |  | polled      |
--   out_valid/ready/data, drive <-- | takes its turn | <-- send_valid/ready/data/last
--
-- Receives  Frames after a select of this node, and the border before the first. While it drives, it receives nothing.
-- Sends     A turn after each poll of this node, and at no other time: 00, select, 00, messages, poll 0. The messages
--           end at the first end of a message at which no byte waits or `turn_bytes` have been sent. If the core sends
--           no byte of a message for `silence_bits`, the message is cut off and the turn ends.
-- Latency   From the last character of the poll to `drive`: turnaround_bits - 1 bits and 3 clocks. To the first
--           character one bit more. `drive` falls one bit and one clock after the clock in which the transmitter is
--           ready again.
-- Errors    A character with an error belongs to no token. It ends what was selected, except within a frame for this
--           node.
-- Pressure  Characters for the core wait for rx_ready, and others do not wait. send_ready is high only in a turn.
-- Reset     Ends a turn at once.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;
  use work.protocol_pkg.all;

entity rs485_node is
  generic (
    bit_clocks      : positive := 17;
    turn_bytes      : positive := 256; -- sent in a turn, without the rest of the last message
    turnaround_bits : positive := 10;
    silence_bits    : positive := 255  -- of the core, within a message
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    node  : in  std_ulogic_vector(5 downto 0); -- 1 to 63, does not change
    drive : out std_ulogic;

    line_valid : in  std_ulogic;
    line_ready : out std_ulogic;
    line_data  : in  std_ulogic_vector(7 downto 0);
    line_error : in  receive_error_t;

    rx_valid : out std_ulogic; -- line_data and line_error are for the core
    rx_ready : in  std_ulogic;

    send_valid : in  std_ulogic;
    send_ready : out std_ulogic;
    send_data  : in  std_ulogic_vector(7 downto 0);
    send_last  : in  std_ulogic;

    out_valid : out std_ulogic;
    out_ready : in  std_ulogic;
    out_data  : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of rs485_node is

  subtype byte_t is std_ulogic_vector(7 downto 0);

  constant border    : byte_t := (others => '0');
  constant to_master : byte_t := std_ulogic_vector(to_unsigned(rs485_poll_bit_c, 8)); -- poll 0

  type hearing_t is (
    between,   -- between messages: the next byte decides what comes
    frame,     -- a frame for this node
    token,     -- a token: its second byte is next
    end_token, -- a token: both bytes were right so far
    skip       -- up to the next border
  );

  type turn_t is (
    idle,
    turnaround,
    begin_border,
    select_node, select_check, select_border,
    saying,
    broken_border, -- the core has not finished a message
    poll_master, poll_check, poll_border,
    ending -- the last character is being sent
  );

  -- The state after `turn`: the order of the characters around the messages.
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

  signal hearing                : hearing_t := between;
  signal first                  : byte_t := border;
  signal selected               : std_ulogic := '0';
  signal ours                   : std_ulogic; -- the character on line_data is for the core
  signal polled                 : std_ulogic := '0';

  signal turn                   : turn_t := idle;
  signal inside                 : std_ulogic := '0'; -- a message is being sent
  signal left                   : natural range 0 to turn_bytes := 0;
  signal bits_left              : natural range 0 to maximum(silence_bits, turnaround_bits) := 0;
  signal clocks_left            : natural range 0 to bit_clocks - 1 := 0;
  signal may_say                : std_ulogic;
  signal driving                : std_ulogic := '0'; -- a register, so that no glitch drives the pair

begin

  -- From the master: frames for this node, and the border before the first.

  hear : process (all) is
    variable whole : boolean;
  begin
    whole := line_error = no_receive_error;
    ours  <= '0';
    case hearing is
      when between =>
        if selected = '1' and (not whole or line_data(7) = '1') then
          ours <= '1';
        end if;
      when frame =>
        ours <= '1';
      when end_token =>
        if whole and line_data = border and first = "00" & node then
          ours <= '1';
        end if;
      when token | skip =>
        ours <= '0';
    end case;
    if driving = '1' then
      ours <= '0';
    end if;
  end process;

  rx_valid <= line_valid and ours;
  line_ready  <= rx_ready or not ours;

  understand : process (clock) is
    variable whole : boolean;
    variable byte  : byte_t;
  begin
    if rising_edge(clock) then
      polled <= '0';
      if line_valid = '1' and line_ready = '1' then
        whole := line_error = no_receive_error;
        byte  := line_data;
        if not whole then
          hearing <= skip;
          if hearing /= frame then
            selected <= '0'; -- the token may have selected another node
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

  -- The turn.

  with turn select out_data <=
    "00" & node              when select_node,
    token_check("00" & node) when select_check,
    send_data                when saying,
    to_master                when poll_master,
    token_check(to_master)   when poll_check,
    border                   when others;

  may_say <= '1' when inside = '1' or left > 0 else '0';

  with turn select out_valid <=
    '0'                    when idle | turnaround | ending,
    send_valid and may_say when saying,
    '1'                    when others;

  send_ready <= out_ready and may_say when turn = saying else '0';
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
          if send_ready = '1' and send_valid = '1' then
            inside    <= not send_last;
            bits_left <= silence_bits;
            if left > 0 then
              left <= left - 1;
            end if;
          elsif inside = '0' and out_ready = '1' then -- the last message is nearly sent: a late one may join
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

end architecture;
