-- SPDX-License-Identifier: BSD-3-Clause
--
-- Isolated currents and voltages from sigma-delta modulators, such as AMC1306 and AD7403: a slow filter with many bits
-- for the loop, and a fast one with few bits that trips. All modulators get one clock.
--
--   mclk  __/‾‾\__/‾‾\__/‾‾\__
--   data  ---X-----X-----X----     changes behind the rise, and is taken just before the next one
--
--   +0             control: bit 0 enable. Its rise starts, also after a trip.
--   +1             status (read): bit 0 running, bit 1 tripped, bit 2 a channel is not valid now, bits 6..4 the
--                  channels that were beyond the limit, or lost, at the trip
--   +2             limit of the fast filter, 0 to trip_osr**3 / 2: a larger value of either sign trips. 0 never trips.
--                  It holds for values from 2 clocks after the write on.
--   +3             stamp: the clock of the last values (read)
--   +4 + n         offset of channel n, which is taken away from its values
--   +4 + channels + n  value of channel n, two's complement: -osr**3 / 2 if all bits are 0, osr**3 / 2 if all are 1
--
-- Filters   osr and trip_osr are how many bits a value takes. A filter sees the last three times as many. Half of its
--           bits are 1 at an input of 0.
-- Lost      A modulator never gives more than 128 equal bits, so 129 of them are a broken line. Then the channel is not
--           valid until 4 values are there again.
-- Trip      A channel that is beyond the limit, or not valid, trips: the pin `trip` rises, and the wires are not valid
--           from that clock on. It stays so until enable rises.
-- Safe      0 in the control word is as a trip: `trip` is high, and the wires are not valid. Values are still measured.
-- Wires     value_0_wire to value_2_wire have the values, and are valid while it runs. Without a channel one never is.
-- Events    sampled: new values. tripped.
-- Latency   2 clocks per access. From the take of a bit to its value 5 clocks, and to the trip 6 clocks.
-- Errors    err for a write of +1, +3 and of a value, and for other addresses.
-- Reset     Not enabled: trip is high. Offsets and limit are 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity sigma_delta_adc is
  generic (
    clock_hz     : positive               := 50_000_000;
    channels     : positive range 1 to 3  := 2;
    modulator_hz : positive               := 10_000_000; -- at most; a quarter of clock_hz is the most there is
    osr          : positive range 8 to 256 := 64;
    trip_osr     : positive range 4 to 32 := 8;
    data_width   : positive range 32 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    tripped      : out std_ulogic;

    value_0_wire : out wire_t;
    value_1_wire : out wire_t;
    value_2_wire : out wire_t;

    mclk         : out std_ulogic;
    trip         : out std_ulogic;
    data         : in  std_ulogic_vector(channels - 1 downto 0) -- asynchronous
  );
end entity;

architecture rtl of sigma_delta_adc is

  constant period      : positive := maximum(4, (clock_hz - 1) / modulator_hz + 1); -- clocks of mclk
  constant take_at     : positive := 2;   -- clocks after the rise, so the level is that just before it
  constant equal_most  : positive := 128; -- bits
  constant settles     : positive := 4;   -- values
  constant width       : positive := bits_for(osr ** 3 + 1);
  constant trip_width  : positive := bits_for(trip_osr ** 3 + 1);
  constant words       : positive := 4 + 2 * channels;
  constant bias        : positive := osr ** 3 / 2;
  constant trip_bias   : positive := trip_osr ** 3 / 2;

  subtype channels_t is std_ulogic_vector(channels - 1 downto 0);
  subtype offset_t is signed(width downto 0);
  subtype value_t is signed(width + 1 downto 0);
  subtype limit_t is unsigned(trip_width - 1 downto 0);
  subtype bound_t is signed(trip_width + 1 downto 0);
  type values_t is array (0 to channels - 1) of value_t;
  type sums_t is array (0 to channels - 1) of unsigned(width - 1 downto 0);
  type trip_sums_t is array (0 to channels - 1) of unsigned(trip_width - 1 downto 0);
  type equals_t is array (0 to channels - 1) of natural range 0 to equal_most;
  type settled_t is array (0 to channels - 1) of natural range 0 to settles;

  function words_that_take return std_ulogic_vector is
    variable found : std_ulogic_vector(0 to words - 1) := (others => '0');
  begin
    found(0) := '1';
    found(2) := '1';
    found(4 to 3 + channels) := (others => '1');
    return found;
  end function;

  constant may_write : std_ulogic_vector(0 to words - 1) := words_that_take;

  signal read_words  : word_vector_t(0 to words - 1);
  signal write_words : word_vector_t(0 to words - 1);

  signal enable         : std_ulogic;
  signal limit          : limit_t;
  signal highest, lowest : bound_t := (others => '0');          -- of the sums within the limit, a clock after it
  signal enabled_before : std_ulogic := '1';
  signal levels         : channels_t;
  signal count          : natural range 0 to period - 1 := 0; -- of mclk
  signal take           : std_ulogic;
  signal sums           : sums_t;
  signal trip_sums      : trip_sums_t;
  signal fresh, trip_fresh : channels_t;                      -- the same of all channels
  signal before         : channels_t := (others => '0');      -- the last bit
  signal equals         : equals_t := (others => equal_most);
  signal settled        : settled_t := (others => 0);
  signal lost, beyond   : channels_t := (others => '0');
  signal running        : std_ulogic := '0';
  signal is_tripped     : std_ulogic := '0';
  signal culprits       : channels_t := (others => '0');
  signal now, stamp     : unsigned(31 downto 0) := (others => '0');
  signal values         : values_t := (others => (others => '0'));

  function wire_from (found : values_t; number : natural; valid : std_ulogic) return wire_t is
  begin
    if number >= channels then
      return no_wire;
    end if;
    return valid & std_ulogic_vector(resize(found(number), 32));
  end function;

begin

  registers : entity work.register_slave
    generic map (writable => may_write, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words);

  enable <= write_words(0)(0);
  limit  <= unsigned(write_words(2)(limit_t'range));

  process (all) is
  begin
    read_words                        <= (others => (others => '0'));
    read_words(0)(0)                  <= enable;
    read_words(1)(2 downto 0)         <= (or lost) & is_tripped & running;
    read_words(1)(3 + channels downto 4) <= culprits;
    read_words(2)                     <= extended(write_words(2)(limit_t'range));
    read_words(3)                     <= std_ulogic_vector(stamp);
    for number in 0 to channels - 1 loop
      read_words(4 + number)            <=
        std_ulogic_vector(resize(signed(write_words(4 + number)(offset_t'range)), 32));
      read_words(4 + channels + number) <= std_ulogic_vector(resize(values(number), 32));
    end loop;
  end process;

  trip         <= not running;
  value_0_wire <= wire_from(values, 0, running);
  value_1_wire <= wire_from(values, 1, running);
  value_2_wire <= wire_from(values, 2, running);

  inputs_synchroniser : entity work.synchroniser
    generic map (width => channels)
    port map (clock => clock, asynchronous => data, levels => levels);

  take <= '1' when count = take_at else '0';

  filters : for number in 0 to channels - 1 generate
    slow : entity work.sigma_delta_adc_sinc3
      generic map (osr => osr, width => width)
      port map (
        clock => clock, reset => reset, take => take, bit_in => levels(number), value => sums(number),
        fresh => fresh(number));

    fast : entity work.sigma_delta_adc_sinc3
      generic map (osr => trip_osr, width => trip_width)
      port map (
        clock => clock, reset => reset, take => take, bit_in => levels(number), value => trip_sums(number),
        fresh => trip_fresh(number));
  end generate;

  run : process (clock) is
    variable sum : bound_t;
    variable bad : channels_t;
  begin
    if rising_edge(clock) then
      now            <= now + 1;
      enabled_before <= enable;
      sampled        <= fresh(0);
      tripped        <= '0';

      mclk <= '1' when count < period / 2 else '0';
      if count = period - 1 then
        count <= 0;
      else
        count <= count + 1;
      end if;

      if fresh(0) = '1' then
        stamp <= now;
      end if;
      -- The sums are compared with both bounds at once. A size, which would be compared with the limit, takes an adder
      -- more in the same clock.
      highest <= trip_bias + signed(resize(limit, bound_t'length));
      -- Not `trip_bias -`: GHDL 2.0 synthesises that with its sides changed.
      lowest  <= to_signed(trip_bias, bound_t'length) - signed(resize(limit, bound_t'length));
      if (or limit) = '0' then
        highest <= to_signed(2 ** trip_width, bound_t'length);
        lowest  <= (others => '0');
      end if;

      for number in 0 to channels - 1 loop
        if take = '1' then
          before(number) <= levels(number);
          if levels(number) /= before(number) then
            equals(number) <= 0;
          elsif equals(number) /= equal_most then
            equals(number) <= equals(number) + 1;
          end if;
        end if;
        if fresh(number) = '1' then
          values(number) <= signed(resize(sums(number), value_t'length)) - bias -
                            signed(write_words(4 + number)(offset_t'range));
          if settled(number) /= settles then
            settled(number) <= settled(number) + 1;
          end if;
        end if;
        if equals(number) = equal_most then
          settled(number) <= 0;
        end if;
        lost(number) <= '0';
        if settled(number) /= settles then
          lost(number) <= '1';
        end if;

        if trip_fresh(number) = '1' then
          sum            := signed(resize(trip_sums(number), bound_t'length));
          beyond(number) <= '0';
          if sum > highest or sum < lowest then
            beyond(number) <= '1';
          end if;
        end if;
      end loop;

      bad := lost or beyond;
      if enable = '0' then
        running <= '0';
      elsif running = '1' and (or bad) = '1' then
        running    <= '0';
        is_tripped <= '1';
        tripped    <= '1';
        culprits   <= bad;
      elsif enabled_before = '0' then
        running    <= nor bad;
        is_tripped <= or bad;
        tripped    <= or bad;
        culprits   <= bad;
      end if;

      if reset = '1' then
        now        <= (others => '0');
        stamp      <= (others => '0');
        count      <= 0;
        mclk       <= '0';
        sampled    <= '0';
        tripped    <= '0';
        before     <= (others => '0');
        equals     <= (others => equal_most); -- until a bit changes
        settled    <= (others => 0);
        lost       <= (others => '1');
        beyond     <= (others => '0');
        running    <= '0';
        is_tripped <= '0';
        culprits   <= (others => '0');
        values     <= (others => (others => '0'));
      end if;
    end if;
  end process;

end architecture;
