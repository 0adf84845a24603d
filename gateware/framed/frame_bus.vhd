-- SPDX-License-Identifier: BSD-3-Clause
--
-- Makes one access after the other on the bus-independent interface, for the framed application.
--
-- Ports     read, write: begin an access in the next clock, with the address and data of that clock. Both stay stable
--           until `done`.
--           found: high for one clock, together with the word that was read. failed, silent_bus, denied_write: about
--           the last access.
--           hold: keep the bus from now on until `free`.
-- Latency   `done` is high from the clock after the answer until the next access begins.
-- Errors    failed: the bus refused the access, or did not answer (silent_bus), or the dead-man has tripped
--           (denied_write).

library ieee;
  use ieee.std_logic_1164.all;

use work.bii_pkg.all;
use work.frame_layout_pkg.all;

entity frame_bus is
  generic (
    address_width : positive range 1 to 32 := 8;
    data_width    : positive range 8 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    read         : in  std_ulogic;
    write        : in  std_ulogic;
    hold         : in  std_ulogic;
    free         : in  std_ulogic;
    address      : in  std_ulogic_vector(address_width - 1 downto 0);
    data         : in  word32_t;
    found        : out std_ulogic;
    done         : out std_ulogic;
    failed       : out std_ulogic;
    silent_bus   : out std_ulogic;
    denied_write : out std_ulogic;
    bii_request  : out bii_request_t;
    bii_response : in  bii_response_t
  );
end entity;

architecture rtl of frame_bus is

  signal valid, writes, holding, over : std_ulogic := '0';

begin

  found <= valid and not writes and bii_response.done;
  done  <= over;

  drive : process (clock)
  begin
    if rising_edge(clock) then
      if valid = '1' and bii_response.done = '1' then
        valid <= '0';
        over  <= '1';
        failed     <= '0';
        silent_bus <= '0';
        denied_write <= '0';
        if bii_response.status /= ok then
          failed <= '1';
        end if;
        if bii_response.status = silent then
          silent_bus <= '1';
        end if;
        if bii_response.status = denied then
          denied_write <= '1';
        end if;
      elsif read = '1' or write = '1' then
        valid  <= '1';
        writes <= write;
        over   <= '0';
      end if;
      if free = '1' then
        holding <= '0';
      elsif hold = '1' then
        holding <= '1';
      end if;
      if reset = '1' then
        valid   <= '0';
        holding <= '0';
      end if;
    end if;
  end process;

  ask : process (all)
  begin
    bii_request            <= bii_request_idle;
    bii_request.valid      <= valid;
    bii_request.write      <= writes;
    bii_request.block_hold <= holding;
    bii_request.address(address_width - 1 downto 0) <= address;
    bii_request.data(data_width - 1 downto 0)       <= data(data_width - 1 downto 0);
  end process;

end architecture;
