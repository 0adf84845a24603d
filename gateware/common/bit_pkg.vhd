-- SPDX-License-Identifier: BSD-3-Clause
--
-- A condition as a bit, for signals that are made of both.

library ieee;
  use ieee.std_logic_1164.all;

package bit_pkg is

  -- '1' if the condition is true. Example: ready and to_bit(count = 0).
  function to_bit(condition : boolean) return std_ulogic;

end package;

package body bit_pkg is

  function to_bit(condition : boolean) return std_ulogic is
  begin
    if condition then
      return '1';
    end if;
    return '0';
  end function;

end package body;
