-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bus-independent interface: what the application layer asks of whatever bus lies below it.
--
-- The application raises valid with write, address and data steady until done, which stands for one clock together
-- with the status. `block_hold` is high from before the first until after the last access whose words belong together; a
-- master keeps its bus for that time. Every access ends: the master answers `silent` when nothing on the bus does.

library ieee;
  use ieee.std_logic_1164.all;

package bii_pkg is

  type bii_status_t is (
    ok,      -- done
    error,   -- a slave refused
    silent,  -- nothing answered in time
    denied   -- a write, and the dead-man has tripped: it was not made
  );

  type bii_request_t is record
    valid   : std_ulogic;                      -- an access is asked for
    write   : std_ulogic;                      -- with valid: 1 write, 0 read
    address : std_ulogic_vector(31 downto 0);  -- with valid: word address; bits beyond the bus's width do not count
    data    : std_ulogic_vector(31 downto 0);  -- with valid and write; likewise
    block_hold : std_ulogic;                   -- the bus must not be given away
  end record;

  type bii_response_t is record
    done   : std_ulogic;                       -- the access is over
    status : bii_status_t;                     -- with done
    data   : std_ulogic_vector(31 downto 0);   -- with done of a read that is ok; unused upper bits are zero
  end record;

  constant bii_request_idle : bii_request_t := (
    valid => '0', write => '0', address => (others => '0'), data => (others => '0'), block_hold => '0');

  constant bii_response_idle : bii_response_t := (done => '0', status => ok, data => (others => '0'));

end package;
