-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of frame_dispatcher: what the framed application begins, and that only work that needs room waits for
-- room.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_pkg.all;

entity frame_dispatcher_formal is
  port (
    clk             : in std_ulogic;
    reset           : in std_ulogic;
    turned          : in std_ulogic;
    tripped         : in std_ulogic;  -- the dead-man has tripped, and the trip is not yet counted
    publish         : in std_ulogic;
    room            : in std_ulogic;  -- there is room for a whole payload
    receive_overrun : in std_ulogic;
    publish_overrun : in std_ulogic;
    frame_valid     : in std_ulogic;
    frame_entry     : in entry_t;
    asks            : in std_ulogic;  -- the program asks for work
    ready_to_begin  : in std_ulogic
  );
end entity;

architecture properties of frame_dispatcher_formal is

  signal begun   : std_ulogic := '0';  -- the reset of power-up is over
  signal pending, begins : std_ulogic;  -- what was chosen in the clock before may begin, and begins
  signal wants   : std_ulogic;
  signal choice  : entry_t;
  signal counted : std_ulogic;
  signal kind    : natural range 0 to 31;
  signal kind_before  : natural range 0 to 31 := 0;
  signal wants_before : std_ulogic := '0';
  signal post    : std_ulogic;         -- the frame is a post, which needs no room
  signal line_overran : std_ulogic := '0';
  signal reports      : std_ulogic;    -- what begins is the overrun of the line
  signal counts       : std_ulogic;    -- what begins is an overrun of a publish
  signal overruns     : natural range 0 to 15 := 0;  -- of publishes, not yet counted

begin

  default clock is rising_edge(clk);

  dut : entity work.frame_dispatcher
    port map (
      clock => clk, reset => reset, turned => turned, tripped => tripped, publish => publish, room => room,
      receive_overrun => receive_overrun, publish_overrun => publish_overrun, frame_valid => frame_valid,
      frame_entry => frame_entry, asks => asks, begins => begins, wants => wants, choice => choice,
      pending => pending, counted => counted);

  begins <= asks and pending and ready_to_begin;
  kind   <= to_integer(unsigned(choice));
  post   <= '1' when unsigned(frame_entry) = 4 or unsigned(frame_entry) = 6 else '0';

  reports <= '1' when kind_before = entry_receive_overrun else '0';
  counts  <= '1' when kind_before = entry_publish_overrun and begins = '1' else '0';

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      kind_before  <= kind;
      wants_before <= wants;
      line_overran <= receive_overrun or (line_overran and not (begins and reports));
      if publish_overrun = '1' and counts = '0' and overruns /= 15 then
        overruns <= overruns + 1;
      elsif publish_overrun = '0' and counts = '1' and overruns /= 0 then
        overruns <= overruns - 1;
      end if;
      if reset = '1' then
        overruns     <= 0;
        line_overran <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The receiver gives only frames. Other entries come from the dispatcher alone.
  frames_are_frames : assume always unsigned(frame_entry) < entry_trip;

  -- A trip is counted before any frame or publish begins, so the count that a host reads is never too low.
  trip_before_frames : assert always begun = '1' and tripped = '1' -> wants = '1' and
                       (kind = entry_trip or kind = entry_half_turn or
                        kind = entry_receive_overrun or kind = entry_publish_overrun);

  -- A publish begins only if there is room for all of it.
  publish_has_room : assert always begun = '1' and wants = '1' and kind = entry_publish ->
                     publish = '1' and room = '1';

  -- If there is room, a publish goes before every frame.
  publish_before_frames : assert always begun = '1' and wants = '1' and publish = '1' and room = '1' ->
                          not (kind < 16);

  -- Without room, a publish does not make a post wait.
  post_goes_on : assert always begun = '1' and frame_valid = '1' and post = '1' and room = '0' -> wants = '1';

  -- An overrun of the line is reported, and nothing else is reported as one.
  overrun_is_told : assert always begun = '1' and kind = entry_receive_overrun and wants = '1' -> line_overran = '1';

  -- An overrun is kept until it is reported.
  overrun_waits : assert always begun = '1' and line_overran = '1' -> wants = '1' and
                  (kind = entry_receive_overrun or kind = entry_half_turn);

  -- An overrun of a publish is counted before any frame or publish begins, also if the next one comes meanwhile.
  publish_overrun_waits : assert always begun = '1' and overruns /= 0 -> wants = '1' and
                          (kind = entry_publish_overrun or kind = entry_receive_overrun or kind = entry_half_turn);

  -- It is counted once.
  publish_overrun_is_told : assert always begun = '1' and kind = entry_publish_overrun and wants = '1' -> overruns /= 0;

  -- Nothing begins without a cause.
  has_a_cause : assert always begun = '1' and wants = '1' and kind < entry_trip -> frame_valid = '1';

  -- What begins was chosen in the clock before.
  begins_what_was_chosen : assert always begun = '1' and begins = '1' -> wants_before = '1';

  -- A trip is counted when it begins.
  trip_is_counted : assert always begun = '1' -> (counted = '1' and begins = '1' and kind_before = entry_trip) or
                    (counted = '0' and (begins = '0' or kind_before /= entry_trip));

  -- A post begins while a publish is due.
  post_seen : cover {begun = '1' and begins = '1' and publish = '1' and kind_before = 4};

  -- A publish begins.
  publish_seen : cover {begun = '1' and begins = '1' and kind_before = entry_publish};

end architecture;
