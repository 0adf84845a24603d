-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bus-independent interface, between the application layer and any bus.
--
-- The application raises valid, and keeps write, address and data stable until done. done is high for one clock,
-- together with the status. `block_hold` is high from before the first access to after the last access of words that
-- belong together. A master keeps its bus for that time. Every access ends: if no slave answers, the master answers
-- `silent`.

library ieee;
  use ieee.std_logic_1164.all;

package bii_pkg is

  type bii_status_t is (
    ok,      -- done
    error,   -- a slave refused
    silent,  -- no answer in time
    denied   -- a write, but the dead-man has tripped: the write was not made
  );

  type bii_request_t is record
    valid   : std_ulogic;                      -- an access is requested
    write   : std_ulogic;                      -- with valid: 1 write, 0 read
    address : std_ulogic_vector(31 downto 0);  -- with valid: word address; bits beyond the width of the bus are ignored
    data    : std_ulogic_vector(31 downto 0);  -- with valid and write; bits beyond the width are ignored
    block_hold : std_ulogic;                   -- keep the bus
  end record;

  type bii_response_t is record
    done   : std_ulogic;                       -- the access ends
    status : bii_status_t;                     -- with done
    data   : std_ulogic_vector(31 downto 0);   -- with done of a read that is ok; unused upper bits are zero
  end record;

  constant bii_request_idle : bii_request_t := (
    valid => '0', write => '0', address => (others => '0'), data => (others => '0'), block_hold => '0');

  constant bii_response_idle : bii_response_t := (done => '0', status => ok, data => (others => '0'));

end package;
