-- SPDX-License-Identifier: BSD-3-Clause
--
-- Follows a LIST or POST_LIST for the proof of the framed application: what of the list comes next, byte by byte and
-- access by access. Address and data have one byte each.
--
-- The application goes through a list twice. The first time, it only checks the form. What comes next is the same
-- function of the bytes both times, and the receiver gives the same bytes again after a rewind. So the second time the
-- list has the form that was found the first time. That is the only assumption here.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.bit_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_list_parts_pkg.all;
use work.frame_pkg.all;
use work.frame_works_pkg.all;
use work.protocol_pkg.all;

entity frame_list is
  port (
    clk, reset      : in std_ulogic;
    w               : in frame_work_t;            -- the work in hand
    begins          : in std_ulogic;
    -- The frame that waits, and what is taken of it.
    waiting         : in entry_t;
    barrier         : in std_ulogic;
    left            : in unsigned(3 downto 0);    -- bytes of it that are not taken
    data            : in byte_t;                  -- its next byte
    missing         : in std_ulogic;              -- fewer bytes are left than would be taken
    take, takes_many, rewind, request_done : in std_ulogic;
    take_more       : in unsigned(7 downto 0);
    -- The bus, and the answer.
    bii             : in bii_request_t;
    reply           : in frame_reply_t;
    marks           : in byte_t;
    known           : out frame_list_t
  );
end entity;

architecture properties of frame_list is

  signal part, part_now     : part_t := 0;            -- what comes next; the same, after an access that begins now
  signal operation          : operation_t := 0;
  signal words, words_now   : unsigned(7 downto 0) := (others => '0');  -- of the operation that were not begun
  signal address, address_now : unsigned(7 downto 0) := (others => '0');  -- of the next access
  signal value              : byte_t := (others => '0');
  signal at_start           : std_ulogic := '1';      -- nothing was taken since the last rewind
  signal odd, formed, was_open : std_ulogic := '0';
  signal several : std_ulogic := '0';                 -- there was an access before the last one
  signal opens, posts, executes, repeats : std_ulogic;
  signal finished : std_ulogic;
  signal right_access, again, needed_there, may_be : std_ulogic;

begin

  default clock is rising_edge(clk);

  opens    <= bii.valid and not was_open and w.listed;
  posts    <= to_bit(unsigned(waiting) = request_kind_post_list_c mod 16);
  executes <= or (marks and byte_t(to_unsigned(mark_executing, 8)));
  repeats  <= or (marks and byte_t(to_unsigned(mark_repeated, 8)));
  finished <= to_bit(is_end(part_now)) and nor left;

  known <= (part => part_now, operation => operation, words => words_now, address => address_now, value => value,
            at_start => at_start, formed => formed, odd => odd, executes => executes, posts => posts,
            barred => barrier);

  -- What comes next after an access that begins in this clock.
  look : process (all) is
    variable first : part_t;
    variable more  : boolean;
  begin
    first := part;
    if at_start = '1' then
      first := part_plain;
      if posts = '1' then
        first := part_post;
      elsif barrier = '1' then
        first := part_barred;
      end if;
    end if;
    part_now    <= first;
    words_now   <= words;
    address_now <= address;
    more        := words /= 0;
    if opens = '1' then
      if part = part_again then
        words_now <= words - 1;
        more      := words /= 1;
      end if;
      part_now <= opened(first, operation, more);
      if climbs(operation) then
        address_now <= address + 1;
      end if;
    end if;
  end process;

  follow : process (clk) is
    variable next_part : part_t;
    variable runs      : boolean;
  begin
    if rising_edge(clk) then
      was_open <= bii.valid;
      several  <= (several or (opens and to_bit(w.accesses = 1))) and not begins;
      part     <= part_now;
      words    <= words_now;
      address  <= address_now;
      at_start <= '0';
      if take = '1' and missing = '0' then
        runs      := executes = '1' and (repeats = '0' or reads(operation));
        next_part := taken(part_now, operation, takes_many = '1', runs);
        if takes_many = '1' and take_more + 1 /= words_now then
          next_part := part_astray;
        end if;
        part <= next_part;
        case part_now is
          when part_first | part_read | part_written | part_masked => operation <= operation_of(data);
          when part_size             => words <= unsigned(data);
          when part_base | part_item => address <= unsigned(data);
          when part_value | part_stream => value <= data;
          when others                => null;
        end case;
        if part_now = part_value or part_now = part_stream or next_part = part_due then
          words <= words_now - 1;
        end if;
        if is_end(next_part) then
          words <= (others => '0');
          odd   <= odd or to_bit(words_now = 0 or operation = no_operation or (posts = '1' and reads(operation)));
        end if;
      elsif at_start = '1' then
        at_start <= '1';
      end if;
      if rewind = '1' or begins = '1' or reset = '1' then
        at_start <= '1';
        odd      <= '0';
        formed   <= finished and not odd;
      end if;
    end if;
  end process;

  -- While a list is executed, its bytes have the form that was found before.
  check : process (all) is
    variable needed : unsigned(9 downto 0);  -- bytes of the operation that are left
    variable each   : unsigned(9 downto 0);
  begin
    each := resize(words_now, 10);
    if operation = 6 then
      each := resize(words_now, 10) + shift_left(resize(words_now, 10), 1);
    elsif not once(operation) and not reads(operation) then
      each := shift_left(resize(words_now, 10), 1);
    elsif reads(operation) and once(operation) then
      each := (others => '0');
    end if;
    needed := each;
    case part_now is
      when part_first | part_size => needed := to_unsigned(1, 10);
      when part_base   => needed := each + 1;
      when part_block  =>
        if once(operation) then
          needed := each + 1;
        end if;
      when part_values =>
        needed := resize(words_now, 10);
        if operation = 6 then
          needed := shift_left(resize(words_now, 10), 1);
        end if;
      when part_masks  => needed := resize(words_now, 10);
      when part_mask   => needed := each - 1;
      when part_value  =>
        if operation = 6 then
          needed := each - 2;
        else
          needed := each - 1;
        end if;
      when others      =>
        if part_now < part_plain then
          needed := to_unsigned(part_plain - part_now, 10);
        elsif is_head(part_now) then
          needed := to_unsigned(part_first - part_now, 10);
        elsif is_end(part_now) or part_now = part_astray then
          needed := (others => '0');
        end if;
    end case;
    needed_there <= to_bit(needed <= left);
    may_be       <= to_bit(
      part_now <= part_first or part_now = part_astray or
      (operation /= no_operation and (posts = '0' or not reads(operation)) and
       (words_now /= 0 or (part_now /= part_base and part_now /= part_item and part_now /= part_block))));
  end process;

  again <= to_bit(w.listed = '1' and w.dones = 0 and (executes = '1' or (formed = '1' and is_head(part_now))));

  right_access <= to_bit(
    (part = part_due or part = part_again or part = part_write) and executes = '1' and formed = '1' and
    bii.write = to_bit(part = part_write or (part = part_due and not reads(operation) and not changes(operation))) and
    unsigned(bii.address(7 downto 0)) = address and
    (bii.write = '0' or part = part_write or bii.data(7 downto 0) = value));

  -- While a list is executed, and before that from the rewind on, its bytes have the form that was found the first time
  -- (opens_what_is_next). They are the same bytes: frame_receiver_bytes proves that. Of a list that went astray nothing
  -- is assumed.
  same_bytes : assume always w.begun = '1' and again = '1' -> needed_there = '1' and may_be = '1';

  -- An access of a list is the one that comes next of it, with its address, and with its value if the list has it. So
  -- each access is done once, and in order. It begins only when the whole list was gone through, had its form, and
  -- ended with the frame.
  opens_what_is_next : assert always w.begun = '1' and opens = '1' -> right_access = '1';

  -- A LIST that goes well is answered behind its last access.
  list_ends : assert always w.begun = '1' and w.listed = '1' and reply.kind = '1' and executes = '1' and
              unsigned(reply.data(3 downto 0)) = reply_status_ok_c -> finished = '1' and bii.valid = '0';

  -- A POST_LIST that goes well is done behind its last access.
  post_list_ends : assert always w.begun = '1' and w.listed = '1' and request_done = '1' and executes = '1' and
                   posts = '1' and w.trouble = 0 -> finished = '1' and bii.valid = '0';

  -- A LIST of several accesses is answered.
  several_seen : cover {w.begun = '1' and w.listed = '1' and reply.kind = '1' and several = '1'};

  -- A LIST that was executed before, and whose answer was not kept, reads again.
  again_seen : cover {w.begun = '1' and opens = '1' and repeats = '1'};

end architecture;
