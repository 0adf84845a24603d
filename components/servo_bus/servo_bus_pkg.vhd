-- SPDX-License-Identifier: BSD-3-Clause
--
-- The packets of a servo bus, in the protocol of Dynamixel (2.0) and in that of Feetech (STS).
--
--   Dynamixel  FF FF FD 00 | id | length, 2 bytes | instruction | parameters | CRC-16, low byte first
--   Feetech    FF FF       | id | length          | instruction | parameters | not the sum from the id on
--
-- torques and goals are written to all servos at once (83, to the id FE): the register, the bytes for each servo, then
-- for each servo its id and its bytes. A question (02) is to one servo: the first register, and how many bytes. Its
-- reply has 55 (Dynamixel only), an error byte, and the bytes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package servo_bus_pkg is

  subtype byte_t is std_ulogic_vector(7 downto 0);
  subtype servo_t is unsigned(2 downto 0);
  type packet_t is (torques, goals, question);
  type bytes_t is array (natural range <>) of byte_t;

  -- The words of a servo on the bus.
  constant drive_field    : natural := 0;
  constant goal_field     : natural := 1;
  constant position_field : natural := 2;
  constant speed_field    : natural := 3;
  constant load_field     : natural := 4;
  constant status_field   : natural := 5;
  constant age_field      : natural := 6;
  constant failures_field : natural := 7;

  -- What differs between the protocols.
  type protocol_t is record
    feetech      : boolean;
    header_last  : natural;          -- places in a packet: of the last byte that is the same in all
    head_last    : natural;          -- of the last byte before the servos, or before the check
    tail_last    : natural;          -- in the check
    goal_last    : natural;          -- in the bytes of a goal, with the id
    length_least : natural;          -- of a packet to no servo
    reply_length : natural;
    error_place  : natural;          -- of the error byte of a reply; the data follow
    check_place  : natural;          -- of its check
    registers    : bytes_t(0 to 2);  -- of torques, of goals, and the first of a question
    sizes        : bytes_t(0 to 2);  -- their bytes
  end record;

  function protocol_of (number : natural) return protocol_t;

  -- The check behind the header FF FF FD of Dynamixel.
  function header_check return std_ulogic_vector;

  -- One bit more for the CRC-16 with the polynomial 8005.
  function check_with (check : std_ulogic_vector(15 downto 0); data : std_ulogic) return std_ulogic_vector;

  -- Numbers with a sign bit and a magnitude of so many bits, as Feetech has them. The most negative one is one less.
  function with_sign (value : std_ulogic_vector(15 downto 0)) return std_ulogic_vector;
  function without_sign (value : std_ulogic_vector(15 downto 0); sign_bit : natural) return std_ulogic_vector;

end package;

package body servo_bus_pkg is

  function protocol_of (number : natural) return protocol_t is
  begin
    if number = 1 then
      return (
        feetech => true, header_last => 1, head_last => 6, tail_last => 0, goal_last => 2, length_least => 4,
        reply_length => 8, error_place => 4, check_place => 11,
        registers => (x"28", x"2A", x"38"), sizes => (x"01", x"02", x"06"));
    end if;
    return (
      feetech => false, header_last => 2, head_last => 11, tail_last => 1, goal_last => 4, length_least => 7,
      reply_length => 14, error_place => 8, check_place => 19,
      registers => (x"40", x"74", x"7E"), sizes => (x"01", x"04", x"0A"));
  end function;

  function check_with (check : std_ulogic_vector(15 downto 0); data : std_ulogic) return std_ulogic_vector is
    variable shifted : std_ulogic_vector(15 downto 0);
  begin
    shifted := check(14 downto 0) & '0';
    if (check(15) xor data) = '1' then
      shifted := shifted xor x"8005";
    end if;
    return shifted;
  end function;

  function header_check return std_ulogic_vector is
    constant header : std_ulogic_vector(23 downto 0) := x"FFFFFD";
    variable check  : std_ulogic_vector(15 downto 0) := (others => '0');
  begin
    for place in header'range loop
      check := check_with(check, header(place));
    end loop;
    return check;
  end function;

  function with_sign (value : std_ulogic_vector(15 downto 0)) return std_ulogic_vector is
    variable negative : unsigned(15 downto 0);
  begin
    if value(15) = '0' then
      return value;
    end if;
    negative := 0 - unsigned(value);
    if negative(15) = '1' then
      return x"FFFF";
    end if;
    return '1' & std_ulogic_vector(negative(14 downto 0));
  end function;

  function without_sign (value : std_ulogic_vector(15 downto 0); sign_bit : natural) return std_ulogic_vector is
    variable size : unsigned(15 downto 0) := (others => '0');
  begin
    size(sign_bit - 1 downto 0) := unsigned(value(sign_bit - 1 downto 0));
    if value(sign_bit) = '1' then
      return std_ulogic_vector(0 - size);
    end if;
    return std_ulogic_vector(size);
  end function;

end package body;
