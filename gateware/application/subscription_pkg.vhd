-- SPDX-License-Identifier: BSD-3-Clause
--
-- Between the application and the subscription manager.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package subscription_pkg is

  type subscription_request_t is record
    group_number  : unsigned(7 downto 0);           -- which group is looked at or changed
    index         : unsigned(7 downto 0);           -- which of its addresses; of a mask, which byte
    value         : std_ulogic_vector(31 downto 0); -- what is written
    write_address : std_ulogic;  -- value is address number index of the group
    write_count   : std_ulogic;  -- address number index is the last one of the group
    write_rate    : std_ulogic;  -- value is the group's rate; to be held until `done`
    write_mask    : std_ulogic;  -- value is byte number index of the event mask
    enable        : std_ulogic;  -- publishing on
    disable       : std_ulogic;  -- publishing off
    publish_take  : std_ulogic;  -- the publish that is due is taken on
  end record;

  type subscription_response_t is record
    done     : std_ulogic;                      -- write_rate is done
    looked   : std_ulogic;                      -- rate belongs to the group_number of the clock before
    rate     : std_ulogic_vector(31 downto 0);
    count    : unsigned(7 downto 0);            -- one clock after group_number
    address  : std_ulogic_vector(31 downto 0);  -- one clock after group_number and index
    mask     : byte_t;                          -- at once
    publish  : std_ulogic;                      -- a publish is due
    publish_group : unsigned(7 downto 0);       -- with publish: of this group
  end record;

  constant subscription_request_idle : subscription_request_t := (
    group_number => (others => '0'), index => (others => '0'), value => (others => '0'), others => '0');

  constant subscription_response_idle : subscription_response_t := (
    done => '0', looked => '0', rate => (others => '0'), count => (others => '0'), address => (others => '0'),
    mask => (others => '0'), publish => '0', publish_group => (others => '0'));

end package;
