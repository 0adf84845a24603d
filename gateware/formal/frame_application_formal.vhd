-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the framed application with its program. z3 sends any frames, one after the other. The bus answers in
-- any way, and the transmitter stalls at any time. Address and data have 8 bits. There are no lists and no groups.
-- The dead-man is in any state, and denies writes at any time.
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
use work.frame_pkg.all;
use work.frame_program_pkg.all;
use work.one_thing_pkg.all;
use work.protocol_pkg.all;

entity frame_application_formal is
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
    position        : in unsigned(7 downto 0);
    fetched         : out frame_instruction_t;
    executed        : out frame_instruction_t;
    caller          : in unsigned(7 downto 0);
    turns           : in unsigned(2 downto 0);
    sees_missing    : in std_ulogic;
    sees_not_new    : in std_ulogic;
    sees_failed     : in std_ulogic;
    if_bytes, if_bits, if_value, if_above_low, if_above_high, if_place, if_half, if_state : in std_ulogic;
    marks           : in byte_t;
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
    lists => false, deadman => true, gateware_version => x"00000000", build => x"00000000",
    spec_hash => x"0000000000000000");

  constant content : word_memory_t := memory_content(settings);

  constant program : frame_program_t := frame_program_for(settings);

  signal position_ahead, position_now : unsigned(7 downto 0) := (others => '0');
  signal idle : std_ulogic := '1';  -- nothing is executed

  subtype constants_t is natural range word_zero to word_two;

  signal begun   : std_ulogic := '0';  -- the reset of power-up is over

  signal request : frame_request_t;
  signal stands  : std_ulogic;
  signal taken, length : unsigned(3 downto 0);
  signal take, rewind, request_done, wants, busy : std_ulogic;
  signal reply   : frame_reply_t;
  signal epoch, epoch_before : crc16_t;
  signal in_session : std_ulogic;
  signal bii     : bii_request_t;
  signal answer  : bii_response_t;
  signal dead_man_request : dead_man_request_t;

  signal verdict_before : std_ulogic_vector(1 downto 0) := (others => '0');
  signal begins_before, loads_before : std_ulogic := '0';
  signal looked_at, looked_at_next : natural range 0 to 255 := 0;

  -- The work in hand.
  signal entry     : natural range 0 to 31 := 0;
  signal entry_now : entry_t := (others => '0');    -- what was chosen in the clock before
  signal frame     : std_ulogic := '0';             -- the work is a frame
  signal had_id    : std_ulogic := '0';             -- and long enough to have an id
  signal dones     : natural range 0 to 2 := 0;
  signal kinds     : natural range 0 to 2 := 0;
  signal kind      : byte_t := (others => '0');
  signal given     : std_ulogic := '0';             -- the kind of the payload in hand was sent
  signal begun_payload : std_ulogic := '0';         -- and some of its bytes were
  signal accesses  : natural range 0 to 2 := 0;
  signal trouble   : natural range 0 to 3 := 0;     -- its access: 1 failed, 2 had no answer, 3 was denied
  signal memories  : natural range 0 to 2 := 0;     -- how often its id was remembered
  signal remembered : std_ulogic_vector(3 downto 0) := "0000";
  signal judgements : natural range 0 to 3 := 0;    -- how often the cache was asked
  signal judged    : std_ulogic := '0';             -- the cache has called the id new
  signal judged_id : std_ulogic_vector(15 downto 0) := (others => '0');
  signal other, other_before : std_ulogic := '1';   -- the cache was busy with something else one and two clocks before
  signal id_before, id_then : std_ulogic_vector(15 downto 0) := (others => '0');
  signal forgot    : std_ulogic := '0';             -- the work has made the cache forget a place
  signal after_reset : std_ulogic := '1';           -- the clock before was the last one of a reset
  signal commanded : std_ulogic;                    -- the dead-man was started, stopped or armed
  signal routine   : std_ulogic := '0';             -- a routine was called and has not returned
  signal accessed  : std_ulogic;                    -- a request with an id has ended, and opened the bus
  signal told_truly : std_ulogic;                   -- what was remembered is what was said and what the bus said
  signal jump_kept, calls, returns, judges, with_id, at_rest, epoch_may_change : std_ulogic;

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
      clock => clk, reset => reset, request => request, take => take, rewind => rewind, request_done => request_done,
      reply => reply, reply_ready => reply_ready, reply_idle => reply_idle, epoch => epoch, may_begin => may_begin,
      wants => wants, busy => busy, receive_overrun => receive_overrun, dead_man_request => dead_man_request,
      dead_man_response => dead_man, bii_request => bii, bii_response => response);

  bus_side : entity work.bii_user_view port map (clk => clk, reset => reset, request => bii, response => answer);

  -- To a user of the bus `denied` is an answer like `error`.
  answer     <= (done => response.done, data => response.data, status => error) when response.status = denied else
                response;
  fetched    <= program(to_integer(position_ahead));
  executed   <= program(to_integer(position_now)) when idle = '0' else nothing_done;
  in_session <= nand epoch(15 downto 8);
  at_rest    <= begun and not busy;
  jump_kept  <= if_bytes or if_bits or if_value or if_above_low or if_above_high or if_place or if_half or if_state;
  calls      <= steps and instruction(do_call);
  returns    <= steps and instruction(do_return);
  judges     <= finishes and to_bit(unsigned(instruction(condition_f)) = if_not_new);
  epoch_may_change <= to_bit(frame = '1' and stands = '1' and given = '0' and reply_idle = '1' and
                             (entry = entry_open or entry = request_kind_close_c mod 16));
  with_id    <= frame and to_bit(entry < 16 and entry /= request_kind_post_c mod 16 and
                                 entry /= request_kind_post_list_c mod 16);

  accessed   <= at_rest and with_id and to_bit(accesses = 1);
  told_truly <= to_bit(memories = 1 and remembered = kind(3 downto 0) and
                       to_integer(unsigned(remembered)) = trouble);

  request_side : entity work.frame_arrivals
    port map (
      clk => clk, reset => reset, begun => begun, arrives => arrives, entry_in => entry_in, chained_in => chained_in,
      barrier_in => barrier_in, length_in => length_in, data => data, in_session => in_session, take => take,
      rewind => rewind, done => request_done, request => request, length => length, taken => taken);

  stands <= request.valid;

  -- Which word the memory reads, and what the cache has said of the id in work.
  note_before : process (clk) is
  begin
    if rising_edge(clk) then
      looked_at_next <= to_integer(word_index);
      looked_at      <= looked_at_next;
      begun          <= '1';
      after_reset    <= reset;
      verdict_before <= fresh & repeated;
      begins_before  <= begins;
      loads_before   <= reset or (finishes and to_bit(instruction(special_f) = load_epoch));
    end if;
  end process;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      epoch_before <= epoch;
      id_before    <= id;
      id_then      <= id_before;
      entry_now <= choice;
      if fetches = '1' then
        position_ahead <= position;
      end if;
      if steps = '1' then
        position_now <= position_ahead;
        idle         <= jump or instruction(do_begin);
      end if;

      other_before <= other;
      other        <= remember or instruction(do_before) or to_bit(instruction(special_f) = forget_place);

      if reply.restart = '1' or reply.finish = '1' then
        given         <= '0';
        begun_payload <= '0';
      else
        given         <= given or reply.kind;
        begun_payload <= begun_payload or reply.put;
      end if;
      if reply.restart = '1' and given = '1' then
        given <= '1';  -- the bytes are dropped, the kind stays
      end if;
      if reply.kind = '1' then
        kind <= reply.data;
        if kinds < 2 then
          kinds <= kinds + 1;
        end if;
      end if;
      if request_done = '1' and dones < 2 then
        dones <= dones + 1;
      end if;
      if bii.valid = '1' and response.done = '1' then
        if accesses < 2 then
          accesses <= accesses + 1;
        end if;
        trouble <= 0;
        if response.status = error then
          trouble <= 1;
        elsif response.status = silent then
          trouble <= 2;
        elsif response.status = denied then
          trouble <= 3;
        end if;
      end if;
      if judges = '1' and judgements < 3 then
        judgements <= judgements + 1;
      end if;
      if judges = '1' and fresh = '1' then
        judged    <= '1';
        judged_id <= id;
      end if;
      if remember = '1' then
        remembered <= status_out;
        if memories < 2 then
          memories <= memories + 1;
        end if;
      end if;
      forgot  <= forgot or (finishes and to_bit(instruction(special_f) = forget_place));
      routine <= (routine or calls) and not returns;

      if begins = '1' then
        entry    <= to_integer(unsigned(entry_now));
        frame    <= to_bit(unsigned(entry_now) < entry_trip);
        if unsigned(entry_now) < entry_trip then
          entry <= to_integer(unsigned(request.entry));
        end if;
        had_id   <= to_bit(length >= 2);
        dones    <= 0;
        kinds    <= 0;
        accesses <= 0;
        trouble  <= 0;
        memories <= 0;
        judged   <= '0';
        forgot   <= '0';
        judgements <= 0;
      end if;
      if reset = '1' then
        idle          <= '1';
        frame         <= '0';
        given         <= '0';
        begun_payload <= '0';
        routine       <= '0';
        dones         <= 0;
        kinds         <= 0;
        accesses      <= 0;
        memories      <= 0;
        judged        <= '0';
        forgot        <= '0';
        judgements    <= 0;
      end if;
    end if;
  end process;

  places : entity work.frame_places
    generic map (program => program)
    port map (
      clk => clk, begun => begun, place_now => position_now, place_ahead => position_ahead, caller => caller,
      idle => idle, busy => busy, first_clock => first_clock, jump => jump, begins => begins, turns => turns,
      sees_missing => sees_missing, sees_not_new => sees_not_new, sees_failed => sees_failed, jump_kept => jump_kept,
      marks => marks, stands => stands, waiting => request.entry, had_id => had_id, length => length, taken => taken,
      chosen => entry_now, entry => entry, frame => frame, routine => routine, dones => dones, in_session => in_session,
      bus_open => bii.valid, over => over, failed => failed, silent_bus => silent_bus, denied_write => denied_write,
      tripped => dead_man.tripped, commanded => commanded, accesses => accesses, trouble => trouble, data => found,
      word_index => word_index, looked_at => looked_at, looked_at_next => looked_at_next, kinds => kinds, kind => kind,
      given => given, begun_payload => begun_payload, reply_idle => reply_idle, fresh => fresh, repeated => repeated,
      memories => memories, judgements => judgements, judged => judged, judged_id => judged_id, id => id,
      id_before => id_before, id_then => id_then, forgot => forgot, other => other, other_before => other_before);

  commands : entity work.frame_commands
    port map (
      clk => clk, reset => reset, begun => begun, request => dead_man_request, tripped => dead_man.tripped,
      begins => begins, at_rest => at_rest, in_session => in_session, fresh => fresh, frame => frame, entry => entry,
      dones => dones, memories => memories, remembered => remembered, commanded => commanded);

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- Constants of the memory have their values.
  constants_are : assume always holds(looked_at < constants_t'low or
                                      looked_at > constants_t'high or word = content(looked_at));

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

  -- A frame in work is marked as done when the work ends.
  done_once : assert always at_rest = '1' and frame = '1' -> dones = 1;

  -- It is marked as done once, and no other frame is.
  nothing_done_else : assert always begun = '1' and request_done = '1' -> stands = '1' and frame = '1' and dones = 0;

  -- Marking a frame as done ends the work in hand.
  done_ends : assert always begun = '1' and request_done = '1' and reset = '0' -> next (busy = '0');

  -- Commands to the transmitter keep the rules on which it relies.
  says_one_thing : assert always begun = '1' -> one_thing(reply, given, reply_ready);

  -- Every answer that begins also ends, once, before anything else begins. So publishes, replies and ticks never share
  -- the transmitter.
  answer_ends : assert always at_rest = '1' -> given = '0' and begun_payload = '0';

  -- A frame has one answer.
  one_answer : assert always begun = '1' and reply.kind = '1' -> kinds = 0;

  -- A request whose id is new or repeated is answered.
  answered : assert always at_rest = '1' and with_id = '1' and had_id = '1' and
             (fresh = '1' or repeated = '1') -> kinds = 1;

  -- There is no answer to a dropped frame, to a post, or without a frame.
  silent_else : assert always begun = '1' and reply.kind = '1' -> holds(frame = '1' and
                (with_id = '1' or entry = entry_hello or entry = entry_open or entry = entry_session));

  -- The kind of the answer belongs to the kind of the frame.
  kind_belongs : assert always begun = '1' and reply.kind = '1' -> holds(
                 (with_id = '1' and reply.data(7 downto 4) = x"C") or
                 (entry = entry_hello and unsigned(reply.data) = device_kind_hello_c) or
                 (entry = entry_open and unsigned(reply.data) = device_kind_open_c) or
                 (entry = entry_session and unsigned(reply.data) = device_kind_closed_c));

  -- The bus is opened only in a session, and once. This happens for a READ or WRITE whose id is new, or for a POST.
  opened_if_asked : assert always begun = '1' and bii.valid = '1' ->
                    holds(in_session = '1' and frame = '1' and dones = 0 and accesses = 0 and
                          ((entry = request_kind_read_c mod 16 and fresh = '1' and bii.write = '0') or
                           (entry = request_kind_write_c mod 16 and fresh = '1' and bii.write = '1') or
                           (entry = request_kind_post_c mod 16 and bii.write = '1')));

  -- The bus is never opened with a hold.
  bus_not_held : assert always begun = '1' -> bii.block_hold = '0';

  -- The work in hand does not end before its access.
  awaited : assert always begun = '1' and busy = '0' -> bii.valid = '0';

  -- The verdict on an id is used only after the cache has looked at this id, and before the work changes the cache.
  judged_in_time : assert always begun = '1' and judges = '1' ->
                   id = id_before and id = id_then and (other or other_before or forgot) = '0' and
                   instruction(do_before) = '0' and memories = 0;

  -- The work has one id: none is taken after the cache was asked.
  id_stands : assert always begun = '1' and to_bit(instruction(take_f) = take_id) = '1' -> judgements = 0;

  -- An id is remembered once, and only if the cache has called it new. The proof of the cache assumes this.
  new_is_remembered : assert always begun = '1' and remember = '1' -> memories = 0 and judged = '1' and id = judged_id;

  -- The program does not loop: no id is judged more than twice.
  judged_twice_most : assert always begun = '1' -> judgements <= 2;

  -- An access that succeeded is remembered with the status of the bus, which is also in its answer.
  executed_is_remembered : assert always begun = '1' and accessed = '1' and trouble = 0 -> told_truly = '1';

  -- An access that the bus refused or did not answer is remembered with that status, too.
  failure_is_remembered : assert always begun = '1' and accessed = '1' and (trouble = 1 or trouble = 2) ->
                          told_truly = '1';

  -- A WRITE that the dead-man denied is not remembered. Its answer says that it was denied.
  denied_is_told : assert always begun = '1' and accessed = '1' and trouble = 3 ->
                   memories = 0 and kinds = 1 and unsigned(kind(3 downto 0)) = reply_status_denied_c;

  -- A READ or WRITE that is remembered was executed.
  remembered_is_executed : assert always at_rest = '1' and memories = 1 and
                           (entry = request_kind_read_c mod 16 or entry = request_kind_write_c mod 16) -> accesses = 1;

  -- The epoch changes only during an OPEN or CLOSE, and only while nothing is being sent. Receiver and transmitter
  -- assume this.
  epoch_stands : assert always begun = '1' and reset = '0' -> next (epoch_may_change = '1' or epoch = epoch_before);

  -- The program never leaves its instructions. After a reset it starts at the first ones.
  in_program : assert always begun = '1' and idle = '0' -> or instruction;

  -- A routine is not called from within a routine, and returns once.
  one_routine : assert always begun = '1' -> (calls = '0' or routine = '0') and (returns = '0' or routine = '1');

  -- Nothing holds in the first clock of an instruction, nor without one, but for the clock after a reset. The proof of
  -- the sequencer assumes this.
  holds_later : assert always begun = '1' and after_reset = '0' and (first_clock = '1' or busy = '0') -> jump = '0';

  -- No routine is open at the end of the work.
  routine_ends : assert always begun = '1' and busy = '0' -> routine = '0';

  -- No instruction that names its place stores where the constants or the description are.
  constants_stand : assert always begun = '1' and finishes = '1' and instruction(store_f) /= store_nothing and
                    instruction(do_pointer) = '0' -> holds(
                      not (to_integer(word_index) < control_frames_c) and
                      not (to_integer(word_index) >= constants_t'low and to_integer(word_index) <= constants_t'high));

  -- A READ is answered.
  read_seen : cover {at_rest = '1' and entry = request_kind_read_c mod 16 and accesses = 1 and kinds = 1};

end architecture;
