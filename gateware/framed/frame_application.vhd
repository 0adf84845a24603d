-- SPDX-License-Identifier: BSD-3-Clause
--
-- Executes the requests of the framed protocol, each of them once, and answers them. Between requests it publishes
-- groups. It is a small processor. An instruction has two clocks or more. A jump costs one more. Block RAM holds its
-- program (frame_program_pkg), its words, the executed ids (`places`) and their replies (`cache`).
--
-- Ports     See frame_receiver (request, take, rewind, request_done), frame_transmitter (reply and its ports), bii_pkg,
--           subscription_pkg and dead_man_pkg, whose `alive` does not come from here.
--           epoch: FFFF while no session is open. overrun: one-clock pulses, each of which is counted.
--           may_begin: low while another application has the bus. busy: this application has it.
-- Latency   With a 2-clock bus and 2 address bytes, 11 clocks from a read request to the kind of its reply. There can
--           be a read every 20 clocks, and a post every 14.
-- Errors    The status values of docs/protocol.md. A refused request changes nothing except counters.
-- Arbitration  Publishes first, then requests. It changes only between messages.
-- Pressure  While reply_ready is low, the program stops where it wants to send. So an answer waits for room, and all
--           frames after it wait too. A publish begins only if there is room for all of it. Until then posts are
--           executed. If the publish is due again in that time, one is skipped and counted (publish_overruns).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.bit_pkg.all;
use work.dead_man_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.frame_program_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity frame_application is
  generic (
    settings : frame_settings_t  -- see framed
  );
  port (
    clock                 : in  std_ulogic;
    reset                 : in  std_ulogic;
    request               : in  frame_request_t;
    take                  : out std_ulogic;
    take_more             : out unsigned(7 downto 0);
    takes_many            : out std_ulogic;
    rewind                : out std_ulogic;
    request_done          : out std_ulogic;
    reply                 : out frame_reply_t;
    reply_ready           : in  std_ulogic;
    reply_idle            : in  std_ulogic;
    epoch                 : out crc16_t;
    may_begin             : in  std_ulogic := '1';
    wants                 : out std_ulogic;
    busy                  : out std_ulogic;
    receive_overrun       : in  std_ulogic := '0';
    publish_overrun       : in  std_ulogic := '0';
    subscription_request  : out subscription_request_t;
    subscription_response : in  subscription_response_t := subscription_response_idle;
    dead_man_request      : out dead_man_request_t;
    dead_man_response     : in  dead_man_response_t := dead_man_response_idle;
    bii_request           : out bii_request_t;
    bii_response          : in  bii_response_t
  );
end entity;

architecture rtl of frame_application is

  constant exchanges  : natural  := settings.exchanges;
  constant groups     : natural  := settings.groups;
  constant lists      : boolean  := settings.lists;
  constant deadman    : boolean  := settings.deadman;

  constant program       : frame_program_t := frame_program_for(settings);
  constant content       : word_memory_t   := memory_content(settings);
  constant address_bits  : positive        := 8 * settings.address_bytes;
  constant data_bytes    : positive        := settings.data_bytes;
  constant once          : byte_t          := byte_t(to_unsigned(shape_once, 8));
  constant up            : byte_t          := byte_t(to_unsigned(shape_up, 8));

  subtype pointer_t is unsigned(bits_for(content'length) - 1 downto 0);

  signal instruction  : frame_instruction_t;
  signal number_now, said, recalled : byte_t;
  signal first, last, holds, pending, begins : std_ulogic;
  signal late         : std_ulogic;  -- it is executed once more at most
  signal early        : std_ulogic;  -- the word that is to be sent is not there yet
  signal silent       : std_ulogic;  -- the word is that of an access without an answer
  signal rests        : std_ulogic;  -- it waits for work
  signal act_now      : std_ulogic;  -- the instruction is executed in this clock
  signal sets_rate    : std_ulogic;  -- and waits for the end of that
  signal does         : std_ulogic;  -- unless it waited for an access that failed
  signal finishes     : std_ulogic;  -- and this is its last time
  signal choice       : entry_t;     -- what to begin
  signal counted      : std_ulogic;  -- the trip of the dead-man begins
  signal looks        : std_ulogic;  -- there is some work

  signal judges       : std_ulogic;  -- this is the first clock of the instruction
  signal steps        : std_ulogic;  -- and this is its last one
  signal waits        : std_ulogic;  -- it does nothing yet

  signal data         : word32_t := (others => '0');
  signal address      : unsigned(address_bits - 1 downto 0) := (others => '0');
  signal id           : std_ulogic_vector(15 downto 0) := (others => '0');
  signal epoch_now    : crc16_t := (others => '1');
  signal count_down   : unsigned(7 downto 0);
  signal count, group_number : unsigned(7 downto 0) := (others => '0');
  signal size         : unsigned(2 downto 0) := (others => '0');
  signal flags : byte_t;
  signal own_flags : byte_t := byte_t(to_unsigned(flag_untold, 8));
  signal sets, clears : std_ulogic;  -- flags to set and to clear in this clock
  signal marks, shape : byte_t := (others => '0');
  signal passes       : std_ulogic;  -- the instruction is take_item, and takes nothing: all words have one address
  signal pointer      : pointer_t := (others => '0');

  signal word_index : pointer_t;
  signal word       : word32_t;

  signal new_id, repeated, unordered, not_kept : std_ulogic;
  signal kept_status, status_now : std_ulogic_vector(3 downto 0);
  signal kept_count              : unsigned(4 downto 0);
  signal remember, forget, starts, keep, recall : std_ulogic;

  signal time_now : unsigned(31 downto 0);
  signal half, look, turned, publish : std_ulogic;

  signal stores   : std_ulogic;
  signal says     : std_ulogic;
  signal turns_up : std_ulogic;                    -- `data` is rotated up by a byte
  signal reads, writes, holds_bus, found, access_done, failed, silent_bus, denied_write : std_ulogic;

begin

  assert settings.exchanges = 0 or settings.exchange_size <= exchange_size_most(settings)
    report "frame_application: exchange_size is beyond what a frame can define; lower it" severity failure;
  assert content'length <= 1024
    report "frame_application: groups and exchange groups need more than 1024 words" severity failure;

  sequencer : entity work.frame_sequencer
    generic map (program => program, sizes => exchanges > 0)
    port map (
      clock => clock, reset => reset, act => act_now, holds => holds, begins => begins,
      entry => choice, operation => request.entry(3 downto 0), size => size, instruction => instruction,
      rests => rests, judges => judges, steps => steps, waits => waits, first => first, last => last, late => late);

  judge : entity work.frame_judge
    generic map (lists => lists, exchanges => exchanges > 0, deadman => deadman)
    port map (
      clock => clock, judges => judges, steps => steps, instruction => instruction, request => request,
      reply_idle => reply_idle, data => data, word => word, pointer => resize(pointer, 10),
      count => count, flags => flags, marks => marks, shape => shape, new_id => new_id, repeated => repeated,
      not_kept => not_kept, unordered => unordered, failed => failed, silent_bus => silent_bus,
      denied_write => denied_write, half => half, holds => holds);

  memory : entity work.frame_memory
    generic map (content => content)
    port map (clock => clock, index => word_index, store => instruction(store_f), enable => stores,
      data => data, word => word);

  cache : entity work.reply_cache
    generic map (window => settings.window)
    port map (
      clock => clock, id => id, before => instruction(do_before), new_id => new_id,
      repeated => repeated, order => unordered, status => kept_status, kept => kept_count, too_long => not_kept,
      remember => remember, status_in => status_now, forget => forget, forget_index => pointer(6 downto 0),
      start => starts, keep => keep, data_in => said, recall => recall, data_out => recalled);

  timer : entity work.frame_clock
    port map (clock => clock, reset => reset, time_now => time_now, half => half, look => look, turned => turned);

  dispatcher : entity work.frame_dispatcher
    generic map (publishing => groups > 0, deadman => deadman)
    port map (
      clock => clock, reset => reset, turned => turned, tripped => dead_man_response.uncounted, publish => publish,
      room => reply_ready, receive_overrun => receive_overrun, publish_overrun => publish_overrun,
      frame_valid => request.valid, frame_entry => request.entry, asks => rests, begins => begins,
      wants => looks, choice => choice, pending => pending, counted => counted);

  bus_access : entity work.frame_bus
    generic map (address_width => settings.address_width, data_width => settings.data_width)
    port map (
      clock => clock, reset => reset, read => reads, write => writes, hold => holds_bus, free => rests,
      address => std_ulogic_vector(address(settings.address_width - 1 downto 0)), data => data, found => found,
      done => access_done, failed => failed, silent_bus => silent_bus, denied_write => denied_write,
      bii_request => bii_request, bii_response => bii_response);

  -- What to do next.

  number_now <= instruction(number_f);
  count_down <= count - 1;

  says     <= instruction(say_f'left) or or instruction(say_f'left - 1 downto say_f'right);
  act_now  <= not waits and (reply_ready or not says) and
              (access_done or not instruction(do_await)) and
              (subscription_response.done or not sets_rate);
  does     <= not waits and (reply_ready or not says) and
              ((access_done and not failed) or not instruction(do_await)) and
              (subscription_response.done or not sets_rate);
  finishes <= does and last;
  sets_rate <= to_bit(instruction(manage_f) = manage_rate and groups > 0);
  begins   <= rests and pending and may_begin;
  wants    <= rests and looks;
  busy     <= not rests;

  -- What is sent.

  early <= to_bit(instruction(source_f) = from_half) and not late;

  -- A status: of the cached reply, of `data`, or of the instruction.
  status_now <= data(3 downto 0) when number_now(5) = '1' else number_now(3 downto 0);

  speak : process (all)
    variable what : std_ulogic_vector(2 downto 0);
  begin
    case instruction(source_f) is
      when from_top   => said <= data(31 downto 24);
      when from_word  => said <= data(8 * data_bytes - 1 downto 8 * data_bytes - 8);
      when from_half  =>
        said <= word(7 downto 0);
        if last = '0' then
          said <= word(15 downto 8);
        end if;
      when from_id    => said <= id(15 downto 8);
      when from_cache => said <= recalled;
      when from_other =>
        said <= byte_t(group_number);
        if instruction(say_f) = say_kind or groups = 0 then
          said <= "1100" & kept_status;
          if number_now(5) = '1' then
            said <= "1100" & data(3 downto 0);
          end if;
        end if;
      when others     => said <= number_now;
    end case;
    what          := instruction(say_f) and not (say_f => early);
    reply.put     <= does and to_bit(what = say_byte or what = say_kept);
    reply.kind    <= does and to_bit(what = say_kind or what = say_last);
    reply.finish  <= does and to_bit(what = say_end or what = say_last);
    reply.restart <= does and to_bit(what = say_again);
    reply.data    <= said;
  end process;

  -- Requests to the other entities.

  takes : if lists generate
    passes     <= to_bit(instruction(take_f) = take_item) and or (shape and once);
    take       <= does and or instruction(take_f) and not passes;
    take_more  <= count_down when instruction(take_f) = take_many else x"00";
    takes_many <= to_bit(instruction(take_f) = take_many);
  else generate
    take       <= does and or instruction(take_f);
    take_more  <= x"00";
    takes_many <= '0';
  end generate;

  -- In the first clock, because the byte comes two clocks later.
  rewind       <= (judges and instruction(do_rewind)) or (rests and not begins);
  request_done <= finishes and instruction(do_done);

  -- What belongs to a bus error and to a timeout differs in the lowest three bits of its place.
  word_index <= pointer when instruction(do_pointer) = '1' else
                resize(unsigned(number_now xor ("00000" & (2 downto 0 => silent))), pointer'length);
  silent     <= silent_bus and to_bit(instruction(special_f) = by_silence);

  remember <= finishes and instruction(do_place) and nor (marks and byte_t(to_unsigned(mark_repeated, 8)));
  forget   <= finishes and to_bit(instruction(special_f) = forget_place);
  starts   <= rests or (does and to_bit(instruction(say_f) = say_again));
  keep     <= does and to_bit(instruction(say_f) = say_kept) and not early;
  recall   <= does and to_bit(instruction(source_f) = from_cache);
  look     <= finishes and to_bit(instruction(special_f) = half_turn);
  publish   <= subscription_response.publish and flags(2);

  stores    <= finishes and not holds;
  reads     <= finishes and not holds and instruction(do_read);
  writes    <= finishes and not holds and instruction(do_write);
  holds_bus <= finishes and to_bit(instruction(special_f) = hold_bus);

  -- The registers.

  turns_up <= to_bit(instruction(data_f) = data_turn or instruction(source_f) = from_top or
                     instruction(source_f) = from_word);

  shift_data : process (clock)
  begin
    if rising_edge(clock) then
      if found = '1' then
        data <= bii_response.data;
      elsif does = '1' then
        if turns_up = '1' then
          data <= data(23 downto 0) & data(31 downto 24);
        elsif instruction(take_f) = take_first and first = '1' then
          data <= x"000000" & request.data;
        elsif instruction(take_f) = take_data or instruction(take_f) = take_first then
          data <= data(23 downto 0) & request.data;
        elsif last = '1' then
          case instruction(data_f) is
            when data_word  => data <= word;
            when data_clock => data <= std_ulogic_vector(time_now);
            when data_flags => data <= (31 downto 3 => '0') & flags(2 downto 0);
            when data_group =>
              if groups > 0 then
                data <= subscription_response.word;
              end if;
            when data_add =>
              if lists or exchanges > 0 then
                data <= std_ulogic_vector(unsigned(data) + unsigned(word));
              end if;
            when data_and =>
              if lists then
                data <= data and word;
              end if;
            when data_and_not =>
              if lists then
                data <= data and not word;
              end if;
            when others => null;
          end case;
        end if;
      end if;
    end if;
  end process;

  shift_others : process (clock)
  begin
    if rising_edge(clock) then
      if does = '1' then
        if instruction(take_f) = take_id then
          id <= id(7 downto 0) & request.data;
        elsif instruction(source_f) = from_id then
          id <= id(7 downto 0) & id(15 downto 8);
        end if;
        if instruction(take_f) = take_address or (lists and instruction(take_f) = take_item and passes = '0') then
          address <= address(address_bits - 9 downto 0) & unsigned(request.data);
        end if;
      end if;
      if finishes = '1' then
        if instruction(do_load_address) = '1' and exchanges > 0 then
          address <= unsigned(word(address'range));
        elsif instruction(do_find_address) = '1' and groups > 0 then
          address <= unsigned(subscription_response.word(address'range));
        elsif instruction(special_f) = address_up and lists then
          address <= address + unsigned'("" & or (shape and up));
        end if;
      end if;
    end if;
  end process;

  registers : process (clock)
    variable special : std_ulogic_vector(4 downto 0);
    variable base    : pointer_t;
  begin
    if rising_edge(clock) then
      special := instruction(special_f);
      base    := resize(unsigned(std_ulogic_vector'(instruction(far_f) & instruction(target_f))), pointer'length);

      if rests = '1' then
        count <= (others => '0');
        marks <= (others => '0');
        if groups > 0 then
          group_number <= subscription_response.publish_group;
        end if;
      elsif finishes = '1' then
        if instruction(do_count) = '1' then
          count <= count_down;
        end if;
        case special is
          when set_flags    => own_flags    <= own_flags or number_now;
          when clear_flags  => own_flags    <= own_flags and not number_now;
          when set_marks    => marks        <= marks or number_now;
          when load_shape   =>
            shape <= shape_of(data(7 downto 0));
            if lists then
              marks <= marks or marks_of(shape_of(data(7 downto 0)));
            end if;
          when load_count   => count        <= unsigned(data(7 downto 0));
          when load_kept    => count        <= resize(kept_count, 8);
          when load_group   => group_number <= unsigned(data(7 downto 0));
          when load_size    => size         <= unsigned(word(26 downto 24));
          when load_epoch   => epoch_now    <= data(15 downto 0);
          when others       => null;
        end case;
        if instruction(manage_f) = manage_publish and groups > 0 then
          own_flags(2) <= data(0);
        end if;

        if instruction(do_point) = '1' then
          pointer <= base;
          if instruction(do_point_group) = '1' and groups > 0 then
            pointer <= base or resize(group_number, pointer'length);
          elsif instruction(do_point_other) = '1' and exchanges > 0 then
            pointer <= base or shift_left(resize(group_number, pointer'length), bits_for(exchange_stride(settings)));
          end if;
        elsif instruction(do_point_data) = '1' then
          pointer <= resize(unsigned(data(7 downto 0)), pointer'length);
        elsif instruction(do_point_up) = '1' then
          pointer <= pointer + 1;
        end if;
      end if;

      if reset = '1' then
        epoch_now <= (others => '1');
        own_flags <= byte_t(to_unsigned(flag_untold, 8));
      end if;
    end if;
  end process;

  epoch <= epoch_now;

  -- Three flags belong to the dead-man. To set or clear them is a command to it.
  flags  <= own_flags(7 downto 4) & dead_man_response.tripped_now & own_flags(2) & dead_man_response.running &
            dead_man_response.tripped;
  sets   <= finishes and to_bit(instruction(special_f) = set_flags);
  clears <= finishes and to_bit(instruction(special_f) = clear_flags);
  dead_man_request <= (
    alive => '0', start => finishes and to_bit(instruction(special_f) = start_dead_man), ticks => data,
    trip => sets and number_now(0), arm => clears and number_now(0), renew => clears and number_now(3),
    counted => counted);

  manage_groups : process (all)
  begin
    subscription_request              <= subscription_request_idle;
    subscription_request.group_number <= group_number;
    subscription_request.place        <= '0' & count;
    subscription_request.word         <= data;
    subscription_request.rate         <= data;
    subscription_request.write_rate   <= sets_rate;
    if finishes = '1' then
      case instruction(manage_f) is
        when manage_word    => subscription_request.write_word   <= '1';
        when manage_fill    => subscription_request.fill         <= '1';
        when manage_empty   => subscription_request.empty        <= '1';
        when manage_event   => subscription_request.write_event  <= '1';
        when manage_publish =>
          subscription_request.enable  <= data(0);
          subscription_request.disable <= not data(0);
        when manage_clear   => subscription_request.clear        <= '1';
        when manage_take    => subscription_request.publish_take <= '1';
        when others         => null;
      end case;
    end if;
  end process;

end architecture;
