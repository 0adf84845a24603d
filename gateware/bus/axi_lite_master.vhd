-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bus-independent interface on an AXI4-Lite bus.
--
-- Addresses  AXI counts bytes: word a is at 4 * a, for every data_width. So a word address has at most 30 bits.
-- Latency    Address and data are on the bus one clock after bii_request.valid. `done` comes in the same clock as the
--            response. A read or write takes 3 clocks if the slave takes the address at once and answers in the next
--            clock.
-- Block      AXI4-Lite cannot hold its bus. `hold` is high from the first to the last access of a block, and during
--            each single access, like Wishbone's cyc. It is for slaves that show one moment for a whole block. Other
--            masters may come between.
-- Errors     SLVERR and DECERR end an access with status `error`. After `timeout_clocks` clocks without a response it
--            ends with status `silent`.
-- Late       AXI cannot cancel an access. After a timeout, the access stays on the bus until its response comes, and
--            this response is dropped. Only then does the next access start, so a late response is never used for
--            another access. Until then every access ends with `silent` after timeout_clocks, and does not reach the
--            bus. A write that ended with `silent` may still happen.
-- Pressure   valid waits for ready on every channel. bii_request waits.
-- Reset      Drops the current access. Reset the slaves in the same clock, as AXI demands.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.axi_lite_pkg.all;
  use work.bii_pkg.all;
  use work.protocol_pkg.all;
  use work.width_pkg.all;

entity axi_lite_master is
  generic (
    address_width  : positive range 1 to 32 := 8; -- of words
    data_width     : positive range 8 to 32 := 32;
    timeout_clocks : positive               := limits_bus_timeout_clocks_c
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    bii_request  : in  bii_request_t;
    bii_response : out bii_response_t;
    axi_lite_m2s : out axi_lite_m2s_t;
    axi_lite_s2m : in  axi_lite_s2m_t;
    hold         : out std_ulogic
  );
end entity;

architecture rtl of axi_lite_master is

  constant address_bits : positive := minimum(address_width, 30);

  signal busy       : std_ulogic := '0'; -- an access is on the bus
  signal writes     : std_ulogic := '0'; -- … which is a write
  signal given_up   : std_ulogic := '0'; -- … and has timed out
  signal aw, w, ar  : std_ulogic := '0'; -- valid of these channels
  signal address    : std_ulogic_vector(address_bits - 1 downto 0);
  signal data       : std_ulogic_vector(data_width - 1 downto 0);
  signal b, r       : std_ulogic;        -- ready of these channels: address and data were taken
  signal over       : std_ulogic;        -- the response has come
  signal response   : axi_response_t;
  signal waited     : natural range 0 to timeout_clocks := 0;
  signal expired    : std_ulogic;
  signal in_block   : std_ulogic := '0';

begin

  assert address_width <= 30
    report "axi_lite_master: an address_width of " & integer'image(address_width)
           & " does not fit an AXI address of 32 bits, which counts bytes; at most 30"
    severity failure;

  b        <= busy and writes and not aw and not w;
  r        <= busy and not writes and not ar;
  over     <= (b and axi_lite_s2m.bvalid) or (r and axi_lite_s2m.rvalid);
  response <= axi_lite_s2m.bresp when writes = '1' else axi_lite_s2m.rresp;
  expired  <= '1' when waited = timeout_clocks else '0';
  hold     <= bii_request.valid or (in_block and bii_request.block_hold);

  drive : process (all) is
  begin
    axi_lite_m2s         <= axi_lite_m2s_idle;
    axi_lite_m2s.awvalid <= aw;
    axi_lite_m2s.wvalid  <= w;
    axi_lite_m2s.bready  <= b;
    axi_lite_m2s.arvalid <= ar;
    axi_lite_m2s.rready  <= r;
    axi_lite_m2s.awaddr(address_bits + 1 downto 2)          <= address;
    axi_lite_m2s.araddr(address_bits + 1 downto 2)          <= address;
    axi_lite_m2s.wdata(data_width - 1 downto 0)             <= data;
    axi_lite_m2s.wstrb(bytes_for(data_width) - 1 downto 0) <= (others => '1');
  end process;

  answer : process (all) is
  begin
    bii_response <= bii_response_idle;
    bii_response.data(data_width - 1 downto 0) <= axi_lite_s2m.rdata(data_width - 1 downto 0);
    if bii_request.valid = '1' then
      if over = '1' and given_up = '0' then
        bii_response.done <= '1';
        if response(1) = '1' then
          bii_response.status <= error;
        end if;
      elsif expired = '1' then
        bii_response.done   <= '1';
        bii_response.status <= silent;
      end if;
    end if;
  end process;

  process (clock) is
  begin
    if rising_edge(clock) then
      aw <= aw and not axi_lite_s2m.awready;
      w  <= w and not axi_lite_s2m.wready;
      ar <= ar and not axi_lite_s2m.arready;
      if busy = '1' then
        if over = '1' then
          busy     <= '0';
          given_up <= '0';
        elsif expired = '1' then
          given_up <= '1';
        end if;
      elsif bii_request.valid = '1' and expired = '0' then
        busy    <= '1';
        writes  <= bii_request.write;
        aw      <= bii_request.write;
        w       <= bii_request.write;
        ar      <= not bii_request.write;
        address <= bii_request.address(address_bits - 1 downto 0);
        data    <= bii_request.data(data_width - 1 downto 0);
      end if;

      if bii_request.valid = '0' or bii_response.done = '1' then
        waited <= 0;
      else
        waited <= waited + 1;
      end if;
      in_block <= (in_block or bii_request.valid) and bii_request.block_hold;

      if reset = '1' then
        busy     <= '0';
        given_up <= '0';
        aw       <= '0';
        w        <= '0';
        ar       <= '0';
        waited   <= 0;
        in_block <= '0';
      end if;
    end if;
  end process;

end architecture;
