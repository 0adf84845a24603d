-- SPDX-License-Identifier: BSD-3-Clause
-- What a core is built with (docs/settings.md).
-- Generated from protocol/protocol.toml by protocol/generate.py; edit there.
--
--   core : entity unitylink.core
--     generic map (settings => core_settings(clock_hz => 12_000_000, groups => 4))
library ieee;
  use ieee.std_logic_1164.all;

package settings_pkg is

  type protocol_t is (protocol_both, protocol_framed, protocol_classic);
  type datalink_t is (datalink_full, datalink_lite, datalink_none);
  type checksum_t is (checksum_crc8, checksum_xor, checksum_none);

  type settings_t is record
    address_bits          : natural range 1 to 32;  -- bits: width of a word's address
    data_bits             : natural range 8 to 32;  -- bits: width of a data word
    clock_hz              : natural range 1000 to 1000000000;  -- Hz: frequency of the clock
    -- Hz: base frequency of publishing; two strobes are at least groups + 5 clocks apart
    base_hz               : natural range 1 to 1000000000;
    groups                : natural range 1 to 256;  -- groups: number of publish groups
    group_size            : natural range 1 to 255;  -- words: most addresses of a publish group
    rate_bytes            : natural range 1 to 4;  -- bytes: width of a group's divisor
    -- words: most words of a classic read-many; 0: there is no such command
    read_many             : natural range 0 to 255;
    publish_mode          : natural range 0 to 2;  -- 0 no publishing, 1 prefers requests, 2 prefers publishes
    configuration_command : boolean;  -- the classic command RLC exists
    protocol              : protocol_t;  -- protocols that the device speaks; the design contains no other
    -- classic datalink; lite and none check nothing; none sends data as bytes, not as digits
    datalink              : datalink_t;
    checksum              : checksum_t;  -- checksum of the full datalink
    polynomial            : natural range 0 to 255;  -- polynomial of crc8
    -- groups whose event is an edge of their event input; for the others it is a level
    edge_events           : std_ulogic_vector(255 downto 0);
    -- groups: number of exchange groups of the framed protocol; 0: there are none
    exchanges             : natural range 0 to 4;
    -- words: words of an exchange group, in and out; at most 122, 81, 61 or 49 with 1 to 4 address bytes
    exchange_size         : natural range 1 to 122;
    lists                 : boolean;  -- the requests LIST and POST_LIST exist
    deadman               : boolean;  -- the dead-man exists
    -- requests: most requests in flight; a power of two, and the number of places in the reply cache
    window                : natural range 2 to 128;
    gateware_version      : std_ulogic_vector(31 downto 0);  -- version that the device reports
    build                 : std_ulogic_vector(31 downto 0);  -- number of the build that the device reports
    -- hash of all that the spec says about the wire; 0: the device reports none
    spec_hash             : std_ulogic_vector(63 downto 0);
    timeout_clocks        : natural range 1 to 1000000;  -- clocks: time after which a bus access without an answer ends
  end record;

  -- The defaults, but for what is named.
  function core_settings(
    address_bits          : natural range 1 to 32 := 8;
    data_bits             : natural range 8 to 32 := 32;
    clock_hz              : natural range 1000 to 1000000000 := 50000000;
    base_hz               : natural range 1 to 1000000000 := 1000;
    groups                : natural range 1 to 256 := 16;
    group_size            : natural range 1 to 255 := 32;
    rate_bytes            : natural range 1 to 4 := 2;
    read_many             : natural range 0 to 255 := 255;
    publish_mode          : natural range 0 to 2 := 2;
    configuration_command : boolean := true;
    protocol              : protocol_t := protocol_both;
    datalink              : datalink_t := datalink_full;
    checksum              : checksum_t := checksum_crc8;
    polynomial            : natural range 0 to 255 := 7;
    edge_events           : std_ulogic_vector(255 downto 0) := (others => '0');
    exchanges             : natural range 0 to 4 := 2;
    exchange_size         : natural range 1 to 122 := 30;
    lists                 : boolean := true;
    deadman               : boolean := true;
    window                : natural range 2 to 128 := 64;
    gateware_version      : std_ulogic_vector(31 downto 0) := x"00010000";
    build                 : std_ulogic_vector(31 downto 0) := x"00000000";
    spec_hash             : std_ulogic_vector(63 downto 0) := x"0000000000000000";
    timeout_clocks        : natural range 1 to 1000000 := 100
  ) return settings_t;

  -- The same at another clock: of a design whose clock is a generic.
  function at_clock(settings : settings_t; clock_hz : positive) return settings_t;

  -- What a choice is called.
  function text_of(choice : protocol_t) return string;
  function protocol_of(text : string) return protocol_t;
  function text_of(choice : datalink_t) return string;
  function datalink_of(text : string) return datalink_t;
  function text_of(choice : checksum_t) return string;
  function checksum_of(text : string) return checksum_t;

end package;

package body settings_pkg is

  function core_settings(
    address_bits          : natural range 1 to 32 := 8;
    data_bits             : natural range 8 to 32 := 32;
    clock_hz              : natural range 1000 to 1000000000 := 50000000;
    base_hz               : natural range 1 to 1000000000 := 1000;
    groups                : natural range 1 to 256 := 16;
    group_size            : natural range 1 to 255 := 32;
    rate_bytes            : natural range 1 to 4 := 2;
    read_many             : natural range 0 to 255 := 255;
    publish_mode          : natural range 0 to 2 := 2;
    configuration_command : boolean := true;
    protocol              : protocol_t := protocol_both;
    datalink              : datalink_t := datalink_full;
    checksum              : checksum_t := checksum_crc8;
    polynomial            : natural range 0 to 255 := 7;
    edge_events           : std_ulogic_vector(255 downto 0) := (others => '0');
    exchanges             : natural range 0 to 4 := 2;
    exchange_size         : natural range 1 to 122 := 30;
    lists                 : boolean := true;
    deadman               : boolean := true;
    window                : natural range 2 to 128 := 64;
    gateware_version      : std_ulogic_vector(31 downto 0) := x"00010000";
    build                 : std_ulogic_vector(31 downto 0) := x"00000000";
    spec_hash             : std_ulogic_vector(63 downto 0) := x"0000000000000000";
    timeout_clocks        : natural range 1 to 1000000 := 100
  ) return settings_t is
  begin
    return (
      address_bits          => address_bits,
      data_bits             => data_bits,
      clock_hz              => clock_hz,
      base_hz               => base_hz,
      groups                => groups,
      group_size            => group_size,
      rate_bytes            => rate_bytes,
      read_many             => read_many,
      publish_mode          => publish_mode,
      configuration_command => configuration_command,
      protocol              => protocol,
      datalink              => datalink,
      checksum              => checksum,
      polynomial            => polynomial,
      edge_events           => edge_events,
      exchanges             => exchanges,
      exchange_size         => exchange_size,
      lists                 => lists,
      deadman               => deadman,
      window                => window,
      gateware_version      => gateware_version,
      build                 => build,
      spec_hash             => spec_hash,
      timeout_clocks        => timeout_clocks);
  end function;

  function at_clock(settings : settings_t; clock_hz : positive) return settings_t is
    variable changed : settings_t := settings;
  begin
    changed.clock_hz := clock_hz;
    return changed;
  end function;

  function text_of(choice : protocol_t) return string is
  begin
    case choice is
      when protocol_both => return "both";
      when protocol_framed => return "framed";
      when protocol_classic => return "classic";
    end case;
  end function;

  function protocol_of(text : string) return protocol_t is
  begin
    if text = "framed" then
      return protocol_framed;
    end if;
    if text = "classic" then
      return protocol_classic;
    end if;
    assert text = "both" report "settings_pkg: no protocol is called " & text severity failure;
    return protocol_both;
  end function;

  function text_of(choice : datalink_t) return string is
  begin
    case choice is
      when datalink_full => return "full";
      when datalink_lite => return "lite";
      when datalink_none => return "none";
    end case;
  end function;

  function datalink_of(text : string) return datalink_t is
  begin
    if text = "lite" then
      return datalink_lite;
    end if;
    if text = "none" then
      return datalink_none;
    end if;
    assert text = "full" report "settings_pkg: no datalink is called " & text severity failure;
    return datalink_full;
  end function;

  function text_of(choice : checksum_t) return string is
  begin
    case choice is
      when checksum_crc8 => return "crc8";
      when checksum_xor => return "xor";
      when checksum_none => return "none";
    end case;
  end function;

  function checksum_of(text : string) return checksum_t is
  begin
    if text = "xor" then
      return checksum_xor;
    end if;
    if text = "none" then
      return checksum_none;
    end if;
    assert text = "crc8" report "settings_pkg: no checksum is called " & text severity failure;
    return checksum_crc8;
  end function;

end package body;
