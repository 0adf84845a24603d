-- SPDX-License-Identifier: BSD-3-Clause
--
-- Passes requests on while they come in, one byte at a time. It is the request_buffer of the datalinks "lite" and
-- "none".
--
--   receive --> | letters -> recogniser -> command | one data byte | --> request
--
-- Ports     receive: at most one event per clock, and none while room is low.
--           request: valid from the colon, or from the end of the command, until request_done. Its command and similar
--           fields are valid until the first take. After that `data` is the next byte, with `ready`. `missing`: none
--           will come. Bytes after a request that is done are dropped up to the next `start`.
--           message_end: comes with the colon or byte in `receive` after which a request needs no more. "none" uses it.
-- Latency   A request is valid one clock after its colon or end, and a byte one clock after it came. One byte per two
--           clocks.
-- Errors    None of its own. A `bad` outside a message is passed on. Letters of an unknown command give a number
--           without a command.

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
    take         : in  std_ulogic;
    request_done : in  std_ulogic
  );
end entity;

architecture rtl of request_stream is

  constant machine : recogniser_t := recogniser(has_read_many, has_publishing, false, configuration_command);

  type record_t is record
    state   : command_t;                 -- of the recogniser
    named   : std_ulogic;                -- the request of this message was passed on
    ended   : std_ulogic;                -- all of the message has come
    counted : std_ulogic;                -- the first byte has given the number of bytes
    left    : unsigned(10 downto 0);     -- bytes still to come, as far as known
    valid   : std_ulogic;
    begun   : std_ulogic;                -- the command was taken
    error   : std_ulogic;
    full    : std_ulogic;                -- `data` holds a byte
    data    : byte_t;
  end record;

  constant initial : record_t := (
    state => (others => '0'), left => (others => '0'), data => x"00", others => '0');

  signal r, r_next : record_t := initial;

  -- The bytes that a command needs, as far as its letters say. For read-many and WSA, the bytes up to their count.
  function bytes_of(command : command_t) return natural is
  begin
    case to_integer(unsigned(command)) is
      when command_read                  => return address_bytes;
      when command_write                 => return address_bytes + data_bytes;
      when command_read_many             => return 1;
      when command_write_group_addresses => return 2;
      when command_write_group_rate      => return 1 + rate_bytes;
      when command_read_group            => return 1;
      when command_write_event_mask      => return mask_bytes;
      when others                        => return 0;
    end case;
  end function;

  -- Whether the first bytes of the command give the number of bytes.
  function counts(command : command_t) return boolean is
  begin
    return unsigned(command) = command_read_many or unsigned(command) = command_write_group_addresses;
  end function;

begin

  room    <= not r.full and not (r.valid and r.ended);
  request <= (
    valid => r.valid, ready => r.full or r.ended, missing => r.ended and not r.full, data => r.data,
    error => r.error, checked => '0', command => r.state);

  follow : process (all)
    variable v : record_t;

    procedure hand_on is
    begin
      v.named := '1';
      v.valid := '1';
      v.begun := '0';
      v.error := '0';
    end procedure;
  begin
    v := r;
    message_end <= '0';

    if take = '1' then
      v.begun := '1';
      if r.begun = '1' then
        v.full := '0';
      end if;
    end if;
    if request_done = '1' then
      v.valid := '0';
      v.full  := '0';
    end if;

    case receive.event is
      when start =>
        v.state   := machine(step_of(r.state, receive));
        v.named   := '0';
        v.ended   := '0';
        v.counted := '0';
      when letter =>
        v.state := machine(step_of(r.state, receive));
      when colon =>
        v.state := machine(step_of(r.state, receive));
        hand_on;
        v.left := to_unsigned(bytes_of(v.state), 11);
        if bytes_of(v.state) = 0 then
          v.ended := '1';
          message_end <= '1';
        end if;
      when byte =>
        if v.valid = '1' then
          v.full := '1';
          v.data := receive.data;
        end if;
        v.left := r.left - 1;
        if r.left = 1 then
          if r.counted = '0' and counts(r.state) then
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
          hand_on;
        end if;
      when bad =>
        hand_on;
        v.ended := '1';
        v.error := '1';
        v.data  := receive.data;
      when nothing =>
        null;
    end case;
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
