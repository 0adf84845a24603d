-- SPDX-License-Identifier: BSD-3-Clause
--
-- Decides for each byte of a port whether it is classic text or part of a frame (docs/protocol.md, "One port, two
-- protocols").
--
--   after a 00:  80 hex or more --> frame, up to and including the next 00
--                anything else  --> classic, as after reset
--
-- Ports     rx in; classic and frame out: valid/ready. Both outputs share one `data`, which is rx_data. A 00 between
--           frames goes to the classic side, which ignores it between messages. Within a message it is an invalid
--           character.
-- Latency   None: a byte passes in the clock in which it comes.
-- Errors    None. Only a 00 ends a frame, so a pause or text within a frame changes nothing.
-- Pressure  A side that is not ready stalls the port.

library ieee;
  use ieee.std_logic_1164.all;

use work.protocol_pkg.all;

entity port_splitter is
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic;
    rx_valid      : in  std_ulogic;
    rx_ready      : out std_ulogic;
    rx_data       : in  byte_t;
    classic_valid : out std_ulogic;
    classic_ready : in  std_ulogic;
    frame_valid   : out std_ulogic;
    frame_ready   : in  std_ulogic
  );
end entity;

architecture rtl of port_splitter is

  signal at_border : std_ulogic := '0';  -- the byte before was a 00
  signal inside    : std_ulogic := '0';  -- inside a frame

  signal border, framed, passes : std_ulogic;  -- the class of the byte

begin

  border <= nor rx_data;
  framed <= inside or (at_border and rx_data(7));

  classic_valid <= rx_valid and not framed;
  frame_valid   <= rx_valid and framed;
  passes        <= frame_ready when framed = '1' else classic_ready;
  rx_ready      <= passes;

  follow : process (clock)
  begin
    if rising_edge(clock) then
      if rx_valid = '1' and passes = '1' then
        at_border <= border;
        inside    <= framed and not border;
      end if;
      if reset = '1' then
        at_border <= '0';
        inside    <= '0';
      end if;
    end if;
  end process;

end architecture;
