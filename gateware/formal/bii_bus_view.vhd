-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bus-independent interface as a bus sees it. It is the mirror image of bii_user_view.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bii_pkg.all;

entity bii_bus_view is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    request  : in bii_request_t;
    response : in bii_response_t
  );
end entity;

architecture properties of bii_bus_view is
begin

  default clock is rising_edge(clk);

  -- A request stays the same until it is done.
  request_stands : assume always request.valid = '1' and response.done = '0' and reset = '0' ->
                   next (request.valid = '1' and request.write = prev(request.write) and
                         request.address = prev(request.address) and
                         (request.write = '0' or request.data = prev(request.data)));

  -- At least one clock without a request lies between two accesses.
  request_ends : assume always request.valid = '1' and response.done = '1' -> next (request.valid = '0');

  -- `done` comes only with a request.
  done_when_asked : assert always response.done = '0' or request.valid = '1';

  -- The status has one of its three values. In hardware its two bits could hold a fourth.
  status_is_one : assert always response.status = ok or response.status = error or response.status = silent;

end architecture;
