-- SPDX-License-Identifier: BSD-3-Clause
--
-- The rules on which the framed transmitter relies. Its proof assumes them, and the proof of frame_application asserts
-- them.

library ieee;
  use ieee.std_logic_1164.all;

use work.frame_pkg.all;

package one_thing_pkg is

  -- The program does one thing at a time. It gives the kind once for each payload, not after the payload's end, and
  -- nothing while the transmitter is not ready. `given` is high once the payload in hand has its kind.
  function one_thing(reply : frame_reply_t; given : std_ulogic; ready : std_ulogic) return boolean;

end package;

package body one_thing_pkg is

  function one_thing(reply : frame_reply_t; given : std_ulogic; ready : std_ulogic) return boolean is
  begin
    return (reply.put = '0' or (reply.kind or reply.restart or reply.finish) = '0') and
           (reply.restart = '0' or reply.finish = '0') and
           (reply.kind = '0' or (given = '0' and reply.restart = '0' and
                                 (reply.data(7 downto 4) = x"C" or reply.data(7 downto 2) = "110100"))) and
           (reply.finish = '0' or given = '1' or reply.kind = '1') and
           (ready = '1' or (reply.put or reply.kind or reply.restart or reply.finish) = '0');
  end function;

end package body;
