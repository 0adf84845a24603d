-- SPDX-License-Identifier: BSD-3-Clause
--
-- The framed side of a core: frames in and out, requests and publishes on the bus-independent interface (docs/protocol.md).
--
--   frame --> frame_receiver --> frame_application <--> bii, subscription
--   tx <----- frame_transmitter <------+
--
-- All there is to say stands in the three of them. What the dead-man has to know goes to an entity of its own in front of the
-- bus (dead_man), which also stops what this side does not know of. A sign of life is a frame of the session whose check was
-- right, when its last byte has come in: it counts before it is executed, and also while nothing is.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity framed is
  generic (
    address_width : positive range 1 to 32  := 8;
    data_width    : positive range 8 to 32  := 32;
    clock_hz      : positive                := limits_clock_hz_default_c;
    base_hz       : positive                := limits_base_hz_default_c;
    groups        : natural  range 0 to 256 := 2;
    group_size    : natural  range 0 to 255 := 16;
    rate_bytes    : positive range 1 to 4   := 2;
    exchanges     : natural  range 0 to 4   := 2;
    exchange_size : natural  range 0 to 60  := 16;
    lists         : boolean                 := true;
    deadman       : boolean                 := true;
    window        : positive range 2 to 128 := frame_window_default_c;
    classic       : boolean                 := false;
    gateware_version : word32_t             := (others => '0');
    build         : word32_t                := (others => '0');
    spec_hash     : std_ulogic_vector(63 downto 0) := (others => '0')
  );
  port (
    clock                 : in  std_ulogic;
    reset                 : in  std_ulogic;
    frame_valid           : in  std_ulogic;
    frame_ready           : out std_ulogic;
    frame_data            : in  byte_t;
    receive_overrun       : in  std_ulogic := '0';
    tx_valid              : out std_ulogic;
    tx_ready              : in  std_ulogic;
    tx_data               : out byte_t;
    tx_last               : out std_ulogic;
    tx_publish            : out std_ulogic;
    session_open          : out std_ulogic;
    may_begin             : in  std_ulogic := '1';
    wants                 : out std_ulogic;
    busy                  : out std_ulogic;
    subscription_request  : out subscription_request_t;
    subscription_response : in  subscription_response_t := subscription_response_idle;
    dead_man_request      : out dead_man_request_t;  -- to the dead-man in front of the bus, where there is one
    dead_man_response     : in  dead_man_response_t := dead_man_response_idle;
    bii_request           : out bii_request_t;
    bii_response          : in  bii_response_t
  );
end entity;

architecture rtl of framed is

  constant payload_max : positive := 250;
  constant ring_bytes  : positive := 512;

  constant settings : frame_settings_t := (
    address_width => address_width, data_width => data_width, address_bytes => bytes_for(address_width),
    data_bytes => bytes_for(data_width), clock_hz => clock_hz, base_hz => base_hz, groups => groups,
    group_size => group_size, rate_bytes => rate_bytes, exchanges => exchanges, exchange_size => exchange_size,
    window => window, cache_bytes => frame_cache_bytes_default_c, request_max => payload_max, reply_max => payload_max,
    credit => ring_bytes, classic => classic, lists => lists, deadman => deadman,
    gateware_version => gateware_version, build => build, spec_hash => spec_hash);

  signal epoch                        : crc16_t;
  signal alive                        : std_ulogic;
  signal commands                     : dead_man_request_t;
  signal request                      : frame_request_t;
  signal take, rewind, request_done   : std_ulogic;
  signal take_bytes                   : unsigned(7 downto 0);
  signal reply                        : frame_reply_t;
  signal reply_ready, reply_idle      : std_ulogic;

begin

  session_open <= nand epoch(15 downto 8);

  receiver : entity work.frame_receiver
    generic map (request_max => payload_max, ring_bytes => ring_bytes, many => lists)
    port map (
      clock => clock, reset => reset, epoch => epoch,
      frame_valid => frame_valid, frame_ready => frame_ready, frame_data => frame_data,
      request => request, take => take, take_bytes => take_bytes, rewind => rewind, done => request_done, alive => alive);

  application : entity work.frame_application
    generic map (settings => settings)
    port map (
      clock => clock, reset => reset,
      request => request, take => take, take_bytes => take_bytes, rewind => rewind, request_done => request_done,
      reply => reply, reply_ready => reply_ready, reply_idle => reply_idle, epoch => epoch,
      may_begin => may_begin, wants => wants, busy => busy, receive_overrun => receive_overrun,
      publish_overrun => subscription_response.overrun,
      subscription_request => subscription_request, subscription_response => subscription_response,
      dead_man_request => commands, dead_man_response => dead_man_response,
      bii_request => bii_request, bii_response => bii_response);

  tell_dead_man : process (all)
  begin
    dead_man_request       <= commands;
    dead_man_request.alive <= alive;
  end process;

  transmitter : entity work.frame_transmitter
    port map (
      clock => clock, reset => reset, epoch => epoch,
      reply => reply, ready => reply_ready, idle => reply_idle,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

end architecture;
