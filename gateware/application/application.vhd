-- SPDX-License-Identifier: BSD-3-Clause
--
-- Executes classic requests on the bus and answers them. Between requests it publishes groups. It is a small processor
-- that executes one instruction per clock. Its program (program_pkg) is in block RAM.
--
-- Ports     request, take, rewind, request_done: see request_buffer. busy: a message is in hand.
--           subscription: see subscription_pkg. bii: see bii_pkg.
--           word: valid/ready. The datalink turns words into characters.
-- Latency   The head of a reply is sent in the clock in which the request is valid, if nothing else is in hand. Clocks
--           in all, with a 2-clock bus and no stalls, for AB address and DB data bytes: read 9 + AB + DB, write 8 + AB
--           + DB, each word of a read-many 3 + AB + DB, each word of a publish 4 + DB.
-- Errors    The E_ codes of docs/classic-protocol.md section 4. A refused request changes nothing. An error within a
--           read-many or publish ends it there, and the bus is released.
-- Arbitration  Only between messages. publish_mode 2 prefers publishes, and 1 prefers requests. The other side gets its
--              turn after `turns_most` messages of the preferred side, so neither starves.
-- Pressure  While word_ready is low, the program stops where it wants to send. Nothing is lost.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bii_pkg.all;
use work.bit_pkg.all;
use work.datalink_pkg.all;
use work.instruction_pkg.all;
use work.program_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity application is
  generic (
    address_width : positive range 1 to 32  := 8;
    data_width    : positive range 8 to 32  := 32;
    base_hz       : positive                := limits_base_hz_default_c;
    groups        : positive range 1 to 256 := 2;
    group_size    : positive range 1 to 255 := 16;
    most_words    : natural  range 0 to 255 := 32;  -- of a read-many; 0: no read-many
    rate_bytes    : positive range 1 to 4   := 2;
    publish_mode  : natural  range 0 to 2   := 2;
    turns_most    : positive range 1 to 15  := latency_turns_most_c;  -- messages in a row while the other side waits
    whole_requests : boolean                := true -- requests can be read twice; false: rewind must not be needed
  );
  port (
    clock                 : in  std_ulogic;
    reset                 : in  std_ulogic;
    request               : in  request_t;
    take                  : out std_ulogic;
    rewind                : out std_ulogic;
    request_done          : out std_ulogic;
    busy                  : out std_ulogic;
    subscription_request  : out subscription_request_t;
    subscription_response : in  subscription_response_t;
    bii_request           : out bii_request_t;
    bii_response          : in  bii_response_t;
    word_valid            : out std_ulogic;
    word_ready            : in  std_ulogic;
    word_data             : out word_t
  );
end entity;

architecture rtl of application is

  constant address_bytes : positive := bytes_for(address_width);
  constant data_bytes    : positive := bytes_for(data_width);
  constant mask_bytes    : positive := maximum(limits_event_mask_bytes_min_c, (groups + 7) / 8);
  constant publishes     : boolean  := publish_mode > 0;

  -- The register of data also holds the rate of a group.
  function register_bytes return positive is
  begin
    if publishes and rate_bytes > data_bytes then
      return rate_bytes;
    end if;
    return data_bytes;
  end function;

  constant program : program_t := program_for(
    address_bytes, data_bytes, most_words, publish_mode, base_hz, groups, group_size, rate_bytes, mask_bytes,
    whole_requests);
  constant position_bits : positive := bits_for(program'length);

  signal instruction : instruction_t := nothing_done;
  signal position    : unsigned(position_bits - 1 downto 0);  -- of the next instruction
  signal following   : unsigned(position_bits - 1 downto 0);  -- if there is no jump

  signal data         : std_ulogic_vector(8 * register_bytes - 1 downto 0) := (others => '0');
  signal address      : std_ulogic_vector(8 * address_bytes - 1 downto 0)  := (others => '0');
  signal count        : unsigned(7 downto 0) := (others => '0');
  signal some_left    : std_ulogic := '0';  -- `count` is not zero
  signal group_number : unsigned(bits_for(groups) - 1 downto 0) := (others => '0');

  signal jump       : std_ulogic;  -- the condition of the instruction holds
  signal act_now    : std_ulogic;  -- the actions of the instruction are done
  signal step       : std_ulogic;  -- the instruction ends in this clock

  signal begins  : std_ulogic;             -- a message begins
  signal publish : std_ulogic;             -- the next message is a publish
  signal publish_begun : std_ulogic := '0';
  signal serving : std_ulogic := '0';      -- the message in hand is a request
  signal turns   : natural range 0 to turns_most := 0;  -- messages of the preferred side while the other waited
  signal yields  : std_ulogic := '0';      -- the next turn belongs to the other side
  signal checked_publish : std_ulogic := '0';

  signal bus_valid, bus_write, bus_hold : std_ulogic := '0';
  signal access_done : std_ulogic := '0';
  signal failed      : std_ulogic;
  signal failure     : unsigned(1 downto 0) := "00";  -- position for the access that failed; 0: none failed

  -- Checks of the byte of the request that is in `address` now. They are made when the byte comes, because a jump has
  -- no time for them.
  signal bad_read_many, bad_size, bad_group : std_ulogic := '0';

  alias lowest : std_ulogic_vector(7 downto 0) is address(7 downto 0);

  -- Whether a byte is more than a constant. A tree of gates is faster than a subtraction.
  function above(value : byte_t; limit : natural) return std_ulogic is
    constant limit_bits : unsigned(7 downto 0) := to_unsigned(limit, 8);
    variable more       : std_ulogic := '0';
  begin
    for place in 0 to 7 loop
      if limit_bits(place) = '0' then
        more := more or value(place);
      else
        more := more and value(place);
      end if;
    end loop;
    return more;
  end function;

begin

  -- What to do next.

  failed <= or failure;

  judge : process (all)
    variable holds : std_ulogic_vector(condition_f);
  begin
    holds(if_missing)        := request.missing;
    holds(if_some_left)      := some_left and not failed;
    holds(if_bad_read_many)  := bad_read_many;
    holds(if_bad_size)       := bad_size;
    holds(if_bad_group)      := bad_group;
    holds(if_group_empty)    := subscription_response.empty;
    holds(if_group_inactive) := subscription_response.inactive;
    holds(if_rate_pending)   := not subscription_response.done;
    jump <= or (holds and instruction(condition_f));
  end process;

  -- The actions of an instruction never wait for work or the bus (instruction_pkg). Only going on waits for them.
  act_now <= (word_ready or not instruction(do_say)) and (request.ready or not instruction(do_take));
  step    <= act_now and (request.valid or subscription_response.publish or not instruction(do_begin)) and
             (access_done or not instruction(do_await));
  busy    <= not instruction(do_begin);
  begins  <= instruction(do_begin) and word_ready and (request.valid or subscription_response.publish);

  choose : process (all)
  begin
    publish <= subscription_response.publish;
    if request.valid = '1' and (publish_mode = 2) = (yields = '1') then
      publish <= '0';
    end if;
  end process;

  go_on : process (all)
    variable entry : command_t;
  begin
    entry := request.command;
    if publish = '1' then
      entry := std_ulogic_vector(to_unsigned(command_publish, 5));
    elsif request.error = '1' then
      entry := std_ulogic_vector(to_unsigned(command_error, 5));
    end if;
    following <= unsigned(instruction(following_f'right + position_bits - 1 downto following_f'right));
    if instruction(do_begin) = '1' then
      following(4 downto 0) <= unsigned(entry);
    elsif instruction(do_await) = '1' and failed = '1' then
      following <= resize(failure, position_bits);
    end if;
  end process;

  decide : process (all)
  begin
    position <= following;
    if jump = '1' then
      position <= unsigned(instruction(target_f'right + position_bits - 1 downto target_f'right));
    end if;
    if reset = '1' then
      position <= (others => '0');
    end if;
  end process;

  fetch : process (clock)
  begin
    if rising_edge(clock) then
      if step = '1' or reset = '1' then
        instruction <= program(to_integer(position));
      end if;
    end if;
  end process;

  -- What is sent.

  -- The head of an error is different, and is sent later.
  word_valid <= instruction(do_say) and (request.ready or not instruction(do_take)) and
                (access_done or not instruction(do_await)) and
                not (instruction(do_begin) and not publish and (request.error or not request.valid));

  speak : process (all)
    variable content : byte_t;
  begin
    case instruction(source_f) is
      when from_data    => content := data(8 * data_bytes - 1 downto 8 * data_bytes - 8);
      when from_address => content := address(8 * address_bytes - 1 downto 8 * address_bytes - 8);
      when from_group   => content := byte_t(resize(group_number, 8));
      when from_mask    => content := subscription_response.mask;
      when others       => content := instruction(number_f);
    end case;
    if instruction(do_begin) = '1' then
      content := byte_plain_head_c;
      if publish = '1' then
        content := byte_plain_publish_c;
        if checked_publish = '1' then
          content := byte_checked_publish_c;
        end if;
      elsif request.checked = '1' then
        content := byte_checked_head_c;
      end if;
    end if;
    word_data <= instruction(kind_f) & content;
  end process;

  -- The actions.

  take         <= (instruction(do_take) and request.ready and (word_ready or not instruction(do_say))) or
                  (instruction(do_begin) and word_ready and request.valid and not publish);
  rewind       <= instruction(do_rewind);
  request_done <= instruction(do_finish) and word_ready and serving;

  registers : process (clock)
  begin
    if rising_edge(clock) then
      publish_begun <= begins and publish;
      if begins = '1' then
        serving <= not publish;
        turns   <= 0;
        yields  <= '0';
        if request.valid = '1' and subscription_response.publish = '1' and yields = '0' then
          turns  <= turns + 1;
          yields <= to_bit(turns + 1 = turns_most);
        end if;
      end if;

      if bii_response.done = '1' then
        data(8 * data_bytes - 1 downto 0) <= bii_response.data(8 * data_bytes - 1 downto 0);
      elsif instruction(do_shift_data) = '1' and act_now = '1' then
        data <= data(data'left - 8 downto 0) & request.data;
      end if;

      if instruction(do_load_address) = '1' then
        address <= subscription_response.word(address'range);
        if address_width < 8 and instruction(do_count) = '1' then  -- not a number of addresses
          address(7 downto minimum(address_width, 7)) <= (others => '0');
        end if;
      elsif (instruction(do_begin) and request.valid) = '1' or (instruction(do_shift_address) and act_now) = '1' then
        address <= address(address'left - 8 downto 0) & request.data;
        bad_read_many <= nor request.data or above(request.data, most_words);
        bad_size      <= nor request.data or above(request.data, group_size);
        bad_group     <= above(request.data, groups - 1);
      end if;

      if instruction(do_begin) = '1' then
        count     <= (others => '0');
        some_left <= '0';
      elsif instruction(do_load_count) = '1' then
        count     <= unsigned(lowest);
        some_left <= or lowest;
      elsif instruction(do_count) = '1' and act_now = '1' then
        count     <= count - 1;
        some_left <= to_bit(count /= 1);
      end if;

      if begins = '1' and publish = '1' then
        group_number <= subscription_response.publish_group(group_number'range);
      elsif instruction(do_load_group) = '1' then
        group_number <= unsigned(lowest(group_number'range));
      end if;

      if instruction(manage_f) = manage_enable then
        checked_publish <= instruction(number_f'right);
      end if;

      if reset = '1' then
        turns  <= 0;
        yields <= '0';
        checked_publish <= '0';
        publish_begun   <= '0';
      end if;
    end if;
  end process;

  drive : process (clock)
  begin
    if rising_edge(clock) then
      bus_hold <= instruction(do_hold);
      if bii_response.done = '1' then
        bus_valid   <= '0';
        access_done <= '1';
        if bii_response.status = silent then
          failure <= to_unsigned(position_silent, 2);
        elsif bii_response.status /= ok and bus_write = '1' then
          failure <= to_unsigned(position_refused_write, 2);
        elsif bii_response.status /= ok then
          failure <= to_unsigned(position_refused_read, 2);
        end if;
      elsif act_now = '1' and (instruction(do_read) = '1' or instruction(do_write) = '1') and
            not (request.missing = '1' and serving = '1') then  -- not without the bytes that it needs
        bus_valid   <= '1';
        bus_write   <= instruction(do_write);
        access_done <= '0';
      end if;
      if instruction(do_begin) = '1' then
        failure <= "00";
      end if;
      if reset = '1' then
        bus_valid <= '0';
        bus_hold  <= '0';
      end if;
    end if;
  end process;

  access_bus : process (all)
  begin
    bii_request            <= bii_request_idle;
    bii_request.valid      <= bus_valid;
    bii_request.write      <= bus_write;
    bii_request.block_hold <= bus_hold;
    bii_request.address(address_width - 1 downto 0) <= address(address_width - 1 downto 0);
    bii_request.data(data_width - 1 downto 0)       <= data(data_width - 1 downto 0);
  end process;

  manage_groups : process (all)
  begin
    subscription_request              <= subscription_request_idle;
    subscription_request.group_number <= resize(group_number, 8);
    subscription_request.place        <= '0' & count;
    if instruction(do_place) = '1' then
      subscription_request.place <= unsigned(instruction(number_f'left) & instruction(number_f));
    end if;
    subscription_request.word(address'range)              <= address;
    -- Without publishing, data may be shorter than a rate.
    subscription_request.rate <= std_ulogic_vector(
      resize(unsigned(data(minimum(data'length, 8 * rate_bytes) - 1 downto 0)), 32));
    case instruction(manage_f) is
      when manage_write_word => subscription_request.write_word <= '1';
      when manage_empty      => subscription_request.empty      <= '1';
      when manage_fill       => subscription_request.fill       <= '1';
      when manage_write_rate => subscription_request.write_rate <= '1';
      when manage_write_mask => subscription_request.write_mask <= '1';
      when manage_enable     => subscription_request.enable     <= '1';
      when manage_disable    => subscription_request.disable    <= '1';
      when others            => null;
    end case;
    subscription_request.publish_take <= publish_begun;
  end process;

end architecture;
