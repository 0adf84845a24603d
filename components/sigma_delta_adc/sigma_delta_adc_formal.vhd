-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of sigma_delta_adc with two channels, an osr of 8 and a trip_osr of 4. A bit may be taken at any clock,
-- and both filters may give any value at any clock: what they give is proven in sigma_delta_adc_sinc3. The bus may do
-- anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity sigma_delta_adc_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    m2s        : in wishbone_m2s_t;
    data       : in std_ulogic_vector(1 downto 0);
    words      : in std_ulogic_vector(255 downto 0); -- shows the registers; the next ones show signals, too
    take       : in std_ulogic;
    levels     : in std_ulogic_vector(1 downto 0);
    fresh      : in std_ulogic_vector(1 downto 0);
    trip_fresh : in std_ulogic_vector(1 downto 0);
    sums       : in unsigned(19 downto 0);         -- of the slow filters, that of channel 0 first
    trip_sums  : in unsigned(13 downto 0)
  );
end entity;

architecture properties of sigma_delta_adc_formal is

  constant bias       : positive := 256; -- half of osr**3
  constant trip_bias  : positive := 32;
  constant equal_most : positive := 128;

  subtype equal_t is natural range 0 to equal_most;
  type equals_t is array (0 to 1) of equal_t;

  signal s2m                    : wishbone_s2m_t;
  signal sampled, tripped, trip : std_ulogic;
  signal wire_0, wire_1, wire_2 : wire_t;
  signal begun                  : std_ulogic := '0';
  signal reset_1                : std_ulogic := '1';
  signal off_1, off_2           : std_ulogic := '1';              -- enable was 0, or a reset, so many clocks ago
  signal trip_1, trip_2         : std_ulogic := '1';
  signal beyond_1, beyond_2     : std_ulogic := '0';              -- a fast value was too large, so many clocks ago
  signal before                 : std_ulogic_vector(1 downto 0) := "00"; -- the last bits
  signal equals                 : equals_t := (others => equal_most);    -- bits that were like the one before them
  signal lost_1, lost_2, lost_3 : std_ulogic := '1';              -- a line was lost, so many clocks ago
  signal lost_now               : std_ulogic := '0';              -- a line was lost while it ran, a clock ago
  signal sampled_before         : std_ulogic := '0';
  signal expected               : signed(31 downto 0) := (others => '0'); -- the value of channel 0
  signal enable                 : std_ulogic;
  signal limit                  : unsigned(6 downto 0);
  signal limit_1                : unsigned(6 downto 0);           -- a clock ago, which is the one that holds
  signal offset                 : signed(10 downto 0);

  -- The fast value of a channel is beyond the limit.
  function is_beyond (sum : unsigned(6 downto 0); limit : unsigned(6 downto 0)) return std_ulogic is
    variable found : std_ulogic := '0';
  begin
    if limit /= 0 and (resize(sum, 8) > trip_bias + resize(limit, 8) or resize(sum, 8) + limit < trip_bias) then
      found := '1';
    end if;
    return found;
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.sigma_delta_adc
    generic map (clock_hz => 4_000_000, channels => 2, modulator_hz => 1_000_000, osr => 8, trip_osr => 4)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, tripped => tripped,
      value_0_wire => wire_0, value_1_wire => wire_1, value_2_wire => wire_2, mclk => open, trip => trip,
      data => data);

  enable <= words(32 * 7);
  limit  <= unsigned(words(32 * 5 + 6 downto 32 * 5));
  offset <= signed(words(32 * 3 + 10 downto 32 * 3));

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun          <= '1';
      reset_1        <= reset;
      off_1          <= not enable or reset;
      off_2          <= off_1;
      trip_1         <= trip;
      trip_2         <= trip_1;
      sampled_before <= fresh(0) and not reset;
      expected       <= signed(resize(sums(19 downto 10), 32)) - bias - offset;

      limit_1  <= limit;
      beyond_1 <= '0';
      if trip_fresh(0) = '1' and is_beyond(trip_sums(13 downto 7), limit_1) = '1' then
        beyond_1 <= '1';
      end if;
      if trip_fresh(1) = '1' and is_beyond(trip_sums(6 downto 0), limit_1) = '1' then
        beyond_1 <= '1';
      end if;
      beyond_2 <= beyond_1;

      lost_1 <= '0';
      for channel in 0 to 1 loop
        if take = '1' then
          before(channel) <= levels(channel);
          equals(channel) <= 0;
          if levels(channel) = before(channel) then
            equals(channel) <= minimum(equals(channel) + 1, equal_most);
          end if;
        end if;
        if equals(channel) = equal_most then
          lost_1 <= '1';
        end if;
      end loop;
      lost_2   <= lost_1;
      lost_3   <= lost_2;
      lost_now <= lost_2 and not trip and not reset;

      if reset = '1' then
        before   <= "00";
        equals   <= (others => equal_most);
        beyond_1 <= '0';
        beyond_2 <= '0';
        lost_1   <= '1';
        lost_2   <= '1';
        lost_3   <= '1';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- Without enable it is tripped a clock later.
  safe_when_off : assert always begun = '1' and off_1 = '1' -> trip = '1';

  -- A fast value of any channel that is beyond the limit, of either sign, trips two clocks later.
  beyond_trips : assert always begun = '1' and beyond_2 = '1' -> trip = '1';

  -- A line with 129 equal bits trips three clocks later.
  lost_trips : assert always begun = '1' and lost_3 = '1' -> trip = '1';

  -- A line that is lost while it runs is told with the trip.
  lost_is_told : assert always begun = '1' and lost_now = '1' and off_1 = '0' -> tripped = '1' and trip = '1';

  -- It trips for nothing else: a value was beyond the limit, or a line was lost.
  trip_has_a_cause : assert always begun = '1' and reset_1 = '0' and trip = '1' and trip_1 = '0' and off_1 = '0' ->
                              beyond_2 = '1' or lost_3 = '1';

  -- It starts only when enable rises, and when no line was lost.
  start_is_asked : assert always begun = '1' and trip = '0' and trip_1 = '1' ->
                            off_1 = '0' and off_2 = '1' and lost_3 = '0';

  -- The values are valid for other components only while it is not tripped, and nothing is wrong.
  trip_voids : assert always begun = '1' and (is_valid(wire_0) = '1' or is_valid(wire_1) = '1') ->
                        trip = '0' and off_1 = '0' and beyond_2 = '0' and lost_3 = '0';

  -- A wire without a channel is never valid.
  none_is_void : assert always begun = '1' -> is_valid(wire_2) = '0';

  -- A trip while it runs and enable is on is told.
  trip_is_told : assert always begun = '1' and reset_1 = '0' and trip = '1' and trip_1 = '0' and off_1 = '0' ->
                          tripped = '1';

  -- What is told is a trip, or a start that was refused.
  nothing_else_is_told : assert always begun = '1' and tripped = '1' ->
                                  trip = '1' and off_1 = '0' and (trip_1 = '0' or off_2 = '1');

  -- Each slow value is told.
  sample_is_told : assert always begun = '1' -> sampled = sampled_before;

  -- A value is the sum of its filter, with 0 in the middle, less the offset. It never wraps.
  right_value : assert always begun = '1' and sampled = '1' -> value_of(wire_0) = expected;

  -- It runs, and a value that is too large trips.
  beyond_seen : cover {begun = '1' and trip = '0' and beyond_1 = '1'; trip = '1'};

end architecture;
