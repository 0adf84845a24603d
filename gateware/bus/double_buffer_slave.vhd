-- SPDX-License-Identifier: BSD-3-Clause
--
-- Double-buffered memory on the Wishbone bus: a commit makes all that the PC wrote visible to the FPGA at once.
--
--   +0 .. words - 1   write: the hidden bank                       read: the visible bank
--   +words            write any value: commit, the banks swap      read: number of commits so far
--
-- Hazard     A commit swaps the banks and does not copy. A word that is not written before a commit has its value of
--            two commits ago.
-- FPGA side  user_read_data is the visible word at user_read_address, one clock later. The FPGA writes words of its own
--            to the visible bank by user_write_valid/ready. committed is high for one clock when a commit took effect.
--            Read words that belong together after it.
-- Block      While cyc is high, user_write_ready is low, so a read-many or a publish sees one moment. The FPGA's word
--            waits for the end of the block, and the next block sees it.
-- Latency    ack or err one clock after strobe: 2 clocks per access.
-- Errors     err for an address beyond +words, and for a write that does not select all bytes by sel. Such an access
--            changes nothing.
-- Reset      Sets the number of commits to zero and makes the first bank visible. Both banks are zero at power-up
--            (initial value of block RAM), and a reset keeps their words.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity double_buffer_slave is
  generic (
    words      : positive range 1 to 2 ** 20 := 16;
    data_width : positive range 8 to 32      := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    committed : out std_ulogic;

    user_read_address : in  natural range 0 to words - 1;
    user_read_data    : out std_ulogic_vector(data_width - 1 downto 0);

    user_write_valid   : in  std_ulogic;
    user_write_ready   : out std_ulogic;
    user_write_address : in  natural range 0 to words - 1;
    user_write_data    : in  std_ulogic_vector(data_width - 1 downto 0)
  );
end entity;

architecture rtl of double_buffer_slave is

  constant index_bits : positive := bits_for(words);
  constant all_bytes  : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  subtype word_t is std_ulogic_vector(data_width - 1 downto 0);
  type banks_t is array (0 to 2 ** (index_bits + 1) - 1) of word_t; -- bank above index

  signal banks       : banks_t := (others => (others => '0'));
  signal visible     : std_ulogic := '0';
  signal commits     : unsigned(data_width - 1 downto 0);
  signal word        : word_t;     -- the word from the banks …
  signal counting    : std_ulogic; -- … or the number of commits
  signal asked       : std_ulogic;
  signal ack, err    : std_ulogic;
  signal is_word     : std_ulogic;
  signal is_commit   : std_ulogic;
  signal whole       : std_ulogic;
  signal write       : std_ulogic;
  signal write_index : unsigned(index_bits downto 0);
  signal write_word  : word_t;
  signal index       : unsigned(index_bits - 1 downto 0);

begin

  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  is_word   <= '1' when unsigned(wishbone_m2s.adr) < words else '0';
  is_commit <= '1' when unsigned(wishbone_m2s.adr) = words else '0';
  whole     <= '1' when wishbone_m2s.sel(all_bytes'range) = all_bytes else '0';
  index     <= unsigned(wishbone_m2s.adr(index_bits - 1 downto 0));

  -- One write port is enough, because the FPGA writes only while no bus cycle is open.
  user_write_ready <= not wishbone_m2s.cyc;

  process (all) is
  begin
    if wishbone_m2s.cyc = '1' then
      write       <= asked and wishbone_m2s.we and is_word and whole;
      write_index <= (not visible) & index;
      write_word  <= wishbone_m2s.dat(data_width - 1 downto 0);
    else
      write       <= user_write_valid;
      write_index <= visible & to_unsigned(user_write_address, index_bits);
      write_word  <= user_write_data;
    end if;
  end process;

  memory : process (clock) is
  begin
    if rising_edge(clock) then
      if write = '1' then
        banks(to_integer(write_index)) <= write_word;
      end if;
      word           <= banks(to_integer(unsigned'(visible & index)));
      user_read_data <= banks(to_integer(unsigned'(visible & to_unsigned(user_read_address, index_bits))));
    end if;
  end process;

  control : process (clock) is
  begin
    if rising_edge(clock) then
      ack       <= '0';
      err       <= '0';
      committed <= '0';
      if asked = '1' then
        counting <= is_commit;
        if (is_word = '0' and is_commit = '0') or (wishbone_m2s.we = '1' and whole = '0') then
          err <= '1';
        else
          ack <= '1';
          if wishbone_m2s.we = '1' and is_commit = '1' then
            visible   <= not visible;
            commits   <= commits + 1;
            committed <= '1';
          end if;
        end if;
      end if;
      if reset = '1' then
        ack       <= '0';
        err       <= '0';
        committed <= '0';
        visible   <= '0';
        commits   <= (others => '0');
      end if;
    end if;
  end process;

  process (all) is
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    if counting = '1' then
      wishbone_s2m.dat(data_width - 1 downto 0) <= std_ulogic_vector(commits);
    else
      wishbone_s2m.dat(data_width - 1 downto 0) <= word;
    end if;
  end process;

end architecture;
