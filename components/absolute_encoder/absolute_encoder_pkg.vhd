-- SPDX-License-Identifier: BSD-3-Clause
--
-- Why a reading of an absolute encoder does not count.

library ieee;
  use ieee.std_logic_1164.all;

package absolute_encoder_pkg is

  subtype reason_t is std_ulogic_vector(1 downto 0);

  constant fine         : reason_t := "00";
  constant no_answer    : reason_t := "01";
  constant wrong_check  : reason_t := "10";
  constant device_error : reason_t := "11";

end package;
