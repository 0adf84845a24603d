-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of tosnet_walk in a ring of two nodes, with any masks of registers: the order of the bytes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;

entity tosnet_walk_formal is
  port (
    clk         : in std_ulogic;
    restart     : in std_ulogic;
    step        : in std_ulogic;
    own_address : in unsigned(3 downto 0);
    first_mask  : in std_ulogic_vector(7 downto 0); -- of node 1, at address 0
    last_mask   : in std_ulogic_vector(7 downto 0)  -- of node 2, at address 1
  );
end entity;

architecture properties of tosnet_walk_formal is

  signal begun       : std_ulogic := '0';
  signal table_index : unsigned(3 downto 0);
  signal table_entry : std_ulogic_vector(7 downto 0) := x"00";
  signal table_mask  : std_ulogic_vector(7 downto 0) := x"00";
  signal ready, finished, own : std_ulogic;
  signal address     : std_ulogic_vector(9 downto 0);
  signal lane        : unsigned(1 downto 0);
  signal mask        : std_ulogic_vector(7 downto 0); -- of the node whose section it is
  signal enabled     : std_ulogic;                    -- the register is
  signal moves       : std_ulogic;
  signal was_order   : unsigned(9 downto 0) := (others => '0');
  signal order       : unsigned(9 downto 0);          -- grows with each byte: node, section, register, byte

begin

  default clock is rising_edge(clk);

  dut : entity work.tosnet_walk
    port map (
      clock => clk, restart => restart, step => step, nodes => "0010", own_address => own_address,
      table_index => table_index, table_entry => table_entry, table_mask => table_mask, ready => ready,
      finished => finished, address => address, lane => lane, own => own);

  moves   <= ready and step and not restart;
  mask    <= first_mask when address(6) = '1' else last_mask;
  enabled <= mask(to_integer(unsigned(address(5 downto 3))));
  order   <= "0" & unsigned(not address(6 downto 6)) & unsigned(address(2 downto 2)) & not unsigned(address(5 downto 3))
             & unsigned(address(1 downto 0)) & lane;

  process (clk) is
  begin
    if rising_edge(clk) then
      begun       <= '1';
      was_order   <= order;
      table_entry <= "0000" & (0 to 3 => '0');
      table_mask  <= x"00";
      if table_index = 0 then
        table_entry <= x"01";
        table_mask  <= first_mask;
      elsif table_index = 1 then
        table_entry <= x"12";
        table_mask  <= last_mask;
      end if;
    end if;
  end process;

  -- A walk begins with a restart.
  restart_first : assume always begun = '1' or restart = '1';

  -- The ring stays as it is.
  ring_stays : assume always begun = '1' ->
               first_mask = prev(first_mask) and last_mask = prev(last_mask) and own_address = prev(own_address);

  -- Steps are made only while a byte is there.
  steps_when_ready : assume always step = '1' -> ready = '1';

  -- A byte is there, or the end has come, never both.
  not_both : assert always begun = '1' -> not (ready = '1' and finished = '1');

  -- Each byte is of a register that is enabled.
  only_enabled : assert always begun = '1' and ready = '1' -> enabled = '1';

  -- Whose section it is, is told.
  owner_is_told : assert always begun = '1' and ready = '1' ->
                  own = to_bit((own_address = 0 and address(6) = '1') or (own_address = 1 and address(7) = '1'));

  -- Within a register, the next byte follows at once, with the next lane or the next word.
  bytes_in_order : assert always moves = '1' and order(3 downto 0) /= 15 ->
                   next (restart = '1' or order = was_order + 1);

  -- A step to another register goes to a later place of the packet.
  always_on : assert always moves = '1' -> next (restart = '1' or ready = '0' or order > was_order);

  -- The end is reached.
  ends : cover {finished = '1' and begun = '1'};

  -- The second node is reached.
  second_node : cover {ready = '1' and address(7) = '1'};

end architecture;
