-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the FT245 asynchronous interface at 50 MHz, with a chip whose flags change at any time.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity ft245_async_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    rxf_n      : in std_ulogic;
    txe_n      : in std_ulogic;
    data_in    : in std_ulogic_vector(7 downto 0);
    rx_ready   : in std_ulogic;
    tx_valid   : in std_ulogic;
    tx_data    : in std_ulogic_vector(7 downto 0);
    tx_last    : in std_ulogic;
    tx_publish : in std_ulogic
  );
end entity;

architecture properties of ft245_async_formal is

  signal rd_n, wr_n, siwu_n   : std_ulogic;
  signal data_out             : std_ulogic_vector(7 downto 0);
  signal drive                : std_ulogic;
  signal rx_valid, tx_ready   : std_ulogic;
  signal rx_data              : std_ulogic_vector(7 downto 0);
  signal begun                : std_ulogic := '0';

  signal was_rd_n, was_wr_n, was_siwu_n, was_drive : std_ulogic := '1';  -- one clock ago
  signal was_data     : std_ulogic_vector(7 downto 0) := (others => '0');
  signal rd_low       : natural range 0 to 3 := 0;   -- clocks for which it has been low
  signal wr_low       : natural range 0 to 3 := 0;
  signal siwu_low     : natural range 0 to 15 := 0;
  signal ends         : std_ulogic := '0';           -- the end of a message was taken
  signal after_reset  : std_ulogic := '1';           -- a reset cut short what went on one clock ago

begin

  default clock is rising_edge(clk);

  dut : entity work.ft245_async
    generic map (clock_hz => 50_000_000, rx_depth => 2, tx_depth => 2)
    port map (
      clock => clk, reset => reset, rxf_n => rxf_n, txe_n => txe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
      data_in => data_in, data_out => data_out, data_drive => drive,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun       <= '1';
      after_reset <= reset;
      was_rd_n    <= rd_n;
      was_wr_n    <= wr_n;
      was_siwu_n  <= siwu_n;
      was_drive   <= drive;
      was_data    <= data_out;
      rd_low      <= 0;
      wr_low      <= 0;
      siwu_low    <= 0;
      if rd_n = '0' and rd_low < 3 then
        rd_low <= rd_low + 1;
      end if;
      if wr_n = '0' and wr_low < 3 then
        wr_low <= wr_low + 1;
      end if;
      if siwu_n = '0' and siwu_low < 15 then
        siwu_low <= siwu_low + 1;
      end if;
      if tx_valid = '1' and tx_ready = '1' and tx_last = '1' then
        ends <= '1';
      end if;
      if reset = '1' then
        ends <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- It never reads and writes at the same time.
  one_strobe : assert always begun = '0' or rd_n = '1' or wr_n = '1';

  -- It drives the data only for a write. It never drives while the chip does, nor in the clock after.
  never_both_drive : assert always begun = '0' or drive = '0' or (rd_n = '1' and (after_reset = '1' or was_rd_n = '1'));

  -- It drives the same byte during a write, and for at least one clock before and after.
  byte_stands : assert always begun = '0' or after_reset = '1' or (wr_n = '1' and was_wr_n = '1') or
                (drive = '1' and was_drive = '1' and data_out = was_data);

  -- Each strobe is low for at least two clocks: 30 ns, rounded up.
  strobes_long_enough : assert always begun = '0' or after_reset = '1' or
                        ((was_rd_n = '1' or rd_n = '0' or rd_low >= 2) and
                         (was_wr_n = '1' or wr_n = '0' or wr_low >= 2));

  -- SIWU# falls only if the end of a message has been taken.
  flushes_ends_only : assert always begun = '0' or siwu_n = '1' or after_reset = '1' or ends = '1';

  -- SIWU# stays low for 13 clocks: 250 ns, rounded up.
  flush_long_enough : assert always begun = '0' or after_reset = '1' or was_siwu_n = '1' or siwu_n = '0' or
                      siwu_low >= 13;

  -- A byte is read after one was written.
  both_ways_seen : cover {rx_valid = '1' and ends = '1' and siwu_low > 0};

  -- SIWU# falls.
  flush_seen : cover {siwu_n = '0' and ends = '1' and after_reset = '0'};

end architecture;
