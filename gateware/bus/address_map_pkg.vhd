-- SPDX-License-Identifier: BSD-3-Clause
--
-- The address map: which slave answers at which addresses.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package address_map_pkg is

  type address_range_t is record
    base  : unsigned(31 downto 0); -- the first address
    words : positive;              -- the number of words
  end record;

  type address_map_t is array (natural range <>) of address_range_t;

  function last_address (span : address_range_t) return unsigned;
  function overlaps (one : address_range_t; other : address_range_t) return boolean;

  -- Whether size and base fit: the size is a power of two, and the base a multiple of it. Then decoding needs a
  -- comparison and no subtraction.
  function is_aligned (span : address_range_t) return boolean;

end package;

package body address_map_pkg is

  function last_address (span : address_range_t) return unsigned is
  begin
    return span.base + to_unsigned(span.words - 1, 32);
  end function;

  function overlaps (one : address_range_t; other : address_range_t) return boolean is
  begin
    return one.base <= last_address(other) and other.base <= last_address(one);
  end function;

  function is_aligned (span : address_range_t) return boolean is
    constant offset : unsigned(31 downto 0) := to_unsigned(span.words - 1, 32);
    constant count  : unsigned(31 downto 0) := to_unsigned(span.words, 32);
  begin
    return (count and offset) = 0 and (span.base and offset) = 0;
  end function;

end package body;
