-- SPDX-License-Identifier: BSD-3-Clause
--
-- The Unity-Link core on an AXI4-Lite bus.
--
--   rx, tx <--> core_bii <--> axi_lite_master <--> axi_lite
--
-- core_bii.vhd and axi_lite_master.vhd have all details. hold: high during a block, for slaves that keep one moment.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.axi_lite_pkg.all;
use work.bii_pkg.all;
use work.frame_layout_pkg.all;
use work.engine_pkg.all;
use work.settings_pkg.all;

entity core_axi_lite is
  generic (
    settings    : settings_t    := core_settings;  -- docs/settings.md
    engine      : engine_t      := engine_fast;    -- of the framed protocol: docs/gateware/framed_small.md
    safe_values : safe_values_t := no_safe_values  -- the values that the dead-man writes
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    rx_valid     : in  std_ulogic;
    rx_ready     : out std_ulogic;
    rx_data      : in  std_ulogic_vector(7 downto 0);
    rx_error     : in  std_ulogic_vector(2 downto 0) := "000";
    tx_valid     : out std_ulogic;
    tx_ready     : in  std_ulogic;
    tx_data      : out std_ulogic_vector(7 downto 0);
    tx_last      : out std_ulogic;
    tx_publish   : out std_ulogic;
    events       : in  std_ulogic_vector(settings.groups - 1 downto 0) := (others => '0');
    tripped      : out std_ulogic;
    axi_lite_m2s : out axi_lite_m2s_t;
    axi_lite_s2m : in  axi_lite_s2m_t;
    hold         : out std_ulogic
  );
end entity;

architecture rtl of core_axi_lite is

  signal bii_request  : bii_request_t;
  signal bii_response : bii_response_t;

begin

  core_bii : entity work.core_bii
    generic map (settings => settings, engine => engine, safe_values => safe_values)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish,
      events => events, tripped => tripped,
      bii_request => bii_request, bii_response => bii_response);

  axi_lite_master : entity work.axi_lite_master
    generic map (
      address_width => settings.address_bits, data_width => settings.data_bits,
      timeout_clocks => settings.timeout_clocks)
    port map (
      clock => clock, reset => reset, bii_request => bii_request, bii_response => bii_response,
      axi_lite_m2s => axi_lite_m2s, axi_lite_s2m => axi_lite_s2m, hold => hold);

end architecture;
