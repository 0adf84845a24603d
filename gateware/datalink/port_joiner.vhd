-- SPDX-License-Identifier: BSD-3-Clause
--
-- Lets classic text and frames share one port, message by message.
--
-- Ports     classic, frame in, tx out: each valid/ready/data. `last` is high with the last byte of a message, and
--           `publish` with all bytes of a publish.
-- Latency   None: a byte passes in the clock in which it comes.
-- Arbitration  Only between messages. A frame goes first.
-- Pressure  tx_ready stalls the side whose message is being sent. The other side waits for the last byte of this
--           message.

library ieee;
  use ieee.std_logic_1164.all;

use work.protocol_pkg.all;

entity port_joiner is
  port (
    clock           : in  std_ulogic;
    reset           : in  std_ulogic;
    classic_valid   : in  std_ulogic;
    classic_ready   : out std_ulogic;
    classic_data    : in  byte_t;
    classic_last    : in  std_ulogic;
    classic_publish : in  std_ulogic;
    frame_valid     : in  std_ulogic;
    frame_ready     : out std_ulogic;
    frame_data      : in  byte_t;
    frame_last      : in  std_ulogic;
    frame_publish   : in  std_ulogic;
    tx_valid        : out std_ulogic;
    tx_ready        : in  std_ulogic;
    tx_data         : out byte_t;
    tx_last         : out std_ulogic;
    tx_publish      : out std_ulogic
  );
end entity;

architecture rtl of port_joiner is

  signal within  : std_ulogic := '0';  -- a message is being sent
  signal framed  : std_ulogic := '0';  -- and it is a frame
  signal chooses : std_ulogic;         -- the choice is the frame
  signal valid, last : std_ulogic;

begin

  chooses <= framed when within = '1' else frame_valid;

  valid         <= frame_valid when chooses = '1' else classic_valid;
  last          <= frame_last when chooses = '1' else classic_last;
  tx_valid      <= valid;
  tx_last       <= last;
  tx_data       <= frame_data when chooses = '1' else classic_data;
  tx_publish    <= frame_publish when chooses = '1' else classic_publish;
  frame_ready   <= tx_ready and chooses;
  classic_ready <= tx_ready and not chooses;

  follow : process (clock)
  begin
    if rising_edge(clock) then
      if valid = '1' then  -- a byte that was shown stays
        within <= not (last and tx_ready);
        framed <= chooses;
      end if;
      if reset = '1' then
        within <= '0';
      end if;
    end if;
  end process;

end architecture;
