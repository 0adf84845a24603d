-- SPDX-License-Identifier: BSD-3-Clause
--
-- The functions that turn a generic into a number of bits or bytes.

package width_pkg is

  -- Bytes that hold `bits` bits. Example: 12 -> 2.
  function bytes_for(bits : positive) return positive;

  -- Bits that count from 0 to `values` - 1, at least one. Examples: 1 -> 1, 16 -> 4, 17 -> 5.
  function bits_for(values : positive) return positive;

end package;

package body width_pkg is

  function bytes_for(bits : positive) return positive is
  begin
    return (bits + 7) / 8;
  end function;

  function bits_for(values : positive) return positive is
    variable bits : positive := 1;
  begin
    while 2 ** bits < values loop
      bits := bits + 1;
    end loop;
    return bits;
  end function;

end package body;
