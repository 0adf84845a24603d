-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the two queues of a fifo_slave. In each direction any one word is followed from its arrival to its
-- departure.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity fifo_slave_formal is
  port (
    clk           : in std_ulogic;
    reset         : in std_ulogic;
    m2s           : in wishbone_m2s_t;
    to_pc_valid   : in std_ulogic;
    to_pc_data    : in std_ulogic_vector(7 downto 0);
    from_pc_ready : in std_ulogic;
    mark          : in std_ulogic  -- follow the word that comes now
  );
end entity;

architecture properties of fifo_slave_formal is

  constant depth         : positive := 2;
  constant remind_clocks : positive := 6;

  signal s2m : wishbone_s2m_t;
  signal arrival, not_empty           : std_ulogic;
  signal to_pc_ready, from_pc_valid   : std_ulogic;
  signal from_pc_data                 : std_ulogic_vector(7 downto 0);
  signal begun                        : std_ulogic := '0';
  signal answered, is_data            : std_ulogic;
  signal comes, leaves                : std_ulogic;  -- a word to the PC enters, or has been read
  signal sent, taken                  : std_ulogic;  -- a word from the PC has been written, or leaves

  signal up, was_up     : natural range 0 to depth + 1 := 0;  -- words to the PC that came and have not been read
  signal down, was_down : natural range 0 to depth + 1 := 0;  -- words from the PC

  -- The followed words: whether they are inside, and how many words are ahead of them.
  signal up_inside, down_inside : std_ulogic := '0';
  signal up_ahead, down_ahead   : natural range 0 to depth := 0;
  signal up_word, down_word     : std_ulogic_vector(7 downto 0) := (others => '0');

  signal high_clocks : natural range 0 to remind_clocks + 1 := 0;  -- for which arrival has been high
  signal low_clocks  : natural range 0 to 4 := 0;                  -- for which it has been low, though a word waits

begin

  default clock is rising_edge(clk);

  dut : entity work.fifo_slave
    generic map (depth => depth, data_width => 8, remind_clocks => remind_clocks)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, arrival => arrival,
      not_empty => not_empty, to_pc_valid => to_pc_valid, to_pc_ready => to_pc_ready, to_pc_data => to_pc_data,
      from_pc_valid => from_pc_valid, from_pc_ready => from_pc_ready, from_pc_data => from_pc_data);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  answered <= s2m.ack or s2m.err;
  is_data  <= '1' when unsigned(m2s.adr) = 0 else '0';
  comes    <= to_pc_valid and to_pc_ready;
  leaves   <= s2m.ack and not m2s.we and is_data;
  sent     <= s2m.ack and m2s.we;
  taken    <= from_pc_valid and from_pc_ready;

  follow : process (clk) is
    variable up_left, down_left : natural range 0 to depth + 1;  -- words inside, without the one that comes
  begin
    if rising_edge(clk) then
      begun    <= '1';
      was_up   <= up;
      was_down <= down;

      up_left := up;
      if leaves = '1' and up > 0 then
        up_left := up - 1;
      end if;
      up <= up_left;
      if comes = '1' and up_left <= depth then
        up <= up_left + 1;
      end if;
      if up_inside = '1' and leaves = '1' then
        if up_ahead = 0 then
          up_inside <= '0';
        else
          up_ahead <= up_ahead - 1;
        end if;
      elsif up_inside = '0' and comes = '1' and mark = '1' and up_left <= depth then
        up_inside <= '1';
        up_ahead  <= up_left;
        up_word   <= to_pc_data;
      end if;

      down_left := down;
      if taken = '1' and down > 0 then
        down_left := down - 1;
      end if;
      down <= down_left;
      if sent = '1' and down_left <= depth then
        down <= down_left + 1;
      end if;
      if down_inside = '1' and taken = '1' then
        if down_ahead = 0 then
          down_inside <= '0';
        else
          down_ahead <= down_ahead - 1;
        end if;
      elsif down_inside = '0' and sent = '1' and mark = '1' and down_left <= depth then
        down_inside <= '1';
        down_ahead  <= down_left;
        down_word   <= m2s.dat(7 downto 0);
      end if;

      high_clocks <= 0;
      low_clocks  <= 0;
      if arrival = '1' and high_clocks <= remind_clocks then
        high_clocks <= high_clocks + 1;
      end if;
      if arrival = '0' and not_empty = '1' and low_clocks < 4 then
        low_clocks <= low_clocks + 1;
      end if;
      if reset = '1' then
        up          <= 0;
        down        <= 0;
        was_up      <= 0;
        was_down    <= 0;
        up_inside   <= '0';
        down_inside <= '0';
        high_clocks <= 0;
        low_clocks  <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no access during power-up.
  quiet_first : assume always begun = '1' or m2s.stb = '0';

  -- The PC waits for the answer to each access.
  patient : assume always m2s.stb = '1' and answered = '0' and reset = '0' -> next (m2s.stb = '1');

  -- Words to the PC are read in the order in which they came. None is lost, doubled or changed.
  order_to_pc : assert always begun = '0' or leaves = '0' or up_inside = '0' or up_ahead > 0 or
                s2m.dat = 24x"0" & up_word;

  -- A read finds a word only if there is one.
  no_word_invented : assert always begun = '0' or leaves = '0' or up > 0;

  -- A read is refused only if no word waits.
  read_if_there : assert always begun = '0' or s2m.err = '0' or m2s.we = '1' or is_data = '0' or was_up = 0;

  -- The FPGA has to wait only while the queue to the PC is full.
  room_to_pc : assert always begun = '0' or to_pc_ready = '1' or up >= depth;

  -- Words from the PC leave in the order in which they were written. None is lost, doubled or changed.
  order_from_pc : assert always begun = '0' or from_pc_valid = '0' or down_inside = '0' or down_ahead > 0 or
                  from_pc_data = down_word;

  -- The FPGA gets a word only if there is one.
  no_word_from_pc_invented : assert always begun = '0' or from_pc_valid = '0' or down > 0;

  -- A whole write to +0 is refused only if the queue is full.
  written_if_room : assert always begun = '0' or s2m.err = '0' or m2s.we = '0' or is_data = '0' or
                    m2s.sel(0) = '0' or was_down = depth;

  -- Only +0 is written, and only by whole words.
  writes_refused : assert always sent = '1' -> is_data = '1' and m2s.sel(0) = '1';

  -- A read of +1 gives the number of words that wait.
  counts_words : assert always begun = '0' or s2m.ack = '0' or m2s.we = '1' or unsigned(m2s.adr) /= 1 or
                 unsigned(s2m.dat) = was_up;

  -- A read of +2 gives the room for words from the PC.
  counts_room : assert always begun = '0' or s2m.ack = '0' or m2s.we = '1' or unsigned(m2s.adr) /= 2 or
                unsigned(s2m.dat) + was_down = depth;

  -- Other addresses are refused.
  beyond_refused : assert always s2m.ack = '1' -> unsigned(m2s.adr) < 3;

  -- `arrival` is low behind each word that was read, so that the next word is a new edge.
  edge_for_each_word : assert always leaves = '1' -> arrival = '0';

  -- `arrival` is low for at most two clocks while a word waits.
  announced : assert always begun = '0' or low_clocks <= 2;

  -- It rises again if no word is read for remind_clocks.
  reminds : assert always begun = '0' or high_clocks <= remind_clocks - 1;

  -- Both queues are full.
  both_full : cover {begun = '1' and up = depth and down = depth};

end architecture;
