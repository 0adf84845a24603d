-- SPDX-License-Identifier: BSD-3-Clause
--
-- Keeps requests until they are complete and found good; the application sees no other ones.
--
--   receive --> | command letters -> command | data bytes -> one of two halves of a memory | --> request, data
--
-- While one request is executed the next is received. A datalink error takes the place of the message it belongs to, so
-- that replies and errors leave in the order of their causes.
--
-- Ports     receive: an event a clock, never refused; nothing but `start` and a lone `bad` may come while room is low, and
--           those must not. request: stands until request_done; `data` is its first byte not yet taken, and the next one
--           in the clock after take.
-- Latency   A request is valid one clock after its `good`.
-- Errors    None of its own. Letters that are no command give `unknown`.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.command_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;
use work.width_pkg.all;

entity request_buffer is
  generic (
    message_entries       : positive;
    has_read_many         : boolean := true;
    has_publishing        : boolean := true;
    has_checksum          : boolean := true;  -- without one nothing can be published with it
    configuration_command : boolean := true
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    receive      : in  receive_t;
    room         : out std_ulogic;
    request      : out request_t;
    data         : out byte_t;
    take         : in  std_ulogic;
    request_done : in  std_ulogic
  );
end entity;

architecture rtl of request_buffer is

  constant index_bits : positive := bits_for(message_entries);

  type half_t is array (0 to 1) of request_t;
  type memory_t is array (0 to 2 ** (index_bits + 1) - 1) of byte_t;

  signal memory     : memory_t;
  signal halves     : half_t := (others => request_none);
  signal write_half : std_ulogic := '0';
  signal read_half  : std_ulogic := '0';

  signal checked : std_ulogic := '0';
  signal marked  : std_ulogic := '0';  -- there was a colon
  signal letters : letters_t := (others => (others => '0'));
  signal count   : natural range 0 to 4 := 0;  -- letters; 4: too many
  signal size    : unsigned(index_bits - 1 downto 0) := (others => '0');

  signal read_index, read_next : unsigned(index_bits - 1 downto 0) := (others => '0');
  signal half_next             : std_ulogic;

  function number(bit : std_ulogic) return natural is
  begin
    if bit = '1' then
      return 1;
    end if;
    return 0;
  end function;

begin

  room    <= not halves(number(write_half)).valid;
  request <= halves(number(read_half));

  half_next <= read_half xor request_done;

  advance : process (all)
  begin
    read_next <= read_index;
    if request_done = '1' then
      read_next <= (others => '0');
    elsif take = '1' then
      read_next <= read_index + 1;
    end if;
  end process;

  store : process (clock)
  begin
    if rising_edge(clock) then
      if receive.event = byte then
        memory(to_integer(write_half & size)) <= receive.data;
      end if;
      data <= memory(to_integer(half_next & read_next));
    end if;
  end process;

  keep : process (clock)
  begin
    if rising_edge(clock) then
      read_index <= read_next;
      read_half  <= half_next;
      if request_done = '1' then
        halves(number(read_half)).valid <= '0';
      end if;

      case receive.event is
        when nothing =>
          null;
        when start =>
          checked <= receive.checked;
          marked  <= '0';
          count   <= 0;
          size    <= (others => '0');
        when letter =>
          if count < 3 then
            letters(count + 1) <= receive.data(4 downto 0);
          end if;
          if count < 4 then
            count <= count + 1;
          end if;
        when colon =>
          marked <= '1';
        when byte =>
          size <= size + 1;
        when good | bad =>
          halves(number(write_half)) <= (
            valid => '1', error => '0', code => receive.data, checked => checked,
            command => command_of(
              letters, count, marked, has_read_many, has_publishing, has_checksum, configuration_command),
            length => resize(size, 11));
          if receive.event = bad then
            halves(number(write_half)).error <= '1';
          end if;
          write_half <= not write_half;
      end case;

      if reset = '1' then
        halves(0).valid <= '0';
        halves(1).valid <= '0';
        write_half      <= '0';
        read_half       <= '0';
        read_index      <= (others => '0');
      end if;
    end if;
  end process;

  -- Properties
  never_refused : process (clock)
  begin
    if rising_edge(clock) and reset = '0' then
      assert not ((receive.event = start or receive.event = bad) and room = '0')
        report "request_buffer: a message began without room" severity failure;
      assert not (request_done = '1' and request.valid = '0')
        report "request_buffer: done without a request" severity failure;
    end if;
  end process;

end architecture;
