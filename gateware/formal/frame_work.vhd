-- SPDX-License-Identifier: BSD-3-Clause
--
-- Follows the work of the framed application for its proof. Its properties are about each work, whatever the work does:
-- what is done once, which id is judged and remembered, and that the program stays within its instructions.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;
use work.width_pkg.all;

entity frame_work is
  generic (
    program : frame_program_t;
    lists   : boolean
  );
  port (
    clk, reset      : in std_ulogic;
    -- The design, and what it is connected to.
    request         : in frame_request_t;
    reply           : in frame_reply_t;
    reply_idle      : in std_ulogic;
    bii             : in bii_request_t;
    response        : in bii_response_t;
    epoch           : in crc16_t;
    request_done, busy, begins, steps, fetches, finishes, jump, first_clock : in std_ulogic;
    position        : in unsigned(bits_for(program'length) - 1 downto 0);
    choice          : in entry_t;
    word_index      : in unsigned(7 downto 0);
    id              : in std_ulogic_vector(15 downto 0);
    fresh, remember : in std_ulogic;
    status_out      : in std_ulogic_vector(3 downto 0);
    -- The instructions for it, and what is known of its work.
    instruction     : in  frame_instruction_t;
    fetched         : out frame_instruction_t;
    executed        : out frame_instruction_t;
    place_ahead, place_now : out unsigned(bits_for(program'length) - 1 downto 0);
    known           : out frame_work_t
  );
end entity;

architecture properties of frame_work is

  signal ahead, now_at : unsigned(place_now'range) := (others => '0');
  signal idle      : std_ulogic := '1';
  signal begun     : std_ulogic := '0';
  signal epoch_before : crc16_t;
  signal looked_at, looked_at_next : natural range 0 to 255 := 0;
  signal after_reset : std_ulogic := '1';           -- the clock before was the last one of a reset

  -- The work in hand: see frame_work_t.
  signal entry     : natural range 0 to 31 := 0;
  signal entry_now : entry_t := (others => '0');
  signal frame     : std_ulogic := '0';
  signal had_id    : std_ulogic := '0';
  signal dones     : natural range 0 to 2 := 0;
  signal kinds     : natural range 0 to 2 := 0;
  signal kind      : byte_t := (others => '0');
  signal given     : std_ulogic := '0';
  signal begun_payload : std_ulogic := '0';
  signal accesses  : natural range 0 to 2 := 0;
  signal trouble   : natural range 0 to 3 := 0;
  signal memories  : natural range 0 to 2 := 0;
  signal remembered : std_ulogic_vector(3 downto 0) := "0000";
  signal judgements : natural range 0 to 3 := 0;
  signal judged    : std_ulogic := '0';
  signal judged_id : std_ulogic_vector(15 downto 0) := (others => '0');
  signal other, other_before : std_ulogic := '1';
  signal id_before, id_then : std_ulogic_vector(15 downto 0) := (others => '0');
  signal forgot    : std_ulogic := '0';
  signal routine   : std_ulogic := '0';
  signal listed    : std_ulogic;
  signal status    : std_ulogic_vector(3 downto 0);
  signal stands, in_session, calls, returns, judges, with_id, at_rest, epoch_may_change : std_ulogic;

begin

  default clock is rising_edge(clk);

  place_ahead <= ahead;
  place_now   <= now_at;
  fetched     <= program(to_integer(ahead));
  executed    <= program(to_integer(now_at)) when idle = '0' else nothing_done;
  stands      <= request.valid;
  in_session  <= nand epoch(15 downto 8);
  at_rest     <= begun and not busy;
  calls       <= steps and instruction(do_call);
  returns     <= steps and instruction(do_return);
  judges      <= finishes and to_bit(unsigned(instruction(condition_f)) = if_not_new);
  epoch_may_change <= to_bit(frame = '1' and stands = '1' and given = '0' and reply_idle = '1' and
                             (entry = entry_open or entry = request_kind_close_c mod 16));
  with_id     <= frame and to_bit(entry < 16 and entry /= request_kind_post_c mod 16 and
                                  entry /= request_kind_post_list_c mod 16);

  listed      <= frame and to_bit(lists and (entry = request_kind_list_c mod 16 or
                                             entry = request_kind_post_list_c mod 16));

  state_status : process (all) is
  begin
    status <= std_ulogic_vector(to_unsigned(trouble, 4));
    if trouble = 3 then
      status <= std_ulogic_vector(to_unsigned(reply_status_denied_c, 4));
      if listed = '1' then
        status <= std_ulogic_vector(to_unsigned(reply_status_bus_error_c, 4));
      end if;
    end if;
  end process;

  known <= (
    begun => begun, idle => idle, entry => entry, chosen => entry_now, frame => frame, listed => listed,
    with_id => with_id,
    had_id => had_id, at_rest => at_rest, dones => dones, kinds => kinds, kind => kind, given => given,
    begun_payload => begun_payload, accesses => accesses, trouble => trouble, status => status,
    memories => memories, remembered => remembered, judgements => judgements, judged => judged, judged_id => judged_id,
    id_before => id_before, id_then => id_then, other => other, other_before => other_before, forgot => forgot,
    routine => routine, in_session => in_session, looked_at => looked_at, looked_at_next => looked_at_next);

  -- Which word the memory reads.
  note_before : process (clk) is
  begin
    if rising_edge(clk) then
      looked_at_next <= to_integer(word_index);
      looked_at      <= looked_at_next;
      begun          <= '1';
      after_reset    <= reset;
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
        ahead <= position;
      end if;
      if steps = '1' then
        now_at <= ahead;
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
        if accesses < 2 and not (listed = '1' and accesses = 1) then
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
        had_id   <= to_bit(request.length >= 2);
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

  -- A frame in work is marked as done when the work ends.
  done_once : assert always at_rest = '1' and frame = '1' -> dones = 1;

  -- It is marked as done once, and no other frame is.
  nothing_done_else : assert always begun = '1' and request_done = '1' -> stands = '1' and frame = '1' and dones = 0;

  -- Marking a frame as done ends the work in hand.
  done_ends : assert always begun = '1' and request_done = '1' and reset = '0' -> next (busy = '0');

  -- Every answer that begins also ends, once, before anything else begins. So publishes, replies and ticks never share
  -- the transmitter.
  answer_ends : assert always at_rest = '1' -> given = '0' and begun_payload = '0';

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

end architecture;
