-- SPDX-License-Identifier: BSD-3-Clause
--
-- The parts of a LIST or POST_LIST, for the proof of the framed application: what comes next of it, after the bytes
-- that were taken and the accesses that were made. Address and data have one byte each.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_layout_pkg.all;
use work.protocol_pkg.all;

package frame_list_parts_pkg is

  -- What comes next of a list: a byte, several bytes at once, or an access to the bus.
  subtype part_t is natural range 0 to 24;

  constant part_barred  : natural := 0;   -- the first of the five bytes before the list, if there is a barrier
  constant part_plain   : natural := 5;   -- the first of the three bytes before the list of a LIST
  constant part_post    : natural := 6;   -- the first of the two bytes before the list of a POST_LIST
  constant part_first   : natural := 8;   -- the first operation
  constant part_size    : natural := 9;   -- the count of an operation
  constant part_base    : natural := 10;  -- the one address of an operation
  constant part_item    : natural := 11;  -- the address of a word
  constant part_mask    : natural := 12;
  constant part_value   : natural := 13;
  constant part_due     : natural := 14;  -- the access of this word
  constant part_again   : natural := 15;  -- the access of a word that has no byte of its own
  constant part_write   : natural := 16;  -- the write of a word that was read for it
  constant part_stream  : natural := 17;  -- the value of a word that has no address of its own
  constant part_read    : natural := 18;  -- another operation, or the end: behind one that reads
  constant part_written : natural := 19;  -- likewise behind one that writes
  constant part_masked  : natural := 20;  -- and one that writes with masks
  constant part_block   : natural := 21;  -- all addresses at once, because nothing is executed
  constant part_values  : natural := 22;  -- all values at once
  constant part_masks   : natural := 23;  -- as many bytes once more
  constant part_astray  : natural := 24;  -- something was taken or opened that was not next

  -- The operations of a list, and one that does not exist.
  subtype operation_t is natural range 0 to 8;

  constant no_operation : natural := 8;

  function operation_of(byte : byte_t) return operation_t;
  function shape_of(operation : operation_t) return byte_t;  -- in the design
  function reads(operation : operation_t) return boolean;
  function once(operation : operation_t) return boolean;     -- all its words have one address
  function climbs(operation : operation_t) return boolean;   -- or one after the other
  function changes(operation : operation_t) return boolean;  -- it reads each word and writes it

  function is_head(part : part_t) return boolean;
  function is_run(part : part_t) return boolean;   -- only of a list that is executed
  function is_skip(part : part_t) return boolean;  -- only of an operation that is not
  function is_end(part : part_t) return boolean;   -- the list may end here
  function has_address(part : part_t) return boolean;  -- the list had the address of the next access

  -- The part may be one of this operation.
  function belongs(part : part_t; operation : operation_t) return boolean;

  -- What is next when a byte is taken, or `count` of them at once. `runs`: the operation is executed.
  function taken(part : part_t; operation : operation_t; many, runs : boolean) return part_t;

  -- What is next when an access begins. `more`: words of the operation are left.
  function opened(part : part_t; operation : operation_t; more : boolean) return part_t;
  -- What the proof knows of the list in work (frame_list).
  type frame_list_t is record
    part      : part_t;                          -- what comes next
    operation : operation_t;
    words     : unsigned(7 downto 0);            -- of the operation that were not begun
    address   : unsigned(7 downto 0);            -- of the next access
    value     : byte_t;                          -- the last one
    at_start  : std_ulogic;                      -- nothing was taken since the last rewind
    formed    : std_ulogic;                      -- the list was gone through before that, and had its form
    odd       : std_ulogic;                      -- an operation before this one does not have its form
    executes  : std_ulogic;                      -- mark_executing is set
    posts     : std_ulogic;                      -- it is a POST_LIST
    barred    : std_ulogic;                      -- it has a barrier
  end record;

end package;

package body frame_list_parts_pkg is

  function operation_of(byte : byte_t) return operation_t is
  begin
    case to_integer(unsigned(byte)) is
      when list_operation_read_c         => return 0;
      when list_operation_read_up_c      => return 1;
      when list_operation_read_fifo_c    => return 2;
      when list_operation_write_c        => return 3;
      when list_operation_write_up_c     => return 4;
      when list_operation_write_fifo_c   => return 5;
      when list_operation_write_masked_c => return 6;
      when list_operation_add_c          => return 7;
      when others                        => return no_operation;
    end case;
  end function;

  type shapes_t is array (operation_t) of natural;

  constant shapes : shapes_t := (
    shape_reads, shape_reads + shape_once + shape_up, shape_reads + shape_once + shape_fifo, 0, shape_once + shape_up,
    shape_once, shape_mask, shape_add, shape_none);

  function shape_of(operation : operation_t) return byte_t is
  begin
    return byte_t(to_unsigned(shapes(operation), 8));
  end function;

  function reads(operation : operation_t) return boolean is
  begin
    return operation <= 2;
  end function;

  function once(operation : operation_t) return boolean is
  begin
    return operation = 1 or operation = 2 or operation = 4 or operation = 5;
  end function;

  function climbs(operation : operation_t) return boolean is
  begin
    return operation = 1 or operation = 4;
  end function;

  function changes(operation : operation_t) return boolean is
  begin
    return operation = 6 or operation = 7;
  end function;

  function is_head(part : part_t) return boolean is
  begin
    return part < part_first;
  end function;

  function is_run(part : part_t) return boolean is
  begin
    return part >= part_base and part <= part_stream;
  end function;

  function is_skip(part : part_t) return boolean is
  begin
    return part >= part_block and part <= part_masks;
  end function;

  function is_end(part : part_t) return boolean is
  begin
    return part >= part_read and part <= part_masked;
  end function;

  function belongs(part : part_t; operation : operation_t) return boolean is
  begin
    case part is
      when part_base    => return once(operation);
      when part_item    => return not once(operation) and operation /= no_operation;
      when part_mask | part_masks | part_masked => return operation = 6;
      when part_value   => return not reads(operation) and not once(operation) and operation /= no_operation;
      when part_stream  => return not reads(operation) and once(operation);
      when part_due     => return operation /= no_operation and not (reads(operation) and once(operation));
      when part_again   => return reads(operation) and once(operation);
      when part_write   => return changes(operation);
      when part_read    => return reads(operation);
      when part_values  => return not reads(operation);
      when part_written => return not reads(operation) and operation /= 6;
      when others       => return true;
    end case;
  end function;

  function has_address(part : part_t) return boolean is
  begin
    return part >= part_mask and part <= part_stream;
  end function;

  function taken(part : part_t; operation : operation_t; many, runs : boolean) return part_t is
  begin
    if many and not is_skip(part) then
      return part_astray;
    end if;
    case part is
      when 4 | 7        => return part_first;
      when part_first | part_read | part_written | part_masked => return part_size;
      when part_size =>
        if not runs then
          return part_block;
        elsif once(operation) then
          return part_base;
        end if;
        return part_item;
      when part_base =>
        if reads(operation) then
          return part_again;
        end if;
        return part_stream;
      when part_item =>
        if reads(operation) then
          return part_due;
        elsif operation = 6 then
          return part_mask;
        end if;
        return part_value;
      when part_mask    => return part_value;
      when part_value | part_stream => return part_due;
      when part_block =>
        if once(operation) = many then
          return part_astray;
        elsif reads(operation) then
          return part_read;
        end if;
        return part_values;
      when part_values =>
        if not many then
          return part_astray;
        elsif operation = 6 then
          return part_masks;
        end if;
        return part_written;
      when part_masks =>
        if many then
          return part_masked;
        end if;
        return part_astray;
      when others =>
        if is_head(part) then
          return part + 1;
        end if;
        return part_astray;
    end case;
  end function;

  function opened(part : part_t; operation : operation_t; more : boolean) return part_t is
  begin
    if part = part_due and changes(operation) then
      return part_write;
    elsif part /= part_due and part /= part_again and part /= part_write then
      return part_astray;
    elsif not more then
      if reads(operation) then
        return part_read;
      elsif operation = 6 then
        return part_masked;
      end if;
      return part_written;
    elsif part = part_again then
      return part_again;
    elsif once(operation) then
      return part_stream;
    end if;
    return part_item;
  end function;

end package body;
