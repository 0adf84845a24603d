-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of async_fifo, between two clocks with any timing that z3 chooses. The order is checked by following any
-- one word by its number.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity async_fifo_formal is
  generic (
    depth : positive := 4
  );
  port (
    write_clk   : in std_ulogic;
    read_clk    : in std_ulogic;
    write_valid : in std_ulogic;
    write_data  : in std_ulogic_vector(0 downto 0);
    read_ready  : in std_ulogic;
    mark        : in std_ulogic  -- follow the word that is written now
  );
end entity;

architecture properties of async_fifo_formal is

  subtype number_t is unsigned(3 downto 0); -- of a word modulo 16; at most depth + 1 words are inside

  signal write_ready, read_valid : std_ulogic;
  signal read_data               : std_ulogic_vector(0 downto 0);
  signal came, went              : number_t := (others => '0');
  signal follow                  : number_t := (others => '0'); -- number of the word that is followed
  signal marked                  : std_ulogic := '0';
  signal word                    : std_ulogic_vector(0 downto 0);
  signal inside                  : number_t;

begin

  default clock is rising_edge(write_clk);

  dut : entity work.async_fifo
    generic map (width => 1, depth => depth)
    port map (
      write_clock => write_clk, write_reset => '0',
      write_valid => write_valid, write_ready => write_ready, write_data => write_data,
      read_clock => read_clk, read_reset => '0',
      read_valid => read_valid, read_ready => read_ready, read_data => read_data);

  write_side : process (write_clk) is
  begin
    if rising_edge(write_clk) then
      if write_valid = '1' and write_ready = '1' then
        came <= came + 1;
        if mark = '1' and marked = '0' then
          follow <= came;
          marked <= '1';
          word   <= write_data;
        end if;
      end if;
    end if;
  end process;

  read_side : process (read_clk) is
  begin
    if rising_edge(read_clk) then
      if read_valid = '1' and read_ready = '1' then
        went <= went + 1;
      end if;
    end if;
  end process;

  inside <= came - went;

  -- The words inside are those that came in less those that left. There are never more than depth + 1.
  never_overflows : assert always inside <= depth + 1;

  -- It offers a word only if there is one.
  never_underflows : assert always read_valid = '1' -> inside /= 0;

  -- No word is lost, doubled or changed: the word on offer is the next in the order of arrival.
  order_kept : assert always read_valid = '1' and marked = '1' and went = follow and inside <= 8 -> read_data = word;

  -- All places are taken.
  full : cover {inside = depth + 1};

  -- A word has come through.
  flows : cover {went = 1};

end architecture;
