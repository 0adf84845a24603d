-- SPDX-License-Identifier: BSD-3-Clause
--
-- Between the application and the subscription manager.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package subscription_pkg is

  -- A group keeps words at places. Place 0 has the number of its addresses; they follow from place 1, the last one first;
  -- place -1 has the highest byte of its rate, -2 the next one; before those is room for those of a rate still to come.
  -- The subscription manager itself looks at none of them.
  subtype place_t is unsigned(8 downto 0);

  type subscription_request_t is record
    group_number : unsigned(7 downto 0);           -- which group is looked at or changed
    place        : place_t;                        -- which of its words; of a mask, which byte
    word         : std_ulogic_vector(31 downto 0); -- what is written there
    rate         : std_ulogic_vector(31 downto 0); -- with write_rate
    write_word   : std_ulogic;  -- write that word
    fill         : std_ulogic;  -- the group has addresses now
    empty        : std_ulogic;  -- the group has none any more
    write_rate   : std_ulogic;  -- set the group's rate; to be held until `done`
    write_mask   : std_ulogic;  -- write that byte of the event mask
    write_event  : std_ulogic;  -- the event input triggers the group: the lowest bit of word
    clear        : std_ulogic;  -- as after reset: no group has addresses, rate or event, publishing off
    enable       : std_ulogic;  -- publishing on
    disable      : std_ulogic;  -- publishing off
    publish_take : std_ulogic;  -- the publish that was due in the clock before is taken on; it is of group_number
  end record;

  type subscription_response_t is record
    done     : std_ulogic;                      -- write_rate is done
    word     : std_ulogic_vector(31 downto 0);  -- one clock after group_number and place
    empty    : std_ulogic;                      -- the group has no addresses; at once
    inactive : std_ulogic;                      -- the group's rate is 0; at once
    mask     : byte_t;                          -- at once
    publish  : std_ulogic;                      -- a publish is due
    publish_group : unsigned(7 downto 0);       -- with publish: of this group
    overrun  : std_ulogic;                      -- for one clock: a group is due again that has not been published yet
  end record;

  constant subscription_request_idle : subscription_request_t := (
    group_number => (others => '0'), place => (others => '0'), word => (others => '0'), rate => (others => '0'),
    others => '0');

  constant subscription_response_idle : subscription_response_t := (
    done => '0', word => (others => '0'), empty => '1', inactive => '1', mask => (others => '0'), publish => '0',
    publish_group => (others => '0'), overrun => '0');

end package;
