-- SPDX-License-Identifier: BSD-3-Clause
--
-- A core's physical layer and the other end of its wires, as the byte streams that a PC sees. Benches put it before a
-- core.
--
-- Kinds     "none", "fifo" (of `fifo_words`), "uart", "spi_slave", "ft245_async", "ft245_sync", "rs485" (node 1).
-- Ports     in, out: bytes to and from the core, as the PC gives and takes them. rx, tx: the ports of the core.
-- Pressure  While out_ready is low, the PC takes nothing, and a chip fills up. An SPI slave and an RS-485 node send
--           only when the PC asks: it sends zeros, or polls. A UART always sends, and bytes that are not taken are
--           lost.

library ieee;
  use ieee.std_logic_1164.all;

use work.bench_pkg.all;
use work.physical_pkg.all;
use work.stream_bench_pkg.all;

entity far_end is
  generic (
    kind       : string;
    fifo_words : positive := 16;
    seed       : positive := 1
  );
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic;
    running    : in  boolean;
    in_valid   : in  std_ulogic;
    in_ready   : out std_ulogic;
    in_data    : in  std_ulogic_vector(7 downto 0);
    out_valid  : out std_ulogic;
    out_ready  : in  std_ulogic;
    out_data   : out std_ulogic_vector(7 downto 0);
    rx_valid   : out std_ulogic;
    rx_ready   : in  std_ulogic;
    rx_data    : out std_ulogic_vector(7 downto 0);
    rx_error   : out receive_error_t;
    tx_valid   : in  std_ulogic;
    tx_ready   : out std_ulogic;
    tx_data    : in  std_ulogic_vector(7 downto 0);
    tx_last    : in  std_ulogic;
    tx_publish : in  std_ulogic
  );
end entity;

architecture bench of far_end is

  constant clock_hz : positive := 50_000_000;

begin

  wires : if kind = "fifo" generate
    rx_error <= no_receive_error;

    rx_fifo : entity work.fifo
      generic map (width => 8, depth => fifo_words)
      port map (
        clock => clock, reset => reset, write_valid => in_valid, write_ready => in_ready, write_data => in_data,
        read_valid => rx_valid, read_ready => rx_ready, read_data => rx_data);
    tx_fifo : entity work.fifo
      generic map (width => 8, depth => fifo_words)
      port map (
        clock => clock, reset => reset, write_valid => tx_valid, write_ready => tx_ready, write_data => tx_data,
        read_valid => out_valid, read_ready => out_ready, read_data => out_data);

  elsif kind = "ft245_async" generate
    signal rxf_n, txe_n, rd_n, wr_n, siwu_n, data_drive : std_ulogic;
    signal data_to_fpga, data_to_chip                   : std_ulogic_vector(7 downto 0);
  begin
    rx_error <= no_receive_error;

    ft245 : entity work.ft245_async
      generic map (clock_hz => clock_hz)
      port map (
        clock => clock, reset => reset,
        rxf_n => rxf_n, txe_n => txe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_in => data_to_fpga, data_out => data_to_chip, data_drive => data_drive,
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);
    chip : entity work.ft245_async_model
      generic map (seed => seed, room_bytes => 4)
      port map (
        clock => clock, rxf_n => rxf_n, txe_n => txe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_to_fpga => data_to_fpga, data_to_chip => data_to_chip, data_drive => data_drive,
        to_fpga_valid => in_valid, to_fpga_ready => in_ready, to_fpga_data => in_data,
        from_fpga_valid => out_valid, from_fpga_ready => out_ready, from_fpga_data => out_data,
        written => open, si_pulses => open);

  elsif kind = "ft245_sync" generate
    signal chip_clock, rxf_n, txe_n, oe_n, rd_n, wr_n, siwu_n, data_drive : std_ulogic;
    signal data_to_fpga, data_to_chip                                     : std_ulogic_vector(7 downto 0);
  begin
    rx_error <= no_receive_error;

    ft245 : entity work.ft245_sync
      port map (
        clock => clock, reset => reset, chip_clock => chip_clock,
        rxf_n => rxf_n, txe_n => txe_n, oe_n => oe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_in => data_to_fpga, data_out => data_to_chip, data_drive => data_drive,
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);
    chip : entity work.ft245_sync_model
      generic map (seed => seed, room_bytes => 4)
      port map (
        clock => clock, running => running, chip_clock => chip_clock,
        rxf_n => rxf_n, txe_n => txe_n, oe_n => oe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_to_fpga => data_to_fpga, data_to_chip => data_to_chip, data_drive => data_drive,
        to_fpga_valid => in_valid, to_fpga_ready => in_ready, to_fpga_data => in_data,
        from_fpga_valid => out_valid, from_fpga_ready => out_ready, from_fpga_data => out_data,
        written => open, si_pulses => open);

  elsif kind = "uart" generate
    signal to_fpga, from_fpga : std_ulogic;
  begin
    physical : entity work.uart
      generic map (clock_hz => clock_hz, baud_hz => clock_hz / 8)
      port map (
        clock => clock, reset => reset, rx_line => to_fpga, tx_line => from_fpga, line_break => open,
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data);
    adapter : entity work.uart
      generic map (clock_hz => clock_hz, baud_hz => clock_hz / 8)
      port map (
        clock => clock, reset => reset, rx_line => from_fpga, tx_line => to_fpga, line_break => open,
        rx_valid => out_valid, rx_ready => out_ready, rx_data => out_data, rx_error => open,
        tx_valid => in_valid, tx_ready => in_ready, tx_data => in_data);

  elsif kind = "rs485" generate
    signal to_node, from_node, node_line, drive : std_ulogic;
  begin
    from_node <= node_line when drive = '1' else '1';

    physical : entity work.rs485
      generic map (clock_hz => clock_hz, baud_hz => clock_hz / 8)
      port map (
        clock => clock, reset => reset, node => "000001", rx_line => to_node, tx_line => node_line, drive => drive,
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last);
    adapter : entity work.uart
      generic map (clock_hz => clock_hz, baud_hz => clock_hz / 8)
      port map (
        clock => clock, reset => reset, rx_line => from_node, tx_line => to_node, line_break => open,
        rx_valid => out_valid, rx_ready => out_ready, rx_data => out_data, rx_error => open,
        tx_valid => in_valid, tx_ready => in_ready, tx_data => in_data);

  elsif kind = "spi_slave" generate
    signal sck  : std_ulogic := '0';
    signal cs_n : std_ulogic := '1';
    signal mosi : std_ulogic := '0';
    signal miso : std_ulogic;
  begin
    physical : entity work.spi_slave
      port map (
        clock => clock, reset => reset, sck => sck, cs_n => cs_n, mosi => mosi, miso => miso, miso_drive => open,
        waiting => open, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last);

    master : process
      constant half_bit    : time := 2 sec / clock_hz;
      variable given, came : std_ulogic_vector(7 downto 0);
    begin
      in_ready  <= '0';
      out_valid <= '0';
      wait until rising_edge(clock) and in_valid = '1';
      cs_n <= '0';
      wait_clocks(clock, 8);
      while in_valid = '1' loop
        given := in_data;
        pulse(clock, in_ready);
        spi_exchange(sck, mosi, miso, half_bit, given, came);
        send(clock, out_valid, out_ready, out_data, came);
      end loop;
      wait_clocks(clock, 4);
      cs_n <= '1';
      wait_clocks(clock, 8);
    end process;

  else generate
    rx_error <= no_receive_error;
    rx_valid <= in_valid;
    in_ready <= rx_ready;
    rx_data  <= in_data;
    out_valid <= tx_valid;
    tx_ready  <= out_ready;
    out_data  <= tx_data;
  end generate;

end architecture;
