-- SPDX-License-Identifier: BSD-3-Clause
--
-- The classic datalink in both directions, in the chosen variant.
--
--   full   rx -> decoder -> receiver      -> receive    digits, checksum, all errors reported; valid from `good` on
--   lite   rx -> decoder -> lite_receiver -> receive    digits, no checksum; valid at once
--   none   rx -> decoder -> lite_receiver -> receive    plain bytes, for a physical layer that loses nothing
--          tx <- transmitter <- word
--
-- Ports     receive, room, message_end: see receiver and lite_receiver. word: valid/ready, see transmitter.
-- Latency   One clock from rx to receive, one clock from word to tx. One character per clock.
-- Errors    full: docs/classic-protocol.md section 4. lite and none: see lite_receiver; rx_error is ignored.
-- Pressure  valid/ready on both streams. Nothing is lost.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity datalink is
  generic (
    datalink        : string   := "full";    -- "full", "lite" or "none"
    message_entries : positive;              -- full: see receiver
    checksum        : string   := "crc8";    -- full: "crc8", "xor" or "none"
    polynomial      : natural range 0 to 255 := to_integer(unsigned(crc8_polynomial_c))
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    rx_valid    : in  std_ulogic;
    rx_ready    : out std_ulogic;
    rx_data     : in  byte_t;
    rx_error    : in  std_ulogic_vector(2 downto 0);
    receive     : out receive_t;
    room        : in  std_ulogic;
    message_end : in  std_ulogic := '0';
    word_valid  : in  std_ulogic;
    word_ready  : out std_ulogic;
    word_data   : in  word_t;
    tx_valid    : out std_ulogic;
    tx_ready    : in  std_ulogic;
    tx_data     : out byte_t;
    tx_last     : out std_ulogic;  -- see transmitter
    tx_publish  : out std_ulogic
  );
end entity;

architecture rtl of datalink is

  signal character_valid, character_ready : std_ulogic;
  signal character_data                   : character_t;

begin

  assert datalink = "full" or datalink = "lite" or datalink = "none"
    report "datalink: datalink must be full, lite or none" severity failure;

  decoder : entity work.decoder
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      character_valid => character_valid, character_ready => character_ready, character_data => character_data);

  reception : if datalink = "full" generate
    receiver : entity work.receiver
      generic map (message_entries => message_entries, checksum => checksum, polynomial => polynomial)
      port map (
        clock => clock, reset => reset,
        character_valid => character_valid, character_ready => character_ready, character_data => character_data,
        rx_error => rx_error, room => room, receive => receive);
  else generate
    lite_receiver : entity work.lite_receiver
      generic map (digits => datalink /= "none")
      port map (
        clock => clock, reset => reset,
        character_valid => character_valid, character_ready => character_ready, character_data => character_data,
        room => room, message_end => message_end, receive => receive);
  end generate;

  transmitter : entity work.transmitter
    generic map (
      digits => datalink /= "none", checksum => checksum_of(datalink, checksum), polynomial => polynomial)
    port map (
      clock => clock, reset => reset,
      word_valid => word_valid, word_ready => word_ready, word_data => word_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

end architecture;
