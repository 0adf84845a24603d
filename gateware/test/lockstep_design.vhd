-- SPDX-License-Identifier: BSD-3-Clause
--
-- A small design with the structure of a live simulation: the core, registers with a user's side, memory. It runs as
-- source in GHDL and compiled in Verilator, clock by clock (tests/gateware/test_lockstep.py).
--
--   addresses 0 to 7    read_words, 32 bits each, address 0 in the lowest; 0 and 1 inverted by a wide constant
--   addresses 8 to 15   write_words
--   addresses 16 to 63  none
--   addresses 64 to 79  memory

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.address_map_pkg.all;
use work.register_pkg.all;
use work.settings_pkg.all;
use work.wishbone_pkg.all;

entity lockstep_design is
  generic (
    address_width : positive := 8;
    data_width    : positive := 32;
    base_hz       : positive := 50_000;
    groups        : positive := 2;
    group_size    : positive := 16;
    rate_bytes    : positive := 2;
    read_many     : natural  := 32;
    publish_mode  : natural  := 2;
    datalink      : string   := "full";
    checksum      : string   := "crc8";
    protocol      : string   := "classic"
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
    read_words  : in  std_ulogic_vector(8 * 32 - 1 downto 0);
    write_words : out std_ulogic_vector(8 * 32 - 1 downto 0)
  );
end entity;

architecture bench of lockstep_design is

  constant slaves : address_map_t(0 to 1) := (
    0 => (base => to_unsigned(0, 32), words => 64),
    1 => (base => to_unsigned(64, 32), words => 16));

  signal master_m2s : wishbone_m2s_t;
  signal master_s2m : wishbone_s2m_t;
  signal slaves_m2s : wishbone_m2s_vector_t(0 to 1);
  signal slaves_s2m : wishbone_s2m_vector_t(0 to 1);

  -- Only one word is not zero: a single wide constant would lose it.
  function first_words return word_vector_t is
    variable words : word_vector_t(0 to 63) := (others => (others => '0'));
  begin
    words(9) := x"0BADCAFE";
    return words;
  end function;

  constant first : word_vector_t(0 to 63) := first_words;

  signal turned  : std_ulogic_vector(63 downto 0);
  signal seen    : word_vector_t(0 to 63);
  signal written : word_vector_t(0 to 63);

begin

  core : entity work.core
    generic map (
      settings => core_settings(
        protocol => protocol_of(protocol), address_bits => address_width, data_bits => data_width, base_hz => base_hz,
        groups => groups, group_size => group_size, rate_bytes => rate_bytes, read_many => read_many,
        publish_mode => publish_mode, datalink => datalink_of(datalink), checksum => checksum_of(checksum)))
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, events => events,
      wishbone_m2s => master_m2s, wishbone_s2m => master_s2m);

  interconnect : entity work.wishbone_interconnect
    generic map (address_map => slaves)
    port map (
      master_m2s => master_m2s, master_s2m => master_s2m, slaves_m2s => slaves_m2s, slaves_s2m => slaves_s2m);

  registers : entity work.register_slave
    generic map (writable => "0000000011111111------------------------------------------------",
                 data_width => data_width, snapshot => true, initial => first)
    port map (
      clock => clock, reset => reset, wishbone_m2s => slaves_m2s(0), wishbone_s2m => slaves_s2m(0),
      read_words => seen, write_words => written, written => open,
      was_read => open);

  -- GHDL 2.0 writes constants of more than 32 bits wrongly in Verilog.
  turned  <= x"0123456789ABCDEF" when events(0) = '1' else x"FEDCBA9876543210";
  seen(0) <= read_words(31 downto 0) xor turned(31 downto 0);
  seen(1) <= read_words(63 downto 32) xor turned(63 downto 32);

  others_seen : for index in 2 to 7 generate
    seen(index) <= read_words(32 * index + 31 downto 32 * index);
  end generate;

  holes : for index in 16 to 63 generate
    seen(index) <= (others => '0');
  end generate;

  words : for index in 0 to 7 generate
    seen(8 + index) <= written(8 + index);
    write_words(32 * index + 31 downto 32 * index) <= written(8 + index);
  end generate;

  memory : entity work.wishbone_memory
    generic map (words => 16, data_width => data_width)
    port map (clock => clock, reset => reset, wishbone_m2s => slaves_m2s(1), wishbone_s2m => slaves_s2m(1));

end architecture;
