-- SPDX-License-Identifier: BSD-3-Clause
--
-- Gives the bus and the publish groups to the classic or to the framed application, message by message.
--
-- Ports     For each application: busy (it is in a message), may_begin (it may begin one), its requests to bus and
--           subscription manager. framed_wants: the framed application has a message to begin.
-- Latency   None of its own.
-- Arbitration  The framed application begins whenever the classic one is in no message. The classic one begins only if
--              the framed one is in no message and has none to begin.

library ieee;
  use ieee.std_logic_1164.all;

use work.bii_pkg.all;
use work.subscription_pkg.all;

entity application_switch is
  port (
    classic_busy         : in  std_ulogic;
    classic_may_begin    : out std_ulogic;
    classic_subscription : in  subscription_request_t;
    classic_bii          : in  bii_request_t;
    classic_bii_response : out bii_response_t;
    framed_busy          : in  std_ulogic;
    framed_wants         : in  std_ulogic;
    framed_may_begin     : out std_ulogic;
    framed_subscription  : in  subscription_request_t;
    framed_bii           : in  bii_request_t;
    framed_bii_response  : out bii_response_t;
    subscription_request : out subscription_request_t;
    bii_request          : out bii_request_t;
    bii_response         : in  bii_response_t
  );
end entity;

architecture rtl of application_switch is
begin

  framed_may_begin  <= not classic_busy;
  classic_may_begin <= not framed_busy and not framed_wants;

  subscription_request <= framed_subscription when framed_busy = '1' else classic_subscription;
  bii_request          <= framed_bii when framed_busy = '1' else classic_bii;

  respond : process (all)
  begin
    classic_bii_response <= bii_response;
    framed_bii_response  <= bii_response;
    if framed_busy = '1' then
      classic_bii_response.done <= '0';
    else
      framed_bii_response.done <= '0';
    end if;
  end process;

end architecture;
