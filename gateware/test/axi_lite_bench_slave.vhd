-- SPDX-License-Identifier: BSD-3-Clause
--
-- An AXI4-Lite memory with random delays: on each channel it is ready, or answers, after a random number of clocks.
-- Byte address 4 * a is word a. It refuses words whose bits 7-4 are E. It answers words whose bits 7-4 are F only after
-- at least slow_clocks. It checks that the master keeps the rules of axi_lite_pkg. `executed` counts the writes that
-- have reached the memory.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.axi_lite_pkg.all;
  use work.bench_pkg.all;

entity axi_lite_bench_slave is
  generic (
    wait_clocks_most : natural  := 6; -- on each channel
    slow_clocks      : positive := 60;
    seed             : positive := 1
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    axi_lite_m2s : in  axi_lite_m2s_t;
    axi_lite_s2m : out axi_lite_s2m_t;
    executed     : out natural
  );
end entity;

architecture test of axi_lite_bench_slave is

  signal s2m : axi_lite_s2m_t := axi_lite_s2m_idle;

begin

  axi_lite_s2m <= s2m;

  serve : process is

    type memory_t is array (0 to 255) of std_ulogic_vector(31 downto 0);
    variable memory  : memory_t := (others => (others => '0'));
    variable random  : random_t;
    variable address : std_ulogic_vector(31 downto 0);
    variable data    : std_ulogic_vector(31 downto 0);
    variable strobe  : std_ulogic_vector(3 downto 0);
    variable refused : boolean;

    impure function patience return natural is
    begin
      return random.integer_between(0, wait_clocks_most);
    end function;

    procedure think is
    begin
      check_equal(address(31 downto 10) & address(1 downto 0), std_ulogic_vector'(x"000000"), "a byte address");
      refused := address(9 downto 6) = x"E";
      if address(9 downto 6) = x"F" then
        wait_clocks(clock, slow_clocks + random.integer_between(0, 3 * slow_clocks));
      else
        wait_clocks(clock, patience);
      end if;
    end procedure;

    procedure take_address is
    begin
      wait_clocks(clock, patience);
      s2m.awready <= '1';
      wait until rising_edge(clock) and axi_lite_m2s.awvalid = '1';
      address     := axi_lite_m2s.awaddr;
      s2m.awready <= '0';
    end procedure;

    procedure take_data is
    begin
      wait_clocks(clock, patience);
      s2m.wready <= '1';
      wait until rising_edge(clock) and axi_lite_m2s.wvalid = '1';
      data       := axi_lite_m2s.wdata;
      strobe     := axi_lite_m2s.wstrb;
      s2m.wready <= '0';
    end procedure;

    variable place : natural;

  begin
    random.seed(seed);
    executed <= 0;
    wait until rising_edge(clock) and reset = '0';
    loop
      wait until rising_edge(clock) and (axi_lite_m2s.awvalid or axi_lite_m2s.arvalid) = '1';
      check_equal(axi_lite_m2s.awvalid and axi_lite_m2s.arvalid, '0', "two accesses at once");
      if axi_lite_m2s.arvalid = '1' then
        wait_clocks(clock, patience);
        s2m.arready <= '1';
        wait until rising_edge(clock) and axi_lite_m2s.arvalid = '1';
        address     := axi_lite_m2s.araddr;
        s2m.arready <= '0';
        think;
        s2m.rvalid <= '1';
        s2m.rresp  <= axi_okay_c;
        s2m.rdata  <= memory(to_integer(unsigned(address(9 downto 2))));
        if refused then
          s2m.rresp <= axi_decode_error_c;
          s2m.rdata <= x"0BADBAD0";
        end if;
        wait until rising_edge(clock) and axi_lite_m2s.rready = '1';
        s2m.rvalid <= '0';
      else
        -- Address and data in any order.
        if random.chance(50) then
          take_address;
          take_data;
        else
          take_data;
          take_address;
        end if;
        think;
        if not refused then
          place := to_integer(unsigned(address(9 downto 2)));
          for lane in strobe'range loop
            if strobe(lane) = '1' then
              memory(place)(8 * lane + 7 downto 8 * lane) := data(8 * lane + 7 downto 8 * lane);
            end if;
          end loop;
        end if;
        executed   <= executed + 1;
        s2m.bvalid <= '1';
        s2m.bresp  <= axi_okay_c;
        if refused then
          s2m.bresp <= axi_slave_error_c;
        end if;
        wait until rising_edge(clock) and axi_lite_m2s.bready = '1';
        s2m.bvalid <= '0';
      end if;
    end loop;
  end process;

  -- valid and its payload stay the same until ready, and there is only one access at a time.
  watch : process (clock) is
    variable before       : axi_lite_m2s_t := axi_lite_m2s_idle;
    variable before_ready : axi_lite_s2m_t := axi_lite_s2m_idle;
    variable asked        : boolean := false; -- an address was taken and is not yet answered
  begin
    if rising_edge(clock) and reset = '0' then
      check(not asked or (axi_lite_m2s.awvalid or axi_lite_m2s.arvalid) = '0',
            "an access before the last was answered");
      if (axi_lite_m2s.awvalid and s2m.awready) = '1' or (axi_lite_m2s.arvalid and s2m.arready) = '1' then
        asked := true;
      elsif (axi_lite_m2s.bready and s2m.bvalid) = '1' or (axi_lite_m2s.rready and s2m.rvalid) = '1' then
        asked := false;
      end if;
      check(before.awvalid = '0' or before_ready.awready = '1'
            or (axi_lite_m2s.awvalid = '1' and axi_lite_m2s.awaddr = before.awaddr), "a write address was withdrawn");
      check(before.wvalid = '0' or before_ready.wready = '1'
            or (axi_lite_m2s.wvalid = '1' and axi_lite_m2s.wdata = before.wdata and axi_lite_m2s.wstrb = before.wstrb),
            "write data were withdrawn");
      check(before.arvalid = '0' or before_ready.arready = '1'
            or (axi_lite_m2s.arvalid = '1' and axi_lite_m2s.araddr = before.araddr), "a read address was withdrawn");
      before       := axi_lite_m2s;
      before_ready := s2m;
    end if;
  end process;

end architecture;
