-- SPDX-License-Identifier: BSD-3-Clause
--
-- Hands requests on while they come in, one byte at a time: the request_buffer of the datalinks "lite" and "none".
--
--   receive --> | command letters -> command | one data byte | --> request, data, data_valid, data_ended
--
-- Ports     receive: an event a clock, none while room is low. request: from the colon or the end of the command until
--           request_done; its length is said to be more than any request needs. data: the next byte, with data_valid;
--           data_ended: none will come. What comes behind a request that is done is dropped up to the next `start`.
--           message_end: with the colon or byte in `receive`: a request needs no more ("none" goes by it).
-- Latency   A request is valid one clock after its colon or end, a byte one clock after it came; a byte in two clocks.
-- Errors    None of its own; a lone `bad` is handed on. Letters that are no command give `unknown`.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.command_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity request_stream is
  generic (
    address_bytes         : positive range 1 to 4;
    data_bytes            : positive range 1 to 4;
    rate_bytes            : positive range 1 to 4;
    mask_bytes            : positive range 1 to 32;
    has_read_many         : boolean := true;
    has_publishing        : boolean := true;
    configuration_command : boolean := true
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    receive      : in  receive_t;
    room         : out std_ulogic;
    message_end  : out std_ulogic;
    request      : out request_t;
    data         : out byte_t;
    data_valid   : out std_ulogic;
    data_ended   : out std_ulogic;
    take         : in  std_ulogic;
    request_done : in  std_ulogic
  );
end entity;

architecture rtl of request_stream is

  type record_t is record
    letters : letters_t;
    count   : natural range 0 to 4;      -- letters; 4: too many
    named   : std_ulogic;                -- the request of this message has been handed on
    ended   : std_ulogic;                -- and all of it has come
    counted : std_ulogic;                -- a first byte has said how many there are
    left    : unsigned(10 downto 0);     -- bytes to come as far as known
    request : request_t;
    full    : std_ulogic;                -- a byte is in `data`
    data    : byte_t;
  end record;

  constant initial : record_t := (
    letters => (others => (others => '0')), count => 0, named => '0', ended => '0', counted => '0', left => (others => '0'),
    request => request_none, full => '0', data => x"00");

  signal r, r_next : record_t := initial;

  -- Bytes a command needs, as far as its letters say; of read-many and WSA, up to their count.
  function bytes_of(command : command_t) return natural is
  begin
    case command is
      when read                  => return address_bytes;
      when write                 => return address_bytes + data_bytes;
      when read_many             => return 1;
      when write_group_addresses => return 2;
      when write_group_rate      => return 1 + rate_bytes;
      when read_group            => return 1;
      when write_event_mask      => return mask_bytes;
      when others                => return 0;
    end case;
  end function;

begin

  room       <= not r.full and not (r.request.valid and r.ended);
  request    <= r.request;
  data       <= r.data;
  data_valid <= r.full;
  data_ended <= r.ended and not r.full;

  follow : process (all)
    variable v       : record_t;
    variable command : command_t;

    procedure hand_on is
    begin
      v.named           := '1';
      v.request.valid   := '1';
      v.request.error   := '0';
      v.request.command := command;
    end procedure;
  begin
    v := r;
    message_end <= '0';
    command := unknown;

    if take = '1' then
      v.full := '0';
    end if;
    if request_done = '1' then
      v.request.valid := '0';
      v.full          := '0';
    end if;

    case receive.event is
      when start =>
        v.count   := 0;
        v.named   := '0';
        v.ended   := '0';
        v.counted := '0';
      when letter =>
        if r.count < 3 then
          v.letters(r.count + 1) := receive.data(4 downto 0);
        end if;
        if r.count < 4 then
          v.count := r.count + 1;
        end if;
      when colon =>
        command := command_of(r.letters, r.count, '1', has_read_many, has_publishing, false, configuration_command);
        hand_on;
        v.left := to_unsigned(bytes_of(command), 11);
        if bytes_of(command) = 0 then
          v.ended := '1';
          message_end <= '1';
        end if;
      when byte =>
        if v.request.valid = '1' then
          v.full := '1';
          v.data := receive.data;
        end if;
        v.left := r.left - 1;
        if r.left = 1 then
          if r.counted = '0' and (r.request.command = read_many or r.request.command = write_group_addresses) then
            v.counted := '1';
            v.left    := resize(unsigned(receive.data) * to_unsigned(address_bytes, 3), 11);
          end if;
          if v.left = 0 then
            v.ended := '1';
            message_end <= '1';
          end if;
        end if;
      when good =>
        v.ended := '1';
        if r.named = '0' then
          command := command_of(r.letters, r.count, '0', has_read_many, has_publishing, false, configuration_command);
          hand_on;
        end if;
      when bad =>
        hand_on;
        v.ended         := '1';
        v.request.error := '1';
        v.request.code  := receive.data;
      when nothing =>
        null;
    end case;
    v.request.length := (others => '1');
    r_next <= v;
  end process;

  step : process (clock)
  begin
    if rising_edge(clock) then
      r <= r_next;
      if reset = '1' then
        r <= initial;
      end if;
    end if;
  end process;

end architecture;
