-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the checksum of the classic datalink, for all sums and all data at once. It is a function without
-- memory.

library ieee;
  use ieee.std_logic_1164.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity crc8_formal is
  port (
    clk          : in std_ulogic;
    sum, other   : in byte_t;
    data, change : in byte_t
  );
end entity;

architecture properties of crc8_formal is

  function parallel(sum : byte_t; data : byte_t) return byte_t is
  begin
    return next_checksum("crc8", 7, sum, data);
  end function;

  -- Division by x8 + x2 + x + 1, one bit after the other, as textbooks show it.
  function serial(sum : byte_t; data : byte_t) return byte_t is
    variable rest : byte_t := sum;
    variable top  : std_ulogic;
  begin
    for place in 7 downto 0 loop
      top  := rest(7) xor data(place);
      rest := rest(6 downto 2) & (rest(1) xor top) & (rest(0) xor top) & top;
    end loop;
    return rest;
  end function;

  signal both : byte_t;  -- difference of the sums of two different messages

begin

  default clock is rising_edge(clk);

  both <= parallel(sum, data) xor parallel(other, data xor change);

  -- The parallel function of a byte gives the same sum as its bits one by one.
  parallel_is_serial : assert always parallel(sum, data) = serial(sum, data);

  -- The sum of a difference is the difference of the sums.
  linear : assert always both = parallel(sum xor other, change);

  -- A message followed by its own sum has the sum zero.
  residue_is_zero : assert always parallel(sum, sum) = x"00";

  -- A wrong sum stays wrong whatever byte follows, so no byte hides an earlier error.
  error_stays : assert always sum = other or change /= x"00" or both /= x"00";

  -- A wrong byte makes the sum wrong, for any number of wrong bits in any place.
  error_counts : assert always sum /= other or change = x"00" or both /= x"00";

  -- A sum of zero is reached.
  zero_sum : cover {parallel(sum, data) = x"00" and data /= x"00"};

end architecture;
