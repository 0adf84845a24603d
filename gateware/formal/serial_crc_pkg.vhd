-- SPDX-License-Identifier: BSD-3-Clause
--
-- The checksum of frames, one bit after the other, as the polynomial is written. The proofs of the receiver and the
-- transmitter compare their checks with it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_pkg.all;
use work.protocol_pkg.all;

package serial_crc_pkg is

  function serial_crc (state : crc16_t; data : byte_t) return crc16_t;

end package;

package body serial_crc_pkg is

  function serial_crc (state : crc16_t; data : byte_t) return crc16_t is
    variable rest : crc16_t := state;
    variable feed : std_ulogic;
  begin
    for place in 0 to 7 loop
      feed := rest(0) xor data(place);
      rest := '0' & rest(15 downto 1);
      if feed = '1' then
        rest := rest xor std_ulogic_vector(to_unsigned(frame_crc16_polynomial_c, 16));
      end if;
    end loop;
    return rest;
  end function;

end package body;
