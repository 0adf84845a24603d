-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of framed_small with its program: whatever comes, in frames of any kind and order, each request is
-- executed at most once. The frames have any bytes, and the bus answers in any way.
--
-- Memory      The block RAM is left out. In its place stand the bytes of it that matter: the variables that name the
--             request in hand, and the record of one place, which z3 chooses. Any other byte has any value at each
--             read.
-- Invariant   A table says which facts are true at each place of the program, and which are kept through a call.
--             tools/small/assemble.py knows the places, and tools/formal/small_facts.py makes the table. Here both
--             are checked: two clocks in which they hold are followed by a third one.
--
-- The generics are the table, and addresses of the program and of its variables.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.bit_pkg.all;
use work.dead_man_pkg.all;
use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.small_facts_pkg.all;
use work.small_instruction_pkg.all;
use work.small_program_pkg.all;

entity small_engine_formal is
  generic (
    facts : string;  -- of each place: 24 hexadecimal digits
    -- Places of the program.
    at_now, at_take_address, at_write_word, at_open_new,
      at_listen, at_decode_end, at_is_long, at_no_session, at_is_wrong, at_judged, at_judged_kind,
      at_drop, at_done, at_judge, at_distance, at_not_new, at_put_reply, at_remember, at_slot, at_fails, at_post,
      at_finish, at_write, at_open, at_session, at_session_place, at_bump, at_clear : natural;
    -- Bytes of the memory.
    byte_kind, byte_id_h, byte_id_l, byte_record, byte_status, byte_count, byte_repeated, byte_scratch, byte_found,
      byte_low, byte_high, byte_head, byte_look, byte_after, byte_outside, byte_posts_h, byte_posts_l,
      byte_places : natural
  );
  port (
    clk               : in  std_ulogic;
    reset             : in  std_ulogic;
    frame_valid       : in  std_ulogic;
    frame_data        : in  byte_t;
    receive_overrun   : in  std_ulogic;
    tx_ready          : in  std_ulogic;
    response          : in  bii_response_t;
    dead_man          : in  dead_man_response_t;
    watched           : in  unsigned(2 downto 0);  -- the place that is watched
    any_byte          : in  byte_t;                -- what the memory reads, if that is not one of the bytes below
    leaves            : in  std_ulogic;            -- `clear` ends early: this shortens the search, and adds behaviour
    guided            : in  std_ulogic;            -- all inputs are as the covers need them
    looked            : out byte_t;                -- what the memory has read
    -- Signals of the design.
    executing         : in  std_ulogic;
    position          : in  unsigned(9 downto 0);
    caller            : in  unsigned(9 downto 0);
    caller_before     : in  unsigned(9 downto 0);
    instruction       : in  small_instruction_t;
    a                 : in  unsigned(7 downto 0);
    x                 : in  unsigned(8 downto 0);
    carry             : in  std_ulogic;
    read_address      : in  unsigned(9 downto 0);
    write_address     : in  unsigned(9 downto 0);
    written           : in  byte_t;
    writes            : in  std_ulogic;
    store, put, loads, loads_carry, points, goes_on, moves, follows : in std_ulogic;
    acts, tells, notes : in std_ulogic_vector(8 downto 0)
  );
end entity;

architecture properties of small_engine_formal is

  subtype address_t is unsigned(9 downto 0);
  type record_t is array (0 to 3) of number_t;

  constant address_of : numbers_t := (
    byte_kind, byte_id_h, byte_id_l, byte_record, byte_status, byte_count, byte_repeated, byte_scratch, byte_found,
    byte_low, byte_high, byte_head, byte_look, byte_after, byte_outside, byte_posts_h, byte_posts_l);

  constant table : table_t := table_of(facts);

  signal begun   : std_ulogic := '0';
  signal watched_before : unsigned(2 downto 0) := "000";

  signal tx_valid, tx_last, tx_publish, frame_ready : std_ulogic;
  signal tx_data : byte_t;
  signal bii     : bii_request_t;
  signal told    : dead_man_request_t;

  -- What the design sees, guided or not.
  signal resets, comes   : std_ulogic;
  signal came, any_now   : byte_t;
  signal response_now    : bii_response_t;
  signal dead_man_now    : dead_man_response_t;
  signal frames          : natural range 0 to 3 := 0;  -- that were begun

  -- The memory.
  signal byte_of  : bytes_t := (others => (others => '0'));
  signal place    : record_t := (others => (others => '0'));  -- id (low byte first), status, bytes kept
  signal here     : address_t;                    -- of the place
  signal read_now : number_t := (others => '0');

  signal current : address_t := (others => '0');  -- the place of the instruction in work
  signal starts  : std_ulogic;                    -- its first clock

  -- The frame in hand.
  signal effects  : natural range 0 to 2 := 0;    -- what it has done outside
  signal reached  : std_ulogic := '0';            -- it was begun, since the reset
  signal session  : std_ulogic := '0';            -- a session has begun or ended
  signal effect, ours : std_ulogic;
  signal id, place_id, posts : word16_t;
  signal ahead    : word16_t;                     -- how far its id is ahead of that of the place
  signal wanted   : word16_t := (others => '0');  -- the id whose distance is computed

  signal row, row_1, row_2 : row_t;               -- of this place, of the caller, and of its caller
  signal facts_now : facts_t;
  signal table_holds, steps_hold, flow_holds : boolean;

  -- A kind, or the number of a counter of discarded frames less 80.
  function is_kind(byte : byte_t) return boolean is
  begin
    return unsigned(byte) >= 16#80# or unsigned(byte) < 16#48#;
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.framed_small
    generic map (
      settings => core_settings(
        address_bits => 8, data_bits => 8, clock_hz => 1000, base_hz => 100, protocol => protocol_framed,
        publish_mode => 0, lists => false, exchanges => 0, window => window))
    port map (
      clock => clk, reset => resets, frame_valid => comes, frame_ready => frame_ready, frame_data => came,
      receive_overrun => receive_overrun and not guided, tx_valid => tx_valid, tx_ready => tx_ready or guided,
      tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish, dead_man_request => told,
      dead_man_response => dead_man_now, bii_request => bii, bii_response => response_now);

  -- The way to the covers: a piece is checked, a WRITE is executed, then a POST, and a session is opened.
  guide : process (all) is
  begin
    resets       <= reset;
    comes        <= frame_valid;
    came         <= frame_data;
    response_now <= response;
    dead_man_now <= dead_man;
    any_now      <= any_byte;
    if guided = '1' then
      resets       <= not begun;
      comes        <= '1';
      came         <= x"00";
      response_now <= (data => (others => '0'), status => ok, done => '1');
      dead_man_now <= dead_man_response_idle;
      any_now      <= x"00";
      if current = at_now + 8 then
        case frames is
          when 1      => any_now <= std_ulogic_vector(to_unsigned(request_kind_write_c, 8));
          when 2      => any_now <= std_ulogic_vector(to_unsigned(request_kind_post_c, 8));
          when others => any_now <= std_ulogic_vector(to_unsigned(request_kind_open_c, 8));
        end case;
      elsif current = at_now + 22 then                          -- its size
        any_now <= x"20";
      elsif current = at_write + 1 then                         -- A + D
        any_now <= x"18";
      elsif current = at_open then
        any_now <= x"0B";
      elsif current = at_now + 27 or current = at_take_address or current = at_write_word + 1 or
          current = at_open + 20 or current = at_open_new then
        any_now <= x"01";
      elsif current = at_finish + 16 then                       -- the last block of the reply ends here
        any_now <= std_ulogic_vector(byte_of(n_found) + 1);
      end if;
    end if;
  end process;

  -- The memory.

  looked <= std_ulogic_vector(read_now);
  here   <= to_unsigned(byte_places, 10) + resize(watched & "00", 10);

  remember : process (clk) is
    variable read : number_t;
  begin
    if rising_edge(clk) then
      read := unsigned(any_now);
      if read_address = small_window_mask then
        read := to_unsigned(window - 1, 8);
      elsif read_address = small_window then
        read := to_unsigned(window, 8);
      end if;
      for name in names_t loop
        if read_address = address_of(name) then
          read := byte_of(name);
        end if;
        if writes = '1' and write_address = address_of(name) then
          byte_of(name) <= unsigned(written);
        end if;
      end loop;
      for number in 0 to 3 loop
        if read_address = here + number then
          read := place(number);
        end if;
        if writes = '1' and write_address = here + number then
          place(number) <= unsigned(written);
        end if;
      end loop;
      if (leaves or guided) = '1' and current = at_clear + 3 then
        read := x(7 downto 0);
      end if;
      read_now <= read;
    end if;
  end process;

  -- The frame in hand.

  starts   <= not executing;
  id       <= joined(byte_of(n_id_h), byte_of(n_id_l));
  place_id <= joined(place(1), place(0));
  posts    <= joined(byte_of(n_posts_h), byte_of(n_posts_l));
  ahead    <= id - place_id;
  ours     <= to_bit(id(2 downto 0) = watched);
  effect   <= acts(out_read) or acts(out_write) or tells(tell_start) or tells(tell_arm);

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun          <= '1';
      watched_before <= watched;
      if executing = '1' then
        current <= position;
      elsif current = at_now + 6 then
        effects <= 0;
        reached <= '1';
        session <= '0';
        if frames < 3 then
          frames <= frames + 1;
        end if;
      elsif current = at_distance then
        wanted <= joined(byte_of(n_high), a);
      end if;
      if effect = '1' and effects < 2 then
        effects <= effects + 1;
      end if;
      if tells(tell_renew) = '1' then
        session <= '1';
      end if;
      if resets = '1' then
        effects <= 0;
        reached <= '0';
      end if;
    end if;
  end process;

  -- The invariant.

  row   <= table(to_integer(current));
  row_1 <= table(to_integer(caller));
  row_2 <= table(to_integer(caller_before));

  know : process (all) is
    variable known : facts_t;

    procedure fact(name : fact_t; holds : boolean) is
    begin
      known(fact_t'pos(name)) := to_bit(holds);
    end procedure;

    variable is_older : boolean;
  begin
    known    := (others => '1');
    is_older := ours = '0' or (ahead /= 0 and ahead(15) = '0');
    fact(none, effects = 0);
    fact(begun_frame, reached = '1');
    fact(not_post, byte_of(n_kind) /= request_kind_post_c);
    fact(is_post, byte_of(n_kind) = request_kind_post_c);
    fact(older, is_older);
    fact(recorded, byte_of(n_record) = place_of(byte_places, id(7 downto 0)));
    fact(fresh, is_older or byte_of(n_repeated) /= 0);
    fact(remembered, ours = '0' or ahead = 0);
    fact(settled, effects = 0 or byte_of(n_kind) = request_kind_post_c or ours = '0' or ahead = 0 or session = '1' or
                  byte_of(n_status) = reply_status_denied_c);
    fact(renewed, session = '1');
    fact(next_post, posts = id + 1);
    fact(out_known, byte_of(n_outside) = ((byte_of(n_kind) and x"FE") xor to_unsigned(request_kind_hello_c, 8)));
    fact(a_high, a(7) = '1');
    fact(a_low, a(7) = '0');
    fact(a_counter, a >= 16#80# and a < 16#C8#);
    fact(x_low, x < 16#80#);
    fact(x_counter, x >= 16#80# and x < 16#C8#);
    fact(x_high, x >= 16#100#);
    fact(x_ring, x >= 16#180#);
    fact(look_high, byte_of(n_look)(7) = '1');
    fact(after_high, byte_of(n_after)(7) = '1');
    fact(x_clear, x < 16#80# or x >= 16#100#);
    fact(kind_legal, byte_of(n_kind) >= 16#80# or byte_of(n_kind) < 16#48#);
    fact(kind_small, byte_of(n_kind) < 16#48#);
    fact(post_or_older, is_older or byte_of(n_kind) = request_kind_post_c);
    fact(post_or_recorded, byte_of(n_record) = place_of(byte_places, id(7 downto 0)) or
                           byte_of(n_kind) = request_kind_post_c);
    fact(head_high, byte_of(n_head)(7) = '1');
    facts_now <= known;
  end process;

  look_up : process (all) is
    variable holds : boolean;

    -- Whether what has been called may return to a place.
    impure function returns(routine : std_ulogic_vector(7 downto 0); there : row_t) return boolean is
    begin
      for number in 1 to 31 loop
        if unsigned(routine) = number and there(number) = '0' then
          return false;
        end if;
      end loop;
      return true;
    end function;
  begin
    holds := (row(true_f) and not facts_now) = (facts_t'range => '0');
    if unsigned(row(group_f)) /= 0 then
      holds := holds and returns(row(group_f), row_1) and
               (row_1(kept_f) and not facts_now) = (facts_t'range => '0');
      if unsigned(row_1(group_f)) /= 0 then
        holds := holds and returns(row_1(group_f), row_2) and
                 (row_2(kept_f) and not facts_now) = (facts_t'range => '0') and unsigned(row_2(group_f)) = 0;
      end if;
    end if;
    table_holds <= holds;
    flow_holds  <= current < facts'length / 24 and instruction = plain_program(to_integer(current)) and
                   position = current + 1 and (acts or tells or notes) = "000000000" and
                   (store or put or loads or loads_carry or points or goes_on or moves or follows) = '0';
  end process;

  steps : entity work.small_steps
    generic map (
      at_now => at_now, at_open_new => at_open_new,
      at_listen => at_listen, at_decode_end => at_decode_end, at_is_long => at_is_long,
      at_no_session => at_no_session, at_is_wrong => at_is_wrong, at_judged => at_judged,
      at_judged_kind => at_judged_kind, at_drop => at_drop, at_judge => at_judge, at_distance => at_distance,
      at_not_new => at_not_new, at_put_reply => at_put_reply, at_remember => at_remember, at_slot => at_slot,
      at_fails => at_fails, at_post => at_post, at_session => at_session, at_session_place => at_session_place,
      at_bump => at_bump, at_clear => at_clear, places => byte_places)
    port map (
      current => current, caller => caller, a => a, x => x, carry => carry, b => byte_of, place_low => place(0),
      id => id, place_id => place_id, posts => posts, wanted => wanted, watched => watched, holds => steps_hold);

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or resets = '1';

  -- The watched place is any, and stays the same.
  one_is_watched : assume always begun = '1' -> watched = watched_before;

  -- The kind of a frame in the ring is one that was stored there when the frame was checked (see kind_is_known).
  ring_keeps : assume always starts = '1' and current = at_now + 8 ->
               is_kind(any_now);

  -- The processor is at the place that the table names, with the instruction that the program has there.
  in_program : assert always begun = '1' and starts = '1' -> flow_holds;

  -- The facts of the table are true at their places, and each call returns to where it came from.
  facts_are_true : assert always begun = '1' and starts = '1' -> table_holds;

  -- Within the routines, accumulator, X and variables have what the source says.
  steps_are_right : assert always begun = '1' and starts = '1' -> steps_hold;

  -- What is stored as the kind of a checked frame is a kind, or the number of a counter of discarded frames.
  kind_is_known : assert always begun = '1' and store = '1' and current = at_judged_kind + 2 ->
                  is_kind(written);

  -- A frame does one thing at most: an access to the bus, a start of the dead-man, or an arming.
  one_effect : assert always begun = '1' and effect = '1' -> effects = 0 and reached = '1';

  -- A request is executed only if its place holds an older id. So a request that was executed is not executed again.
  new_is_executed : assert always begun = '1' and effect = '1' and byte_of(n_kind) /= request_kind_post_c and
                           ours = '1' -> ahead /= 0 and ahead(15) = '0';

  -- A POST is executed only if it is the next one. It is counted before it is executed.
  next_post_is_executed : assert always begun = '1' and effect = '1' and byte_of(n_kind) = request_kind_post_c ->
                          posts = id + 1;

  -- When a request that was executed is done, its place holds its id, unless it was denied or ended the session.
  executed_is_remembered : assert always begun = '1' and starts = '1' and current = at_done and effects = 1 and
                                  byte_of(n_kind) /= request_kind_post_c and ours = '1' and session = '0' and
                                  byte_of(n_status) /= reply_status_denied_c ->
                           place_id = id;

  -- A place changes only when a request is remembered in it, or when a session begins or ends.
  places_stand : assert always begun = '1' and writes = '1' and write_address >= here and write_address < here + 4 ->
                 (current >= at_remember and current < at_remember + 6) or
                 (current >= at_session_place and current < at_session_place + 6);

  -- It goes to a later id only.
  places_go_on : assert always begun = '1' and store = '1' and current = at_remember + 2 and ours = '1' ->
                 write_address = here and ahead /= 0 and ahead(15) = '0';

  -- A request is executed, and done.
  executed_seen : cover {begun = '1' and starts = '1' and current = at_done and effects = 1 and
                         byte_of(n_kind) /= request_kind_post_c and ours = '1'};

end architecture;
