-- SPDX-License-Identifier: BSD-3-Clause
--
-- Walks through the bytes of a DATA packet: for each node of the ring its OUT section, then its IN section; in a
-- section the enabled registers from 7 down to 0; in a register 16 bytes.
--
-- Use       `restart` goes to the first byte. `ready` says that the outputs belong to the next byte, and `step` goes on
--           from there. After the last byte, `finished` is high instead of `ready`.
-- Look      The next node with a register is looked up while the one before is walked through. So `ready` is high again
--           two clocks after each step, and up to 4 + 2 * nodes clocks after `restart`.
-- Address   As in the shared memory: id, register, IN (1) or OUT (0), word. `lane` is the byte of the word, the low one
--           first.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;

entity tosnet_walk is
  port (
    clock       : in  std_ulogic;
    restart     : in  std_ulogic;
    step        : in  std_ulogic;
    nodes       : in  unsigned(3 downto 0); -- of the ring
    own_address : in  unsigned(3 downto 0); -- in the ring
    table_index : out unsigned(3 downto 0);
    table_entry : in  std_ulogic_vector(7 downto 0); -- one clock after table_index
    table_mask  : in  std_ulogic_vector(7 downto 0);
    ready       : out std_ulogic;
    finished    : out std_ulogic;
    address     : out std_ulogic_vector(9 downto 0);
    lane        : out unsigned(1 downto 0);
    own         : out std_ulogic  -- the section is of this node
  );
end entity;

architecture rtl of tosnet_walk is

  -- The node whose section is walked through.
  signal valid     : std_ulogic := '0';
  signal id        : std_ulogic_vector(3 downto 0) := "0000";
  signal mask      : std_ulogic_vector(7 downto 0);
  signal todo      : std_ulogic_vector(7 downto 0) := x"00"; -- registers of the section that are not finished
  signal section   : std_ulogic := '0';                    -- IN
  signal place     : unsigned(3 downto 0) := "0000"; -- byte of the register
  signal selected  : unsigned(2 downto 0);          -- the highest register of `todo`
  signal others_todo : std_ulogic_vector(7 downto 0);

  -- The node after it, whose fields the table shows.
  signal index      : unsigned(3 downto 0) := "0000";
  signal shown      : std_ulogic := '0'; -- the table shows the fields of `index`
  signal there_is   : std_ulogic;        -- there is such a node
  signal next_valid : std_ulogic;        -- it has a register

begin

  table_index <= index;
  ready       <= valid;
  finished    <= not valid and not there_is;
  address     <= id & std_ulogic_vector(selected) & section & std_ulogic_vector(place(3 downto 2));
  lane        <= place(1 downto 0);

  there_is    <= to_bit(index /= nodes);
  next_valid  <= there_is and shown and (or table_mask);

  highest : process (all) is
  begin
    selected    <= "000";
    others_todo <= todo;
    for number in 0 to 7 loop
      if todo(number) = '1' then
        selected <= to_unsigned(number, 3);
      end if;
    end loop;
    others_todo(to_integer(selected)) <= '0';
  end process;

  process (clock) is
    variable ends : boolean; -- the node has no byte left
  begin
    if rising_edge(clock) then
      ends := valid = '0';
      if step = '1' then
        place <= place + 1;
        if place = 15 then
          todo <= others_todo;
          if others_todo = x"00" then
            todo    <= mask;
            section <= '1';
            ends    := section = '1';
          end if;
        end if;
      end if;
      if ends then
        valid   <= next_valid;
        id      <= table_entry(3 downto 0);
        mask    <= table_mask;
        todo    <= table_mask;
        own     <= to_bit(index = own_address);
        section <= '0';
        place   <= "0000";
      end if;

      -- A node without a register is passed over. A lookup takes two clocks: one for the index, one for the table.
      shown <= there_is;
      if shown = '1' and (ends or next_valid = '0') then
        index <= index + 1;
        shown <= '0';
      end if;

      if restart = '1' then
        valid <= '0';
        index <= "0000";
        shown <= '0';
      end if;
    end if;
  end process;

end architecture;
