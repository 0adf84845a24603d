-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bus-independent interface on a Wishbone B4 bus, classic cycles.
--
-- Latency   None of its own: strobe comes in the same clock as bii_request.valid, and done in the same clock as ack. An
--           access takes as many clocks as the slave: 2 with a registered acknowledge.
-- Block     cyc stays high from the first access while bii_request.block_hold is high.
-- Errors    err ends an access with status `error`. After `timeout_clocks` clocks without ack or err the access ends
--           with status `silent`, cyc falls, and no slave is addressed.
-- Late ack  A slave may still answer after a timeout. So the bus rests, with cyc low, for another `timeout_clocks`
--           clocks, or until that answer has come and gone. Only then does the next access start, so a late ack is not
--           used for another access. (Wishbone demands that a slave forgets an access when cyc falls. A slave that
--           answers more than twice `timeout_clocks` late breaks that rule.)
-- Pressure  bii_request waits. Nothing else can wait.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.protocol_pkg.all;
use work.wishbone_pkg.all;

entity wishbone_master is
  generic (
    address_width  : positive range 1 to 32 := 8;
    data_width     : positive range 8 to 32 := 32;
    timeout_clocks : positive := limits_bus_timeout_clocks_c
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    bii_request  : in  bii_request_t;
    bii_response : out bii_response_t;
    wishbone_m2s : out wishbone_m2s_t;
    wishbone_s2m : in  wishbone_s2m_t
  );
end entity;

architecture rtl of wishbone_master is

  signal waited  : natural range 0 to timeout_clocks := 0;  -- clocks of this access, or of this rest
  signal resting : std_ulogic := '0';  -- the bus rests after a timeout
  signal strobe  : std_ulogic;
  signal expired : std_ulogic := '0';  -- waited is timeout_clocks
  signal held    : std_ulogic := '0';  -- inside a block, after its first access began

begin

  strobe  <= bii_request.valid and not resting;

  drive : process (all)
  begin
    wishbone_m2s     <= wishbone_m2s_idle;
    wishbone_m2s.cyc <= (strobe and not expired) or (held and bii_request.block_hold);
    wishbone_m2s.stb <= strobe and not expired;
    wishbone_m2s.we  <= bii_request.write;
    wishbone_m2s.adr(address_width - 1 downto 0) <= bii_request.address(address_width - 1 downto 0);
    wishbone_m2s.dat(data_width - 1 downto 0)    <= bii_request.data(data_width - 1 downto 0);
    wishbone_m2s.sel((data_width + 7) / 8 - 1 downto 0) <= (others => '1');
    if expired = '1' then
      wishbone_m2s.cyc <= '0';
    end if;
  end process;

  answer : process (all)
  begin
    bii_response <= bii_response_idle;
    bii_response.data(data_width - 1 downto 0) <= wishbone_s2m.dat(data_width - 1 downto 0);
    if strobe = '1' then
      if expired = '1' then
        bii_response.done   <= '1';
        bii_response.status <= silent;
      elsif wishbone_s2m.err = '1' then
        bii_response.done   <= '1';
        bii_response.status <= error;
      elsif wishbone_s2m.ack = '1' then
        bii_response.done <= '1';
      end if;
    end if;
  end process;

  watch : process (clock)
  begin
    if rising_edge(clock) then
      expired <= '0';
      held <= (held or strobe) and bii_request.block_hold and not resting;
      if resting = '1' then
        if expired = '1' or wishbone_s2m.ack = '1' or wishbone_s2m.err = '1' then
          resting <= '0';
          waited  <= 0;
        else
          waited <= waited + 1;
          if waited = timeout_clocks - 1 then
            expired <= '1';
          end if;
        end if;
      elsif strobe = '1' and expired = '1' then
        resting <= '1';
        waited  <= 0;
        held    <= '0';
      elsif strobe = '1' and wishbone_s2m.ack = '0' and wishbone_s2m.err = '0' then
        waited <= waited + 1;
        if waited = timeout_clocks - 1 then
          expired <= '1';
        end if;
      else
        waited <= 0;
      end if;
      if reset = '1' then
        resting <= '0';
        waited  <= 0;
        expired <= '0';
        held    <= '0';
      end if;
    end if;
  end process;

end architecture;
