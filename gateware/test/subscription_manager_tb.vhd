-- SPDX-License-Identifier: BSD-3-Clause
--
-- subscription_manager: exact strobes, rates, order among groups, coalescing, level and edge events, addresses at every
-- place of every group, mask bytes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.subscription_pkg.all;

entity subscription_manager_tb is
  generic (
    groups        : positive := 4;
    group_size    : positive := 5;
    address_width : positive := 11;
    period        : positive := 300
  );
end entity;

architecture bench of subscription_manager_tb is

  constant strobe_to_publish : natural := groups + 5;  -- clocks; always the same

  signal clock     : std_ulogic := '0';
  signal reset     : std_ulogic := '1';
  signal ended     : boolean := false;
  signal now_clock : natural := 0;
  signal events    : std_ulogic_vector(groups - 1 downto 0) := (others => '0');
  signal request   : subscription_request_t := subscription_request_idle;
  signal response  : subscription_response_t;

begin

  clock     <= not clock after 1 ns when not ended;
  now_clock <= now_clock + 1 when rising_edge(clock);

  dut : entity work.subscription_manager
    generic map (
      address_width => address_width, clock_hz => 1000 * period, base_hz => 1000, groups => groups,
      group_size => group_size, rate_bytes => 2, edge_events => (1 => '1', others => '0'))
    port map (clock => clock, reset => reset, events => events, request => request, response => response);

  play : process

    procedure look(group_number : natural; place : natural := 0) is
    begin
      request.group_number <= to_unsigned(group_number, 8);
      request.place        <= to_unsigned(place, 9);
    end procedure;

    function address_of(group_number : natural; index : natural) return natural is
    begin
      return (group_number * 257 + index * 7 + 1) mod 2 ** minimum(address_width, 20);
    end function;

    -- In a large device most groups are small here, so that the bench is quick.
    function size_of(group_number : natural) return positive is
    begin
      if group_number mod 16 = 0 or group_number = groups - 1 or groups <= 16 then
        return group_size;
      end if;
      return 1;
    end function;

    -- Address number index of a group is at place size - index. Place 0 has their number.
    procedure fill(group_number : natural; count : positive) is
    begin
      for place in 0 to count loop
        look(group_number, place);
        request.word <= std_ulogic_vector(to_unsigned(count, 32));
        if place > 0 then
          request.word <= std_ulogic_vector(to_unsigned(address_of(group_number, count - place), 32));
        end if;
        pulse(clock, request.write_word);
      end loop;
      pulse(clock, request.fill);
    end procedure;

    procedure rate(group_number : natural; value : natural) is
    begin
      look(group_number);
      tick(clock);
      request.rate       <= std_ulogic_vector(to_unsigned(value, 32));
      request.write_rate <= '1';
      wait until rising_edge(clock) and response.done = '1';
      request.write_rate <= '0';
      tick(clock, 3);
      check(response.inactive = '1' xor value /= 0, "inactive");
    end procedure;

    procedure mask(index : natural; value : natural) is
    begin
      look(0, index);
      request.word       <= std_ulogic_vector(to_unsigned(value, 32));
      pulse(clock, request.write_mask);
    end procedure;

    procedure enable is
    begin
      pulse(clock, request.enable);
    end procedure;

    procedure disable is
    begin
      pulse(clock, request.disable);
    end procedure;

    -- Takes the publish that is due.
    procedure taken(group_number : natural) is
    begin
      for waited in 1 to 4 * period loop
        exit when response.publish = '1';
        tick(clock);
      end loop;
      check_equal(response.publish, '1', "publish of group " & integer'image(group_number));
      check_equal(to_integer(response.publish_group), group_number, "group to publish");
      tick(clock);
      look(group_number);
      pulse(clock, request.publish_take);
      tick(clock, 2);
    end procedure;

    procedure none(clocks : positive) is
    begin
      for c in 1 to clocks loop
        tick(clock);
        check_equal(response.publish, '0', "publish without a cause");
      end loop;
    end procedure;

    variable start : natural;
    constant last  : natural := groups - 1;
  begin
    tick(clock, 2);
    reset <= '0';
    tick(clock);
    -- Every address of every group is at its place. A group that was not filled has no address.
    look(last);
    tick(clock, 2);
    check_equal(response.empty, '1', "an empty group");
    check_equal(response.inactive, '1', "rate of a group never set");
    for group_number in 0 to last loop
      fill(group_number, size_of(group_number));
    end loop;
    for group_number in 0 to last loop
      for index in 0 to size_of(group_number) - 1 loop
        if index mod 16 = 0 or index = size_of(group_number) - 1 then
          look(group_number, size_of(group_number) - index);
          tick(clock, 2);
          check_equal(to_integer(unsigned(response.word)), address_of(group_number, index), "address");
        end if;
      end loop;
      look(group_number, 0);
      tick(clock, 2);
      check_equal(to_integer(unsigned(response.word)),
                  size_of(group_number) mod 2 ** maximum(minimum(address_width, 20), 8), "count");
      check_equal(response.empty, '0', "a group with addresses");
    end loop;
    -- Rate 1 in all groups: all are due together, and are served downwards and around in each period, to the clock.
    for group_number in 0 to last loop
      rate(group_number, 1);
    end loop;
    none(20);
    enable;
    start := now_clock;
    for round in 0 to 2 loop
      wait until rising_edge(clock) and response.publish = '1';
      wait for 1 ps;
      check_equal(now_clock - start, round * period + strobe_to_publish, "clocks to the publish");
      for group_number in minimum(last, period / 8) downto 0 loop
        if last <= period / 8 then
          taken(group_number);
        else
          taken(last - (minimum(last, period / 8) - group_number));
        end if;
      end loop;
      exit when last > period / 8;  -- more groups than a period can serve
    end loop;
    disable;
    tick(clock, 3);
    if last <= period / 8 then
      none(2 * period);
      -- Rate 3: after two periods, then every third. Further causes join the publish that waits.
      for group_number in 0 to last loop
        rate(group_number, 0);
      end loop;
      rate(0, 3);
      enable;
      start := now_clock;
      for round in 0 to 2 loop
        wait until rising_edge(clock) and response.publish = '1';
        wait for 1 ps;
        check_equal(now_clock - start, (3 * round + 2) * period + strobe_to_publish, "clocks at rate 3");
        taken(0);
      end loop;
      tick(clock, 7 * period);
      taken(0);
      none(period / 2);
      rate(0, 0);
      -- Events: group 0 by level, group 1 by edge, others not enabled.
      mask(0, 3);
      check_equal(response.mask, std_ulogic_vector'(x"03"), "mask");
      events(1) <= '1';
      taken(1);
      none(2 * period);
      events(1) <= '0';
      tick(clock, 4);
      events(1) <= '1';
      tick(clock, 2);
      events(1) <= '0';
      tick(clock, 2);
      events(1) <= '1';
      tick(clock, 5);
      taken(1);
      none(period);
      events(0) <= '1';
      taken(0);
      taken(0);
      taken(0);
      events(0) <= '0';
      taken(0);
      none(period);
      events(2) <= '1';
      none(period);
      -- An event while publishing is off is not lost.
      disable;
      events(0) <= '1';
      tick(clock);
      events(0) <= '0';
      none(50);
      enable;
      taken(0);
      none(period);
      -- If a rate and an event of one group come together, the rate is served first.
      rate(0, 1);
      tick(clock, period);
      taken(0);
      events(0) <= '1';
      tick(clock);
      events(0) <= '0';
      tick(clock, period);
      taken(0);
      taken(0);
      rate(0, 0);
      mask(0, 0);
      check_equal(response.mask, std_ulogic_vector'(x"00"), "mask cleared");
      events(0) <= '1';
      none(period);
    end if;
    report_passed("subscription_manager_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 10 ms, "subscription_manager_tb");

end architecture;
