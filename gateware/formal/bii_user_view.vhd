-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bus-independent interface as its user sees it. The duties of the user are asserted, and those of the bus are
-- assumed. The mirror image is bii_bus_view.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bii_pkg.all;

entity bii_user_view is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    request  : in bii_request_t;
    response : in bii_response_t
  );
end entity;

architecture properties of bii_user_view is
begin

  default clock is rising_edge(clk);

  -- A request stays the same until it is done.
  request_stands : assert always request.valid = '1' and response.done = '0' and reset = '0' ->
                   next (request.valid = '1' and request.write = prev(request.write) and
                         request.address = prev(request.address) and
                         (request.write = '0' or request.data = prev(request.data)));

  -- At least one clock without a request lies between two accesses.
  request_ends : assert always request.valid = '1' and response.done = '1' -> next (request.valid = '0');

  -- `done` comes only with a request.
  done_when_asked : assume always response.done = '0' or request.valid = '1';

  -- The status has one of its three values. In hardware its two bits could hold a fourth.
  status_is_one : assume always response.status = ok or response.status = error or response.status = silent;

end architecture;
