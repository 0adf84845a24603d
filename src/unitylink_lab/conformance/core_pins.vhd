-- SPDX-License-Identifier: BSD-3-Clause
--
-- The core of a replay, as replay_tb has it, with a plain port for each signal: for a chip with each port at a pin.
-- Generics: those of replay_tb. Latency: that of `core`. The bus is Wishbone without blocks and bytes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

library unitylink;
  use unitylink.engine_pkg.all;
  use unitylink.frame_layout_pkg.all;
  use unitylink.register_pkg.all;
  use unitylink.settings_pkg.all;
  use unitylink.wishbone_pkg.all;

entity core_pins is
  generic (
    address_bits  : positive := 8;
    data_bits     : positive := 32;
    base_hz       : positive := 1000;
    groups        : positive := 2;
    group_size    : positive := 16;
    rate_bytes    : positive := 2;
    read_many     : natural  := 32;
    publish_mode  : natural  := 2;
    configuration_command : boolean := true;
    datalink      : string   := "full";
    checksum      : string   := "crc8";
    polynomial    : natural  := 7;
    edge_events   : natural  := 0;
    protocol      : string   := "classic";
    engine        : string   := "fast";
    lists         : boolean  := true;
    deadman       : boolean  := true;
    exchanges     : natural  := 2;
    exchange_size : positive := 16;
    window        : positive := 32;
    clock_hz      : positive := 50_000_000
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    rx_valid    : in  std_ulogic;
    rx_ready    : out std_ulogic;
    rx_data     : in  std_ulogic_vector(7 downto 0);
    rx_error    : in  std_ulogic_vector(2 downto 0);
    tx_valid    : out std_ulogic;
    tx_ready    : in  std_ulogic;
    tx_data     : out std_ulogic_vector(7 downto 0);
    events      : in  std_ulogic_vector(groups - 1 downto 0);
    strobe      : out std_ulogic;
    write       : out std_ulogic;
    address     : out std_ulogic_vector(8 * ((address_bits + 7) / 8) - 1 downto 0);
    to_memory   : out std_ulogic_vector(data_bits - 1 downto 0);
    from_memory : in  std_ulogic_vector(data_bits - 1 downto 0);
    done        : in  std_ulogic;
    refused     : in  std_ulogic
  );
end entity;

architecture plain of core_pins is

  constant safe_values : safe_values_t(0 to 1) := ((address => x"00000010", value => x"00000001"),
                                                   (address => x"00000011", value => x"FFFFFFFF"));

  signal wishbone_m2s : wishbone_m2s_t;
  signal wishbone_s2m : wishbone_s2m_t;

begin

  strobe    <= wishbone_m2s.cyc and wishbone_m2s.stb;
  write     <= wishbone_m2s.we;
  address   <= wishbone_m2s.adr(address'range);
  to_memory <= wishbone_m2s.dat(to_memory'range);

  answer : process (all)
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.dat(from_memory'range) <= from_memory;
    wishbone_s2m.ack <= done;
    wishbone_s2m.err <= refused;
  end process;

  core : entity unitylink.core
    generic map (
      settings => core_settings(
        address_bits => address_bits, data_bits => data_bits, clock_hz => clock_hz, base_hz => base_hz,
        groups => groups, group_size => group_size, rate_bytes => rate_bytes, read_many => read_many,
        publish_mode => publish_mode, configuration_command => configuration_command, datalink => datalink_of(datalink),
        checksum => checksum_of(checksum), polynomial => polynomial,
        edge_events => std_ulogic_vector(to_unsigned(edge_events, 256)), protocol => protocol_of(protocol),
        lists => lists, deadman => deadman, exchanges => exchanges,
        exchange_size => exchange_size, window => window,
        spec_hash => x"0123456789ABCDEF"),
      engine => engine_of(engine), safe_values => safe_values)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data,
      tx_last => open, tx_publish => open, events => events, tripped => open,
      wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

end architecture;
