-- SPDX-License-Identifier: BSD-3-Clause
--
-- The framed side of a core: frames in and out, requests and publishes on the bus-independent interface
-- (docs/protocol.md).
--
--   frame --> frame_receiver --> frame_application <--> bii, subscription
--   tx <----- frame_transmitter <------+
--
-- The three entities have the details. What the dead-man must know goes to the entity dead_man in front of the bus.
-- dead_man also stops writes of other applications. A sign of life is a frame of the session with a right check. It
-- counts when its last byte has come in, before the frame is executed, and also while nothing is executed.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.subscription_pkg.all;

entity framed is
  generic (
    settings : settings_t := core_settings  -- docs/settings.md
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
    dead_man_request      : out dead_man_request_t;  -- to the dead-man in front of the bus, if there is one
    dead_man_response     : in  dead_man_response_t := dead_man_response_idle;
    bii_request           : out bii_request_t;
    bii_response          : in  bii_response_t
  );
end entity;

architecture rtl of framed is

  constant frame_settings : frame_settings_t := frame_settings_of(settings);

  signal epoch                        : crc16_t;
  signal alive                        : std_ulogic;
  signal commands                     : dead_man_request_t;
  signal request                      : frame_request_t;
  signal take, rewind, request_done   : std_ulogic;
  signal take_more                    : unsigned(7 downto 0);
  signal takes_many                   : std_ulogic;
  signal reply                        : frame_reply_t;
  signal reply_ready, reply_idle      : std_ulogic;

begin

  session_open <= nand epoch(15 downto 8);

  receiver : entity work.frame_receiver
    generic map (
      request_max => frame_settings.request_max, ring_bytes => frame_settings.credit, many => frame_settings.lists)
    port map (
      clock => clock, reset => reset, epoch => epoch,
      frame_valid => frame_valid, frame_ready => frame_ready, frame_data => frame_data,
      request => request, take => take, take_more => take_more, takes_many => takes_many, rewind => rewind,
      done => request_done,
      alive => alive);

  application : entity work.frame_application
    generic map (settings => frame_settings)
    port map (
      clock => clock, reset => reset,
      request => request, take => take, take_more => take_more, takes_many => takes_many, rewind => rewind,
      request_done => request_done,
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
