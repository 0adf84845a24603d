-- SPDX-License-Identifier: BSD-3-Clause
--
-- Keeps requests until they are complete and found good. The application sees only good requests.
--
--   receive --> | letters -> recogniser -> command | data bytes -> one of two halves of a memory | --> request
--
-- A half has an entry of 8 data bits for each data byte. An entry before them says what the message is: its command,
-- and where its data end. For a datalink error it is the error code instead. The error takes the place of its message,
-- so replies and errors leave in the order of their causes. While one request is executed, the next one is received.
--
-- Ports     receive: at most one event per clock, never refused. Between messages, none may come while room is low.
--           request: valid until request_done. Its command and similar fields are valid until the first take. After
--           that, `data` is the first byte not yet taken. The next byte comes in the clock after take. rewind: back to
--           the state before the first take.
-- Latency   A request is valid two clocks after its `good`.
-- Errors    None of its own. Letters of an unknown command give `command_unknown` or another number without a command.

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
    has_checksum          : boolean := true;  -- false: nothing can be published with a checksum
    configuration_command : boolean := true
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    receive      : in  receive_t;
    room         : out std_ulogic;
    request      : out request_t;
    take         : in  std_ulogic;
    rewind       : in  std_ulogic;
    request_done : in  std_ulogic
  );
end entity;

architecture rtl of request_buffer is

  constant index_bits : positive := bits_for(message_entries);
  constant value_bits : positive := maximum(8, index_bits);  -- a data byte, a code, or the end of the data

  constant machine : recogniser_t := recogniser(has_read_many, has_publishing, has_checksum, configuration_command);

  subtype index_t is unsigned(index_bits - 1 downto 0);
  subtype entry_t is std_ulogic_vector(value_bits + 6 downto 0);  -- error, checked, command, value
  type memory_t is array (0 to 2 ** (index_bits + 1) - 1) of entry_t;

  signal memory : memory_t;
  signal full   : std_ulogic_vector(0 to 1) := "00";  -- the half holds a request

  signal write_half : std_ulogic := '0';
  signal size       : index_t := (others => '0');  -- entries of the message so far
  signal checked    : std_ulogic := '0';
  signal command    : command_t := (others => '0');
  signal judged     : std_ulogic;                  -- the message is good or bad
  signal free        : std_ulogic;                 -- the half that is written is free
  signal writes      : std_ulogic;
  signal write_entry : entry_t;
  signal write_index : index_t;

  signal valid       : std_ulogic := '0';
  signal read_half   : std_ulogic := '0';
  signal half_next   : std_ulogic;
  signal read_index  : index_t := (others => '0');
  signal index_next  : index_t;
  signal read_entry  : entry_t;
  signal missing     : std_ulogic := '0';
  signal ending      : index_t;                    -- the entry after the last data byte

  function number(bit : std_ulogic) return natural is
  begin
    if bit = '1' then
      return 1;
    end if;
    return 0;
  end function;

begin

  -- The write side

  free   <= not full(number(write_half));
  room   <= free;
  judged <= '1' when receive.event = good or receive.event = bad else '0';
  writes <= '1' when receive.event = byte or judged = '1' else '0';

  recognise : process (clock)
  begin
    if rising_edge(clock) then
      if receive.event = start or receive.event = letter or receive.event = colon then
        command <= machine(step_of(command, receive));
      end if;
    end if;
  end process;

  form : process (all)
  begin
    write_entry <= '0' & checked & command & std_ulogic_vector(resize(unsigned(receive.data), value_bits));
    write_index <= size;
    if judged = '1' then
      write_index <= (others => '0');
    end if;
    if receive.event = good then
      write_entry(value_bits - 1 downto 0) <= std_ulogic_vector(resize(size, value_bits));
    elsif receive.event = bad then
      write_entry(write_entry'left) <= '1';
    end if;
  end process;

  store : process (clock)
  begin
    if rising_edge(clock) then
      -- Never the same entry in one clock, because block RAMs differ in what that gives.
      if writes = '1' and free = '1' then
        memory(to_integer(write_half & write_index)) <= write_entry;
      end if;
      if free = '0' or half_next /= write_half then
        read_entry <= memory(to_integer(half_next & index_next));
      end if;
    end if;
  end process;

  keep : process (clock)
  begin
    if rising_edge(clock) then
      if request_done = '1' then
        full(number(read_half)) <= '0';
      end if;
      if receive.event = start then
        checked <= receive.checked;
        size    <= to_unsigned(1, index_bits);
      elsif receive.event = byte then
        size <= size + 1;
      end if;
      if judged = '1' then
        full(number(write_half)) <= '1';
        write_half <= not write_half;
      end if;
      if reset = '1' then
        full       <= "00";
        write_half <= '0';
      end if;
    end if;
  end process;

  -- The read side

  half_next <= read_half xor request_done;

  advance : process (all)
  begin
    index_next <= read_index;
    if request_done = '1' or rewind = '1' or reset = '1' then
      index_next <= (others => '0');
    elsif take = '1' then
      index_next <= read_index + 1;
    end if;
  end process;

  read : process (clock)
  begin
    if rising_edge(clock) then
      read_index <= index_next;
      read_half  <= half_next;
      valid      <= full(number(half_next));  -- full for at least a clock, so its entry can be read
      if read_index = 0 and valid = '1' then  -- before that the entry may never have been written
        ending  <= unsigned(read_entry(index_bits - 1 downto 0));
        missing <= '0';
        if unsigned(read_entry(index_bits - 1 downto 0)) = 1 then
          missing <= '1';
        end if;
      elsif take = '1' then
        missing <= '0';
        if read_index + 1 = ending then
          missing <= '1';
        end if;
      end if;
      if reset = '1' then
        read_half <= '0';
        valid     <= '0';
      end if;
    end if;
  end process;

  request <= (
    valid   => valid,
    ready   => '1',  -- a request that is kept whole has all its data
    missing => missing,
    data    => read_entry(7 downto 0),
    error   => read_entry(read_entry'left),
    checked => read_entry(read_entry'left - 1),
    command => read_entry(read_entry'left - 2 downto read_entry'left - 6));

  -- Properties
  never_refused : process (clock)
  begin
    if rising_edge(clock) and reset = '0' then
      assert not ((receive.event = start or receive.event = bad) and room = '0')
        report "request_buffer: a message began without room" severity failure;
      assert not (request_done = '1' and valid = '0')
        report "request_buffer: done without a request" severity failure;
    end if;
  end process;

end architecture;
