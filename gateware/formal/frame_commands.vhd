-- SPDX-License-Identifier: BSD-3-Clause
--
-- What the framed application asks of the dead-man, for its proof. The proof of dead_man shows what the dead-man does,
-- whatever it is asked.

library ieee;
  use ieee.std_logic_1164.all;

use work.bit_pkg.all;
use work.dead_man_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_commands is
  port (
    clk, reset, begun : in std_ulogic;
    request    : in dead_man_request_t;
    tripped    : in std_ulogic;              -- the dead-man has, so it ignores `start`
    -- The work in hand.
    begins     : in std_ulogic;
    at_rest    : in std_ulogic;
    in_session : in std_ulogic;
    fresh      : in std_ulogic;              -- its id is new
    frame      : in std_ulogic;
    entry      : in natural range 0 to 31;
    dones      : in natural range 0 to 2;
    memories   : in natural range 0 to 2;
    remembered : in std_ulogic_vector(3 downto 0);
    commanded  : out std_ulogic              -- it has started, stopped or armed the dead-man
  );
end entity;

architecture properties of frame_commands is

  signal done_so : std_ulogic := '0';
  signal command : std_ulogic;
  signal is_asked, is_remembered, in_open, in_open_or_close : std_ulogic;

begin

  default clock is rising_edge(clk);

  command   <= (request.start and not tripped) or request.arm;
  commanded <= done_so;

  is_asked <= to_bit(in_session = '1' and frame = '1' and dones = 0 and done_so = '0' and fresh = '1' and
                     entry = request_kind_write_control_c mod 16);

  is_remembered    <= to_bit(memories = 1 and remembered = "0000");
  in_open          <= to_bit(frame = '1' and dones = 0 and entry = entry_open);
  in_open_or_close <= in_open or to_bit(frame = '1' and dones = 0 and entry = request_kind_close_c mod 16);

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      done_so <= (done_so or command) and not (begins or reset);
    end if;
  end process;

  -- The dead-man is started, stopped or armed only in a session, and once. This happens for a WRITE_CONTROL whose id is
  -- new.
  commanded_if_asked : assert always begun = '1' and command = '1' -> is_asked = '1';

  -- This is remembered as done well. So the request is not executed again.
  command_is_remembered : assert always begun = '1' and at_rest = '1' and done_so = '1' -> is_remembered = '1';

  -- Only an OPEN asks it to trip.
  trips_with_open : assert always begun = '1' and request.trip = '1' -> in_open = '1';

  -- Only an OPEN or CLOSE makes `arm` work again.
  renewed_with_session : assert always begun = '1' and request.renew = '1' -> in_open_or_close = '1';

  -- The dead-man is started or stopped.
  start_seen : cover {begun = '1' and request.start = '1'};

end architecture;
