-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the subscription manager: two groups, a strobe every eight clocks, rates up to 2. The application may
-- ask anything that subscription_pkg allows. Events come at any time.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.subscription_pkg.all;

entity subscription_manager_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    events  : in std_ulogic_vector(1 downto 0);
    request : in subscription_request_t
  );
end entity;

architecture properties of subscription_manager_formal is

  constant period      : positive := 8;
  constant rate_clocks : positive := 10;  -- clocks until a new rate is taken

  signal response : subscription_response_t;
  signal begun    : std_ulogic := '0';
  signal publish  : std_ulogic;
  signal chosen   : natural range 0 to 1;
  signal asked    : natural range 0 to 1;
  signal taken    : std_ulogic;

  -- The state of the groups, from the requests.
  signal running, was_running               : std_ulogic := '0';
  signal filled, was_filled        : std_ulogic_vector(1 downto 0) := "00";
  signal enabled                   : std_ulogic_vector(1 downto 0) := "00";
  signal caused                    : std_ulogic_vector(1 downto 0) := "00";  -- it had a rate, or an event that counts
  signal offered                   : std_ulogic := '0';  -- publish, one clock ago
  signal offered_group             : natural range 0 to 1 := 0;
  signal waiting                   : natural range 0 to rate_clocks + 1 := 0;

  -- Group 0 alone, with a rate and no other change.
  signal rate   : unsigned(7 downto 0) := x"00";
  signal steady : std_ulogic := '0';
  signal since  : natural range 0 to 2 * period + 1 := 0;  -- clocks since the group was offered
  signal calm   : std_ulogic;
  signal even   : std_ulogic := '1';  -- nothing changed since publishing was started, and no event came

  -- Fairness: group 0 waits, and so many publishes of group 1 were taken meanwhile.
  signal wants  : std_ulogic := '0';
  signal passed : natural range 0 to 2 := 0;

begin

  default clock is rising_edge(clk);

  dut : entity work.subscription_manager
    generic map (address_width => 4, clock_hz => period, base_hz => 1, groups => 2, group_size => 1, rate_bytes => 1)
    port map (clock => clk, reset => reset, events => events, request => request, response => response);

  publish <= response.publish;
  chosen  <= to_integer(response.publish_group(0 downto 0));
  asked   <= to_integer(request.group_number(0 downto 0));
  taken   <= request.publish_take;
  calm    <= not (request.write_rate or request.fill or request.empty or request.enable or request.disable or
                  request.write_mask or request.write_event or request.clear or reset or or (enabled and events));

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun         <= '1';
      was_running        <= running;
      was_filled    <= filled;
      offered       <= publish;
      offered_group <= chosen;
      caused        <= caused or (enabled and events);

      if request.enable = '1' then
        running <= '1';
      elsif request.disable = '1' then
        running <= '0';
      end if;
      if request.fill = '1' then
        filled(asked) <= '1';
      elsif request.empty = '1' then
        filled(asked) <= '0';
      end if;
      if request.write_mask = '1' and request.place(0) = '0' then
        enabled <= request.word(1 downto 0);
      end if;
      if request.write_event = '1' then
        enabled(asked) <= request.word(0);
      end if;
      if response.done = '1' and request.write_rate = '1' then
        if request.rate(7 downto 0) /= x"00" then
          caused(asked) <= '1';
        end if;
        if asked = 0 then
          rate <= unsigned(request.rate(7 downto 0));
        end if;
      end if;
      waiting <= 0;
      if request.write_rate = '1' and response.done = '0' and waiting <= rate_clocks then
        waiting <= waiting + 1;
      end if;

      if since <= 2 * period then
        since <= since + 1;
      end if;
      if or (enabled and events) = '1' or (running = '1' and calm = '0') then
        even <= '0';
      end if;
      if publish = '1' and offered = '0' and even = '1' and calm = '1' and filled = "01" and running = '1' and
         rate /= 0 then
        steady <= '1';
        since  <= 1;
      end if;
      if calm = '0' then
        steady <= '0';
      end if;

      if taken = '1' and asked = 0 then
        wants  <= '0';
        passed <= 0;
      elsif taken = '1' and wants = '1' and passed < 2 then
        passed <= passed + 1;
      end if;
      if enabled(0) = '1' and events(0) = '1' and filled(0) = '1' and wants = '0' and taken = '0' then
        wants  <= '1';
        passed <= 0;
      end if;
      if request.empty = '1' or request.fill = '1' or request.write_mask = '1' or request.write_event = '1' or
         request.write_rate = '1' then
        wants <= '0';
      end if;

      if reset = '1' or request.clear = '1' then
        running <= '0';
        filled  <= "00";
        enabled <= "00";
        rate    <= x"00";
        steady  <= '0';
        wants   <= '0';
      end if;
      if reset = '1' then
        was_running <= '0';
        was_filled <= "00";
        caused  <= "00";
        offered <= '0';
        even    <= '1';
        waiting <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There are two groups, and the rates are small, so that a proof can wait for them.
  small : assume always request.group_number < 2 and unsigned(request.rate) <= 2;

  -- Only a group that was offered one clock ago is taken.
  takes_what_was_offered : assume always taken = '0' or (offered = '1' and asked = offered_group);

  -- A rate is held until it is done, and not asked for again in that clock.
  rate_is_held : assume always request.write_rate = '1' and response.done = '0' and reset = '0' ->
                 next (request.write_rate = '1' and request.group_number = prev(request.group_number) and
                       request.rate = prev(request.rate));

  -- The application does one thing at a time.
  one_thing : assume always request.write_rate = '0' or
              (taken or request.fill or request.empty or request.enable or request.disable or request.write_mask or
               request.write_event or request.clear) = '0';

  -- A steady group is taken in the clock after it was offered.
  taken_promptly : assume always steady = '0' or offered = '0' or taken = '1';

  -- Nothing is published while publishing is off.
  off_is_silent : assert always begun = '0' or publish = '0' or was_running = '1';

  -- A group without addresses is never published.
  empty_is_silent : assert always begun = '0' or publish = '0' or was_filled(chosen) = '1';

  -- A group that never had a rate or an event is never published.
  disabled_is_silent : assert always begun = '0' or publish = '0' or caused(chosen) = '1';

  -- A group that is alone with its rate is offered after exactly so many strobes. It is never offered sooner.
  never_sooner : assert always begun = '0' or steady = '0' or publish = '0' or offered = '1' or
                 (rate = 1 and since = period) or (rate = 2 and since = 2 * period);

  -- It is never offered later.
  never_later : assert always begun = '0' or steady = '0' or calm = '0' or not
                ((rate = 1 and since = period) or (rate = 2 and since = 2 * period)) or publish = '1';

  -- A waiting group waits for at most one publish of the other group, and for one that was already chosen.
  fair : assert always begun = '0' or wants = '0' or passed < 2 or taken = '0' or asked = 0;

  -- A new rate is taken within a fixed number of clocks, whatever else happens.
  rate_is_taken : assert always begun = '0' or waiting <= rate_clocks;

  -- A steady group is published twice, at rate 2.
  steady_seen : cover {steady = '1' and publish = '1' and offered = '0' and rate = 2 and since = 2 * period};

  -- A group waits for the other group.
  waits_seen : cover {wants = '1' and passed = 1};

end architecture;
