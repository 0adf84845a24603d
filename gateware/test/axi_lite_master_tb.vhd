-- SPDX-License-Identifier: BSD-3-Clause
--
-- axi_lite_master with a slave that delays every channel. Words and errors arrive with their own access, every access
-- ends, and no access starts before a late response has come.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.axi_lite_pkg.all;
  use work.bench_pkg.all;
  use work.bii_pkg.all;

entity axi_lite_master_tb is
  generic (
    address_width    : positive := 8;
    data_width       : positive := 32;
    wait_clocks_most : natural  := 6;
    timeout_clocks   : positive := 40; -- more than a slow slave takes
    seed             : positive := 1
  );
end entity;

architecture test of axi_lite_master_tb is

  constant clock_period : time := 20 ns;

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal done         : boolean := false;
  signal bii_request  : bii_request_t := bii_request_idle;
  signal bii_response : bii_response_t;
  signal axi_lite_m2s : axi_lite_m2s_t;
  signal axi_lite_s2m : axi_lite_s2m_t;
  signal hold         : std_ulogic;
  signal executed     : natural;
  signal quick        : boolean := false; -- the slave answers without delays
  signal from_slave   : axi_lite_s2m_t;
  signal from_quick   : axi_lite_s2m_t := (
    awready => '1', wready => '1', arready => '1', bvalid => '0', rvalid => '0',
    bresp => axi_okay_c, rresp => axi_okay_c, rdata => (others => '0'));
  signal to_slave     : axi_lite_m2s_t;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.axi_lite_master
    generic map (address_width => address_width, data_width => data_width, timeout_clocks => timeout_clocks)
    port map (
      clock => clock, reset => reset, bii_request => bii_request, bii_response => bii_response,
      axi_lite_m2s => axi_lite_m2s, axi_lite_s2m => axi_lite_s2m, hold => hold);

  slave : entity work.axi_lite_bench_slave
    generic map (wait_clocks_most => wait_clocks_most, slow_clocks => timeout_clocks, seed => seed + 100)
    port map (
      clock => clock, reset => reset, axi_lite_m2s => to_slave, axi_lite_s2m => from_slave, executed => executed);

  to_slave     <= axi_lite_m2s_idle when quick else axi_lite_m2s;
  axi_lite_s2m <= from_quick when quick else from_slave;

  answer_quickly : process (clock) is
  begin
    if rising_edge(clock) then
      from_quick.bvalid <= axi_lite_m2s.awvalid;
      from_quick.rvalid <= axi_lite_m2s.arvalid;
    end if;
  end process;

  play : process is

    type memory_t is array (0 to 255) of std_ulogic_vector(data_width - 1 downto 0);
    type known_t is array (0 to 255) of boolean;

    variable random  : random_t;
    variable memory  : memory_t := (others => (others => '0'));
    variable known   : known_t  := (others => true); -- false: a write to it has timed out
    variable address : natural range 0 to 255;
    variable data    : std_ulogic_vector(data_width - 1 downto 0);
    variable silents : natural := 0;
    variable clocks  : natural;

    -- Makes an access, and returns in the clock in which it is done.
    procedure go (write : std_ulogic) is
    begin
      bii_request.valid   <= '1';
      bii_request.write   <= write;
      bii_request.address <= (others => '1'); -- bits beyond the width are ignored
      bii_request.address(address_width - 1 downto 0) <= std_ulogic_vector(to_unsigned(address, address_width));
      bii_request.data    <= (others => '1');
      bii_request.data(data_width - 1 downto 0)       <= data;
      clocks := 1;
      wait for 1 ps;
      while bii_response.done = '0' loop
        check_equal(hold, '1', "hold in an access");
        check(clocks <= timeout_clocks, "an access does not end");
        tick(clock);
        clocks := clocks + 1;
      end loop;
    end procedure;

    procedure finish is
    begin
      tick(clock);
      bii_request.valid <= '0';
      wait for 1 ps;
      check_equal(hold, bii_request.block_hold, "hold after an access");
    end procedure;

    procedure judge (write : std_ulogic) is
    begin
      if bii_response.status = silent then
        silents := silents + 1;
        check_equal(clocks, timeout_clocks + 1, "clocks until an access is given up on");
        if write = '1' then
          known(address) := false;
        end if;
      elsif address / 16 = 14 then
        check(bii_response.status = error, "a refusal");
      else
        check(bii_response.status = ok, "an answer");
        if write = '1' then
          memory(address) := data;
          known(address)  := true;
        elsif known(address) then
          check_equal(bii_response.data(data_width - 1 downto 0), memory(address), "word " & integer'image(address));
          check(unsigned(bii_response.data) <= unsigned(memory(address)), "bits beyond the width");
        end if;
      end if;
    end procedure;

    variable write  : std_ulogic;
    variable before : natural;

  begin
    random.seed(seed);
    tick(clock, 2);
    reset <= '0';
    for access_number in 1 to 1500 loop
      address := random.integer_between(0, 239);
      if random.chance(3) then
        address := random.integer_between(240, 255);
      end if;
      if random.chance(30) then
        address := random.integer_between(0, 7);
      end if;
      data  := random.vector(data_width);
      write := '0';
      if random.chance(50) then
        write := '1';
      end if;
      bii_request.block_hold <= '0';
      if random.chance(30) then
        bii_request.block_hold <= '1';
      end if;
      go(write);
      judge(write);
      finish;
      if random.chance(30) then
        tick(clock, random.integer_between(1, 10));
      end if;
    end loop;
    check(silents > 20, "few accesses were given up on");

    -- While a late response is outstanding, accesses end without reaching the bus.
    bii_request.block_hold <= '0';
    address := 1;
    tick(clock, 5 * timeout_clocks);
    address := 255;
    data    := (others => '1');
    before  := executed;
    go('1');
    check(bii_response.status = silent, "a slow slave");
    finish;
    address := 2;
    data    := (others => '0');
    go('1');
    judge('1');
    finish;
    check(executed = before + 2 or not known(2), "an answered write behind a late one");

    -- A quick slave: three clocks per access, for a write too.
    tick(clock, 5 * timeout_clocks);
    quick <= true;
    for access_number in 1 to 4 loop
      address := access_number;
      data    := random.vector(data_width);
      go(to_unsigned(access_number, 3)(0));
      check_equal(clocks, 3, "clocks of an access");
      check(bii_response.status = ok, "a quick answer");
      finish;
    end loop;

    report_passed("axi_lite_master_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 400000, "axi_lite_master_tb");

end architecture;
