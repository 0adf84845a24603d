-- SPDX-License-Identifier: BSD-3-Clause
--
-- The PC in a bench of your own: reads and writes of a board's words, and its publishes. uart_host carries them over
-- the board's line. Signals of these types join the two:
--
--   signal request : host_request_t := host_request_idle;
--   signal reply   : host_reply_t;
--   signal publish : host_publish_t;
--
-- The package NAME_host_pkg, which `unitylink generate SPEC --only bench` makes, has a read and a write procedure for
-- each name of the spec. They call the procedures of this package. One process calls them all.
--
-- A refused request stops the simulation, with the address and what the board said. The procedures with a `status` hand
-- it over instead (constants reply_status_*_c of protocol_pkg, and status_silent).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_pkg.all;
use work.protocol_pkg.all;

package host_pkg is

  type host_bytes_t is array (natural range <>) of byte_t;
  subtype host_word_t is std_ulogic_vector(31 downto 0);
  type host_words_t is array (natural range <>) of host_word_t;
  subtype host_address_t is unsigned(31 downto 0);
  type host_addresses_t is array (natural range <>) of host_address_t;

  constant status_ok        : natural := 0;
  constant status_silent    : natural := 255;  -- the board has not answered
  constant publish_words    : positive := 60;  -- most words of a publish

  type host_action_t is (action_read, action_write, action_group, action_control);

  -- A new number is a new request.
  type host_request_t is record
    number    : natural;
    action    : host_action_t;
    address   : host_address_t;  -- of a word, of a control register; the number of a group
    word      : host_word_t;     -- to write; the divisor of a group
    on_event  : boolean;
    count     : natural;
    addresses : host_addresses_t(0 to publish_words - 1);
  end record;

  constant host_request_idle : host_request_t :=
    (number => 0, action => action_read, address => (others => '0'), word => (others => '0'), on_event => false,
     count => 0, addresses => (others => (others => '0')));

  -- The answer to the request with this number.
  type host_reply_t is record
    number : natural;
    status : natural;
    word   : host_word_t;  -- that was read
  end record;

  -- The newest publish; each has another number.
  type host_publish_t is record
    number   : natural;
    group_number    : natural;
    sequence_number : unsigned(15 downto 0);
    clock    : unsigned(31 downto 0);
    count    : natural;
    words    : host_words_t(0 to publish_words - 1);
  end record;

  procedure read_word (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    word           : out host_word_t;
    status         : out natural
  );

  procedure write_word (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    word           : in  host_word_t;
    status         : out natural
  );

  -- A value of one or several words: `data_bits` bits in each, the low ones at the lowest address.
  procedure read_value (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    data_bits      : in  positive;
    value          : out std_ulogic_vector
  );

  procedure write_value (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    data_bits      : in  positive;
    value          : in  std_ulogic_vector
  );

  -- Lets the board publish the words at these addresses: once in `divisor` ticks of its base rate (0: never), and at
  -- the event of the group.
  procedure subscribe (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    group_number   : in  natural;
    addresses      : in  host_addresses_t;
    divisor        : in  natural := 0;
    on_event       : in  boolean := true
  );

  -- Waits for the next publish of a group; the simulation stops if none comes in time.
  procedure await_publish (signal publish : in host_publish_t; group_number : in natural; limit : in time);

  -- A frame with its 00, and the payload of what stood between two of them; kind 0 if that is no frame of this epoch.
  function frame_of (kind : natural; payload : host_bytes_t; epoch : crc16_t) return host_bytes_t;
  procedure decode (
    piece   : in  host_bytes_t;
    epoch   : in  crc16_t;
    kind    : out natural;
    payload : out host_bytes_t;
    size    : out natural
  );

  -- A number as `size` bytes, the most significant one first, and the reverse.
  function bytes_of (value : unsigned; size : natural) return host_bytes_t;
  function number_of (data : host_bytes_t) return unsigned;

end package;

package body host_pkg is

  function bytes_of (value : unsigned; size : natural) return host_bytes_t is
    constant wide : unsigned(8 * size - 1 downto 0) := resize(value, 8 * size);
    variable made : host_bytes_t(0 to size - 1);
  begin
    for index in made'range loop
      made(index) := std_ulogic_vector(wide(8 * (size - index) - 1 downto 8 * (size - index) - 8));
    end loop;
    return made;
  end function;

  function number_of (data : host_bytes_t) return unsigned is
    variable made : unsigned(8 * data'length - 1 downto 0) := (others => '0');
  begin
    for index in data'range loop
      made := shift_left(made, 8) or resize(unsigned(data(index)), made'length);
    end loop;
    return made;
  end function;

  function frame_of (kind : natural; payload : host_bytes_t; epoch : crc16_t) return host_bytes_t is
    constant size : natural := payload'length;
    alias data : host_bytes_t(0 to size - 1) is payload;
    variable made : host_bytes_t(0 to size + 5);
    variable code : natural := 1;  -- the place of the code byte of the open block
    variable crc  : crc16_t := epoch;
  begin
    assert size < 254
      report "host_pkg: a payload has at most 253 bytes"
      severity failure;
    made(0) := std_ulogic_vector(to_unsigned(kind, 8));
    for index in 0 to size - 1 loop
      made(index + 2) := data(index);
      if data(index) = x"00" then
        made(code) := std_ulogic_vector(to_unsigned(index + 2 - code, 8));
        code := index + 2;
      end if;
    end loop;
    made(code) := std_ulogic_vector(to_unsigned(size + 2 - code, 8));
    for index in 0 to size + 1 loop
      crc := next_crc16(crc, made(index));
    end loop;
    for index in 0 to 2 loop
      made(size + 2 + index) := check_byte(crc, index);
    end loop;
    made(size + 5) := x"00";
    return made;
  end function;

  procedure decode (
    piece   : in  host_bytes_t;
    epoch   : in  crc16_t;
    kind    : out natural;
    payload : out host_bytes_t;
    size    : out natural
  ) is
    constant whole : integer := piece'length - 3;  -- without the check
    alias data : host_bytes_t(0 to piece'length - 1) is piece;
    variable crc  : crc16_t := epoch;
    variable code : natural := 1;
  begin
    kind := 0;
    size := 0;
    if whole < 2 or whole - 2 > payload'length then
      return;
    end if;
    for index in 0 to whole - 1 loop
      crc := next_crc16(crc, data(index));
    end loop;
    for index in 0 to 2 loop
      if data(whole + index) /= check_byte(crc, index) then
        return;
      end if;
    end loop;
    for index in 2 to whole - 1 loop
      payload(payload'low + index - 2) := data(index);
      if index = code + to_integer(unsigned(data(code))) then
        payload(payload'low + index - 2) := x"00";
        code := index;
      end if;
    end loop;
    if code + to_integer(unsigned(data(code))) = whole then  -- else a block is cut
      kind := to_integer(unsigned(data(0)));
      size := whole - 2;
    end if;
  end procedure;

  procedure complete (signal reply : in host_reply_t; number : in natural) is
  begin
    wait until reply.number = number;
  end procedure;

  procedure read_word (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    word           : out host_word_t;
    status         : out natural
  ) is
    constant number : natural := reply.number + 1;
  begin
    request.action  <= action_read;
    request.address <= address;
    request.number  <= number;
    complete(reply, number);
    word   := reply.word;
    status := reply.status;
  end procedure;

  procedure write_word (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    word           : in  host_word_t;
    status         : out natural
  ) is
    constant number : natural := reply.number + 1;
  begin
    request.action  <= action_write;
    request.address <= address;
    request.word    <= word;
    request.number  <= number;
    complete(reply, number);
    status := reply.status;
  end procedure;

  procedure succeed (status : natural; what : string; address : host_address_t) is
  begin
    assert status = status_ok
      report what & " 16#" & to_hstring(address) & "#: the board answered status "
        & integer'image(status) & " (reply_status in protocol_pkg; 255: nothing)"
      severity failure;
  end procedure;

  procedure read_value (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    data_bits      : in  positive;
    value          : out std_ulogic_vector
  ) is
    constant count  : positive := (value'length + data_bits - 1) / data_bits;
    variable bits   : std_ulogic_vector(count * data_bits - 1 downto 0);
    variable word   : host_word_t;
    variable status : natural;
  begin
    for index in 0 to count - 1 loop
      read_word(request, reply, address + index, word, status);
      succeed(status, "a read of", address + index);
      bits((index + 1) * data_bits - 1 downto index * data_bits) := word(data_bits - 1 downto 0);
    end loop;
    value := bits(value'length - 1 downto 0);
  end procedure;

  procedure write_value (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    address        : in  host_address_t;
    data_bits      : in  positive;
    value          : in  std_ulogic_vector
  ) is
    constant count  : positive := (value'length + data_bits - 1) / data_bits;
    variable bits   : std_ulogic_vector(count * data_bits - 1 downto 0) := (others => '0');
    variable word   : host_word_t;
    variable status : natural;
  begin
    bits(value'length - 1 downto 0) := value;
    for index in 0 to count - 1 loop
      word := (others => '0');
      word(data_bits - 1 downto 0) := bits((index + 1) * data_bits - 1 downto index * data_bits);
      write_word(request, reply, address + index, word, status);
      succeed(status, "a write to", address + index);
    end loop;
  end procedure;

  procedure subscribe (
    signal request : out host_request_t;
    signal reply   : in  host_reply_t;
    group_number   : in  natural;
    addresses      : in  host_addresses_t;
    divisor        : in  natural := 0;
    on_event       : in  boolean := true
  ) is
    constant define : natural := reply.number + 1;
    constant number : host_address_t := to_unsigned(group_number, 32);
    variable places : host_addresses_t(0 to publish_words - 1) := (others => (others => '0'));
  begin
    places(0 to addresses'length - 1) := addresses;
    request.action    <= action_group;
    request.address   <= number;
    request.word      <= std_ulogic_vector(to_unsigned(divisor, 32));
    request.on_event  <= on_event;
    request.count     <= addresses'length;
    request.addresses <= places;
    request.number    <= define;
    complete(reply, define);
    succeed(reply.status, "the definition of group", number);
    request.action  <= action_control;
    request.address <= to_unsigned(control_publish_c, 32);
    request.word    <= x"00000001";
    request.number  <= define + 1;
    complete(reply, define + 1);
    succeed(reply.status, "publishing of group", number);
  end procedure;

  procedure await_publish (signal publish : in host_publish_t; group_number : in natural; limit : in time) is
    constant latest : time := now + limit;
  begin
    loop
      wait on publish for latest - now;
      assert now < latest
        report "await_publish: group " & integer'image(group_number) & " has not been published"
        severity failure;
      exit when publish.group_number = group_number;
    end loop;
  end procedure;

end package body;
