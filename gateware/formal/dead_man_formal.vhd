-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the dead-man, whatever happens around it: signs of life come or stay away at any clock, the applications ask
-- of the bus what they like when they like, or stand still for ever, with the bus held or not, and the bus refuses, or is
-- silent. A tick comes every 4 clocks; there are two safe values; an access takes up to 3 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;

entity dead_man_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    request  : in dead_man_request_t;
    asked    : in bii_request_t;
    response : in bii_response_t     -- of the bus
  );
end entity;

architecture properties of dead_man_formal is

  constant period       : positive := 4;
  constant ticks_most   : positive := 3;
  constant access_most  : positive := 3;
  constant values       : safe_values_t(0 to 1) := ((address => x"00000001", value => x"00000005"),
                                                    (address => x"00000002", value => x"0000000A"));
  -- From a trip to the end of the last safe write: the access that was on the bus, then each with a clock before it; and the
  -- first clock of the first one was before the trip.
  constant written_most : positive := (values'length + 1) * (access_most + 1) - 2;

  -- From an answer to the next tick, and all values anew; they may just have begun.
  constant heard_most   : positive := period + 2 * written_most;

  signal begun    : std_ulogic := '0';
  signal state    : dead_man_response_t;
  signal tripped  : std_ulogic;
  signal answered : bii_response_t;
  signal bii      : bii_request_t;

  -- The moment.
  signal watched  : std_ulogic := '0';                                    -- it was started, and nothing has ended that
  signal limit    : natural range 0 to ticks_most := 0;
  signal since    : natural range 0 to period * ticks_most + 1 := 0;      -- clocks behind the last sign of life
  signal may_arm  : std_ulogic;                                           -- a session has begun with the trip or since
  signal renewed, renewed_before : std_ulogic := '0';
  signal tripped_before, armed_before, commanded_before : std_ulogic := '0';

  -- The bus. What the applications ask has the highest bit of its address set, which the bus does not look at.
  signal waited   : natural range 0 to access_most := 0;        -- clocks of this access so far
  signal theirs   : std_ulogic;                                 -- it is one of the applications
  signal earlier  : std_ulogic := '0';                          -- and began before the trip
  signal ends     : std_ulogic;
  signal asked_on : std_ulogic := '0';                          -- what is asked has been on the bus
  signal is_safe  : std_ulogic_vector(values'range);            -- which safe write is on the bus
  signal made     : std_ulogic_vector(values'range) := "00";    -- which are made, since an application wrote
  signal answers  : std_ulogic_vector(values'range) := "00";    -- and answered
  signal behind   : natural range 0 to written_most := 0;       -- clocks behind the trip
  signal heard    : natural range 0 to heard_most := 0;         -- and of no value without an answer

  function to_bit(what : boolean) return std_ulogic is
  begin
    if what then
      return '1';
    end if;
    return '0';
  end function;

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
      is_safe(number) <= bii.valid and bii.write and not theirs and to_bit(bii.address(1 downto 0) = values(number).address(1 downto 0) and
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
      if tripped = '0' then
        behind <= 0;
        heard  <= 0;
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

  -- The design is reset when it wakes up, and at any later moment.
  reset_first : assume always begun = '1' or reset = '1';

  -- No more ticks than are counted here.
  few_ticks : assume always unsigned(request.ticks) <= ticks_most;

  -- What is asked stands until it is done, as applications are proven.
  asked_stands : assume always asked.valid = '1' and answered.done = '0' and reset = '0' ->
                 next (asked.valid = '1' and asked.write = prev(asked.write) and asked.address = prev(asked.address) and
                       (asked.write = '0' or asked.data = prev(asked.data)));

  -- One access follows another after a clock without, as applications are proven.
  asked_ends : assume always asked.valid = '1' and answered.done = '1' -> next (asked.valid = '0');

  -- A reset is one of the applications, too.
  asked_is_reset : assume always reset = '1' -> next (asked.valid = '0');

  -- The mark of what the applications ask.
  asked_is_marked : assume always asked.address(31) = '1';

  -- Every access ends in time, as bus masters are proven.
  bus_answers : assume always waited < access_most - 1 or bii.valid = '0' or response.done = '1';

  -- It trips at the tick that makes the silence too long, and never later.
  trips_in_time : assert always begun = '1' and watched = '1' and tripped = '0' -> since <= period * limit - 1;

  -- Nor earlier than one tick before, unless it is told to.
  trips_for_a_reason : assert always begun = '1' and tripped = '1' and tripped_before = '0' and reset = '0' ->
                       commanded_before = '1' or since >= period * (limit - 1) + 1;

  -- It is `running` whenever it was started, and nothing has ended that.
  runs : assert always begun = '1' and watched = '1' -> state.running = '1' or tripped = '1';

  -- Only `arm` ends a trip, and only in another session, but for a reset.
  trip_stays : assert always begun = '1' and tripped_before = '1' and tripped = '0' -> armed_before = '1';

  -- It is told as it is.
  told : assert always begun = '1' -> state.tripped = tripped;

  -- From the trip on no write of an application begins on the bus, also none that it had decided on before.
  only_safe_writes : assert always begun = '1' and tripped = '1' and bii.valid = '1' and bii.write = '1' ->
                     or is_safe = '1' or earlier = '1';

  -- All safe values are written in time, whatever the applications do, or fail to do.
  all_safe_in_time : assert always begun = '1' and tripped = '1' and behind = written_most -> and made = '1';

  -- One that nobody answered is written anew, until all are answered.
  all_answered : assert always begun = '1' and tripped = '1' and heard = heard_most -> and answers = '1';

  -- While they are, nothing holds the bus.
  hold_ends : assert always begun = '1' and tripped = '1' and made /= "11" -> bii.block_hold = '0';

  -- An application's access is answered by the bus, if it was there; or else it is a write behind a trip, and `denied`.
  answered_by_the_bus : assert always begun = '1' and asked.valid = '1' and answered.done = '1' ->
                        (ends = '1' and answered.status = response.status and answered.data = response.data and
                         bii.write = asked.write and bii.address(1 downto 0) = asked.address(1 downto 0)) or
                        (asked.write = '1' and tripped = '1' and asked_on = '0' and answered.status = denied);

  -- Nothing is answered that was not asked.
  answers_what_is_asked : assert always begun = '1' and answered.done = '1' -> asked.valid = '1';

  -- A trip while a write of an application is on the bus.
  earlier_seen : cover {begun = '1' and tripped = '1' and earlier = '1' and bii.write = '1'};

  -- All is written.
  written_seen : cover {begun = '1' and tripped = '1' and and made = '1'};

  -- As late as may be.
  latest_seen : cover {begun = '1' and tripped = '1' and behind = written_most - 1 and nand made = '1'};

  -- A write is denied.
  denied_seen : cover {begun = '1' and answered.done = '1' and answered.status = denied};

  -- A value that nobody answered is, later.
  again_seen : cover {begun = '1' and tripped = '1' and heard > 1 and behind = written_most and and answers = '1'};

  -- Armed, and running again.
  armed_seen : cover {begun = '1' and armed_before = '1' and tripped_before = '1' and tripped = '0'};

end architecture;
