-- SPDX-License-Identifier: BSD-3-Clause
--
-- An AXI4-Lite bus leads to a Wishbone bus: the processor of an SoC, or a PCIe core, reaches slaves of the gateware.
--
--   axi_lite_m2s --> write address, write data --+
--                --> read address ---------------+--> one access at a time --> wishbone_m2s
--   axi_lite_s2m <-- write response, read data <-------------------------------- wishbone_s2m
--
-- Addresses  AXI counts bytes: byte 4 * a is word a. The lowest two bits are ignored.
-- Strobes    wstrb becomes sel. register_slave refuses a write of less than its word.
-- Order      One write and one read may wait. If both do, they take turns.
-- Latency    Address and data are on the Wishbone bus 2 clocks after they were taken, the response a clock after ack.
-- Errors     err becomes SLVERR. So does an access without an answer for `timeout_clocks`: cyc falls then, and the
--            slave must forget it, as Wishbone demands.
-- Pressure   Each channel waits for its ready. A response stands until it is taken.
-- Reset      Drops what waits. Reset the master in the same clock, as AXI demands.

library ieee;
  use ieee.std_logic_1164.all;
  use work.axi_lite_pkg.all;
  use work.protocol_pkg.all;
  use work.wishbone_pkg.all;

entity axi_lite_slave is
  generic (
    timeout_clocks : positive := limits_bus_timeout_clocks_c
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    axi_lite_m2s : in  axi_lite_m2s_t;
    axi_lite_s2m : out axi_lite_s2m_t;
    wishbone_m2s : out wishbone_m2s_t;
    wishbone_s2m : in  wishbone_s2m_t
  );
end entity;

architecture rtl of axi_lite_slave is

  type state_t is (idle, asking, answering);

  signal state         : state_t := idle;
  signal writes        : std_ulogic := '0'; -- the access in hand is a write
  signal waited        : natural range 0 to timeout_clocks - 1 := 0;
  signal address_full  : std_ulogic := '0'; -- a write address was taken, and not yet answered
  signal data_full     : std_ulogic := '0';
  signal read_full     : std_ulogic := '0';
  signal write_address : std_ulogic_vector(29 downto 0) := (others => '0');
  signal read_address  : std_ulogic_vector(29 downto 0) := (others => '0');
  signal data          : std_ulogic_vector(31 downto 0);
  signal strobes       : std_ulogic_vector(3 downto 0);
  signal word          : std_ulogic_vector(31 downto 0);
  signal response      : axi_response_t := axi_okay_c;

begin

  respond : process (all) is
  begin
    axi_lite_s2m         <= axi_lite_s2m_idle;
    axi_lite_s2m.awready <= not address_full;
    axi_lite_s2m.wready  <= not data_full;
    axi_lite_s2m.arready <= not read_full;
    axi_lite_s2m.bresp   <= response;
    axi_lite_s2m.rresp   <= response;
    axi_lite_s2m.rdata   <= word;
    if state = answering then
      axi_lite_s2m.bvalid <= writes;
      axi_lite_s2m.rvalid <= not writes;
    end if;
  end process;

  ask : process (all) is
  begin
    wishbone_m2s     <= wishbone_m2s_idle;
    wishbone_m2s.we  <= writes;
    wishbone_m2s.adr <= "00" & read_address;
    wishbone_m2s.dat <= data;
    wishbone_m2s.sel <= "1111";
    if writes = '1' then
      wishbone_m2s.adr <= "00" & write_address;
      wishbone_m2s.sel <= strobes;
    end if;
    if state = asking then
      wishbone_m2s.cyc <= '1';
      wishbone_m2s.stb <= '1';
    end if;
  end process;

  process (clock) is
  begin
    if rising_edge(clock) then
      if axi_lite_m2s.awvalid = '1' and address_full = '0' then
        address_full  <= '1';
        write_address <= axi_lite_m2s.awaddr(31 downto 2);
      end if;
      if axi_lite_m2s.wvalid = '1' and data_full = '0' then
        data_full <= '1';
        data      <= axi_lite_m2s.wdata;
        strobes   <= axi_lite_m2s.wstrb;
      end if;
      if axi_lite_m2s.arvalid = '1' and read_full = '0' then
        read_full    <= '1';
        read_address <= axi_lite_m2s.araddr(31 downto 2);
      end if;

      case state is
        when idle =>
          waited <= 0;
          writes <= address_full and data_full; -- the next write comes too late to pass a read that waits
          if (address_full and data_full) = '1' or read_full = '1' then
            state <= asking;
          end if;

        when asking =>
          word     <= wishbone_s2m.dat;
          response <= axi_okay_c;
          if wishbone_s2m.ack = '1' then
            state <= answering;
          elsif wishbone_s2m.err = '1' or waited = timeout_clocks - 1 then
            response <= axi_slave_error_c;
            state    <= answering;
          else
            waited <= waited + 1;
          end if;

        when answering =>
          if writes = '1' and axi_lite_m2s.bready = '1' then
            address_full <= '0';
            data_full    <= '0';
            state        <= idle;
          elsif writes = '0' and axi_lite_m2s.rready = '1' then
            read_full <= '0';
            state     <= idle;
          end if;
      end case;

      if reset = '1' then
        state        <= idle;
        address_full <= '0';
        data_full    <= '0';
        read_full    <= '0';
      end if;
    end if;
  end process;

end architecture;
