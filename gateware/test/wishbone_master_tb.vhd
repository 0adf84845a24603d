-- SPDX-License-Identifier: BSD-3-Clause
--
-- wishbone_master: acknowledge with and without wait, refusal, timeout, late acknowledge, held blocks, narrow buses.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.bii_pkg.all;
use work.wishbone_pkg.all;

entity wishbone_master_tb is
end entity;

architecture bench of wishbone_master_tb is

  constant timeout_clocks : positive := 20;

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal ended        : boolean := false;
  signal bii_request  : bii_request_t := bii_request_idle;
  signal bii_response : bii_response_t;
  signal wishbone_m2s : wishbone_m2s_t;
  signal wishbone_s2m : wishbone_s2m_t := wishbone_s2m_idle;
  signal cyc_fell     : natural := 0;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.wishbone_master
    generic map (address_width => 12, data_width => 16, timeout_clocks => timeout_clocks)
    port map (
      clock => clock, reset => reset, bii_request => bii_request, bii_response => bii_response,
      wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

  count : process (clock)
    variable before : std_ulogic := '0';
  begin
    if rising_edge(clock) then
      if before = '1' and wishbone_m2s.cyc = '0' then
        cyc_fell <= cyc_fell + 1;
      end if;
      before := wishbone_m2s.cyc;
    end if;
  end process;

  play : process

    -- An access that the slave answers after `waits` clocks, with the data 0xA5A0 + waits.
    procedure answered(waits : natural; err : std_ulogic := '0') is
    begin
      bii_request.valid <= '1';
      wait for 1 ps;
      for c in 1 to waits loop
        check_equal(wishbone_m2s.stb, '1', "strobe while the slave waits");
        check_equal(bii_response.done, '0', "done before the answer");
        tick(clock);
      end loop;
      wishbone_s2m <= (dat => x"FFFF" & std_ulogic_vector(to_unsigned(16#A5A0# + waits, 16)),
                       ack => not err, err => err);
      wait for 1 ps;
      check_equal(bii_response.done, '1', "done with the answer");
      if err = '1' then
        check(bii_response.status = error, "status of a refusal");
      else
        check(bii_response.status = ok, "status");
        check_equal(bii_response.data, x"0000" & std_ulogic_vector(to_unsigned(16#A5A0# + waits, 16)), "data");
      end if;
      tick(clock);
      bii_request.valid <= '0';
      wishbone_s2m      <= wishbone_s2m_idle;
      wait for 1 ps;
      check_equal(wishbone_m2s.stb, '0', "strobe afterwards");
    end procedure;

    procedure unanswered is
    begin
      bii_request.valid <= '1';
      wait for 1 ps;
      for c in 1 to timeout_clocks loop
        check_equal(wishbone_m2s.stb, '1', "strobe up to the time-out");
        check_equal(bii_response.done, '0', "done before the time-out");
        tick(clock);
      end loop;
      check_equal(bii_response.done, '1', "done at the time-out");
      check(bii_response.status = silent, "status at the time-out");
      check_equal(wishbone_m2s.stb, '0', "strobe at the time-out");
      check_equal(wishbone_m2s.cyc, '0', "cycle at the time-out");
      tick(clock);
      bii_request.valid <= '0';
      wait for 1 ps;
    end procedure;

    variable falls : natural;
  begin
    tick(clock, 2);
    reset <= '0';
    tick(clock);
    bii_request.address <= x"FFFFFABC";
    bii_request.data    <= x"12345678";
    bii_request.write   <= '1';
    bii_request.valid   <= '1';
    wait for 1 ps;
    check_equal(wishbone_m2s.adr, std_ulogic_vector'(x"00000ABC"), "address, cut to its width");
    check_equal(wishbone_m2s.dat, std_ulogic_vector'(x"00005678"), "data, cut to their width");
    check_equal(wishbone_m2s.sel, std_ulogic_vector'("0011"), "bytes selected");
    check_equal(wishbone_m2s.we, '1', "write enable");
    bii_request.write <= '0';
    answered(0);
    answered(1);
    tick(clock, 3);
    answered(7);
    answered(2, err => '1');
    answered(timeout_clocks - 1);

    -- A block holds the bus between its accesses, and only then.
    falls := cyc_fell;
    tick(clock);
    falls := cyc_fell;
    bii_request.block_hold <= '1';
    wait for 1 ps;
    check_equal(wishbone_m2s.cyc, '0', "cycle before the first access of a block");
    answered(1);
    tick(clock, 5);
    check_equal(wishbone_m2s.cyc, '1', "cycle between the accesses of a block");
    answered(3);
    tick(clock, 2);
    check_equal(cyc_fell, falls, "falls of the cycle in a block");
    bii_request.block_hold <= '0';
    tick(clock, 2);
    check_equal(cyc_fell, falls + 1, "falls of the cycle after a block");

    -- Without an answer, the access ends. The next one waits until a late answer is no longer possible.
    unanswered;
    bii_request.valid <= '1';
    wait for 1 ps;
    check_equal(wishbone_m2s.stb, '0', "strobe while the bus rests");
    tick(clock, 5);
    wishbone_s2m <= (dat => x"00000BAD", ack => '1', err => '0');  -- late
    wait for 1 ps;
    check_equal(bii_response.done, '0', "a late answer is no answer");
    tick(clock);
    wishbone_s2m <= wishbone_s2m_idle;
    answered(2);
    unanswered;
    bii_request.valid <= '1';
    for c in 1 to timeout_clocks + 1 loop
      wait for 1 ps;
      check_equal(wishbone_m2s.cyc, '0', "cycle while the bus rests");
      tick(clock);
    end loop;
    answered(1);

    -- A timeout within a block ends the block.
    bii_request.block_hold <= '1';
    answered(1);
    unanswered;
    check_equal(wishbone_m2s.cyc, '0', "cycle after a time-out in a block");
    bii_request.block_hold <= '0';
    tick(clock, timeout_clocks + 2);
    answered(1);
    report_passed("wishbone_master_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "wishbone_master_tb");

end architecture;
