-- SPDX-License-Identifier: BSD-3-Clause
--
-- A device on SPI that is set up and then read at a rate, by a program. Its values are words on the bus, with a stamp
-- and an age: see bus_sequencer for the words, the events and the errors, and spi_master for the lines.
--
-- Latency   2 clocks per access. A sample shows about 16 half periods of sclk for each byte after its beginning.
-- Reset     The frame is broken off, and the set-up is done again.

library ieee;
  use ieee.std_logic_1164.all;
  use work.sequencer_pkg.all;
  use work.wishbone_pkg.all;

entity spi_device is
  generic (
    clock_hz      : positive                := 50_000_000;
    sclk_hz       : positive                := 1_000_000;
    mode          : natural range 0 to 3    := 0;
    select_ns     : natural range 0 to 2000 := 100;
    failures_most : positive range 1 to 15  := 3;
    program       : string                  := "C0E8C403C000D800C0E8C403C80020001C01D004";
    values        : positive range 1 to 27  := 1;
    data_width    : positive range 8 to 32  := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;

    select_n     : out std_ulogic;
    sclk         : out std_ulogic;
    mosi         : out std_ulogic;
    miso         : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of spi_device is

  signal request : bus_request_t;
  signal reply   : bus_reply_t;

begin

  sequencer : entity work.bus_sequencer
    generic map (
      clock_hz => clock_hz, program => program, values => values, failures_most => failures_most,
      data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      sampled => sampled, failed => failed, request => request, reply => reply);

  master : entity work.spi_master
    generic map (clock_hz => clock_hz, sclk_hz => sclk_hz, mode => mode, select_ns => select_ns)
    port map (
      clock => clock, reset => reset, request => request, reply => reply,
      select_n => select_n, sclk => sclk, mosi => mosi, miso => miso);

end architecture;
