-- SPDX-License-Identifier: BSD-3-Clause
--
-- The works of the framed application, as its proof tells them apart, and where the program has them.

library ieee;
  use ieee.std_logic_1164.all;

use work.frame_pkg.all;
use work.protocol_pkg.all;

package frame_works_pkg is

  constant work_none    : natural := 0;  -- no frame
  constant work_hello   : natural := 1;
  constant work_open    : natural := 2;
  constant work_session : natural := 3;  -- a frame without a session
  constant work_post    : natural := 4;
  constant work_dropped : natural := 5;
  constant work_post_list : natural := 6;
  constant work_read    : natural := 7;  -- this and what follows are requests with an id
  constant work_write   : natural := 8;
  constant work_close   : natural := 9;
  constant work_control : natural := 10;  -- READ_CONTROL or SYNC
  constant work_setting : natural := 11;  -- WRITE_CONTROL
  constant work_list    : natural := 12;
  constant work_other   : natural := 13;  -- no request that this core knows

  subtype works_t is natural range work_none to work_other;

  -- What the proof knows of the work in hand (frame_work).
  type frame_work_t is record
    begun      : std_ulogic;                      -- the reset of power-up is over
    idle       : std_ulogic;                      -- nothing is executed
    entry      : natural range 0 to 31;
    chosen     : entry_t;                         -- what was chosen in the clock before
    frame      : std_ulogic;                      -- the work is a frame
    listed     : std_ulogic;                      -- which is a LIST or POST_LIST, in a core that has lists
    with_id    : std_ulogic;                      -- or a request with an id
    had_id     : std_ulogic;                      -- and long enough to have one
    at_rest    : std_ulogic;                      -- it has ended
    dones      : natural range 0 to 2;
    kinds      : natural range 0 to 2;
    kind       : byte_t;
    given      : std_ulogic;                      -- the kind of the payload in hand was sent
    begun_payload : std_ulogic;                   -- and some of its bytes were
    accesses   : natural range 0 to 2;            -- 1 for any number of a list
    trouble    : natural range 0 to 3;            -- its last access: 1 failed, 2 had no answer, 3 was denied
    status     : std_ulogic_vector(3 downto 0);   -- the status of that: a list that was denied in part has failed
    memories   : natural range 0 to 2;            -- how often its id was remembered
    remembered : std_ulogic_vector(3 downto 0);
    judgements : natural range 0 to 3;            -- how often the cache was asked
    judged     : std_ulogic;                      -- the cache has called `judged_id` new
    judged_id  : std_ulogic_vector(15 downto 0);
    id_before, id_then : std_ulogic_vector(15 downto 0);
    other, other_before : std_ulogic;             -- the cache was busy with something else one and two clocks before
    forgot     : std_ulogic;                      -- the work has made the cache forget a place
    routine    : std_ulogic;                      -- a routine was called and has not returned
    in_session : std_ulogic;
    looked_at, looked_at_next : natural range 0 to 255;  -- the words of the memory
  end record;

  -- Work begins with this entry, in a core without groups. It is a request with an id.
  function begins_work(entry : natural) return boolean;
  function has_id(entry : natural) return boolean;

  -- Which of the works it is. A core without lists does not know them.
  function work_of(entry : natural; lists : boolean) return natural;

  -- `so` may be, because of a bit of the facts, or is not so.
  function only_if(may : std_ulogic; so : boolean) return boolean;

  -- The bits of a place in the program.
  function position_bits(lists : boolean) return positive;

  -- The entry in the program for a frame: most requests have the same one (frame_dispatcher).
  function place_of(entry : natural) return natural;

end package;

package body frame_works_pkg is

  function has_id(entry : natural) return boolean is
  begin
    return entry > 1 and entry < 15 and entry /= request_kind_post_c mod 16 and
           entry /= request_kind_post_list_c mod 16;
  end function;

  function work_of(entry : natural; lists : boolean) return natural is
  begin
    if lists and entry = request_kind_list_c mod 16 then
      return work_list;
    elsif lists and entry = request_kind_post_list_c mod 16 then
      return work_post_list;
    end if;
    case entry is
      when request_kind_read_c mod 16  => return work_read;
      when request_kind_write_c mod 16 => return work_write;
      when request_kind_post_c mod 16  => return work_post;
      when request_kind_close_c mod 16 => return work_close;
      when request_kind_read_control_c mod 16 | request_kind_sync_c mod 16 => return work_control;
      when request_kind_write_control_c mod 16 => return work_setting;
      when entry_hello                 => return work_hello;
      when entry_open                  => return work_open;
      when entry_session               => return work_session;
      when others                      => null;
    end case;
    if has_id(entry) then
      return work_other;
    elsif entry < entry_trip then
      return work_dropped;
    end if;
    return work_none;
  end function;

  function only_if(may : std_ulogic; so : boolean) return boolean is
  begin
    return may = '1' or not so;
  end function;

  function position_bits(lists : boolean) return positive is
  begin
    if lists then
      return 9;
    end if;
    return 8;
  end function;

  function place_of(entry : natural) return natural is
  begin
    if has_id(entry) and entry /= request_kind_read_c mod 16 and entry /= request_kind_write_c mod 16 then
      return entry_unknown;
    end if;
    return entry;
  end function;

  function begins_work(entry : natural) return boolean is
  begin
    return entry > 1 and entry /= 15 and (entry <= entry_trip or entry = entry_half_turn or
           entry = entry_receive_overrun);
  end function;

end package body;
