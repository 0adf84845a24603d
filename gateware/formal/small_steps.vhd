-- SPDX-License-Identifier: BSD-3-Clause
--
-- What accumulator, X, carry and variables have at single places of the program of the small engine: within the
-- routines that compare ids and remember them, and where the shared routines store. The proof of small_engine asserts
-- that `holds` is true.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.protocol_pkg.all;
use work.small_facts_pkg.all;

entity small_steps is
  generic (
    at_now, at_open_new, at_listen, at_decode_end, at_is_long, at_no_session, at_is_wrong, at_judged, at_judged_kind,
      at_drop,
      at_judge, at_distance, at_not_new, at_put_reply, at_remember, at_slot, at_fails, at_post, at_session,
      at_session_place, at_bump, at_clear : natural;
    places : natural  -- their first address
  );
  port (
    current         : in  unsigned(9 downto 0);  -- the place in the program
    caller          : in  unsigned(9 downto 0);
    a               : in  number_t;
    x               : in  unsigned(8 downto 0);
    carry           : in  std_ulogic;
    b               : in  bytes_t;               -- the variables
    place_low       : in  number_t;              -- of the id of the watched place
    id, place_id    : in  word16_t;
    posts, wanted   : in  word16_t;
    watched         : in  unsigned(2 downto 0);
    holds           : out boolean
  );
end entity;

architecture properties of small_steps is
begin

  step : process (all) is
    variable ok       : boolean;
    variable its      : boolean;                -- the id whose distance is computed has the watched place
    variable distance : word16_t;               -- to the id of the place
    variable ours     : boolean;                -- the id of the frame has it
    variable ahead    : word16_t;               -- how far it is ahead of that of the place
    variable unlike_post : number_t;            -- in which bits the kind is not that of a POST

    procedure when_at(there : natural; true_there : boolean) is
    begin
      ok := ok and (current /= there or true_there);
    end procedure;
  begin
    ok := true;
    ours  := id(2 downto 0) = watched;
    ahead := id - place_id;
    unlike_post := b(n_kind) xor to_unsigned(request_kind_post_c, 8);

    -- The choice of what to do with a frame.
    when_at(1, x = 16#80#);
    when_at(2, x = 16#80# and a = 16#C8#);
    when_at(at_now + 9, a = b(n_kind));
    when_at(at_now + 10, a = (b(n_kind) and x"80"));
    when_at(at_now + 12, a = b(n_kind));
    when_at(at_now + 13, a = (b(n_kind) xor to_unsigned(request_kind_post_c, 8)));
    when_at(at_drop + 1, a = b(n_kind));

    -- The check of a piece.
    when_at(at_listen + 20, a = b(n_kind));
    when_at(at_listen + 21, a = (b(n_kind) and x"FE"));
    when_at(at_listen + 22, a = ((b(n_kind) and x"FE") xor to_unsigned(request_kind_hello_c, 8)));
    when_at(at_decode_end + 12, a = b(n_outside));
    when_at(at_decode_end + 17, a = b(n_kind));
    when_at(at_decode_end + 18, a = unlike_post);
    when_at(at_decode_end + 19, a = (unlike_post and x"FD"));
    when_at(at_decode_end + 20, a = (unlike_post and x"FD"));
    when_at(at_decode_end + 21, a = (unlike_post and x"4D"));
    when_at(at_decode_end + 22, a = (unlike_post and x"4D"));
    when_at(at_decode_end + 23, a = (unlike_post and x"40"));
    when_at(at_is_long + 1, a < 16#48#);
    when_at(at_no_session + 1, a < 16#48#);
    when_at(at_is_wrong + 1, a < 16#48#);
    when_at(at_judged, a < 16#48#);

    -- `distance`: how far an id is ahead of that of its place.
    its      := wanted(2 downto 0) = watched;
    distance := wanted - place_id;
    when_at(at_distance, caller /= at_judge + 4 or joined(b(n_high), a) = id);
    if current > at_distance and current <= at_distance + 16 then
      ok := ok and joined(b(n_high), b(n_low)) = wanted and (caller /= at_judge + 4 or wanted = id);
    end if;
    if current >= at_distance + 9 and current <= at_distance + 16 then
      ok := ok and b(n_found) = place_of(places, wanted(7 downto 0));
    end if;
    when_at(at_distance + 1, a = wanted(7 downto 0));
    when_at(at_distance + 2, a = (wanted(7 downto 0) and x"07"));
    when_at(at_distance + 3, a = (wanted(7 downto 0) and x"07") and b(n_scratch) = a);
    when_at(at_distance + 4, a = shift_left(wanted(7 downto 0) and x"07", 1));
    when_at(at_distance + 5, a = shift_left(wanted(7 downto 0) and x"07", 1) and b(n_scratch) = a);
    when_at(at_distance + 6, a = shift_left(wanted(7 downto 0) and x"07", 2));
    when_at(at_distance + 7, a = place_of(places, wanted(7 downto 0)));
    when_at(at_distance + 8, a = place_of(places, wanted(7 downto 0)) and x = a);
    when_at(at_distance + 9, x = place_of(places, wanted(7 downto 0)));
    when_at(at_distance + 10, x = place_of(places, wanted(7 downto 0)) and a = wanted(7 downto 0));
    when_at(at_distance + 11, not its or (a = distance(7 downto 0)));
    when_at(at_distance + 12, not its or b(n_scratch) = distance(7 downto 0));
    when_at(at_distance + 13, not its or (b(n_scratch) = distance(7 downto 0) and a = wanted(15 downto 8)));
    if current >= at_distance + 11 and current <= at_distance + 13 then
      ok := ok and x = place_of(places, wanted(7 downto 0)) + 1 and
            (not its or carry = to_bit(wanted(7 downto 0) >= place_low));
    end if;
    when_at(at_distance + 14, not its or joined(a, b(n_scratch)) = distance);
    when_at(at_distance + 15, not its or joined(b(n_count), b(n_scratch)) = distance);
    when_at(at_distance + 16, (not its or joined(b(n_count), b(n_scratch)) = distance) and
                              a = place_of(places, wanted(7 downto 0)));

    -- `judge`: whether an id is new.
    when_at(at_judge + 1, a = b(n_id_h));
    when_at(at_judge + 2, b(n_high) = b(n_id_h));
    when_at(at_judge + 3, b(n_high) = b(n_id_h) and a = b(n_id_l));
    when_at(at_judge + 4, a = place_of(places, id(7 downto 0)));
    when_at(at_judge + 6, a = b(n_count));
    when_at(at_judge + 7, a = (b(n_count) or b(n_scratch)));
    if current >= at_judge + 4 and current <= at_judge + 10 then
      ok := ok and (not ours or joined(b(n_count), b(n_scratch)) = ahead);
    end if;
    if current >= at_judge + 8 and current <= at_judge + 10 then
      ok := ok and (not ours or ahead /= 0);
    end if;
    when_at(at_judge + 9, a = b(n_count));
    when_at(at_judge + 10, a = (b(n_count) and x"80"));
    when_at(at_put_reply + 3, a = b(n_repeated));

    -- `remember`, and the places of a new session.
    when_at(at_remember + 1, a = place_of(places, id(7 downto 0)));
    when_at(at_remember + 2, x = place_of(places, id(7 downto 0)));
    when_at(at_remember + 3, x = place_of(places, id(7 downto 0)) + 1 and (not ours or place_low = b(n_id_l)));
    when_at(at_remember + 4, x = place_of(places, id(7 downto 0)) + 2);
    when_at(at_remember + 5, x = place_of(places, id(7 downto 0)) + 3);
    when_at(at_session + 4, a = 0);
    when_at(at_session + 5, a = 16#F8#);
    when_at(at_session_place, a >= 16#F8# and x = place_of(places, a));
    when_at(at_session_place + 1, a >= 16#F8# and x = place_of(places, a) + 1);
    when_at(at_session_place + 2, b(n_scratch) >= 16#F8# and x = place_of(places, b(n_scratch)) + 1);
    when_at(at_session_place + 3, b(n_scratch) >= 16#F8# and x = place_of(places, b(n_scratch)) + 1);
    when_at(at_session_place + 4, b(n_scratch) >= 16#F8# and x = place_of(places, b(n_scratch)) + 2);
    when_at(at_session_place + 5, b(n_scratch) >= 16#F8# and x = place_of(places, b(n_scratch)) + 3);
    if current >= at_session_place + 6 and current <= at_session_place + 8 then
      ok := ok and b(n_scratch) >= 16#F8# and x(8 downto 7) = "01" and
            x(6 downto 0) = resize(place_of(places, b(n_scratch)) + 4, 7);
    end if;
    when_at(at_session_place + 7, a = b(n_scratch));
    when_at(at_session_place + 8, a = b(n_scratch) + 1);

    -- A POST, and what becomes of a failure.
    when_at(at_post + 5, a = b(n_id_l));
    when_at(at_post + 6, a = b(n_id_l) - b(n_posts_l));
    when_at(at_post + 7, b(n_scratch) = b(n_id_l) - b(n_posts_l));
    when_at(at_post + 8, b(n_scratch) = b(n_id_l) - b(n_posts_l) and a = b(n_id_h));
    if current >= at_post + 6 and current <= at_post + 8 then
      ok := ok and carry = to_bit(b(n_id_l) >= b(n_posts_l));
    end if;
    when_at(at_post + 9, joined(a, b(n_scratch)) = id - posts);
    when_at(at_post + 10, joined(b(n_count), b(n_scratch)) = id - posts and a = b(n_count));
    when_at(at_post + 11, joined(b(n_count), b(n_scratch)) = id - posts and a = (b(n_count) or b(n_scratch)));
    when_at(at_post + 12, id = posts);
    when_at(at_post + 13, id = posts and a = b(n_posts_l));
    when_at(at_post + 14, id = posts and a = b(n_posts_l) + 1 and carry = to_bit(b(n_posts_l) = 16#FF#));
    if current >= at_post + 15 and current <= at_post + 17 then
      ok := ok and b(n_posts_l) = b(n_id_l) + 1 and b(n_posts_h) = b(n_id_h);
    end if;
    when_at(at_post + 15, carry = to_bit(b(n_id_l) = 16#FF#));
    when_at(at_post + 16, carry = to_bit(b(n_id_l) = 16#FF#) and a = b(n_id_h));
    when_at(at_post + 17, joined(a, b(n_posts_l)) = id + 1);
    when_at(at_fails + 2, a = b(n_kind));
    when_at(at_fails + 3, a = (b(n_kind) xor to_unsigned(request_kind_post_c, 8)));
    when_at(at_fails + 5, a = b(n_status));
    when_at(at_fails + 6, a = (b(n_status) xor to_unsigned(reply_status_denied_c, 8)));

    -- An OPEN stores its nonce and epoch.
    when_at(at_open_new + 13, x = 16#CE#);
    when_at(at_open_new + 14, x = 16#CF#);
    when_at(at_open_new + 16, x = 16#CA#);
    when_at(at_open_new + 17, x = 16#CB#);

    -- Shared routines: where they store.
    when_at(at_bump + 6, a = x(7 downto 0));
    when_at(at_bump + 7, a = (x(7 downto 0) and x"03"));
    when_at(at_bump + 8, x(1 downto 0) /= 0);
    when_at(at_bump + 9, x(1 downto 0) /= 0 and a = x(7 downto 0));
    when_at(at_bump + 10, a = x(7 downto 0) - 1);
    when_at(at_bump + 11, x(1 downto 0) = 0);
    when_at(at_bump + 12, x(1 downto 0) = 0);
    when_at(at_bump + 13, x(1 downto 0) = 1);
    when_at(at_bump + 14, x(1 downto 0) = 2);
    when_at(at_bump + 15, x(1 downto 0) = 3);
    when_at(at_clear, x(8) = '1' or (x = 16#80# and a = 16#C8#));
    when_at(at_clear + 1, x(8) = '1' or (x >= 16#80# and x < 16#C8# and b(n_scratch) = 16#C8#));
    if current >= at_clear + 2 and current <= at_clear + 4 then
      ok := ok and (x(8) = '1' or (x > 16#80# and x <= 16#C8# and b(n_scratch) = 16#C8#));
    end if;
    when_at(at_clear + 3, a = x(7 downto 0));
    when_at(at_clear + 4, a = 0 or a = (x(7 downto 0) xor b(n_scratch)));
    when_at(at_clear + 5, a = 0);
    when_at(at_slot + 1, a = b(n_record));
    when_at(at_slot + 2, a <= 16#1C#);
    when_at(at_slot + 3, a <= 16#1C# and b(n_scratch) <= 16#1C#);
    when_at(at_slot + 4, a <= 16#38#);
    holds <= ok;
  end process;

end architecture;
