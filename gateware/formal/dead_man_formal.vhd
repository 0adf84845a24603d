-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the dead-man under all conditions. Signs of life come or stay away at any clock. The applications ask
-- the bus for anything at any time, or stop for ever, with the bus held or not. The bus may refuse an access or stay
-- silent. A tick comes every 4 clocks, there are two safe values, and an access takes up to 3 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.bit_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;

entity dead_man_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    request  : in dead_man_request_t;
    asked    : in bii_request_t;
    response : in bii_response_t     -- the answer of the bus
  );
end entity;

architecture properties of dead_man_formal is

  constant period       : positive := 4;
  constant ticks_most   : positive := 3;
  constant access_most  : positive := 3;
  constant values       : safe_values_t(0 to 1) := ((address => x"00000001", value => x"00000005"),
                                                    (address => x"00000002", value => x"0000000A"));
  -- Clocks from a trip to the end of the last safe write. First the access that was on the bus ends. Then come the safe
  -- writes, each with a clock before it. The first clock of the first safe write was before the trip.
  constant written_most : positive := (values'length + 1) * (access_most + 1) - 2;

  -- Clocks from an answer to the end of the next tick's writes. The writes before them may just have begun.
  constant heard_most   : positive := period + 2 * written_most;

  signal begun    : std_ulogic := '0';
  signal state    : dead_man_response_t;
  signal tripped  : std_ulogic;
  signal answered : bii_response_t;
  signal bii      : bii_request_t;

  -- Time.
  signal watched  : std_ulogic := '0';                                    -- it was started, and still counts
  signal limit    : natural range 0 to ticks_most := 0;
  signal since    : natural range 0 to period * ticks_most + 1 := 0;      -- clocks since the last sign of life
  signal may_arm  : std_ulogic;                                           -- a session has begun since the trip or at it
  signal renewed, renewed_before : std_ulogic := '0';
  signal tripped_before, armed_before, commanded_before : std_ulogic := '0';

  -- The bus. Requests of the applications are marked by the highest bit of the address. The bus ignores this bit.
  signal waited   : natural range 0 to access_most := 0;        -- clocks of this access so far
  signal theirs   : std_ulogic;                                 -- the access belongs to an application
  signal earlier  : std_ulogic := '0';                          -- and it began before the trip
  signal ends     : std_ulogic;
  signal asked_on : std_ulogic := '0';                          -- the request of the applications has been on the bus
  signal is_safe  : std_ulogic_vector(values'range);            -- which safe write is on the bus
  signal made     : std_ulogic_vector(values'range) := "00";    -- safe writes made since an application last wrote
  signal answers  : std_ulogic_vector(values'range) := "00";    -- safe writes answered
  signal behind   : natural range 0 to written_most := 0;       -- clocks since the trip
  signal heard    : natural range 0 to heard_most := 0;         -- clocks since the trip, or an unanswered safe write
  signal armed    : natural range 0 to written_most := 0;       -- clocks without a trip

begin

  default clock is rising_edge(clk);

  dut : entity work.dead_man
    generic map (address_width => 2, data_width => 8, clock_hz => period, base_hz => 1, safe_values => values)
    port map (
      clock => clk, reset => reset, request => request, response => state, tripped => tripped,
      asked => asked, answered => answered, bii_request => bii, bii_response => response);

  bus_side : entity work.bii_user_view port map (clk => clk, reset => reset, request => bii, response => response);

  ends   <= bii.valid and response.done;
  theirs <= bii.address(31);

  may_arm <= renewed_before when tripped = '1' and tripped_before = '0' else renewed;

  recognise : process (all) is
  begin
    for number in values'range loop
      is_safe(number) <= bii.valid and bii.write and not theirs and
                         to_bit(bii.address(1 downto 0) = values(number).address(1 downto 0) and
                                bii.data(7 downto 0) = values(number).value(7 downto 0));
    end loop;
  end process;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';

      if since < period * ticks_most + 1 then
        since <= since + 1;
      end if;
      if request.alive = '1' or request.start = '1' then
        since <= 0;
      end if;
      if request.start = '1' then
        watched <= or request.ticks and not tripped;
        limit   <= to_integer(unsigned(request.ticks(1 downto 0)));
      end if;
      if request.renew = '1' then
        watched <= '0';
      end if;
      tripped_before   <= tripped;
      armed_before     <= request.arm and may_arm;
      renewed          <= may_arm or request.renew;
      renewed_before   <= request.renew;
      commanded_before <= request.trip;
      if tripped = '1' and tripped_before = '0' then
        watched <= '0';
      end if;

      if bii.valid = '1' and response.done = '0' then
        if waited < access_most then
          waited <= waited + 1;
        end if;
      else
        waited <= 0;
      end if;
      earlier  <= bii.valid and theirs and not response.done and (earlier or not tripped);
      asked_on <= asked.valid and not answered.done and (asked_on or (bii.valid and theirs));

      if ends = '1' then
        if theirs = '1' and bii.write = '1' then
          made    <= "00";
          answers <= "00";
        else
          made <= made or is_safe;
          if response.status /= silent then
            answers <= answers or is_safe;
          end if;
        end if;
      end if;
      if behind < written_most then
        behind <= behind + 1;
      end if;
      if heard < heard_most then
        heard <= heard + 1;
      end if;
      if ends = '1' and or is_safe = '1' and response.status = silent then
        heard <= 0;
      end if;
      if armed < written_most then
        armed <= armed + 1;
      end if;
      if tripped = '0' then
        behind <= 0;
        heard  <= 0;
      else
        armed <= 0;
      end if;

      if reset = '1' then
        watched <= '0';
        waited  <= 0;
        earlier <= '0';
        made    <= "00";
        answers <= "00";
        behind  <= 0;
        heard   <= 0;
        asked_on       <= '0';
        tripped_before <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There are no more ticks than this file counts.
  few_ticks : assume always unsigned(request.ticks) <= ticks_most;

  -- A request stays the same until it is done. This is proven for the applications.
  asked_stands : assume always asked.valid = '1' and answered.done = '0' and reset = '0' ->
                 next (asked.valid = '1' and asked.write = prev(asked.write) and asked.address = prev(asked.address) and
                       (asked.write = '0' or asked.data = prev(asked.data)));

  -- At least one clock without a request lies between two accesses. This is proven for the applications.
  asked_ends : assume always asked.valid = '1' and answered.done = '1' -> next (asked.valid = '0');

  -- A reset also resets the applications.
  asked_is_reset : assume always reset = '1' -> next (asked.valid = '0');

  -- Requests of the applications have the mark.
  asked_is_marked : assume always asked.address(31) = '1';

  -- Every access ends in time. This is proven for bus masters.
  bus_answers : assume always waited < access_most - 1 or bii.valid = '0' or response.done = '1';

  -- The dead-man trips at the tick at which the silence is too long, and never later.
  trips_in_time : assert always begun = '1' and watched = '1' and tripped = '0' -> since <= period * limit - 1;

  -- It trips at most one tick earlier than that, unless `trip` asks for it.
  trips_for_a_reason : assert always begun = '1' and tripped = '1' and tripped_before = '0' and reset = '0' ->
                       commanded_before = '1' or since >= period * (limit - 1) + 1;

  -- `running` is high from the start until something ends the watch.
  runs : assert always begun = '1' and watched = '1' -> state.running = '1' or tripped = '1';

  -- Only `arm` or a reset ends a trip. `arm` works only in another session.
  trip_stays : assert always begun = '1' and tripped_before = '1' and tripped = '0' -> armed_before = '1';

  -- It trips once: it does not run until it is armed.
  trips_once : assert always begun = '1' and tripped = '1' -> state.running = '0';

  -- The reported state is the state of the output.
  told : assert always begun = '1' -> state.tripped = tripped;

  -- After the trip no write of an application begins on the bus. This includes writes that an application had decided
  -- on before.
  only_safe_writes : assert always begun = '1' and tripped = '1' and bii.valid = '1' and bii.write = '1' ->
                     or is_safe = '1' or earlier = '1';

  -- All safe values are written in time, whatever the applications do or fail to do.
  all_safe_in_time : assert always begun = '1' and tripped = '1' and behind = written_most -> and made = '1';

  -- A safe write without an answer is repeated until all are answered.
  all_answered : assert always begun = '1' and tripped = '1' and heard = heard_most -> and answers = '1';

  -- Without a write that had no answer they are not repeated.
  again_for_a_reason : assert always begun = '1' and tripped = '1' and heard = heard_most -> nor is_safe = '1';

  -- `arm` ends the repetition: at most the writes under way are finished.
  arm_ends_it : assert always begun = '1' and tripped = '0' and armed = written_most -> nor is_safe = '1';

  -- Nothing holds the bus while safe values are written.
  hold_ends : assert always begun = '1' and tripped = '1' and made /= "11" -> bii.block_hold = '0';

  -- The answer to an application's access comes from the bus if the access was there. Otherwise the access is a write
  -- after a trip, and the answer is `denied`.
  answered_by_the_bus : assert always begun = '1' and asked.valid = '1' and answered.done = '1' ->
                        (ends = '1' and answered.status = response.status and answered.data = response.data and
                         bii.write = asked.write and bii.address(1 downto 0) = asked.address(1 downto 0)) or
                        (asked.write = '1' and tripped = '1' and asked_on = '0' and answered.status = denied);

  -- There is no answer without a request.
  answers_what_is_asked : assert always begun = '1' and answered.done = '1' -> asked.valid = '1';

  -- A trip comes while a write of an application is on the bus.
  earlier_seen : cover {begun = '1' and tripped = '1' and earlier = '1' and bii.write = '1'};

  -- All safe values are written.
  written_seen : cover {begun = '1' and tripped = '1' and and made = '1'};

  -- The last safe write comes as late as possible.
  latest_seen : cover {begun = '1' and tripped = '1' and behind = written_most - 1 and nand made = '1'};

  -- A write is denied.
  denied_seen : cover {begun = '1' and answered.done = '1' and answered.status = denied};

  -- A value that had no answer is answered later.
  again_seen : cover {begun = '1' and tripped = '1' and heard > 1 and behind = written_most and and answers = '1'};

  -- The dead-man is armed, and runs again.
  armed_seen : cover {begun = '1' and armed_before = '1' and tripped_before = '1' and tripped = '0'};

end architecture;
