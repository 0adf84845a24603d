-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of ft245_sync. The chip's flags and data have any value in every clock that the datasheet allows. A byte
-- is read or written in each clock in which flag and strobe are both low, as the datasheet says. The streams run on the
-- chip's clock here. The crossing to another clock is async_fifo, which has a proof of its own.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity ft245_sync_formal is
  port (
    clk          : in std_ulogic;
    reset        : in std_ulogic;
    rxf_n        : in std_ulogic;
    txe_n        : in std_ulogic;
    data_to_fpga : in std_ulogic_vector(7 downto 0);
    rx_ready     : in std_ulogic;
    tx_valid     : in std_ulogic;
    tx_data      : in std_ulogic_vector(7 downto 0)
  );
end entity;

architecture properties of ft245_sync_formal is

  constant burst_clocks : positive := 4;

  signal begun : std_ulogic := '0'; -- the reset of power-up is over

  signal oe_n, rd_n, wr_n, siwu_n, data_drive : std_ulogic;
  signal data_out, rx_data                    : std_ulogic_vector(7 downto 0);
  signal rx_valid, tx_ready                   : std_ulogic;
  signal reads, writes                        : std_ulogic; -- a byte moves

  signal oe_before, wr_before, siwu_before    : std_ulogic := '1';
  signal drive_before, refused                : std_ulogic := '0';
  signal data_before                          : std_ulogic_vector(7 downto 0);
  signal owed                                 : std_ulogic := '0'; -- a message has ended, siwu_n has not fallen since
  signal read_some, wrote_some                : std_ulogic := '0';

begin

  default clock is rising_edge(clk);

  -- The top bit of a byte marks the last byte of a message. So the chip's side need not remember which byte was the
  -- last.
  dut : entity work.ft245_sync
    generic map (rx_depth => 4, tx_depth => 4, burst_clocks => burst_clocks, si_ns => 40)
    port map (
      clock => clk, reset => reset, chip_clock => clk,
      rxf_n => rxf_n, txe_n => txe_n, oe_n => oe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
      data_in => data_to_fpga, data_out => data_out, data_drive => data_drive,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_data(7), tx_publish => '0');

  reads  <= rd_n nor rxf_n;
  writes <= wr_n nor txe_n;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun        <= '1';
      oe_before    <= oe_n;
      wr_before    <= wr_n;
      siwu_before  <= siwu_n;
      drive_before <= data_drive;
      data_before  <= data_out;
      refused      <= not wr_n and txe_n;
      read_some    <= read_some or reads;
      wrote_some   <= wrote_some or writes;
      if siwu_n = '0' and siwu_before = '1' then
        owed <= '0';
      end if;
      if writes = '1' and data_out(7) = '1' then
        owed <= '1';
      end if;
      if reset = '1' then
        wr_before   <= '1';
        siwu_before <= '1';
        refused     <= '0';
        owed        <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The bus is never driven from both sides. The FPGA does not drive while oe_n is low, nor in the clock after.
  one_driver : assert always begun = '1' and data_drive = '1' -> oe_n = '1' and oe_before = '1';
  -- oe_n is not low while the FPGA drives, nor in the clock after. So nobody drives for one clock between the two.
  turns_around : assert always begun = '1' and oe_n = '0' -> data_drive = '0' and drive_before = '0';

  -- The chip drives in every clock in which a byte is read, and in the clock before.
  reads_what_is_driven : assert always begun = '1' and rd_n = '0' -> oe_n = '0' and oe_before = '0' and wr_n = '1';

  -- The FPGA drives while it writes.
  writes_what_it_drives : assert always begun = '1' and wr_n = '0' -> data_drive = '1';

  -- A byte for which the chip has no room stays the same until it is taken, or until the FPGA ends the write.
  refused_stands : assert always begun = '1' and refused = '1' and wr_n = '0' -> data_out = data_before;

  -- siwu_n falls only after the chip has taken the last byte of a message.
  sends_behind_messages : assert always begun = '1' and siwu_n = '0' and siwu_before = '1' -> owed = '1';

  -- One byte is passed each way.
  both_ways : cover {begun = '1' and read_some = '1' and wrote_some = '1'};
  -- The end of a message makes the chip send.
  sent : cover {begun = '1' and siwu_n = '0'};

end architecture;
