-- SPDX-License-Identifier: BSD-3-Clause
--
-- The PC's end of a board's UART in a bench of your own, for simulation only. It speaks the framed protocol: it begins
-- a session, executes the requests of host_pkg, and shows the publishes.
--
-- Generics  baud_hz: of the line, 8 data bits, 1 stop bit, no parity, as the board's.
--           answer_bits: how many bit times it waits for an answer before it repeats a request. attempts: how often it
--           sends a request, in all.
-- Ports     rx_line: from the board, tx_line: to the board; idle high. request, reply, publish: see host_pkg.
-- Errors    A request without an answer is repeated (the board executes it once). After the last attempt the reply has
--           status_silent. After a reset of the board a new session begins, without groups, and a note tells it. A
--           byte without its stop bit is reported, and dropped.
-- Latency   A request begins in the delta cycle in which its number changes. The reply comes with the last bit of the
--           board's answer.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.host_pkg.all;
use work.protocol_pkg.all;

entity uart_host is
  generic (
    baud_hz     : positive := 1_000_000;
    answer_bits : positive := 2_000;
    attempts    : positive := 20
  );
  port (
    rx_line : in  std_ulogic;
    tx_line : out std_ulogic := '1';
    request : in  host_request_t;
    reply   : out host_reply_t := (number => 0, status => 0, word => (others => '0'));
    publish : out host_publish_t :=
      (number => 0, group_number => 0, sequence_number => (others => '0'), clock => (others => '0'), count => 0,
       words => (others => (others => '0')))
  );
end entity;

architecture bench of uart_host is

  constant bit_time : time    := 1 sec / baud_hz;
  constant unopened : crc16_t := x"FFFF";

  signal piece        : host_bytes_t(0 to 511);  -- what came between two 00
  signal piece_size   : natural := 0;
  signal piece_number : natural := 0;
  signal epoch        : crc16_t := unopened;
  signal data_bytes   : positive := 4;

begin

  receive : process is
    variable data : byte_t;
    variable size : natural := 0;
    variable came : host_bytes_t(0 to 511);
    variable text : boolean := false;  -- a line of the classic protocol, as the answer to half a frame is
  begin
    wait until rx_line = '0';
    wait for bit_time / 2;
    for index in data'reverse_range loop
      wait for bit_time;
      data(index) := rx_line;
    end loop;
    wait for bit_time;
    if rx_line /= '1' then
      report "uart_host: a byte without its stop bit" severity note;
      size := 0;
      wait until rx_line = '1';
    elsif text or (size = 0 and data(7) = '0') then
      text := data /= x"0A" and data /= x"00";
    elsif data /= x"00" then
      came(size) := data;
      size := (size + 1) mod came'length;
    else
      piece        <= came;
      piece_size   <= size;
      piece_number <= piece_number + 1;
      size := 0;
    end if;
  end process;

  hear : process is
    variable kind, size : natural;
    variable payload    : host_bytes_t(0 to 511);
    variable count      : natural;
    variable words      : host_words_t(0 to publish_words - 1);
    variable number     : natural := 0;
  begin
    wait on piece_number;
    decode(piece(0 to piece_size - 1), epoch, kind, payload, size);
    if kind = device_kind_publish_c and size >= 7 then
      count := (size - 7) / data_bytes;
      for index in 0 to count - 1 loop
        words(index) := std_ulogic_vector(resize(
          number_of(payload(7 + index * data_bytes to 6 + (index + 1) * data_bytes)), 32));
      end loop;
      number := number + 1;
      publish <= (
        number => number, group_number => to_integer(unsigned(payload(0))),
        sequence_number => number_of(payload(1 to 2)), clock => number_of(payload(3 to 6)), count => count,
        words => words);
    end if;
  end process;

  converse : process is

    variable kind, size    : natural;
    variable payload       : host_bytes_t(0 to 511);
    variable address_bytes : positive := 2;
    variable id            : unsigned(15 downto 0) := (others => '0');
    variable session       : unsigned(15 downto 0) := x"1000";

    procedure send (data : host_bytes_t) is
    begin
      for index in data'range loop
        tx_line <= '0';
        wait for bit_time;
        for bit_index in 0 to 7 loop
          tx_line <= data(index)(bit_index);
          wait for bit_time;
        end loop;
        tx_line <= '1';
        wait for bit_time;
      end loop;
    end procedure;

    -- Sends, and waits for a frame of this kind; up to `last`, for a reply has its status there. Its kind is 0 if none
    -- comes.
    procedure ask (frame : host_bytes_t; of_epoch : crc16_t; first, last : natural) is
      variable limit : time;
    begin
      for attempt in 1 to attempts loop
        send(frame);
        limit := now + answer_bits * bit_time;
        while now < limit loop
          wait on piece_number for limit - now;
          exit when now >= limit;
          decode(piece(0 to piece_size - 1), of_epoch, kind, payload, size);
          if kind >= first and kind <= last and (of_epoch = unopened or number_of(payload(0 to 1)) = id) then
            return;
          end if;
          decode(piece(0 to piece_size - 1), unopened, kind, payload, size);
          if kind = device_kind_closed_c and of_epoch /= unopened then
            return;
          end if;
        end loop;
      end loop;
      kind := 0;
    end procedure;

    procedure open_session is
      variable nonce : host_bytes_t(0 to 1);
    begin
      epoch <= unopened;
      send((0 => x"00", 1 => x"00"));
      ask(frame_of(request_kind_hello_c, (x"01", x"01"), unopened), unopened, device_kind_hello_c, device_kind_hello_c);
      if kind = 0 then
        return;
      end if;
      nonce         := payload(1 to 2);
      address_bytes := to_integer(unsigned(payload(5)));
      data_bytes    <= to_integer(unsigned(payload(6)));
      session       := session + 1;
      ask(
        frame_of(request_kind_open_c, nonce & bytes_of(session, 2) & host_bytes_t'(0 => x"00"), unopened), unopened,
        device_kind_open_c, device_kind_open_c);
      if kind /= 0 then
        epoch <= std_ulogic_vector(session);
        id    := x"FFFF";  -- the next one is 0
      end if;
      wait for 0 ns;
    end procedure;

    impure function request_frame return host_bytes_t is
      constant address : host_address_t := request.address;
      variable places  : host_bytes_t(0 to address_bytes * request.count - 1);
    begin
      case request.action is
        when action_read =>
          return frame_of(request_kind_read_c, bytes_of(id, 2) & bytes_of(address, address_bytes), epoch);
        when action_write =>
          return frame_of(
            request_kind_write_c,
            bytes_of(id, 2) & bytes_of(address, address_bytes) & bytes_of(unsigned(request.word), data_bytes), epoch);
        when action_control =>
          return frame_of(
            request_kind_write_control_c,
            bytes_of(id, 2) & bytes_of(address, 2) & bytes_of(unsigned(request.word), 4), epoch);
        when action_group =>
          for index in 0 to request.count - 1 loop
            places(index * address_bytes to (index + 1) * address_bytes - 1) :=
              bytes_of(request.addresses(index), address_bytes);
          end loop;
          return frame_of(
            request_kind_define_group_c,
            bytes_of(id, 2) & bytes_of(address, 1) & bytes_of(unsigned(request.word), 4)
            & host_bytes_t'(0 => "0000000" & to_bit(request.on_event))
            & bytes_of(to_unsigned(request.count, 8), 1) & places, epoch);
      end case;
    end function;

  begin
    wait until request.number /= reply.number;
    for attempt in 1 to 2 loop
      if epoch = unopened then
        open_session;
      end if;
      kind := 0;
      exit when epoch = unopened;
      id := id + 1;
      ask(request_frame, epoch, device_kind_reply_c, device_kind_hello_c - 1);
      exit when kind /= device_kind_closed_c;
      report "uart_host: the board has lost its session; a new one begins" severity note;
      epoch <= unopened;
      wait for 0 ns;
    end loop;
    reply.status <= status_silent when kind < device_kind_reply_c or kind >= device_kind_hello_c
      else kind - device_kind_reply_c;
    if request.action = action_read and size >= 4 + data_bytes then
      reply.word <= std_ulogic_vector(resize(number_of(payload(4 to 3 + data_bytes)), 32));
    end if;
    reply.number <= request.number;
    wait for 0 ns;
  end process;

end architecture;
