-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the reply cache: its verdicts on an id, compared with the full ids that were executed. The assumptions
-- describe the program: it remembers an id only after the cache has called it new.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_layout_pkg.all;
use work.protocol_pkg.all;

entity reply_cache_formal is
  port (
    clk          : in std_ulogic;
    id           : in std_ulogic_vector(15 downto 0);
    one_before   : in std_ulogic;
    remember     : in std_ulogic;
    status_in    : in std_ulogic_vector(3 downto 0);
    forget       : in std_ulogic;
    forget_index : in unsigned(6 downto 0);
    start        : in std_ulogic;
    keep         : in std_ulogic;
    data_in      : in byte_t;
    recall       : in std_ulogic;
    entry        : in std_ulogic_vector(23 downto 0)  -- of the design: the place that was looked up
  );
end entity;

architecture properties of reply_cache_formal is

  constant window : positive := 2;

  subtype turn_t is unsigned(14 downto 0);

  signal new_id, repeated, order, too_long : std_ulogic;
  signal status   : std_ulogic_vector(3 downto 0);
  signal kept     : unsigned(4 downto 0);
  signal data_out : byte_t;

  -- The last id executed in each place. There are two places: even and odd ids.
  signal last_0, last_1     : turn_t := (others => '1');
  signal status_0, status_1 : std_ulogic_vector(3 downto 0) := "0000";
  signal known_0, known_1   : std_ulogic := '0';  -- the place has been written
  signal last        : turn_t;
  signal last_status : std_ulogic_vector(3 downto 0);
  signal known       : std_ulogic;
  signal distance    : turn_t;                     -- of `id` a clock ago; while `looks`, it is that of now, too

  signal steady      : natural range 0 to 2 := 0;  -- clocks without a change of the cache
  signal id_now, id_then : std_ulogic_vector(15 downto 0) := (others => '0');  -- of the last two clocks
  signal before_now, before_then : std_ulogic := '0';
  signal place_now   : std_ulogic;
  signal looks       : std_ulogic;                 -- the verdict is about `id`

begin

  default clock is rising_edge(clk);

  dut : entity work.reply_cache
    generic map (window => window)
    port map (
      clock => clk, id => id, before => one_before, new_id => new_id,
      repeated => repeated, order => order, status => status, kept => kept, too_long => too_long, remember => remember,
      status_in => status_in, forget => forget, forget_index => forget_index, start => start, keep => keep,
      data_in => data_in, recall => recall, data_out => data_out);

  last        <= last_1 when id(0) = '1' else last_0;
  last_status <= status_1 when id(0) = '1' else status_0;
  known       <= known_1 when id(0) = '1' else known_0;
  place_now   <= id_now(0);
  looks       <= '1' when steady = 2 and id = id_now and id = id_then and
                         (one_before or before_now or before_then) = '0' and known = '1' else '0';

  watch : process (clk) is
    variable place : std_ulogic;
    variable turn  : turn_t;
  begin
    if rising_edge(clk) then
      id_now      <= id;
      distance    <= unsigned(id(15 downto 1)) - last;
      before_now  <= one_before;
      before_then <= before_now;
      id_then     <= id_now;
      if steady < 2 then
        steady <= steady + 1;
      end if;
      if remember = '1' or forget = '1' then
        steady <= 0;
        place  := id(0);
        turn   := unsigned(id(15 downto 1));
        if forget = '1' then
          place := forget_index(0);
          turn  := (others => '1');
        end if;
        if place = '1' then
          last_1   <= turn;
          status_1 <= status_in;
          known_1  <= '1';
        else
          last_0   <= turn;
          status_0 <= status_in;
          known_0  <= '1';
        end if;
      end if;
    end if;
  end process;

  -- Only an id that the cache calls new is executed, and then remembered.
  new_is_remembered : assume always remember = '1' -> looks = '1' and new_id = '1' and forget = '0';

  -- An executed id has a status other than 1111. A place that is forgotten has the status 1111, which means none.
  status_is_one : assume always (remember = '0' or status_in /= "1111") and (forget = '0' or status_in = "1111");

  -- The place that was looked up holds what was last executed there.
  entry_is_the_last : assert always steady >= 1 and before_now = '0' and
                      ((place_now = '0' and known_0 = '1') or (place_now = '1' and known_1 = '1')) ->
                      (place_now = '1' or (entry(23 downto 9) = not std_ulogic_vector(last_0) and
                                           entry(8 downto 5) = status_0)) and
                      (place_now = '0' or (entry(23 downto 9) = not std_ulogic_vector(last_1) and
                                           entry(8 downto 5) = status_1));

  -- An id that was executed is never new. So it opens the bus once, unless a later id has taken its place.
  never_twice : assert always looks = '1' and distance = 0 -> new_id = '0';

  -- An executed id is `repeated`, with the status it had. An id that was not executed is not `repeated`.
  repeat_is_known : assert always looks = '1' and distance = 0 ->
                    (last_status = "1111" or (repeated = '1' and status = last_status)) and
                    (last_status /= "1111" or repeated = '0');

  -- An id is new if it is later than the last one of its place, counted modulo the range of ids, and only then.
  new_is_later : assert always looks = '1' -> (new_id = '0' or (distance /= 0 and distance(14) = '0')) and
                 (new_id = '1' or distance = 0 or distance(14) = '1');

  -- An id that is neither new nor repeated is stale. So a late copy of an earlier request opens no bus cycle.
  stale_is_neither : assert always looks = '1' and distance(14) = '1' -> new_id = '0' and repeated = '0';

  -- The verdict depends only on the id and on what was last executed in its place. So it stands until something is
  -- remembered or forgotten, whatever is looked up in between. The proof of frame_application assumes this.
  verdict_stands : assert always looks = '1' ->
                   new_id = to_bit(distance /= 0 and distance(14) = '0') and
                   repeated = to_bit(distance = 0 and last_status /= "1111");

  -- A request is executed and then repeated.
  repeat_seen : cover {looks = '1' and repeated = '1'};

  -- A stale request comes.
  stale_seen : cover {looks = '1' and new_id = '0' and repeated = '0' and last_status /= "1111"};

end architecture;
