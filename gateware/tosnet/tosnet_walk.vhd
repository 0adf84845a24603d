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

  -- The node after it.
  signal index     : unsigned(3 downto 0) := "0000";
  signal asked     : std_ulogic; -- the table shows the fields of `index`
  signal next_valid : std_ulogic := '0';
  signal next_id    : std_ulogic_vector(3 downto 0) := "0000";
  signal next_mask  : std_ulogic_vector(7 downto 0) := x"00";
  signal next_own   : std_ulogic;

begin

  table_index <= index;
  ready       <= valid;
  finished    <= not valid and not next_valid and to_bit(index = nodes);
  address     <= id & std_ulogic_vector(selected) & section & std_ulogic_vector(place(3 downto 2));
  lane        <= place(1 downto 0);

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
        valid      <= next_valid;
        id         <= next_id;
        mask       <= next_mask;
        todo       <= next_mask;
        own        <= next_own;
        section    <= '0';
        place      <= "0000";
        next_valid <= '0';
      end if;

      -- A lookup takes two clocks: one for the index, one for the table.
      asked <= '0';
      if next_valid = '0' and index /= nodes then
        asked <= not asked;
        if asked = '1' then
          next_id    <= table_entry(3 downto 0);
          next_mask  <= table_mask;
          next_own   <= to_bit(index = own_address);
          next_valid <= or table_mask;
          index      <= index + 1;
        end if;
      end if;

      if restart = '1' then
        valid      <= '0';
        next_valid <= '0';
        index      <= "0000";
        asked      <= '0';
      end if;
    end if;
  end process;

end architecture;
