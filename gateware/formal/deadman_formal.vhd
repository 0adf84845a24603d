-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of what the dead-man is made of beside its program: the ticks of frame_clock and what frame_dispatcher lets begin.
-- A tick comes every four clocks here.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_pkg.all;

entity deadman_formal is
  port (
    clk             : in std_ulogic;
    reset           : in std_ulogic;
    running         : in std_ulogic;  -- the dead-man is
    look            : in std_ulogic;  -- at the clock's highest bit
    publish         : in std_ulogic;
    receive_overrun : in std_ulogic;
    publish_overrun : in std_ulogic;
    frame_valid     : in std_ulogic;
    frame_entry     : in entry_t;
    ready_to_begin  : in std_ulogic   -- the program asks for work
  );
end entity;

architecture properties of deadman_formal is

  constant period : positive := 4;

  signal begun    : std_ulogic := '0';  -- the reset of power-up is over
  signal ticking, seen, turned, half, heard, pending, begins : std_ulogic;
  signal entry    : entry_t;
  signal time_now : unsigned(31 downto 0);
  signal kind     : natural range 0 to 31;

  signal phase    : natural range 0 to period - 1 := 0;  -- clocks since the last tick
  signal due      : std_ulogic := '0';  -- a tick has come that was not taken
  signal alive    : std_ulogic := '0';  -- a frame of the session has begun since the last tick was taken
  signal line_overran : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  timer : entity work.frame_clock
    generic map (clock_hz => period, base_hz => 1)
    port map (
      clock => clk, reset => reset, time_now => time_now, half => half, look => look, turned => turned,
      running => running, ticking => ticking, seen => seen);

  dispatcher : entity work.frame_dispatcher
    port map (
      clock => clk, reset => reset, turned => turned, ticking => ticking, publish => publish,
      receive_overrun => receive_overrun, publish_overrun => publish_overrun, frame_valid => frame_valid,
      frame_entry => frame_entry, begins => begins, pending => pending, entry => entry, heard => heard);

  begins <= pending and ready_to_begin;
  kind   <= to_integer(unsigned(entry));
  seen   <= '1' when begins = '1' and kind = entry_tick else '0';

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if seen = '1' then
        due   <= '0';
        alive <= '0';
      elsif begins = '1' and kind < 16 then
        alive <= '1';
      end if;
      if phase = period - 1 then
        phase <= 0;
        due   <= running;
      else
        phase <= phase + 1;
      end if;
      line_overran <= receive_overrun or (line_overran and not (begins and entry ?= std_ulogic_vector(to_unsigned(entry_receive_overrun, 5))));
      if reset = '1' then
        phase        <= 0;
        due          <= '0';
        alive        <= '0';
        line_overran <= '0';
      end if;
    end if;
  end process;

  -- The design is reset when it wakes up, and at any later moment.
  reset_first : assume always begun = '1' or reset = '1';

  -- The receiver tells frames, not what only the dispatcher knows.
  frames_are_frames : assume always unsigned(frame_entry) < entry_tick;

  -- A tick waits if one is due, to the clock: every so many clocks while the dead-man runs, and none otherwise.
  ticks_on_time : assert always begun = '1' -> ticking = due;

  -- While one waits no frame and no publish begins: a host that floods the link cannot put the dead-man off.
  tick_before_frames : assert always begun = '1' and due = '1' and begins = '1' -> kind = entry_tick or kind = entry_half_turn or
                       kind = entry_receive_overrun or kind = entry_publish_overrun;

  -- Only a frame of the session that was begun since the last tick counts as a sign of life: no HELLO, nothing dropped.
  heard_is_true : assert always begun = '1' -> heard = alive;

  -- An overrun of the line is told, and nothing else is taken for one.
  overrun_is_told : assert always begun = '1' and kind = entry_receive_overrun and pending = '1' -> line_overran = '1';

  -- It is not forgotten before it is told.
  overrun_waits : assert always begun = '1' and line_overran = '1' -> pending = '1' and
                  (kind = entry_receive_overrun or kind = entry_half_turn);

  -- Nothing begins without a cause.
  has_a_cause : assert always begun = '1' and pending = '1' and kind < entry_tick -> frame_valid = '1';

  -- A tick without a sign of life.
  silent_seen : cover {begun = '1' and seen = '1' and heard = '0'};

  -- And one with.
  alive_seen : cover {begun = '1' and seen = '1' and heard = '1'};

end architecture;
