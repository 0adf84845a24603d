-- SPDX-License-Identifier: BSD-3-Clause
--
-- Property of ft245_sync: it keeps every byte, against the chip of ft245_sync_formal. All bits of a byte are equal
-- here, so that all eight are followed at the cost of one.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity ft245_sync_bytes_formal is
  port (
    clk          : in std_ulogic;
    reset        : in std_ulogic;
    rxf_n        : in std_ulogic;
    txe_n        : in std_ulogic;
    colour_in    : in std_ulogic; -- each bit of the byte from the chip, if there is one
    rx_ready     : in std_ulogic;
    tx_valid     : in std_ulogic;
    colour_out   : in std_ulogic; -- each bit of the byte to the chip
    mark_in      : in std_ulogic; -- follow this byte
    mark_out     : in std_ulogic
  );
end entity;

architecture properties of ft245_sync_bytes_formal is

  constant burst_clocks : positive := 4;

  signal begun : std_ulogic := '0'; -- the reset of power-up is over

  signal oe_n, rd_n, wr_n, siwu_n, data_drive : std_ulogic;
  signal data_to_fpga, tx_data                : std_ulogic_vector(7 downto 0);
  signal data_out, rx_data                    : std_ulogic_vector(7 downto 0);
  signal rx_valid, tx_ready                   : std_ulogic;
  signal reads, writes, says, takes           : std_ulogic; -- a byte moves, on the bus or on a stream
  signal offered                              : std_ulogic; -- a byte to the chip is on the bus

  signal read_some, wrote_some                : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  dut : entity work.ft245_sync
    generic map (rx_depth => 4, tx_depth => 4, burst_clocks => burst_clocks, si_ns => 40)
    port map (
      clock => clk, reset => reset, chip_clock => clk,
      rxf_n => rxf_n, txe_n => txe_n, oe_n => oe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
      data_in => data_to_fpga, data_out => data_out, data_drive => data_drive,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => '1', tx_publish => '0');

  data_to_fpga <= (others => colour_in);
  tx_data      <= (others => colour_out);

  reads   <= rd_n nor rxf_n;
  writes  <= wr_n nor txe_n;
  offered <= not wr_n;
  says    <= tx_valid and tx_ready;
  takes   <= rx_valid and rx_ready;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun      <= '1';
      read_some  <= read_some or reads;
      wrote_some <= wrote_some or writes;
    end if;
  end process;

  -- At most five bytes: four in the memory, one in its output register, one on its way into the memory. A burst ends
  -- before all places are taken.
  to_fpga : entity work.order_view
    generic map (most => 5)
    port map (
      clk => clk, reset => reset, comes => reads, came => data_to_fpga, mark => mark_in,
      offered => rx_valid, goes => takes, word => rx_data);

  -- Four bytes in the memory, one in its output register, and one on the bus.
  to_chip : entity work.order_view
    generic map (most => 6)
    port map (
      clk => clk, reset => reset, comes => says, came => tx_data, mark => mark_out,
      offered => offered, goes => writes, word => data_out);

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- One byte is passed each way.
  both_ways : cover {begun = '1' and read_some = '1' and wrote_some = '1'};
end architecture;
