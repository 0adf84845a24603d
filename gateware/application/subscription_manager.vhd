-- SPDX-License-Identifier: BSD-3-Clause
--
-- The publish groups: their addresses, rates and events. It chooses the group that publishes next.
--
-- While publishing is on, a strobe comes every clock_hz / base_hz clocks, the first one at once. Each strobe starts a
-- scan of all groups, one per clock. A group whose rate is reached becomes due. An event input also makes its group
-- due, by level or by rising edge. A group that is already due is not queued again. If rate and event come together,
-- the rate is served first. Among the due groups the choice goes downwards and around, from the group that was served
-- last.
--
-- Ports     See subscription_pkg. Requests are taken at once, except write_rate, which waits for `done`. A strobe that
--           comes meanwhile waits 2 clocks for it. `publish` is low during a scan: take it if it was high one clock
--           ago. The event inputs must be synchronous to the clock.
-- Latency   From strobe to `publish` always groups + 5 clocks. From an event input 2 clocks, or until after the scan.
-- Errors    None. An empty group never becomes due, and rate 0 is off. Addresses, counts and rates are in block RAM.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity subscription_manager is
  generic (
    address_width : positive range 1 to 32  := 8;
    clock_hz      : positive                := limits_clock_hz_default_c;
    base_hz       : positive                := limits_base_hz_default_c;
    groups        : positive range 1 to 256 := 2;
    group_size    : positive range 1 to 255 := 16;
    rate_bytes    : positive range 1 to 4   := 2;
    edge_events   : std_ulogic_vector(255 downto 0) := (others => '0')  -- bit g: the event of group g is an edge
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic;
    events   : in  std_ulogic_vector(groups - 1 downto 0);
    request  : in  subscription_request_t;
    response : out subscription_response_t
  );
end entity;

architecture rtl of subscription_manager is

  constant period     : positive := maximum(1, clock_hz / base_hz);
  constant rate_bits  : positive := 8 * rate_bytes;
  constant group_bits : positive := bits_for(groups);
  constant place_bits : positive := bits_for(1 + group_size + 2 * rate_bytes);
  constant word_bits  : positive := maximum(8, address_width);
  constant mask_bits  : positive := bits_for(maximum(limits_event_mask_bytes_min_c, (groups + 7) / 8));

  subtype flags_t is std_ulogic_vector(groups - 1 downto 0);
  subtype group_t is natural range 0 to maximum(groups, 2) - 1;  -- without bits it could not be the address of a memory

  type word_memory_t is array (0 to 2 ** (group_bits + place_bits) - 1) of std_ulogic_vector(word_bits - 1 downto 0);
  -- At least eight words, so that tools use block RAM instead of flip-flops.
  type rate_memory_t is array (0 to 2 ** maximum(group_bits, 3) - 1) of unsigned(rate_bits - 1 downto 0);

  signal words : word_memory_t;  -- see subscription_pkg
  signal rates : rate_memory_t := (others => (others => '0'));  -- the rate less one
  signal tally : rate_memory_t := (others => (others => '0'));  -- strobes counted towards the rate, always fewer

  -- One flag for each group.
  signal filled  : flags_t := (others => '0');  -- it has addresses
  signal active  : flags_t := (others => '0');  -- it has a rate other than 0; its memory word is valid
  signal due     : flags_t := (others => '0');
  signal tripped : flags_t := (others => '0');
  signal enabled : flags_t := (others => '0');  -- its event input makes it due
  signal past    : flags_t := (others => '0');  -- its event input one clock ago
  signal wanting : flags_t;

  signal word_address : unsigned(group_bits + place_bits - 1 downto 0);
  signal reads_word   : std_ulogic;
  signal group_word   : std_ulogic_vector(word_bits - 1 downto 0);

  signal publishing : std_ulogic := '0';
  signal divider    : natural range 0 to period - 1 := 0;
  signal beginning  : std_ulogic := '1';  -- of a period: the divider is 0
  signal strobe     : std_ulogic := '0';  -- a strobe came, and the scan has not begun

  type phase_t is (
    waiting,   -- for a strobe or a new rate
    looking,   -- scans the groups
    changing   -- sets a rate: the old word is in `word`
  );

  signal phase        : phase_t := waiting;
  signal scan         : group_t := 0;
  signal rate_less_one : unsigned(rate_bits - 1 downto 0) := (others => '0'); -- of the scanned group
  signal strobes      : unsigned(rate_bits - 1 downto 0) := (others => '0');  -- counted towards its rate
  signal strobes_next : unsigned(rate_bits - 1 downto 0) := (others => '0');
  signal new_rate     : unsigned(rate_bits - 1 downto 0);
  signal keep         : std_ulogic;         -- keep the tally for the new rate
  signal reached      : std_ulogic;         -- the rate is reached with this strobe
  signal count_on     : std_ulogic := '0';  -- strobes_next goes into the tally of count_group, one clock late for speed
  signal count_group  : group_t := 0;
  signal word_group   : group_t := 0;       -- the scanned group
  signal word_scanned : std_ulogic := '0';  -- it was read for the scan
  signal looked       : std_ulogic := '0';
  signal settled      : std_ulogic_vector(1 downto 0) := "00";  -- clocks since then; after that `strobes` includes all
  signal done         : std_ulogic := '0';

  signal publish     : std_ulogic := '0';
  signal overrun     : std_ulogic := '0';
  signal choice      : group_t := 0;
  signal last_served : group_t := 0;

  -- The next group after `last` that waits to publish, downwards and around.
  function next_group(candidates : flags_t; last : group_t) return group_t is
    variable below, above : group_t := 0;
    variable found        : boolean := false;
  begin
    for g in 0 to groups - 1 loop
      if candidates(g) = '1' then
        above := g;
        if g < last then
          below := g;
          found := true;
        end if;
      end if;
    end loop;
    if found then
      return below;
    end if;
    return above;
  end function;

  signal group_number : group_t;
  signal read_group   : group_t;

begin

  assert period > groups + 4
    report "subscription_manager: at least groups + 5 clocks must lie between two strobes; lower base_hz"
    severity failure;

  group_number <= to_integer(request.group_number) when request.group_number < groups else 0;
  read_group   <= scan when phase = looking else group_number;
  word_address <= to_unsigned(group_number, group_bits) & resize(request.place, place_bits);
  reads_word   <= not request.write_word;
  wanting      <= filled and (due or tripped);

  new_rate <= unsigned(request.rate(rate_bits - 1 downto 0));
  reached  <= '1' when strobes = rate_less_one else '0';

  tally_next : process (clock)
  begin
    if rising_edge(clock) then
      count_on     <= word_scanned;
      count_group  <= word_group;
      strobes_next <= strobes + 1;
      if phase = changing then
        count_on     <= '1';
        strobes_next <= (others => '0');
        if keep = '1' then
          strobes_next <= strobes;
        end if;
      elsif reached = '1' then
        strobes_next <= (others => '0');
      end if;
      if reset = '1' then
        count_on <= '0';
      end if;
    end if;
  end process;

  -- No word is read in the clock in which it is written, because block RAMs differ in what that gives.
  memory : process (clock)
  begin
    if rising_edge(clock) then
      if request.write_word = '1' then
        words(to_integer(word_address)) <= request.word(word_bits - 1 downto 0);
      end if;
      if reads_word = '1' then  -- with an `else` GHDL 2.0 would also read when it writes
        group_word <= words(to_integer(word_address));
      end if;
      if count_on = '1' then
        tally(count_group) <= strobes_next;
      end if;
      if phase = changing then
        rates(word_group) <= new_rate - 1;
      end if;
      if phase /= changing and (count_on = '0' or read_group /= count_group) then
        strobes       <= tally(read_group);
        rate_less_one <= rates(read_group);
      end if;
    end if;
  end process;

  divide : process (clock)
  begin
    if rising_edge(clock) then
      if phase = looking and scan = groups - 1 then
        strobe <= '0';
      end if;
      if publishing = '0' or divider = period - 1 then
        divider   <= 0;
        beginning <= '1';
      else
        divider   <= divider + 1;
        beginning <= '0';
      end if;
      if publishing = '1' and beginning = '1' then
        strobe <= '1';
      end if;
      if request.enable = '1' then
        publishing <= '1';
      elsif request.disable = '1' then
        publishing <= '0';
      end if;
      if reset = '1' or request.clear = '1' then
        publishing <= '0';
        divider    <= 0;
        beginning  <= '1';
        strobe     <= '0';
      end if;
    end if;
  end process;

  look : process (clock)
  begin
    if rising_edge(clock) then
      done         <= '0';
      word_scanned <= '0';
      looked       <= '0';
      settled      <= "00";
      word_group   <= read_group;
      keep         <= '0';
      if request.write_rate = '1' and active(word_group) = '1' and strobes < new_rate then
        keep <= '1';
      end if;

      case phase is
        when waiting =>
          scan   <= 0;
          looked <= '1';
          settled <= settled(0) & looked;
          if strobe = '1' and word_scanned = '0' then
            phase <= looking;
          elsif request.write_rate = '1' and done = '0' and settled(1) = '1' then
            phase <= changing;
          end if;
        when looking =>
          word_scanned <= active(scan) and filled(scan);
          if scan = groups - 1 then
            phase <= waiting;
          else
            scan <= scan + 1;
          end if;
        when changing =>
          done <= '1';
          phase <= waiting;
      end case;

      if reset = '1' then
        phase <= waiting;
        word_scanned <= '0';
        done         <= '0';
      end if;
    end if;
  end process;

  flag : process (clock)
  begin
    if rising_edge(clock) then
      if request.publish_take = '1' then
        if due(group_number) = '1' then
          due(group_number) <= '0';
        else
          tripped(group_number) <= '0';
        end if;
      end if;
      overrun <= '0';
      if word_scanned = '1' and reached = '1' then
        due(word_group) <= '1';
        overrun         <= due(word_group);
      end if;
      if phase = changing then
        active(word_group) <= or new_rate;
        if new_rate = 0 then
          due(word_group) <= '0';
        end if;
      end if;
      if request.fill = '1' then
        filled(group_number) <= '1';
      elsif request.empty = '1' then
        filled(group_number) <= '0';
      end if;
      past <= events;
      for g in 0 to groups - 1 loop
        if enabled(g) = '1' and events(g) = '1' and (past(g) = '0' or edge_events(g) = '0') then
          tripped(g) <= '1';
        end if;
        if request.write_mask = '1' and request.place(mask_bits - 1 downto 0) = g / 8 then
          enabled(g) <= request.word(g mod 8);
        end if;
      end loop;
      if request.write_event = '1' then
        enabled(group_number) <= request.word(0);
      end if;
      if reset = '1' or request.clear = '1' then
        filled  <= (others => '0');
        active  <= (others => '0');
        due     <= (others => '0');
        tripped <= (others => '0');
        enabled <= (others => '0');
        past    <= (others => '0');
      end if;
    end if;
  end process;

  choose : process (clock)
  begin
    if rising_edge(clock) then
      publish <= '0';
      choice  <= next_group(wanting, last_served);
      -- The choice waits for the end of the scan, so that all groups that become due together are seen together.
      if request.publish_take = '1' then
        last_served <= group_number;
      elsif publishing = '1' and strobe = '0' and phase = waiting and looked = '1' then
        publish <= or wanting;
      end if;
      if reset = '1' then
        publish     <= '0';
        last_served <= 0;
      end if;
    end if;
  end process;

  respond : process (all)
  begin
    response               <= subscription_response_idle;
    response.done          <= done;
    response.word(word_bits - 1 downto 0) <= group_word;
    response.empty         <= not filled(group_number);
    response.inactive      <= not active(group_number);
    response.publish       <= publish;
    response.overrun       <= overrun;
    response.publish_group <= to_unsigned(choice, 8);
    for g in 0 to groups - 1 loop
      if request.place(mask_bits - 1 downto 0) = g / 8 then
        response.mask(g mod 8) <= enabled(g);
      end if;
    end loop;
  end process;

end architecture;
