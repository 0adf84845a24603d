-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the fifo. The order is checked by following any one word from its arrival to its departure.

library ieee;
  use ieee.std_logic_1164.all;

entity fifo_formal is
  generic (
    width : positive := 2;
    depth : positive := 4
  );
  port (
    clk         : in std_ulogic;
    reset       : in std_ulogic;
    write_valid : in std_ulogic;
    write_data  : in std_ulogic_vector(width - 1 downto 0);
    read_ready  : in std_ulogic;
    mark        : in std_ulogic  -- follow the word that is written now
  );
end entity;

architecture properties of fifo_formal is

  signal write_ready, read_valid : std_ulogic;
  signal read_data   : std_ulogic_vector(width - 1 downto 0);
  signal begun       : std_ulogic := '0';                  -- the reset of power-up is over
  signal store, load : std_ulogic;

  signal count       : natural range 0 to depth + 1 := 0;  -- words that came in and have not left

  -- The followed word: whether it is inside, and how many words are ahead of it.
  signal inside : std_ulogic := '0';
  signal ahead  : natural range 0 to depth := 0;
  signal word   : std_ulogic_vector(width - 1 downto 0);

begin

  default clock is rising_edge(clk);

  dut : entity work.fifo
    generic map (width => width, depth => depth)
    port map (
      clock => clk, reset => reset,
      write_valid => write_valid, write_ready => write_ready, write_data => write_data,
      read_valid => read_valid, read_ready => read_ready, read_data => read_data);

  store <= write_valid and write_ready;
  load  <= read_valid and read_ready;

  follow : process (clk) is
    variable left : natural range 0 to depth + 1;  -- words inside, without the one that comes
  begin
    if rising_edge(clk) then
      begun <= '1';
      left  := count;
      if load = '1' then
        left := count - 1;
      end if;
      count <= left;
      if store = '1' then
        count <= left + 1;
      end if;
      if inside = '1' and load = '1' then
        if ahead = 0 then
          inside <= '0';
        else
          ahead <= ahead - 1;
        end if;
      elsif inside = '0' and store = '1' and mark = '1' then
        inside <= '1';
        ahead  <= left;
        word   <= write_data;
      end if;
      if reset = '1' then
        count  <= 0;
        inside <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The words inside are those that came in less those that left. There are never more than depth + 1.
  never_overflows : assert always count <= depth + 1 and (store = '0' or load = '1' or count <= depth);

  -- It offers a word only if there is one.
  never_underflows : assert always begun = '1' and read_valid = '1' -> count > 0;

  -- It refuses a word only when it is full, with depth + 1 words inside.
  takes_while_room : assert always begun = '1' and write_ready = '0' -> count = depth + 1;

  -- Words leave in the order of arrival: a word with none before it is the one on offer.
  order_kept : assert always inside = '1' and ahead = 0 and read_valid = '1' -> read_data = word;

  -- The word on offer stays the same until it is taken.
  offer_stands : assert always read_valid = '1' and read_ready = '0' and reset = '0' ->
                 next (read_valid = '1' and read_data = prev(read_data));

  -- A word that enters an empty fifo is on offer two clocks later.
  falls_through : assert always store = '1' and count = 0 and reset = '0' ->
                  next (reset = '0' -> next (read_valid = '1'));

  -- All places are taken.
  full : cover {write_ready = '0' and read_valid = '1' and count = depth + 1};

  -- A full fifo takes a word in and gives one out in the same clock.
  flows : cover {load = '1' and store = '1' and count = depth};

end architecture;
