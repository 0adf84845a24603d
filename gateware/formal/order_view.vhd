-- SPDX-License-Identifier: BSD-3-Clause
--
-- Words that pass through a design which must keep them all: none is lost, doubled, changed or invented. Any one word
-- is followed, and z3 chooses which.

library ieee;
  use ieee.std_logic_1164.all;

entity order_view is
  generic (
    width : positive := 8;
    most  : positive      -- words that may be inside
  );
  port (
    clk       : in std_ulogic;
    reset     : in std_ulogic;                             -- removes what is inside
    comes     : in std_ulogic;                             -- a word comes in this clock …
    came      : in std_ulogic_vector(width - 1 downto 0);
    mark      : in std_ulogic;                             -- … and is followed, if no other word is
    offered   : in std_ulogic;                             -- a word is on offer …
    goes      : in std_ulogic;                             -- … and leaves in this clock
    word      : in std_ulogic_vector(width - 1 downto 0)
  );
end entity;

architecture properties of order_view is

  signal count    : natural range 0 to most + 1 := 0; -- words inside
  signal followed : std_ulogic := '0';
  signal ahead    : natural range 0 to most := 0;     -- words inside before the followed one
  signal expected : std_ulogic_vector(width - 1 downto 0);

begin

  default clock is rising_edge(clk);

  follow : process (clk) is
    variable left : natural range 0 to most + 1; -- words inside, without the one that comes
  begin
    if rising_edge(clk) then
      left := count;
      if goes = '1' and count > 0 then
        left := count - 1;
      end if;
      count <= left;
      if comes = '1' and left <= most then
        count <= left + 1;
      end if;
      if followed = '1' and goes = '1' then
        if ahead = 0 then
          followed <= '0';
        else
          ahead <= ahead - 1;
        end if;
      elsif followed = '0' and comes = '1' and mark = '1' and left < most then
        followed <= '1';
        ahead    <= left;
        expected <= came;
      end if;
      if reset = '1' then
        count    <= 0;
        followed <= '0';
      end if;
    end if;
  end process;

  -- The words inside are those that came in less those that left. There are never more than there is room for, so none
  -- disappears.
  none_too_many : assert always count <= most;

  -- A word is offered only if one is inside.
  none_of_nothing : assert always reset = '0' and offered = '1' -> count > 0;

  -- The word on offer is the next in the order of arrival: none is lost, doubled or changed.
  in_order : assert always reset = '0' and offered = '1' and followed = '1' and ahead = 0 -> word = expected;

end architecture;
