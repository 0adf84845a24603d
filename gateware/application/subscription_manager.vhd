-- SPDX-License-Identifier: BSD-3-Clause
--
-- The publish groups: their addresses, rates and events, and which of them is to publish next.
--
-- A strobe comes every clock_hz / base_hz clocks while publishing is on, the first one at once. At each strobe all
-- groups are looked at, one a clock; a group whose rate is reached becomes due. An event input does the same, by level
-- or by rising edge. Causes coalesce: a group that is due already is not queued again, and of rate and event the rate is
-- served first. Among groups that are due the choice goes downwards and around from the one last served.
--
-- Ports     See subscription_pkg; everything is taken at once but write_rate, which waits for `done` (a strobe that comes
--           meanwhile waits for it, 2 clocks). `publish` is withdrawn while groups are looked at; take it where it
--           stands. The event inputs must be synchronous to the clock.
-- Latency   From strobe to `publish`: groups + 5 clocks, always the same; from an event input: 2 clocks, or after the
--           groups have been looked at.
-- Errors    None. An empty group never becomes due, and rate 0 is off. Addresses, counts and rates live in block RAM.

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

  constant period     : positive := clock_hz / base_hz;
  constant rate_bits  : positive := 8 * rate_bytes;
  constant group_bits : positive := bits_for(groups);
  constant index_bits : positive := bits_for(group_size);

  subtype flags_t is std_ulogic_vector(groups - 1 downto 0);
  subtype group_t is natural range 0 to groups - 1;

  type address_memory_t is array (0 to 2 ** (group_bits + index_bits) - 1) of
    std_ulogic_vector(address_width - 1 downto 0);
  type count_memory_t is array (0 to 2 ** group_bits - 1) of unsigned(7 downto 0);
  type rate_memory_t is array (0 to 2 ** group_bits - 1) of unsigned(2 * rate_bits - 1 downto 0);

  signal addresses : address_memory_t;
  signal counts    : count_memory_t;
  signal rates     : rate_memory_t;  -- rate, and strobes counted towards it

  -- One flag a group.
  signal filled  : flags_t := (others => '0');  -- has addresses
  signal active  : flags_t := (others => '0');  -- has a rate other than 0; its memory word counts
  signal due     : flags_t := (others => '0');
  signal tripped : flags_t := (others => '0');
  signal enabled : flags_t := (others => '0');  -- its event input triggers
  signal past    : flags_t := (others => '0');  -- its event input one clock ago
  signal wanting : flags_t;

  signal address : std_ulogic_vector(address_width - 1 downto 0);
  signal count   : unsigned(7 downto 0);

  signal publishing : std_ulogic := '0';
  signal divider    : natural range 0 to period - 1 := 0;
  signal strobe     : std_ulogic := '0';  -- seen, and the groups not yet looked at

  type phase_t is (
    waiting,   -- for a strobe or a new rate
    looking,   -- at one group after the other
    changing   -- a rate: the old word is in `word`
  );

  signal phase        : phase_t := waiting;
  signal scan         : group_t := 0;
  signal word         : unsigned(2 * rate_bits - 1 downto 0);
  signal word_next    : unsigned(2 * rate_bits - 1 downto 0);
  signal word_group   : group_t := 0;       -- the group `word` is of
  signal word_scanned : std_ulogic := '0';  -- it was read to be looked at
  signal looked       : std_ulogic := '0';
  signal done         : std_ulogic := '0';

  signal publish     : std_ulogic := '0';
  signal choice      : group_t := 0;
  signal last_served : group_t := 0;

  alias word_rate    : unsigned(rate_bits - 1 downto 0) is word(2 * rate_bits - 1 downto rate_bits);
  alias word_strobes : unsigned(rate_bits - 1 downto 0) is word(rate_bits - 1 downto 0);

  -- The group after `last` that wants to publish, downwards and around.
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
    report "subscription_manager: at least groups + 5 clocks must lie between two strobes; lower base_hz" severity failure;

  group_number <= to_integer(request.group_number) when request.group_number < groups else 0;
  read_group   <= scan when phase = looking else group_number;
  wanting      <= filled and (due or tripped);

  -- What becomes of the word that was read: counted one strobe further, or with its new rate.
  count_on : process (all)
  begin
    word_next <= word_rate & (word_strobes + 1);
    if phase = changing then
      word_next <= unsigned(request.value(rate_bits - 1 downto 0)) & to_unsigned(0, rate_bits);
      if active(word_group) = '1' and word_strobes < unsigned(request.value(rate_bits - 1 downto 0)) then
        word_next <= unsigned(request.value(rate_bits - 1 downto 0)) & word_strobes;
      end if;
    elsif word_strobes + 1 >= word_rate then
      word_next <= word_rate & to_unsigned(0, rate_bits);
    end if;
  end process;

  memory : process (clock)
  begin
    if rising_edge(clock) then
      if request.write_address = '1' then
        addresses(to_integer(to_unsigned(group_number, group_bits) & request.index(index_bits - 1 downto 0))) <=
          request.value(address_width - 1 downto 0);
      end if;
      address <= addresses(to_integer(to_unsigned(group_number, group_bits) & request.index(index_bits - 1 downto 0)));
      if request.write_count = '1' then
        counts(group_number) <= request.index + 1;
      end if;
      count <= counts(group_number);
      if word_scanned = '1' or phase = changing then
        rates(word_group) <= word_next;
      end if;
      word <= rates(read_group);
    end if;
  end process;

  divide : process (clock)
  begin
    if rising_edge(clock) then
      if phase = looking and scan = groups - 1 then
        strobe <= '0';
      end if;
      if publishing = '0' then
        divider <= 0;
      elsif divider = 0 then
        divider <= period - 1;
        strobe  <= '1';
      else
        divider <= divider - 1;
      end if;
      if request.enable = '1' then
        publishing <= '1';
      elsif request.disable = '1' then
        publishing <= '0';
      end if;
      if reset = '1' then
        publishing <= '0';
        divider    <= 0;
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
      word_group   <= read_group;

      case phase is
        when waiting =>
          scan   <= 0;
          looked <= '1';
          if strobe = '1' and word_scanned = '0' then
            phase <= looking;
          elsif request.write_rate = '1' and done = '0' and word_scanned = '0' then
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
        if due(choice) = '1' then
          due(choice) <= '0';
        else
          tripped(choice) <= '0';
        end if;
      end if;
      if word_scanned = '1' and word_strobes + 1 >= word_rate then
        due(word_group) <= '1';
      end if;
      if phase = changing then
        active(word_group) <= or request.value(rate_bits - 1 downto 0);
        if unsigned(request.value(rate_bits - 1 downto 0)) = 0 then
          due(word_group) <= '0';
        end if;
      end if;
      if request.write_count = '1' then
        filled(group_number) <= '1';
      end if;
      past <= events;
      for g in 0 to groups - 1 loop
        if enabled(g) = '1' and events(g) = '1' and (past(g) = '0' or edge_events(g) = '0') then
          tripped(g) <= '1';
        end if;
        if request.write_mask = '1' and request.index = g / 8 then
          enabled(g) <= request.value(g mod 8);
        end if;
      end loop;
      if reset = '1' then
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
      -- While the groups are looked at the choice waits, so that all that become due together are seen together.
      if request.publish_take = '1' then
        last_served <= choice;
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
    response.looked        <= looked;
    response.address(address_width - 1 downto 0) <= address;
    response.publish       <= publish;
    response.publish_group <= to_unsigned(choice, 8);
    if filled(group_number) = '1' then
      response.count <= count;
    end if;
    if active(group_number) = '1' then
      response.rate(rate_bits - 1 downto 0) <= std_ulogic_vector(word_rate);
    end if;
    for g in 0 to groups - 1 loop
      if request.index = g / 8 then
        response.mask(g mod 8) <= enabled(g);
      end if;
    end loop;
  end process;

end architecture;
