-- SPDX-License-Identifier: BSD-3-Clause
--
-- A queue in each direction on the Wishbone bus.
--
--   +0  read: removes and gives the oldest word from the FPGA; err if there is none
--       write: one word to the FPGA; err if there is no room
--   +1  read: words from the FPGA that wait        +2  read: words for which the FPGA still has room
--
-- Event     arrival rises once for every word from the FPGA. It is high while words wait, and low for one clock after a
--           word was removed. Connect it to an edge event input of a subscription group with the address +0. Then every
--           word is published as soon as possible, at no fixed rate, and no word is requested that is not there. A
--           level input would request once too often, because it still sees the last word while this word is published.
--           If nothing was removed for remind_clocks, arrival rises again. So a group that was enabled late gets its
--           words. not_empty is the plain level, for logic of your own.
-- FPGA side to_pc_valid/ready/data puts a word in. from_pc_valid/ready/data takes a word out.
-- Capacity  `depth` words in each direction. A full queue never loses a word: it refuses (err) or waits (ready low).
-- Latency   ack or err one clock after strobe: 2 clocks per access. 2 more clocks if a word has just entered an empty
--           queue.
-- Errors    err also for other addresses, for writes to +1 and +2, and for a write that does not select all bytes by
--           sel.
-- Reset     Empties both queues.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity fifo_slave is
  generic (
    depth         : positive range 2 to 2 ** 16 := 16; -- words in each direction, a power of two
    data_width    : positive range 8 to 32      := 32;
    remind_clocks : positive range 4 to 2 ** 30 := 2 ** 20
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    arrival   : out std_ulogic;
    not_empty : out std_ulogic;

    to_pc_valid : in  std_ulogic;
    to_pc_ready : out std_ulogic;
    to_pc_data  : in  std_ulogic_vector(data_width - 1 downto 0);

    from_pc_valid : out std_ulogic;
    from_pc_ready : in  std_ulogic;
    from_pc_data  : out std_ulogic_vector(data_width - 1 downto 0)
  );
end entity;

architecture rtl of fifo_slave is

  constant all_bytes : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  subtype word_t is std_ulogic_vector(data_width - 1 downto 0);

  signal waiting      : natural range 0 to depth; -- words to the PC
  signal room         : natural range 0 to depth; -- for words from the PC
  signal oldest_valid : std_ulogic;               -- the oldest word to the PC has come out of its queue
  signal oldest       : word_t;
  signal asked        : std_ulogic;
  signal is_data      : std_ulogic;               -- the access is at +0
  signal put, take    : std_ulogic;               -- the bus writes or reads +0, and may
  signal word         : word_t;
  signal ack, err     : std_ulogic;
  signal patience     : natural range 0 to remind_clocks - 1; -- clocks until arrival rises again

begin

  assert data_width > 16 or depth < 2 ** data_width
    report "fifo_slave: a depth of " & integer'image(depth) & " does not fit a word of " & integer'image(data_width)
           & " bits"
    severity failure;

  asked   <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  is_data <= '1' when unsigned(wishbone_m2s.adr) = 0 else '0';

  put  <= '1' when asked = '1' and wishbone_m2s.we = '1' and is_data = '1' and room > 0
                   and wishbone_m2s.sel(all_bytes'range) = all_bytes else '0';
  take <= asked and not wishbone_m2s.we and is_data and oldest_valid;

  not_empty   <= '1' when waiting > 0 else '0';
  to_pc_ready <= '1' when waiting < depth else '0';

  -- The counts keep both queues at `depth` words or less, so these fifos are always ready for them.
  to_pc : entity work.fifo
    generic map (width => data_width, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => to_pc_valid and to_pc_ready, write_ready => open, write_data => to_pc_data,
      read_valid => oldest_valid, read_ready => take, read_data => oldest);

  from_pc : entity work.fifo
    generic map (width => data_width, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => put, write_ready => open, write_data => wishbone_m2s.dat(data_width - 1 downto 0),
      read_valid => from_pc_valid, read_ready => from_pc_ready, read_data => from_pc_data);

  process (clock) is
  begin
    if rising_edge(clock) then
      ack <= '0';
      err <= '0';
      if asked = '1' then
        if wishbone_m2s.we = '1' then
          ack <= put;
          err <= not put;
        elsif is_data = '1' then
          -- A read waits for a word that has just been put in.
          word <= oldest;
          ack  <= take;
          err  <= '1' when waiting = 0 else '0';
        elsif unsigned(wishbone_m2s.adr) = 1 then
          word <= std_ulogic_vector(to_unsigned(waiting, data_width));
          ack  <= '1';
        elsif unsigned(wishbone_m2s.adr) = 2 then
          word <= std_ulogic_vector(to_unsigned(room, data_width));
          ack  <= '1';
        else
          err <= '1';
        end if;
      end if;

      if to_pc_valid = '1' and to_pc_ready = '1' and take = '0' then
        waiting <= waiting + 1;
      elsif (to_pc_valid = '0' or to_pc_ready = '0') and take = '1' then
        waiting <= waiting - 1;
      end if;

      if put = '1' and (from_pc_valid = '0' or from_pc_ready = '0') then
        room <= room - 1;
      elsif put = '0' and from_pc_valid = '1' and from_pc_ready = '1' then
        room <= room + 1;
      end if;

      arrival <= '1' when waiting > 0 and take = '0' and patience > 0 else '0';
      if waiting = 0 or take = '1' or patience = 0 then
        patience <= remind_clocks - 1;
      else
        patience <= patience - 1;
      end if;

      if reset = '1' then
        arrival  <= '0';
        patience <= remind_clocks - 1;
        ack      <= '0';
        err      <= '0';
        waiting  <= 0;
        room     <= depth;
      end if;
    end if;
  end process;

  process (all) is
  begin
    wishbone_s2m                              <= wishbone_s2m_idle;
    wishbone_s2m.dat(data_width - 1 downto 0) <= word;
    wishbone_s2m.ack                          <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err                          <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
  end process;

end architecture;
