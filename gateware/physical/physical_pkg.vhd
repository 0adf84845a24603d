-- SPDX-License-Identifier: BSD-3-Clause
--
-- What every physical layer tells the layer above, and what two UARTs agree on.

library ieee;
  use ieee.std_logic_1164.all;

package physical_pkg is

  -- What went wrong between two bytes. The datalink adds these bits to ?f5: parity 1, framing 2, overrun 4.
  subtype receive_error_t is std_ulogic_vector(2 downto 0);
  constant parity_error_bit  : natural := 0;
  constant framing_error_bit : natural := 1;
  constant overrun_error_bit : natural := 2;

  constant no_receive_error : receive_error_t := "000";

  type parity_t is (
    none, -- no parity bit
    even, -- data and parity bit together hold an even number of ones
    odd   -- … an odd number
  );

end package;
