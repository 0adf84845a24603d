-- SPDX-License-Identifier: BSD-3-Clause
--
-- The DATA packet of a running TosNet ring at one node: what it takes out, puts in and passes on.
--
-- Slave     Passes on each byte that comes. In its own IN section it takes the byte, and puts its own OUT byte there.
--           From the OUT sections of the others it takes the bytes.
-- Master    With `send`, sends a packet: its own OUT words, the IN words of the others, and their OUT words as they
--           last came. In what comes back, it takes the OUT words of the others out of their IN sections.
-- Words     `received_valid` is high for one clock with each word that came, at its address in the shared memory. They
--           are for good only if `fresh` is high at the end of the packet. send_word belongs to the send_address of
--           the clock before, or of two clocks before. It must not change from `send` on, or from a strobe to the next.
-- End       packet_done is high for one clock after each DATA packet that came with its whole length. `fresh`: its
--           checksum and the node in its asynchronous slot are as they must be. After a packet that ended early or late
--           `broken` is high for one clock instead. A packet that is not fresh is passed on poisoned.
-- Foreign   The slot names a node that this ring does not have, or, for the master, another one than it had asked:
--           `foreign` is high for one clock. So two rings that are joined by mistake notice it within a cycle.
-- Pressure  item_ready must be high whenever a slave has an item. A master waits.
-- Spec      A slave tells spec_word in the bytes of an empty slot, the lowest byte first, if it has no message, and in
--           the first of eight answers if it has. With zero it tells nothing, like a node of 2010. To the master,
--           `told` is high for one clock with an answer of told_id that is no message: told_word is zero if that node
--           has told nothing.
-- Channel   send_waiting: the mailbox has a message, to send_id. The master sends it, or asks the members in turn for
--           theirs. A slave sends its own only when it is asked.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_exchange is
  generic (
    may_be_master : boolean                       := true;
    spec_word     : std_ulogic_vector(31 downto 0) := x"00000000"
  );
  port (
    clock       : in std_ulogic;
    reset       : in std_ulogic; -- synchronous
    id          : in std_ulogic_vector(3 downto 0);
    running     : in std_ulogic;
    is_master   : in std_ulogic;
    master_id   : in std_ulogic_vector(3 downto 0);
    own_address : in unsigned(3 downto 0);
    nodes       : in unsigned(3 downto 0);
    members     : in std_ulogic_vector(15 downto 0);

    start      : in  std_ulogic; -- tosnet_packet_in
    valid      : in  std_ulogic;
    data       : in  byte_t;
    done       : in  std_ulogic;
    good       : in  std_ulogic;
    item_valid : out std_ulogic; -- to tosnet_packet_out
    item_ready : in  std_ulogic;
    item_data  : out item_t;

    in_index  : out unsigned(3 downto 0); -- tosnet_table, for what comes
    in_entry  : in  std_ulogic_vector(7 downto 0);
    in_mask   : in  std_ulogic_vector(7 downto 0);
    out_index : out unsigned(3 downto 0); -- tosnet_table, for what the master sends
    out_entry : in  std_ulogic_vector(7 downto 0);
    out_mask  : in  std_ulogic_vector(7 downto 0);

    received_valid   : out std_ulogic;
    received_address : out std_ulogic_vector(9 downto 0);
    received_word    : out std_ulogic_vector(31 downto 0);
    send_address     : out std_ulogic_vector(9 downto 0);
    send_word        : in  std_ulogic_vector(31 downto 0);
    send             : in  std_ulogic;
    sent             : out std_ulogic; -- the master's packet is complete, for one clock
    packet_done      : out std_ulogic;
    fresh            : out std_ulogic;
    broken           : out std_ulogic;
    foreign          : out std_ulogic;
    told             : out std_ulogic;
    told_id          : out std_ulogic_vector(3 downto 0);
    told_word        : out std_ulogic_vector(31 downto 0);

    send_waiting : in  std_ulogic := '0'; -- tosnet_mailbox
    send_id      : in  std_ulogic_vector(3 downto 0) := "0000";
    send_begin   : out std_ulogic;
    send_step    : out std_ulogic;
    send_data    : in  byte_t := x"00";
    send_count   : in  unsigned(3 downto 0) := "0000";
    take_valid   : out std_ulogic;
    take_data    : out byte_t;
    take_keep    : out std_ulogic;
    take_count   : out unsigned(3 downto 0);
    take_id      : out std_ulogic_vector(3 downto 0)
  );
end entity;

architecture rtl of tosnet_exchange is

  constant slot_tail  : natural := tosnet_wire_message_bytes_c + 1;
  constant slot_bytes : natural := tosnet_wire_message_bytes_c + 2;

  constant tells : boolean := spec_word /= x"00000000";

  -- What comes.
  signal first       : std_ulogic; -- the next byte is the packet's first
  signal in_packet   : std_ulogic;
  signal in_step     : std_ulogic;
  signal in_ready    : std_ulogic;
  signal in_finished : std_ulogic;
  signal in_address  : std_ulogic_vector(9 downto 0);
  signal in_lane     : unsigned(1 downto 0);
  signal in_own      : std_ulogic;
  signal in_slot     : natural range 0 to slot_bytes; -- bytes of the slot that have come
  signal too_long    : std_ulogic;
  signal stray       : std_ulogic; -- the slot names a node that it must not
  signal for_us      : std_ulogic; -- the slot has a message for this node
  signal answering   : std_ulogic; -- this slave puts its message into the slot
  signal telling     : std_ulogic; -- this slave puts spec_word into the slot
  signal answered    : std_ulogic; -- the slot is an answer of the node that the master has asked
  signal spoke       : std_ulogic; -- … and has a message
  signal untold      : unsigned(2 downto 0) := "000"; -- answers since this slave has told spec_word
  signal heard_word  : std_ulogic_vector(31 downto 0); -- the first bytes of the slot
  signal own_byte    : byte_t;
  signal three_bytes : std_ulogic_vector(23 downto 0); -- of the word that comes
  signal in_item     : item_t;
  signal in_item_valid : std_ulogic;
  signal in_begin, in_next : std_ulogic; -- of the mailbox

  -- What the master sends.
  signal out_item       : item_t;
  signal out_item_valid : std_ulogic;
  signal out_address    : std_ulogic_vector(9 downto 0);
  signal out_begin, out_next : std_ulogic;
  signal asked          : std_ulogic_vector(3 downto 0); -- the node in the slot that was sent
  signal out_message    : std_ulogic; -- the slot has a message for it, which an answer without one leaves there

  function byte_of (bits : std_ulogic_vector(31 downto 0); lane : unsigned(1 downto 0)) return byte_t is
  begin
    case lane is
      when "00"   => return bits(7 downto 0);
      when "01"   => return bits(15 downto 8);
      when "10"   => return bits(23 downto 16);
      when others => return bits(31 downto 24);
    end case;
  end function;

begin

  in_walk : entity work.tosnet_walk
    port map (
      clock => clock, restart => start, step => in_step, nodes => nodes, own_address => own_address,
      table_index => in_index, table_entry => in_entry, table_mask => in_mask,
      ready => in_ready, finished => in_finished, address => in_address, lane => in_lane, own => in_own);

  in_step  <= valid and in_packet and in_ready and not first;
  own_byte <= byte_of(send_word, in_lane);

  received_word    <= data & three_bytes;
  received_address <= in_address(9 downto 3) & (in_address(tosnet_in_bit_c) and not is_master)
                      & in_address(1 downto 0);
  received_valid   <= in_step and (and in_lane) and in_address(tosnet_in_bit_c) and not in_own when is_master = '1' else
                      in_step and (and in_lane) and (in_address(tosnet_in_bit_c) xnor in_own);

  incoming : process (clock) is
    variable who      : natural range 0 to 15;
    variable kind     : natural range 0 to 15;
    variable whole    : std_ulogic;
    variable complete : std_ulogic;
    variable passed   : byte_t;
    variable due_to_tell : std_ulogic;
  begin
    if rising_edge(clock) then
      in_item_valid  <= '0';
      packet_done    <= '0';
      broken         <= '0';
      foreign        <= '0';
      in_begin       <= '0';
      in_next        <= '0';
      take_valid     <= '0';
      take_keep      <= '0';
      told           <= '0';
      take_data      <= data;
      passed         := data;

      if valid = '1' and first = '1' then
        first     <= '0';
        in_packet <= running and to_bit(data = halves(tosnet_wire_data_c, "0000"));
        in_item_valid <= not is_master and running and to_bit(data = halves(tosnet_wire_data_c, "0000"));
        in_slot   <= 0;
        too_long  <= '0';
        stray     <= '0';
        for_us    <= '0';
        answering <= '0';
        telling   <= '0';
        answered  <= '0';
        spoke     <= '0';
      elsif valid = '1' and in_packet = '1' then
        in_item_valid <= not is_master;
        if in_finished = '0' then
          three_bytes <= data & three_bytes(23 downto 8);
          if is_master = '0' and in_own = '1' and in_address(tosnet_in_bit_c) = '1' then
            passed := own_byte;
          end if;
        elsif in_slot = slot_bytes then
          too_long <= '1';
        else
          in_slot <= in_slot + 1;
          if in_slot = 0 then
            who  := to_integer(unsigned(data(3 downto 0)));
            kind := to_integer(unsigned(data(7 downto 4)));
            take_id <= data(3 downto 0);
            if is_master = '1' then
              stray  <= to_bit(data(3 downto 0) /= asked);
              for_us <= to_bit(kind = tosnet_wire_message_from_node_c);
              spoke  <= to_bit(kind = tosnet_wire_message_from_node_c);
              answered <= to_bit(kind = tosnet_wire_message_from_node_c or kind = tosnet_wire_no_message_from_node_c);
            else
              take_id <= master_id;
              stray   <= to_bit(who /= 0) and not members(who);
              for_us  <= to_bit(kind = tosnet_wire_message_from_master_c and (who = 0 or data(3 downto 0) = id));
              if data(3 downto 0) = id
                and (kind = tosnet_wire_message_from_master_c or kind = tosnet_wire_no_message_from_master_c)
              then
                due_to_tell := '0';
                if tells then
                  telling     <= to_bit(kind = tosnet_wire_no_message_from_master_c);
                  due_to_tell := to_bit(kind = tosnet_wire_no_message_from_master_c and untold = 0);
                  if untold > 0 or due_to_tell = '1' then
                    untold <= untold + 1;
                  end if;
                end if;
                answering <= send_waiting and not due_to_tell;
                in_begin  <= send_waiting and not due_to_tell;
                if send_waiting = '1' and due_to_tell = '0' then
                  passed := halves(tosnet_wire_message_from_node_c, id);
                else
                  passed := halves(tosnet_wire_no_message_from_node_c, id);
                end if;
              end if;
            end if;
          elsif in_slot < slot_tail then
            take_valid <= '1';
            in_next    <= answering;
            if answering = '1' then
              passed := send_data;
            elsif telling = '1' and in_slot <= 4 then
              passed := byte_of(spec_word, to_unsigned(in_slot - 1, 2));
            end if;
            if in_slot <= 4 then
              heard_word <= data & heard_word(31 downto 8);
            end if;
          else
            take_count <= unsigned(data(7 downto 4));
            if unsigned(data(7 downto 4)) > tosnet_wire_message_bytes_c then
              for_us <= '0';
            end if;
            if answering = '1' then
              passed := std_ulogic_vector(send_count) & id;
            end if;
          end if;
        end if;
      end if;
      in_item <= '0' & passed;

      if done = '1' then
        first <= '1';
        if in_packet = '1' then
          whole         := in_finished and to_bit(in_slot = slot_bytes) and not too_long;
          complete      := good and whole and not stray;
          in_packet     <= '0';
          in_item_valid <= not is_master;
          in_item       <= item_end(8 downto 1) & not complete;
          packet_done   <= whole;
          broken        <= not whole;
          fresh         <= complete;
          foreign       <= good and stray;
          take_keep     <= complete and for_us;
          told          <= complete and answered and not spoke and not out_message;
        end if;
      end if;

      if reset = '1' or running = '0' then
        first         <= '1';
        in_packet     <= '0';
        packet_done   <= '0';
        broken        <= '0';
        foreign       <= '0';
        in_item_valid <= '0';
        take_keep     <= '0';
        told          <= '0';
        untold        <= "000";
      end if;
    end if;
  end process;

  told_id   <= asked;
  told_word <= heard_word;

  sender : if may_be_master generate

    type state_t is (quiet, command, fetch, put, head, message, tail, ends);

    signal state       : state_t;
    signal wait_clocks : natural range 0 to 3;
    signal step        : std_ulogic;
    signal walk_ready  : std_ulogic;
    signal finished    : std_ulogic;
    signal lane        : unsigned(1 downto 0);
    signal own         : std_ulogic;
    signal place       : natural range 0 to tosnet_wire_message_bytes_c - 1;
    signal turn        : unsigned(3 downto 0) := "0000"; -- the member that is asked next
    signal sends       : std_ulogic;           -- the slot has a message of this node

  begin

    walk : entity work.tosnet_walk
      port map (
        clock => clock, restart => send, step => step, nodes => nodes, own_address => own_address,
        table_index => out_index, table_entry => out_entry, table_mask => out_mask,
        ready => walk_ready, finished => finished, address => out_address, lane => lane, own => own);

    out_message    <= sends;
    out_item_valid <= to_bit(state /= quiet and state /= fetch and (state /= message or wait_clocks = 0));
    step           <= to_bit(state = put) and item_ready;
    out_begin      <= to_bit(state = head) and item_ready and sends;
    out_next       <= to_bit(state = message and wait_clocks = 0) and item_ready and sends;

    process (all) is
    begin
      case state is
        when command =>
          out_item <= '0' & halves(tosnet_wire_data_c, "0000");
        when put =>
          out_item <= '0' & byte_of(send_word, lane);
          if own = '1' and out_address(tosnet_in_bit_c) = '1' then
            out_item <= (others => '0');
          end if;
        when head =>
          out_item <= '0' & halves(tosnet_wire_no_message_from_master_c, asked);
          if sends = '1' then
            out_item <= '0' & halves(tosnet_wire_message_from_master_c, asked);
          end if;
        when message =>
          out_item <= '0' & (send_data and (7 downto 0 => sends));
        when tail =>
          out_item <= '0' & (std_ulogic_vector(send_count) and (3 downto 0 => sends)) & asked;
        when others =>
          out_item <= item_end;
      end case;
    end process;

    process (clock) is
    begin
      if rising_edge(clock) then
        sent <= '0';
        if members(to_integer(turn)) = '0' or std_ulogic_vector(turn) = id then
          turn <= turn + 1;
        end if;
        if wait_clocks > 0 then
          wait_clocks <= wait_clocks - 1;
        end if;
        case state is
          when quiet =>
            if send = '1' then
              state <= command;
              sends <= send_waiting;
              if send_waiting = '1' then
                asked <= send_id;
              else
                asked <= std_ulogic_vector(turn);
                turn  <= turn + 1;
              end if;
            end if;
          when command =>
            if item_ready = '1' then
              state       <= fetch;
              wait_clocks <= 3;
            end if;
          when fetch =>
            if wait_clocks = 0 and walk_ready = '1' then
              state <= put;
            elsif wait_clocks = 0 and finished = '1' then
              state <= head;
            elsif walk_ready = '0' and finished = '0' then
              wait_clocks <= 3;
            end if;
          when put =>
            if item_ready = '1' then
              state       <= fetch;
              wait_clocks <= 3;
            end if;
          when head =>
            if item_ready = '1' then
              state <= message;
              place <= 0;
              wait_clocks <= 3;
            end if;
          when message =>
            if item_ready = '1' and wait_clocks = 0 then
              wait_clocks <= 3;
              if place = tosnet_wire_message_bytes_c - 1 then
                state <= tail;
              else
                place <= place + 1;
              end if;
            end if;
          when tail =>
            if item_ready = '1' then
              state <= ends;
            end if;
          when ends =>
            if item_ready = '1' then
              state <= quiet;
              sent  <= '1';
            end if;
        end case;
        if reset = '1' or running = '0' then
          state <= quiet;
          sent  <= '0';
        end if;
        if reset = '1' then
          turn <= "0000";
        end if;
      end if;
    end process;

  end generate;

  no_sender : if not may_be_master generate
    out_index      <= "0000";
    out_item       <= item_end;
    out_item_valid <= '0';
    out_address    <= (others => '0');
    out_begin      <= '0';
    out_next       <= '0';
    asked          <= "0000";
    out_message    <= '0';
    sent           <= '0';
  end generate;

  item_valid   <= out_item_valid when is_master = '1' else in_item_valid;
  item_data    <= out_item when is_master = '1' else in_item;
  send_begin   <= in_begin or out_begin;
  send_step    <= in_next or out_next;
  send_address <= out_address when is_master = '1' else in_address(9 downto 3) & '0' & in_address(1 downto 0);

end architecture;
