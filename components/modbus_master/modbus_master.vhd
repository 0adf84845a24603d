-- SPDX-License-Identifier: BSD-3-Clause
--
-- A master of Modbus RTU on RS-485: reads registers of its devices again and again, and sends them what the PC has
-- written, without the PC. The program says which registers: see bus_sequencer for the words, the events and the
-- errors, and modbus_master_line for the frames.
--
-- Pins      tx_enable switches the driver of the transceiver. rx needs a pull-up.
-- Latency   2 clocks per access. A sample shows when all its replies have come.
-- Reset     Nothing is sent to a register that the bus has not written since.

library ieee;
  use ieee.std_logic_1164.all;
  use work.sequencer_pkg.all;
  use work.wishbone_pkg.all;

entity modbus_master is
  generic (
    clock_hz      : positive                         := 50_000_000;
    baud_hz       : positive range 1200 to 1_000_000 := 19_200;
    parity        : natural range 0 to 2             := 1;
    stop_bits     : positive range 1 to 2            := 1;
    timeout_us    : positive range 1000 to 1_000_000 := 100_000;
    failures_most : positive range 1 to 15           := 3;
    program       : string := "C0E8C403C000D800C0A0C487C4FFC8002001000300000000000000014801480348020D001C01D004";
    values        : positive range 1 to 27           := 1;
    outputs       : natural range 0 to 8             := 0;
    data_width    : positive range 16 to 32          := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;

    rx           : in  std_ulogic; -- asynchronous
    tx           : out std_ulogic;
    tx_enable    : out std_ulogic
  );
end entity;

architecture rtl of modbus_master is

  signal request : bus_request_t;
  signal reply   : bus_reply_t;

begin

  sequencer : entity work.bus_sequencer
    generic map (
      clock_hz => clock_hz, program => program, values => values, outputs => outputs, failures_most => failures_most,
      data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      sampled => sampled, failed => failed, request => request, reply => reply);

  line : entity work.modbus_master_line
    generic map (
      clock_hz => clock_hz, baud_hz => baud_hz, parity => parity, stop_bits => stop_bits, timeout_us => timeout_us)
    port map (
      clock => clock, reset => reset, request => request, reply => reply, rx => rx, tx => tx, tx_enable => tx_enable);

end architecture;
