-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the framed application with its program. z3 sends any frames, one after the other. The bus answers in
-- any way, and the transmitter stalls at any time. Address and data have 8 bits. There are no groups. There are lists
-- if the generic says so. The dead-man is in any state, and denies writes at any time.
--
-- The state memory of the application is left out. A word of it has any value at each look, except for its constants.
-- So a loaded epoch has any value, a session may be open at power-up, and what goes through the memory may end
-- anywhere.
--
-- The reply cache gives any verdict on an id, but the same one while the id is in work. The clock ticks at any time.
-- frame_sequencer_formal proves that instructions come from the positions that the sequencer decides.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.bit_pkg.all;
use work.dead_man_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_facts_pkg.all;
use work.frame_list_parts_pkg.all;
use work.frame_pkg.all;
use work.frame_program_pkg.all;
use work.frame_works_pkg.all;
use work.one_thing_pkg.all;
use work.protocol_pkg.all;

entity frame_application_formal is
  generic (
    lists : boolean := false
  );
  port (
    clk             : in std_ulogic;
    reset           : in std_ulogic;
    arrives         : in std_ulogic;              -- a frame arrives, if none is waiting
    entry_in        : in entry_t;
    chained_in      : in std_ulogic;
    barrier_in      : in std_ulogic;
    length_in       : in unsigned(3 downto 0);    -- length of its payload
    data            : in byte_t;                  -- the next byte of the payload
    may_begin       : in std_ulogic;
    receive_overrun : in std_ulogic;
    reply_ready     : in std_ulogic;
    reply_idle      : in std_ulogic;
    response        : in bii_response_t;
    dead_man        : in dead_man_response_t;
    -- Observed signals of the design.
    instruction     : in frame_instruction_t;
    finishes        : in std_ulogic;
    jump            : in std_ulogic;
    begins          : in std_ulogic;
    steps           : in std_ulogic;
    fetches         : in std_ulogic;
    first_clock     : in std_ulogic;              -- of an instruction
    position        : in unsigned(position_bits(lists) - 1 downto 0);
    fetched         : out frame_instruction_t;
    executed        : out frame_instruction_t;
    caller          : in unsigned(position_bits(lists) - 1 downto 0);
    turns           : in unsigned(2 downto 0);
    sees_missing    : in std_ulogic;
    sees_not_new    : in std_ulogic;
    sees_failed     : in std_ulogic;
    if_bytes, if_bits, if_value, if_above_low, if_above_high, if_place, if_half, if_state : in std_ulogic;
    marks           : in byte_t;
    shape           : in byte_t;
    count           : in unsigned(7 downto 0);
    address         : in unsigned(7 downto 0);
    choice          : in entry_t;
    id              : in std_ulogic_vector(15 downto 0);
    word_index      : in unsigned(7 downto 0);
    remember        : in std_ulogic;
    found           : in word32_t;                -- `data` of the design
    over, failed, silent_bus, denied_write : in std_ulogic;  -- its access
    status_out      : in std_ulogic_vector(3 downto 0);
    -- Signals of parts that are left out. They have any value that the assumptions allow.
    word            : in word32_t;
    fresh           : in std_ulogic;              -- new_id
    repeated        : in std_ulogic;
    epoch_now       : in crc16_t
  );
end entity;

architecture properties of frame_application_formal is

  constant settings : frame_settings_t := (
    address_width => 8, data_width => 8, address_bytes => 1, data_bytes => 1, clock_hz => 4, base_hz => 1, groups => 0,
    group_size => 0, rate_bytes => 1, exchanges => 0, exchange_size => 0, window => 2,
    cache_bytes => frame_cache_bytes_default_c, request_max => 250, reply_max => 250, credit => 512, classic => false,
    lists => lists, deadman => true, gateware_version => x"00000000", build => x"00000000",
    spec_hash => x"0000000000000000");

  constant content : word_memory_t := memory_content(settings);

  constant program : frame_program_t := frame_program_for(settings);

  signal position_ahead, position_now : unsigned(position'range);

  subtype constants_t is natural range word_zero to word_two;

  signal request : frame_request_t;
  signal length, taken : unsigned(3 downto 0);
  signal take, takes_many, rewind, request_done, wants, busy : std_ulogic;
  signal take_more : unsigned(7 downto 0);
  signal reply   : frame_reply_t;
  signal epoch, epoch_before : crc16_t;
  signal bii     : bii_request_t;
  signal answer  : bii_response_t;
  signal dead_man_request : dead_man_request_t;

  signal verdict_before : std_ulogic_vector(1 downto 0) := (others => '0');
  signal begins_before, loads_before : std_ulogic := '0';

  signal w         : frame_work_t;  -- the work in hand
  signal begun, at_rest, with_id, frame : std_ulogic;
  signal entry     : natural range 0 to 31;
  signal kind      : byte_t;                        -- of the answer; a guide of tools/formal/guides.py reads it
  signal commanded : std_ulogic;                    -- the dead-man was started, stopped or armed
  signal accessed  : std_ulogic;                    -- a request with an id has ended, and opened the bus
  signal told_truly : std_ulogic;                   -- what was remembered is what was said and what the bus said
  signal may_open  : std_ulogic;                    -- there was no access, or only good ones of a list
  signal list_may  : std_ulogic;                    -- this one may be of a list
  signal held_by_list : std_ulogic;                 -- the bus is not kept between accesses, or only by a list
  signal is_again   : std_ulogic;                   -- a LIST whose id is not new has read again, and said so truly
  signal said_truly : std_ulogic;                   -- what was said is what the bus said
  signal jump_kept : std_ulogic;
  signal now       : frame_instruction_t;           -- see frame_places
  signal here, there : list_facts_t;
  signal acts, busy_here, busy_there : std_ulogic;
  signal l         : frame_list_t;                  -- the list in work

  -- GHDL 2.0 accepts only a limited number of terms in PSL, so the others are VHDL.
  function holds(what : boolean) return boolean is
  begin
    return what;
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.frame_application
    generic map (settings => settings)
    port map (
      clock => clk, reset => reset, request => request, take => take, take_more => take_more,
      takes_many => takes_many, rewind => rewind, request_done => request_done,
      reply => reply, reply_ready => reply_ready, reply_idle => reply_idle, epoch => epoch, may_begin => may_begin,
      wants => wants, busy => busy, receive_overrun => receive_overrun, dead_man_request => dead_man_request,
      dead_man_response => dead_man, bii_request => bii, bii_response => response);

  bus_side : entity work.bii_user_view port map (clk => clk, reset => reset, request => bii, response => answer);

  -- To a user of the bus `denied` is an answer like `error`.
  answer     <= (done => response.done, data => response.data, status => error) when response.status = denied else
                response;
  begun      <= w.begun;
  at_rest    <= w.at_rest;
  with_id    <= w.with_id;
  frame      <= w.frame;
  entry      <= w.entry;
  kind       <= w.kind;
  jump_kept  <= if_bytes or if_bits or if_value or if_above_low or if_above_high or if_place or if_half or if_state;
  accessed   <= at_rest and with_id and to_bit(w.accesses = 1);
  said_truly <= to_bit(w.kinds = 1 and w.status = kind(3 downto 0));
  is_again   <= said_truly and to_bit(w.listed = '1' and fresh = '0' and w.memories = 0);
  told_truly <= (said_truly and to_bit(w.memories = 1 and w.remembered = w.status)) or is_again;
  held_by_list <= not bii.block_hold or w.listed;
  may_open   <= to_bit(w.accesses = 0 or (w.listed = '1' and w.trouble = 0));
  list_may   <= w.listed and (not bii.write or fresh or not with_id);

  request_side : entity work.frame_arrivals
    port map (
      clk => clk, reset => reset, begun => begun, arrives => arrives, entry_in => entry_in, chained_in => chained_in,
      barrier_in => barrier_in, length_in => length_in, data => data, in_session => w.in_session, take => take,
      take_more => take_more, rewind => rewind, done => request_done, request => request, length => length,
      taken => taken);

  -- What the cache has said of the id in work, and the epoch before.
  note_before : process (clk) is
  begin
    if rising_edge(clk) then
      epoch_before   <= epoch;
      verdict_before <= fresh & repeated;
      begins_before  <= begins;
      loads_before   <= reset or (finishes and to_bit(instruction(special_f) = load_epoch));
    end if;
  end process;

  work_in_hand : entity work.frame_work
    generic map (program => program, lists => lists)
    port map (
      clk => clk, reset => reset, request => request, reply => reply, reply_idle => reply_idle, bii => bii,
      response => response, epoch => epoch, request_done => request_done, busy => busy, begins => begins,
      steps => steps, fetches => fetches, finishes => finishes, jump => jump, first_clock => first_clock,
      position => position, choice => choice, word_index => word_index, id => id, fresh => fresh, remember => remember,
      status_out => status_out, instruction => instruction, fetched => fetched, executed => executed,
      place_ahead => position_ahead, place_now => position_now, known => w);

  places : entity work.frame_places
    generic map (program => program, lists => lists)
    port map (
      clk => clk, w => w, place_now => position_now, place_ahead => position_ahead, caller => caller, busy => busy,
      first_clock => first_clock, jump => jump, begins => begins, turns => turns, sees_missing => sees_missing,
      sees_not_new => sees_not_new, sees_failed => sees_failed, jump_kept => jump_kept, marks => marks, shape => shape,
      count => count, stands => request.valid, waiting => request.entry, barrier => request.barrier,
      length => length, taken => taken, bus_open => bii.valid, over => over, failed => failed,
      silent_bus => silent_bus, denied_write => denied_write,
      tripped => dead_man.tripped, commanded => commanded, data => found, word_index => word_index,
      reply_idle => reply_idle, fresh => fresh, repeated => repeated, id => id, now => now, acts => acts, here => here,
      there => there, busy_here => busy_here, busy_there => busy_there);

  with_lists : if lists generate

    list : entity work.frame_list
      port map (
        clk => clk, reset => reset, w => w, begins => begins, waiting => request.entry, barrier => request.barrier,
        left => request.left(3 downto 0), data => data, missing => request.missing, take => take,
        takes_many => takes_many, rewind => rewind, request_done => request_done, take_more => take_more, bii => bii,
        reply => reply, marks => marks, known => l);

    list_places : entity work.frame_list_places
      port map (
        clk => clk, w => w, l => l, now => now, acts => acts, turns => turns, begins => begins, here => here,
        there => there, busy_here => busy_here, busy_there => busy_there, left => request.left(3 downto 0),
        bus_open => bii.valid, marks => marks, shape => shape, count => count, address => address,
        data => found(7 downto 0));

  end generate;

  commands : entity work.frame_commands
    port map (
      clk => clk, reset => reset, begun => begun, request => dead_man_request, tripped => dead_man.tripped,
      begins => begins, at_rest => at_rest, in_session => w.in_session, fresh => fresh, frame => frame, entry => entry,
      dones => w.dones, memories => w.memories, remembered => w.remembered, commanded => commanded);

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- Constants of the memory have their values.
  constants_are : assume always holds(w.looked_at < constants_t'low or
                                      w.looked_at > constants_t'high or word = content(w.looked_at));

  -- The cache gives the same verdict on an id while it is in work, and never both new and repeated. The proof of
  -- reply_cache asserts this until something is remembered or forgotten. By judged_in_time, that comes later.
  verdict_stands : assume always holds((fresh and repeated) = '0' and (begins_before = '1' or begun = '0' or
                   verdict_before = fresh & repeated));

  -- An epoch stays the same until another one is loaded. A session may be open at power-up.
  epoch_is_loaded : assume always holds(loads_before = '1' or begun = '0' or epoch_now = epoch_before);

  -- The dead-man denies only writes. Its proof says so (answered_by_the_bus).
  writes_are_denied : assume always response.done = '1' and response.status = denied -> bii.write = '1';

  -- Only `arm` ends a trip (trip_stays).
  trip_stands : assume always dead_man.tripped = '1' and dead_man_request.arm = '0' and reset = '0' ->
                next (dead_man.tripped = '1');

  -- The transmitter stays idle until it gets something to send.
  idle_stands : assume always reply_idle = '1' and (reply.kind or reply.put or reply.finish) = '0' and reset = '0' ->
                next (reply_idle = '1');

  -- Commands to the transmitter keep the rules on which it relies.
  says_one_thing : assert always begun = '1' -> one_thing(reply, w.given, reply_ready);

  -- A frame has one answer.
  one_answer : assert always begun = '1' and reply.kind = '1' -> w.kinds = 0;

  -- A request whose id is new or repeated is answered.
  answered : assert always at_rest = '1' and with_id = '1' and w.had_id = '1' and
             (fresh = '1' or repeated = '1') -> w.kinds = 1;

  -- There is no answer to a dropped frame, to a post, or without a frame.
  silent_else : assert always begun = '1' and reply.kind = '1' -> holds(frame = '1' and
                (with_id = '1' or entry = entry_hello or entry = entry_open or entry = entry_session));

  -- The kind of the answer belongs to the kind of the frame.
  kind_belongs : assert always begun = '1' and reply.kind = '1' -> holds(
                 (with_id = '1' and reply.data(7 downto 4) = x"C") or
                 (entry = entry_hello and unsigned(reply.data) = device_kind_hello_c) or
                 (entry = entry_open and unsigned(reply.data) = device_kind_open_c) or
                 (entry = entry_session and unsigned(reply.data) = device_kind_closed_c));

  -- The bus is opened only in a session, and once. This happens for a READ or WRITE whose id is new, or for a POST. A
  -- LIST or POST_LIST may open it several times, until an access does not go well. A LIST writes only if its id is new.
  opened_if_asked : assert always begun = '1' and bii.valid = '1' ->
                    holds(w.in_session = '1' and frame = '1' and w.dones = 0 and
                          may_open = '1' and
                          (list_may = '1' or
                           (entry = request_kind_read_c mod 16 and fresh = '1' and bii.write = '0') or
                           (entry = request_kind_write_c mod 16 and fresh = '1' and bii.write = '1') or
                           (entry = request_kind_post_c mod 16 and bii.write = '1')));

  -- Only a list keeps the bus between two accesses.
  bus_not_held : assert always begun = '1' -> held_by_list = '1';

  -- An access that succeeded is remembered with the status of the bus, which is also in its answer. A list that was
  -- remembered before is not remembered again.
  executed_is_remembered : assert always begun = '1' and accessed = '1' and w.trouble = 0 -> told_truly = '1';

  -- An access that the bus refused or did not answer is remembered with that status, too.
  failure_is_remembered : assert always begun = '1' and accessed = '1' and w.trouble /= 0 and
                          (w.trouble /= 3 or w.listed = '1') ->
                          told_truly = '1';

  -- A WRITE that the dead-man denied is not remembered. Its answer says that it was denied.
  denied_is_told : assert always begun = '1' and accessed = '1' and w.trouble = 3 and w.listed = '0' ->
                   w.memories = 0 and w.kinds = 1 and unsigned(kind(3 downto 0)) = reply_status_denied_c;

  -- A READ or WRITE that is remembered was executed.
  remembered_is_executed : assert always at_rest = '1' and w.memories = 1 and
                           (entry = request_kind_read_c mod 16 or entry = request_kind_write_c mod 16) ->
                           w.accesses = 1;

  -- No instruction that names its place stores where the constants or the description are.
  constants_stand : assert always begun = '1' and finishes = '1' and instruction(store_f) /= store_nothing and
                    instruction(do_pointer) = '0' -> holds(
                      not (to_integer(word_index) < control_frames_c) and
                      not (to_integer(word_index) >= constants_t'low and to_integer(word_index) <= constants_t'high));

  -- A READ is answered.
  read_seen : cover {at_rest = '1' and entry = request_kind_read_c mod 16 and w.accesses = 1 and w.kinds = 1};

end architecture;
