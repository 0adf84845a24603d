-- SPDX-License-Identifier: BSD-3-Clause
--
-- The commands and requests of the application layer.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package application_pkg is

  -- The command of a message, in five bits. Numbers after `spelling` are incomplete words.
  subtype command_t is std_ulogic_vector(4 downto 0);

  constant command_unknown                   : natural := 0;
  constant command_read                      : natural := 1;
  constant command_write                     : natural := 2;
  constant command_read_many                 : natural := 3;
  constant command_read_configuration        : natural := 4;
  constant command_write_group_addresses     : natural := 5;
  constant command_write_group_rate          : natural := 6;
  constant command_read_group                : natural := 7;
  constant command_enable_publishing         : natural := 8;
  constant command_enable_checked_publishing : natural := 9;
  constant command_disable_publishing        : natural := 10;
  constant command_write_event_mask          : natural := 11;
  constant command_read_event_mask           : natural := 12;
  constant command_spelling                  : natural := 13;
  constant command_error                     : natural := 30;  -- no request but a datalink error
  constant command_publish                   : natural := 31;  -- no request but a publish

  -- A complete request, or a datalink error that must be reported to the sender.
  type request_t is record
    valid   : std_ulogic;  -- a request waits
    ready   : std_ulogic;  -- the next data byte is there, or will never come
    missing : std_ulogic;  -- all its data bytes are taken, and no more will come
    data    : byte_t;      -- the next data byte; before the first take: the code of an error
    error   : std_ulogic;  -- before the first take: it is an error
    checked : std_ulogic;  -- before the first take: the reply also carries a checksum
    command : command_t;   -- before the first take: the command
  end record;

  -- The most entries of a received message, as in the 2012 gateware: the length of the longest command, rounded up.
  function entries_for(address_bytes, data_bytes, read_most, publish_mode, group_size, rate_bytes, mask_bytes : natural)
    return positive;

end package;

package body application_pkg is

  function entries_for(address_bytes, data_bytes, read_most, publish_mode, group_size, rate_bytes, mask_bytes : natural)
    return positive is
    variable longest : positive := 7 + address_bytes + data_bytes;
    variable rounded : positive := 1;

    procedure fit(entries : positive) is
    begin
      if entries > longest then
        longest := entries;
      end if;
    end procedure;
  begin
    if read_most > 0 then
      fit(9 + address_bytes * read_most);
    end if;
    if publish_mode > 0 then
      fit(10 + address_bytes * group_size);
      fit(8 + rate_bytes);
      fit(7 + mask_bytes);
    end if;
    while rounded < longest loop
      rounded := 2 * rounded;
    end loop;
    return rounded + 1;
  end function;

end package body;
