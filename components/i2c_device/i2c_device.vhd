-- SPDX-License-Identifier: BSD-3-Clause
--
-- A device on I2C that is set up and then read at a rate, by a program. Its values are words on the bus, with a stamp
-- and an age: see bus_sequencer for the words, the events and the errors, and i2c_device_master for the lines.
--
-- Pins      scl and sda are open drain: X_drive 1 pulls the line low, X_out is always 0. Both need a pull-up.
-- Latency   2 clocks per access. A sample shows about 9 bits for each byte after its beginning.
-- Reset     Both lines are let go, and the set-up is done again.

library ieee;
  use ieee.std_logic_1164.all;
  use work.sequencer_pkg.all;
  use work.wishbone_pkg.all;

entity i2c_device is
  generic (
    clock_hz      : positive                 := 50_000_000;
    scl_hz        : positive                 := 400_000;
    stretch_us    : positive range 1 to 2000 := 1000;
    failures_most : positive range 1 to 15   := 3;
    program       : string                   := "C0E8C403C000D800C0E8C403C8002090000020911C01D004";
    values        : positive range 1 to 27   := 1;
    data_width    : positive range 8 to 32   := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;

    scl_in       : in  std_ulogic; -- asynchronous
    scl_out      : out std_ulogic;
    scl_drive    : out std_ulogic;
    sda_in       : in  std_ulogic; -- asynchronous
    sda_out      : out std_ulogic;
    sda_drive    : out std_ulogic
  );
end entity;

architecture rtl of i2c_device is

  signal request : bus_request_t;
  signal reply   : bus_reply_t;

begin

  scl_out <= '0';
  sda_out <= '0';

  sequencer : entity work.bus_sequencer
    generic map (
      clock_hz => clock_hz, program => program, values => values, failures_most => failures_most,
      data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      sampled => sampled, failed => failed, request => request, reply => reply);

  master : entity work.i2c_device_master
    generic map (clock_hz => clock_hz, scl_hz => scl_hz, stretch_us => stretch_us)
    port map (
      clock => clock, reset => reset, request => request, reply => reply,
      scl_drive => scl_drive, sda_drive => sda_drive, scl_in => scl_in, sda_in => sda_in);

end architecture;
