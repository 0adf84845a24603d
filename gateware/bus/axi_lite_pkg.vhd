-- SPDX-License-Identifier: BSD-3-Clause
--
-- AXI4-Lite as two records, one for each direction: 32 bits of data, byte addresses, five channels.
--
-- On each channel, a transfer is done in a clock in which valid and ready are both high. Once valid is high, it and its
-- payload stay the same until then. No valid may wait for its ready.

library ieee;
  use ieee.std_logic_1164.all;

package axi_lite_pkg is

  subtype axi_response_t is std_ulogic_vector(1 downto 0);

  constant axi_okay_c         : axi_response_t := "00";
  constant axi_slave_error_c  : axi_response_t := "10"; -- the slave refuses
  constant axi_decode_error_c : axi_response_t := "11"; -- no slave is at this address

  -- Master to slave.
  type axi_lite_m2s_t is record
    awvalid : std_ulogic;                      -- write address
    awaddr  : std_ulogic_vector(31 downto 0);
    awprot  : std_ulogic_vector(2 downto 0);
    wvalid  : std_ulogic;                      -- write data
    wdata   : std_ulogic_vector(31 downto 0);
    wstrb   : std_ulogic_vector(3 downto 0);   -- valid bytes
    bready  : std_ulogic;                      -- write response
    arvalid : std_ulogic;                      -- read address
    araddr  : std_ulogic_vector(31 downto 0);
    arprot  : std_ulogic_vector(2 downto 0);
    rready  : std_ulogic;                      -- read data
  end record;

  -- Slave to master.
  type axi_lite_s2m_t is record
    awready : std_ulogic;
    wready  : std_ulogic;
    bvalid  : std_ulogic;
    bresp   : axi_response_t;
    arready : std_ulogic;
    rvalid  : std_ulogic;
    rdata   : std_ulogic_vector(31 downto 0);
    rresp   : axi_response_t;
  end record;

  constant axi_lite_m2s_idle : axi_lite_m2s_t := (
    awaddr => (others => '0'), awprot => "000", wdata => (others => '0'), wstrb => "0000", araddr => (others => '0'),
    arprot => "000", others => '0');

  constant axi_lite_s2m_idle : axi_lite_s2m_t := (
    bresp => axi_okay_c, rdata => (others => '0'), rresp => axi_okay_c, others => '0');

end package;
