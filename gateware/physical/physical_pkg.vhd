-- SPDX-License-Identifier: BSD-3-Clause
--
-- Types that all physical layers share: errors, parity, when a chip with USB sends at once, and the tokens of an RS-485
-- pair.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;

package physical_pkg is

  -- The errors between two bytes. The datalink adds these bits to ?f5: parity 1, framing 2, overrun 4.
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

  -- The messages after which a chip must send what it has collected.
  type send_immediate_t is (never, publishes, replies, both);

  function sends_at_once (mode : send_immediate_t; last : std_ulogic; publish : std_ulogic) return std_ulogic;

  -- The second byte of the token whose first byte is `token`.
  function token_check (token : std_ulogic_vector(7 downto 0)) return std_ulogic_vector;

end package;

package body physical_pkg is

  function sends_at_once (mode : send_immediate_t; last : std_ulogic; publish : std_ulogic) return std_ulogic is
  begin
    case mode is
      when never     => return '0';
      when publishes => return last and publish;
      when replies   => return last and not publish;
      when both      => return last;
    end case;
  end function;

  function token_check (token : std_ulogic_vector(7 downto 0)) return std_ulogic_vector is
    constant polynomial : std_ulogic_vector(6 downto 0) := std_ulogic_vector(to_unsigned(rs485_check_polynomial_c, 7));
    variable rest       : std_ulogic_vector(6 downto 0) := (others => '0');
    variable feedback   : std_ulogic;
  begin
    for index in 6 downto 0 loop
      feedback := rest(6) xor token(index);
      rest     := (rest(5 downto 0) & '0') xor (polynomial and (6 downto 0 => feedback));
    end loop;
    return '1' & rest;
  end function;

end package body;
