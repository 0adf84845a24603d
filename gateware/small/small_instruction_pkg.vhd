-- SPDX-License-Identifier: BSD-3-Clause
--
-- The instructions of byte_processor. tools/small/assemble.py has the same numbers.
--
--   0 operation(4) mode(2) address(9)
--   1 condition(3) inverted(1) target(11)
--
-- The mode says what the operand is: 0 the byte at the address, 1 the address itself, 2 the byte at X, 3 the byte at X,
-- and then X goes to the next byte. For do_point, 0 takes A with the upper bits of the address, and 1 the address. The
-- other bit of the mode is the highest bit of this address, which has ten bits.
--
-- Modes that an operation has no use for are other instructions:
--
--   do_in     1  give:   the byte at X becomes the one at the address, and then X goes to the next byte
--             3  get:    the byte at the address, and A, become the one at X, and then X goes to the next byte
--   do_store  1  set:    the byte at the address becomes FF
--   do_put    1  put A, in place of the operand
--   do_clear  1  follow: X becomes 100 and the byte at the address

library ieee;
  use ieee.std_logic_1164.all;

package small_instruction_pkg is

  subtype small_instruction_t is std_ulogic_vector(15 downto 0);
  type small_program_t is array (natural range <>) of small_instruction_t;

  constant is_jump     : natural := 15;
  subtype condition_f is natural range 14 downto 12;
  constant is_inverted : natural := 11;  -- it jumps if the condition does not hold; with if_always it returns
  subtype target_f    is natural range 10 downto 0;

  subtype operation_f is natural range 14 downto 11;
  subtype mode_f      is natural range 10 downto 9;
  subtype address_f   is natural range 8 downto 0;
  subtype value_f     is natural range 7 downto 0;

  -- Operations. 0 to 7 change the accumulator, A: load, and, or, xor, and then add, add with carry, subtract, subtract
  -- with carry.
  constant do_in    : std_ulogic_vector(3 downto 0) := "1000";  -- A becomes the byte of a port
  constant do_store : std_ulogic_vector(3 downto 0) := "1001";
  constant do_point : std_ulogic_vector(3 downto 0) := "1010";  -- X becomes the address, or its highest bit and A
  constant do_put   : std_ulogic_vector(3 downto 0) := "1011";  -- the operand is the next byte of the reply
  constant do_out   : std_ulogic_vector(3 downto 0) := "1100";  -- actions of the hardware
  constant do_tell  : std_ulogic_vector(3 downto 0) := "1101";  -- the same: the clock and the dead-man
  constant do_clear : std_ulogic_vector(3 downto 0) := "1110";  -- the operand becomes zero
  constant do_note  : std_ulogic_vector(3 downto 0) := "1111";  -- the same: the ring and publishing

  constant if_always    : std_ulogic_vector(2 downto 0) := "000";
  constant if_zero      : std_ulogic_vector(2 downto 0) := "001";
  constant if_carry     : std_ulogic_vector(2 downto 0) := "010";
  constant if_piece     : std_ulogic_vector(2 downto 0) := "011";
  constant if_sending   : std_ulogic_vector(2 downto 0) := "100";
  constant if_accessing : std_ulogic_vector(2 downto 0) := "101";
  constant if_alert     : std_ulogic_vector(2 downto 0) := "110";
  constant if_called    : std_ulogic_vector(2 downto 0) := "111";  -- always, and the next place is kept for a return

  type small_conditions_t is record
    piece     : std_ulogic;  -- a piece with its 00 waits in the ring
    sending   : std_ulogic;  -- a reply is being sent
    accessing : std_ulogic;  -- an access is on the bus
    alert     : std_ulogic;  -- the clock has turned, or publishing wants the program
  end record;

  -- One bit for each action: of do_out, of do_tell, and of do_note.
  subtype small_actions_t is std_ulogic_vector(8 downto 0);

  constant out_shift_data    : natural := 0;  -- A becomes the lowest byte of the word; the others move up
  constant out_shift_address : natural := 1;
  constant out_read          : natural := 2;  -- begin an access
  constant out_write         : natural := 3;
  constant out_time          : natural := 4;  -- the clock becomes the upper half of the word
  constant out_crc           : natural := 5;  -- step with A
  constant out_crc_clear     : natural := 6;
  constant out_send          : natural := 7;  -- send the reply
  constant out_free          : natural := 8;  -- the ring is free up to A

  constant tell_turn_seen    : natural := 0;
  constant tell_overrun_seen : natural := 1;
  constant tell_start        : natural := 2;  -- these go to the dead-man
  constant tell_trip         : natural := 3;
  constant tell_renew        : natural := 4;
  constant tell_arm          : natural := 5;
  constant tell_counted      : natural := 6;
  constant tell_alive        : natural := 7;
  constant tell_check_next   : natural := 8;  -- the next seven bits of the CRC; only do_in does this

  constant note_piece_taken  : natural := 0;  -- one piece less waits in the ring
  constant note_strobe_taken : natural := 1;  -- one base strobe less waits
  constant note_events_taken : natural := 2;  -- the events of the groups in A have been seen
  constant note_enabled      : natural := 3;  -- A has the groups whose events count
  constant note_publishing   : natural := 4;  -- the lowest bit of A switches it on or off
  constant note_due          : natural := 5;  -- A has the groups that the program will publish
  constant note_hold         : natural := 6;  -- the lowest bit of A keeps the bus
  constant note_again        : natural := 7;  -- the reply begins anew, behind its kind and first code
  constant note_publish      : natural := 8;  -- the reply is a publish

  -- Ports. With its bit, do_in also goes to the next byte of the word, or to the next bits of the CRC.
  constant in_data_next  : natural := 7;
  constant in_check_next : natural := 8;

  subtype small_port_t is std_ulogic_vector(2 downto 0);

  constant in_data   : small_port_t := "000";  -- the highest byte of the word
  constant in_check  : small_port_t := "001";  -- a byte of the check: seven bits of the CRC
  constant in_status : small_port_t := "010";
  constant in_x      : small_port_t := "011";
  constant in_wants  : small_port_t := "100";  -- what publishing wants
  constant in_place  : small_port_t := "101";  -- where the next byte of the reply goes

end package;
