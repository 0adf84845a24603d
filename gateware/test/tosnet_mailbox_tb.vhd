-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_mailbox: messages of all lengths to and from the slot, one slot for each, words of several nodes in a row, a
-- user who is slow, slots that are not kept, and a message for which there is no room.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;

entity tosnet_mailbox_tb is
  generic (
    messages : positive := 60; -- in each direction
    seed     : positive := 1
  );
end entity;

architecture test of tosnet_mailbox_tb is

  type message_t is record
    length : natural range 0 to 12;
    id     : std_ulogic_vector(3 downto 0);
    first  : byte_t; -- byte i is first + i
    kept   : boolean;
  end record;

  type messages_t is array (0 to messages - 1) of message_t;

  -- To the ring, a message has at least one byte, and the next one is to another node, or this one is not of whole
  -- words or has three. Otherwise the two would be one.
  impure function random_messages (number : positive; least : natural) return messages_t is
    variable random : random_t;
    variable result : messages_t;
  begin
    random.seed(number);
    for index in result'range loop
      result(index).length := random.integer_between(least, 12);
      result(index).id     := random.vector(4);
      result(index).first  := random.vector(8);
      result(index).kept   := random.chance(80);
      if index > 0 and result(index).id = result(maximum(index, 1) - 1).id
        and result(maximum(index, 1) - 1).length mod 4 = 0
      then
        result(index).id := not result(index).id;
      end if;
    end loop;
    return result;
  end function;

  constant outgoing : messages_t := random_messages(seed, 1);
  constant incoming : messages_t := random_messages(seed + 1000, 0);

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean := false;
  signal to_ring_valid, to_ring_ready     : std_ulogic := '0';
  signal to_ring_data   : std_ulogic_vector(31 downto 0) := (others => '0');
  signal to_ring_last   : std_ulogic_vector(1 downto 0) := "00";
  signal to_ring_id     : std_ulogic_vector(3 downto 0) := "0000";
  signal from_ring_valid : std_ulogic;
  signal from_ring_ready : std_ulogic := '0';
  signal from_ring_data  : std_ulogic_vector(31 downto 0);
  signal from_ring_last  : std_ulogic_vector(1 downto 0);
  signal from_ring_id    : std_ulogic_vector(3 downto 0);
  signal lost            : std_ulogic;
  signal send_begin, send_step : std_ulogic := '0';
  signal send_data       : byte_t;
  signal send_count      : unsigned(3 downto 0);
  signal take_valid, take_keep : std_ulogic := '0';
  signal take_data       : byte_t := x"00";
  signal take_count      : unsigned(3 downto 0) := "0000";
  signal take_id         : std_ulogic_vector(3 downto 0) := "0000";

  signal sent_all, taken_all : boolean := false;
  signal given   : natural := 0; -- bytes that the user was given
  signal deaf    : boolean := false;

  function byte_at (message : message_t; index : natural) return byte_t is
  begin
    return byte_t(unsigned(message.first) + index);
  end function;

begin

  clock <= not clock after 10 ns when not done;

  dut : entity work.tosnet_mailbox
    port map (
      clock => clock, reset => reset, to_ring_valid => to_ring_valid, to_ring_ready => to_ring_ready,
      to_ring_data => to_ring_data, to_ring_last => to_ring_last, to_ring_id => to_ring_id,
      from_ring_valid => from_ring_valid, from_ring_ready => from_ring_ready, from_ring_data => from_ring_data,
      from_ring_last => from_ring_last, from_ring_id => from_ring_id, lost => lost, send_begin => send_begin,
      send_step => send_step, send_data => send_data, send_count => send_count, take_valid => take_valid,
      take_data => take_data, take_keep => take_keep, take_count => take_count, take_id => take_id);

  -- The user's words. The next word of a message comes at most two clocks after the one before.
  user : process is
    variable random : random_t;
    variable index  : natural;
  begin
    random.seed(seed + 2000);
    wait until reset = '0';
    for number in outgoing'range loop
      if random.chance(30) then
        wait_clocks(clock, random.integer_between(1, 500));
      end if;
      index := 0;
      while index < outgoing(number).length loop
        to_ring_valid <= '1';
        to_ring_id    <= outgoing(number).id;
        to_ring_data  <= random.vector(32); -- bytes that are not valid are anything
        to_ring_last  <= std_ulogic_vector(to_unsigned(minimum(3, outgoing(number).length - index - 1), 2));
        wait for 0 ps;
        for lane in 0 to minimum(3, outgoing(number).length - index - 1) loop
          to_ring_data(31 - 8 * lane downto 24 - 8 * lane) <= byte_at(outgoing(number), index + lane);
        end loop;
        index := index + 4;
        wait until rising_edge(clock) and to_ring_ready = '1';
        to_ring_valid <= '0';
        if random.chance(30) then
          wait until rising_edge(clock);
        end if;
      end loop;
    end loop;
    wait;
  end process;

  -- The slots that go out.
  slots : process is
    variable random : random_t;
    variable number   : natural := 0;
    variable length   : natural;
    variable expected : byte_t;
  begin
    random.seed(seed + 3000);
    wait until reset = '0';
    while number < messages loop
      wait_clocks(clock, random.integer_between(3, 100));
      wait for 1 ps;
      length := outgoing(number).length when to_ring_valid = '1' else 0;
      send_begin <= '1';
      tick(clock);
      send_begin <= '0';
      for index in 0 to 11 loop
        tick(clock, random.integer_between(3, 12));
        expected := byte_at(outgoing(number), index) when index < length else x"00";
        check_equal(send_data, expected, "a byte to send");
        send_step <= '1';
        tick(clock);
        send_step <= '0';
      end loop;
      tick(clock, 2);
      check_equal(to_integer(send_count), length, "the number of bytes");
      if length > 0 then
        number := number + 1;
      end if;
    end loop;
    sent_all <= true;
    wait;
  end process;

  -- The slots that come.
  coming : process is
    variable random : random_t;

    procedure slot (message : message_t) is
    begin
      for index in 0 to 11 loop
        tick(clock, random.integer_between(2, 6));
        take_data  <= random.vector(8);
        if index < message.length then
          take_data <= byte_at(message, index);
        end if;
        take_valid <= '1';
        tick(clock);
        take_valid <= '0';
      end loop;
      tick(clock);
      take_count <= to_unsigned(message.length, 4);
      take_id    <= message.id;
      take_keep  <= to_bit(message.kept);
      tick(clock);
      take_keep  <= '0';
    end procedure;

    variable before, length : natural;

  begin
    random.seed(seed + 4000);
    wait until reset = '0';
    for number in incoming'range loop
      before := given;
      slot(incoming(number));
      check_equal(lost, '0', "a message is lost though there is room");
      if number = messages / 2 then
        -- The user does not take it, so the next one is lost.
        deaf <= true;
      end if;
      if incoming(number).kept and incoming(number).length > 0 then
        check_equal(from_ring_valid, '1', "a word that came");
        if number = messages / 2 then
          slot((length => 5, id => "0101", first => x"AA", kept => true));
          check_equal(lost, '1', "a message that has no room");
          deaf <= false;
        end if;
        while given < before + incoming(number).length loop
          tick(clock);
        end loop;
      end if;
      deaf <= false;
      tick(clock, random.integer_between(1, 20));
      length := incoming(number).length when incoming(number).kept else 0;
      check_equal(given - before, length, "bytes of a message");
      check_equal(from_ring_valid, '0', "a word that did not come");
    end loop;
    taken_all <= true;
    wait;
  end process;

  reader : process is
    variable random : random_t;
    variable number : natural := 0;
    variable index  : natural := 0;
  begin
    random.seed(seed + 5000);
    wait until reset = '0';
    while not done loop
      from_ring_ready <= random.vector(1)(0) and to_bit(not deaf);
      wait until rising_edge(clock);
      if from_ring_valid = '1' and from_ring_ready = '1' then
        while not incoming(number).kept or incoming(number).length = 0 loop
          number := number + 1;
        end loop;
        check_equal(from_ring_id, incoming(number).id, "from whom a message is");
        for lane in 0 to to_integer(unsigned(from_ring_last)) loop
          check(index < incoming(number).length, "more bytes than came");
          check_equal(from_ring_data(31 - 8 * lane downto 24 - 8 * lane), byte_at(incoming(number), index),
                      "a byte that came");
          index := index + 1;
        end loop;
        given <= given + to_integer(unsigned(from_ring_last)) + 1;
        if index = incoming(number).length then
          number := number + 1;
          index  := 0;
        end if;
      end if;
    end loop;
    wait;
  end process;

  play : process is
  begin
    wait_clocks(clock, 4);
    reset <= '0';
    wait until sent_all and taken_all;
    report_passed("tosnet_mailbox_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "tosnet_mailbox_tb");

end architecture;
