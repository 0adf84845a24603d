-- SPDX-License-Identifier: BSD-3-Clause
--
-- The signals between the application and the subscription manager.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;

package subscription_pkg is

  -- A group keeps words at places. Place 0 has the number of its addresses. The addresses follow from place 1, the last
  -- one first. Place -1 has the highest byte of its rate, and -2 the next byte. The places before those have room for
  -- rates with more bytes. The subscription manager itself reads none of these words.
  subtype place_t is unsigned(8 downto 0);

  type subscription_request_t is record
    group_number : unsigned(7 downto 0);           -- the group to read or change
    place        : place_t;                        -- the place of its word; of a mask, the byte
    word         : std_ulogic_vector(31 downto 0); -- the word to write
    rate         : std_ulogic_vector(31 downto 0); -- with write_rate
    write_word   : std_ulogic;  -- write `word`
    fill         : std_ulogic;  -- the group has addresses now
    empty        : std_ulogic;  -- the group has no addresses any more
    write_rate   : std_ulogic;  -- set the group's rate; hold this high until `done`
    write_mask   : std_ulogic;  -- write that byte of the event mask
    write_event  : std_ulogic;  -- the event input makes the group due, if the lowest bit of `word` is set
    clear        : std_ulogic;  -- the state after reset: no group has addresses, rate or event; publishing is off
    enable       : std_ulogic;  -- publishing on
    disable      : std_ulogic;  -- publishing off
    publish_take : std_ulogic;  -- the publish that was due in the clock before is taken; group_number is its group
  end record;

  type subscription_response_t is record
    done     : std_ulogic;                      -- write_rate is done
    word     : std_ulogic_vector(31 downto 0);  -- valid one clock after group_number and place
    empty    : std_ulogic;                      -- the group has no addresses; valid at once
    inactive : std_ulogic;                      -- the group's rate is 0; valid at once
    mask     : byte_t;                          -- valid at once
    publish  : std_ulogic;                      -- a publish is due
    publish_group : unsigned(7 downto 0);       -- the group of that publish
    overrun  : std_ulogic;                      -- for one clock: a group is due again before it was published
  end record;

  constant subscription_request_idle : subscription_request_t := (
    group_number => (others => '0'), place => (others => '0'), word => (others => '0'), rate => (others => '0'),
    others => '0');

  constant subscription_response_idle : subscription_response_t := (
    done => '0', word => (others => '0'), empty => '1', inactive => '1', mask => (others => '0'), publish => '0',
    publish_group => (others => '0'), overrun => '0');

end package;
