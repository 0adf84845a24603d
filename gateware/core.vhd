-- SPDX-License-Identifier: BSD-3-Clause
--
-- The Unity-Link core: a protocol or both on byte streams, requests and publishes on a Wishbone bus.
--
--   rx, tx <--> core_bii <--> wishbone_master <--> wishbone
--
-- All there is to say stands in core_bii.vhd and wishbone_master.vhd. The cycle figures in docs/gateware/core.md are of this
-- entity.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.frame_layout_pkg.all;
use work.protocol_pkg.all;
use work.wishbone_pkg.all;

entity core is
  generic (
    address_width : positive range 1 to 32  := 8;
    data_width    : positive range 8 to 32  := 32;
    clock_hz      : positive                := limits_clock_hz_default_c;
    base_hz       : positive                := limits_base_hz_default_c;  -- of publishing
    groups        : positive range 1 to 256 := 2;
    group_size    : positive range 1 to 255 := 16;   -- addresses a group can have
    rate_bytes    : positive range 1 to 4   := 2;
    read_many     : natural  range 0 to 255 := 32;   -- most words of a read-many; 0: no such command
    publish_mode  : natural  range 0 to 2   := 2;    -- 0 none, 1 prefers requests, 2 prefers publishes
    configuration_command : boolean         := true; -- RLC exists
    datalink      : string                  := "full";  -- "full", "lite" or "none"
    checksum      : string                  := "crc8";  -- "crc8", "xor" or "none"; of the full datalink
    polynomial    : natural range 0 to 255  := to_integer(unsigned(crc8_polynomial_c));
    edge_events   : std_ulogic_vector(255 downto 0) := (others => '0');  -- bit g: event of group g by edge, else level
    protocol      : string                  := "classic";  -- "classic", "framed" or "both"; of framed, as of core_bii:
    exchanges     : natural  range 0 to 4   := 2;
    exchange_size : natural  range 0 to 60  := 16;
    lists         : boolean                 := true;
    deadman       : boolean                 := true;
    safe_values   : safe_values_t           := no_safe_values;
    window        : positive range 2 to 128 := frame_window_default_c;
    gateware_version : word32_t             := (others => '0');
    build         : word32_t                := (others => '0');
    spec_hash     : std_ulogic_vector(63 downto 0) := (others => '0');
    timeout_clocks : positive               := limits_bus_timeout_clocks_c
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
    events       : in  std_ulogic_vector(groups - 1 downto 0) := (others => '0');
    tripped      : out std_ulogic;
    wishbone_m2s : out wishbone_m2s_t;
    wishbone_s2m : in  wishbone_s2m_t
  );
end entity;

architecture rtl of core is

  signal bii_request  : bii_request_t;
  signal bii_response : bii_response_t;

begin

  core_bii : entity work.core_bii
    generic map (
      address_width => address_width, data_width => data_width, clock_hz => clock_hz, base_hz => base_hz,
      groups => groups, group_size => group_size, rate_bytes => rate_bytes, read_many => read_many,
      publish_mode => publish_mode, configuration_command => configuration_command, datalink => datalink,
      checksum => checksum, polynomial => polynomial, edge_events => edge_events, protocol => protocol,
      exchanges => exchanges, exchange_size => exchange_size, lists => lists, deadman => deadman,
      safe_values => safe_values, window => window, gateware_version => gateware_version, build => build,
      spec_hash => spec_hash)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish,
      events => events, tripped => tripped,
      bii_request => bii_request, bii_response => bii_response);

  wishbone_master : entity work.wishbone_master
    generic map (address_width => address_width, data_width => data_width, timeout_clocks => timeout_clocks)
    port map (
      clock => clock, reset => reset, bii_request => bii_request, bii_response => bii_response,
      wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

end architecture;
