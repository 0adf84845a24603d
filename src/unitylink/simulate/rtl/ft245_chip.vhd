-- SPDX-License-Identifier: BSD-3-Clause
--
-- An FTDI chip in asynchronous FIFO mode for compiled gateware: its pins on one side, USB as byte streams on the other.
-- It works in clocks, not nanoseconds, and so fits any clock; gateware/test/ft245_async_model.vhd is the one that
-- checks times.
--
--   to_fpga --> rxf_n, rd_n, data --> FPGA
--   from_fpga <-- | 512 bytes | <-- data, wr_n, txe_n <-- FPGA
--
-- Collects  What the FPGA writes stays here until a packet is full (510 bytes), siwu_n falls, or the latency timer has
--           run out since the first byte of it, as in the chip.
-- Errors    An assertion fails where the FPGA reads or writes without the flag, or drives what the chip drives.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;

entity ft245_chip is
  generic (
    latency_clocks : positive := 16_000; -- 16 ms at 1 MHz
    packet_bytes   : positive := 510
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic;

    rxf_n        : out std_ulogic;
    txe_n        : out std_ulogic;
    rd_n         : in  std_ulogic;
    wr_n         : in  std_ulogic;
    siwu_n       : in  std_ulogic;
    data_to_fpga : out std_ulogic_vector(7 downto 0);
    data_to_chip : in  std_ulogic_vector(7 downto 0);
    data_drive   : in  std_ulogic;

    to_fpga_valid   : in  std_ulogic;
    to_fpga_ready   : out std_ulogic;
    to_fpga_data    : in  std_ulogic_vector(7 downto 0);
    from_fpga_valid : out std_ulogic;
    from_fpga_ready : in  std_ulogic;
    from_fpga_data  : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of ft245_chip is

  constant depth : positive := 512;

  signal read_before, write_before, siwu_before : std_ulogic := '1'; -- the strobes, a clock ago
  signal offered   : std_ulogic := '0';                              -- rxf_n is low
  signal open_up   : std_ulogic := '0';                              -- txe_n is low
  signal put, room : std_ulogic;
  signal has, take : std_ulogic;
  signal collected : natural range 0 to depth + 1 := 0;              -- bytes that nothing has sent yet
  signal due       : natural range 0 to depth + 1 := 0;              -- bytes that USB may have
  signal timer     : natural range 0 to latency_clocks := 0;

begin

  assert rd_n = '1' or data_drive = '0'
    report "ft245_chip: both sides drive the bus" severity failure;
  assert rd_n = '1' or read_before = '0' or offered = '1'
    report "ft245_chip: read without rxf_n" severity failure;
  assert wr_n = '1' or write_before = '0' or (open_up = '1' and data_drive = '1')
    report "ft245_chip: written without txe_n or data" severity failure;

  rxf_n         <= not offered;
  txe_n         <= not open_up;
  data_to_fpga  <= to_fpga_data when rd_n = '0' else x"FF";
  to_fpga_ready <= rd_n and not read_before; -- when the strobe is over
  put           <= write_before and not wr_n;

  collect : entity unitylink.fifo
    generic map (width => 8, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => put, write_ready => room, write_data => data_to_chip,
      read_valid => has, read_ready => take, read_data => from_fpga_data);

  from_fpga_valid <= '1' when has = '1' and due > 0 else '0';
  take            <= '1' when from_fpga_ready = '1' and due > 0 else '0';

  process (clock) is
    variable more, free : natural range 0 to depth + 1;
  begin
    if rising_edge(clock) then
      read_before  <= rd_n;
      write_before <= wr_n;
      siwu_before  <= siwu_n;
      offered      <= to_fpga_valid and (not read_before or rd_n) and not to_fpga_ready;
      open_up      <= room and wr_n and write_before;

      more := collected;
      if put = '1' then
        more := more + 1;
      end if;
      free := due;
      if take = '1' and has = '1' then
        free := free - 1;
      end if;
      timer <= 0;
      if more > 0 and timer < latency_clocks then
        timer <= timer + 1;
      end if;
      if (siwu_before = '1' and siwu_n = '0') or more >= packet_bytes or timer = latency_clocks then
        free  := free + more;
        more  := 0;
        timer <= 0;
      end if;
      collected <= more;
      due       <= free;

      if reset = '1' then
        read_before  <= '1';
        write_before <= '1';
        siwu_before  <= '1';
        offered      <= '0';
        open_up      <= '0';
        collected    <= 0;
        due          <= 0;
        timer        <= 0;
      end if;
    end if;
  end process;

end architecture;
