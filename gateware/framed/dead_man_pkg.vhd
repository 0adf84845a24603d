-- SPDX-License-Identifier: BSD-3-Clause
--
-- The signals between the framed side and the dead-man.

library ieee;
  use ieee.std_logic_1164.all;

use work.frame_layout_pkg.all;

package dead_man_pkg is

  -- To the dead-man: one-clock pulses, and the ticks that go with `start`.
  type dead_man_request_t is record
    alive   : std_ulogic;  -- an intact frame of the session has arrived
    start   : std_ulogic;  -- count silence from now on, up to `ticks`; 0: do not count
    ticks   : word32_t;
    trip    : std_ulogic;  -- trip now, if it runs
    renew   : std_ulogic;  -- a session begins or ends: it stops running, and `arm` works again
    arm     : std_ulogic;  -- the bus may be written again; works only in a session in which it has not tripped
    counted : std_ulogic;  -- `uncounted` was seen
  end record;

  constant dead_man_request_idle : dead_man_request_t := (ticks => (others => '0'), others => '0');

  -- From the dead-man.
  type dead_man_response_t is record
    running     : std_ulogic;
    tripped     : std_ulogic;  -- it has tripped, and nobody has armed it since
    tripped_now : std_ulogic;  -- it has tripped in this session
    uncounted   : std_ulogic;  -- it has tripped since `counted`
  end record;

  constant dead_man_response_idle : dead_man_response_t := (others => '0');

end package;
