-- SPDX-License-Identifier: BSD-3-Clause
--
-- A wire from one component to another: a value of 32 bits, two's complement, in the counts of the element whose value
-- it is. It is valid while its highest bit is 1. An input without a wire is never valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package wire_pkg is

  constant wire_bits : positive := 33;

  subtype wire_t is std_ulogic_vector(wire_bits - 1 downto 0);
  type wire_vector_t is array (natural range <>) of wire_t;

  constant no_wire : wire_t := (others => '0');

  -- A valid value.
  function wire_of (value : signed) return wire_t;

  -- Whether it is valid, and its value.
  function is_valid (wire : wire_t) return std_ulogic;
  function value_of (wire : wire_t) return signed;

  -- A value in fewer bits: too large a one becomes the largest.
  function limited (value : signed; to_bits : positive) return signed;

end package;

package body wire_pkg is

  function wire_of (value : signed) return wire_t is
  begin
    return '1' & std_ulogic_vector(resize(value, wire_bits - 1));
  end function;

  function is_valid (wire : wire_t) return std_ulogic is
  begin
    return wire(wire_bits - 1);
  end function;

  function value_of (wire : wire_t) return signed is
  begin
    return signed(wire(wire_bits - 2 downto 0));
  end function;

  function limited (value : signed; to_bits : positive) return signed is
    constant whole : signed(value'length - 1 downto 0) := value;
    variable found : signed(to_bits - 1 downto 0);
  begin
    found := whole(to_bits - 1 downto 0);
    if resize(found, whole'length) /= whole then
      found := (others => not whole(whole'high));
      found(found'high) := whole(whole'high);
    end if;
    return found;
  end function;

end package body;
