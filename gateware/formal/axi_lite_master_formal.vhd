-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the AXI4-Lite master. The slaves delay every channel by any number of clocks, or for ever.

library ieee;
  use ieee.std_logic_1164.all;
  use work.axi_lite_pkg.all;
  use work.bii_pkg.all;

entity axi_lite_master_formal is
  generic (
    timeout_clocks : positive := 3
  );
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    request : in bii_request_t;
    s2m     : in axi_lite_s2m_t
  );
end entity;

architecture properties of axi_lite_master_formal is

  signal response : bii_response_t;
  signal m2s      : axi_lite_m2s_t;
  signal hold     : std_ulogic;
  signal begun    : std_ulogic := '0';
  signal over     : std_ulogic;  -- a response is accepted from the bus

  -- The slave: what it has accepted and not yet answered.
  signal address_taken, data_taken, read_taken : std_ulogic := '0';

  signal owed    : std_ulogic := '0';  -- an access is on the bus, or its response is still to come
  signal current : std_ulogic := '0';  -- it belongs to the request in hand
  signal begins  : std_ulogic;
  signal waiting : natural range 0 to timeout_clocks + 1 := 0;

begin

  default clock is rising_edge(clk);

  dut : entity work.axi_lite_master
    generic map (address_width => 4, data_width => 8, timeout_clocks => timeout_clocks)
    port map (
      clock => clk, reset => reset, bii_request => request, bii_response => response,
      axi_lite_m2s => m2s, axi_lite_s2m => s2m, hold => hold);

  user_side : entity work.bii_bus_view
    port map (clk => clk, reset => reset, request => request, response => response);

  over   <= (m2s.bready and s2m.bvalid) or (m2s.rready and s2m.rvalid);
  begins <= (m2s.awvalid or m2s.wvalid or m2s.arvalid) and not owed;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if m2s.awvalid = '1' and s2m.awready = '1' then
        address_taken <= '1';
      end if;
      if m2s.wvalid = '1' and s2m.wready = '1' then
        data_taken <= '1';
      end if;
      if m2s.arvalid = '1' and s2m.arready = '1' then
        read_taken <= '1';
      end if;
      if over = '1' then
        address_taken <= '0';
        data_taken    <= '0';
        read_taken    <= '0';
      end if;

      if over = '1' then
        owed <= '0';
      elsif begins = '1' then
        owed <= '1';
      end if;
      if response.done = '1' then
        current <= '0';
      elsif begins = '1' then
        current <= '1';
      end if;

      waiting <= 0;
      if request.valid = '1' and response.done = '0' and waiting <= timeout_clocks then
        waiting <= waiting + 1;
      end if;
      if reset = '1' then
        address_taken <= '0';
        data_taken    <= '0';
        read_taken    <= '0';
        owed          <= '0';
        current       <= '0';
        waiting       <= 0;
      end if;
    end if;
  end process;

  -- The design and its slaves are reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A slave answers a write only once it has both address and data. It holds the answer until it is accepted.
  write_answer : assume always s2m.bvalid = '0' or (address_taken = '1' and data_taken = '1');

  -- A slave answers a read only once it has its address.
  read_answer : assume always s2m.rvalid = '0' or read_taken = '1';

  -- A write address stays the same until it is accepted.
  write_address_stands : assert always m2s.awvalid = '1' and s2m.awready = '0' and reset = '0' ->
                         next (m2s.awvalid = '1' and m2s.awaddr = prev(m2s.awaddr));

  -- A word to write stays the same until it is accepted.
  write_data_stands : assert always m2s.wvalid = '1' and s2m.wready = '0' and reset = '0' ->
                      next (m2s.wvalid = '1' and m2s.wdata = prev(m2s.wdata) and m2s.wstrb = prev(m2s.wstrb));

  -- A read address stays the same until it is accepted.
  read_address_stands : assert always m2s.arvalid = '1' and s2m.arready = '0' and reset = '0' ->
                        next (m2s.arvalid = '1' and m2s.araddr = prev(m2s.araddr));

  -- There is one access at a time. An address or word is not sent while the slave still holds one of the same channel,
  -- or of the other kind of access.
  one_access : assert always (m2s.awvalid = '0' or (address_taken = '0' and read_taken = '0' and m2s.arvalid = '0')) and
               (m2s.wvalid = '0' or (data_taken = '0' and read_taken = '0')) and
               (m2s.arvalid = '0' or (read_taken = '0' and address_taken = '0' and data_taken = '0'));

  -- A new access has the kind, the byte address and the word of the request.
  asks_what_was_asked : assert always begun = '0' or begins = '0' or
                        (m2s.awvalid = request.write and m2s.wvalid = request.write and
                         m2s.arvalid = not request.write and
                         m2s.awaddr(5 downto 2) = request.address(3 downto 0) and
                         m2s.araddr(5 downto 2) = request.address(3 downto 0) and
                         (request.write = '0' or m2s.wdata(7 downto 0) = request.data(7 downto 0)) and
                         m2s.wstrb = "0001");

  -- A request is done at most one clock after the clocks of the timeout.
  always_ends : assert always waiting <= timeout_clocks;

  -- A request ends with `silent` only after the timeout.
  silent_in_time : assert always begun = '0' or response.done = '0' or
                   response.status /= silent or waiting = timeout_clocks;

  -- A late response is dropped. It is never used for another access.
  late_response_is_dropped : assert always response.done = '0' or response.status = silent or
                             (over = '1' and current = '1');

  -- The user gets the word and the status of the response.
  response_is_passed_on : assert always response.done = '0' or response.status = silent or m2s.rready = '0' or
                          (response.data(7 downto 0) = s2m.rdata(7 downto 0) and
                           (response.status = error) = (s2m.rresp(1) = '1'));

  -- `hold` is high while a request stands.
  hold_with_request : assert always request.valid = '0' or hold = '1';

  -- An access times out.
  silent_seen : cover {response.done = '1' and response.status = silent};

  -- The late response comes while the next request waits.
  late_seen : cover {over = '1' and current = '0' and request.valid = '1'};

  -- A read is done.
  read_seen : cover {response.done = '1' and response.status = ok and m2s.rready = '1'};

end architecture;
