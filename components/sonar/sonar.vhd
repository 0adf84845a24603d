-- SPDX-License-Identifier: BSD-3-Clause
--
-- An ultrasonic distance sensor such as the HC-SR04: it is triggered at a rate, and the length of its echo is measured.
--
--   trigger  ___/‾12 us‾\________________________________/‾‾‾   every period_us
--   echo     __________________/‾‾‾‾‾‾‾‾‾‾‾‾‾\______________
--                              |--the time---|                 of the sound, there and back
--
--   +0  control: bit 0 enable, 1 after a reset
--   +1  state (sample_state): bits 7:0 failures, 11:8 failures in a row, 14:12 why the last try failed, 15 valid
--         1 no answer: no echo in the whole period. The sensor is away, or has no power.
--         2 out of range: the echo lasted for timeout_us or longer, so nothing reflects
--         3 stuck: echo was high when the next trigger was due
--   +2  echo of the last sample in us
--
-- Filter    A level of `echo` counts when two samples of it are equal, 1 us apart. So a spike below 1 us never counts.
--           It is delayed by this at the rise as at the fall: the time is right to a us.
-- Stuck     While echo is high there is no trigger. Some sensors hold it for 200 ms if nothing reflects.
-- Block     A try that ends while cyc is high is taken behind it. So all words of a block are of one moment.
-- Wire      echo_wire has +2, and is valid with it.
-- Events    sampled: there is a new value. failed: a try has failed.
-- Latency   2 clocks per access (register_slave). From the fall of echo to sampled at most 3 us and 5 clocks.
-- Errors    err for a write to +1 and +2, and for addresses from 3 on.
-- Reset     trigger is low, and from power-up on. The first one comes a period later. Without enable there is none, and
--           the value is not valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity sonar is
  generic (
    clock_hz      : positive                        := 50_000_000;
    period_us     : positive range 20 to 1_000_000  := 60_000;
    timeout_us    : positive range 1 to 65_535      := 30_000; -- an echo is shorter
    failures_most : positive range 1 to 15          := 3;
    data_width    : positive range 16 to 32         := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;
    echo_wire    : out wire_t; -- for other components

    trigger      : out std_ulogic := '0';
    echo         : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of sonar is

  constant trigger_us : positive := 12;

  subtype reason_t is std_ulogic_vector(2 downto 0);
  subtype time_t is unsigned(bits_for(period_us) - 1 downto 0);
  subtype echo_t is unsigned(bits_for(timeout_us + 1) - 1 downto 0);

  constant fine         : reason_t := "000";
  constant no_answer    : reason_t := "001";
  constant out_of_range : reason_t := "010";
  constant stuck        : reason_t := "011";

  signal read_words  : word_vector_t(0 to 2);
  signal write_words : word_vector_t(0 to 2);
  signal enable      : std_ulogic;

  signal tick           : std_ulogic;                     -- a us is over
  signal now            : time_t := (others => '0');      -- us since the last period began
  signal last           : std_ulogic;                     -- it ends with this us
  signal raw            : std_ulogic;                     -- echo, synchronous
  signal before, level  : std_ulogic := '0';              -- echo a us ago, and behind the filter
  signal armed          : std_ulogic := '0';              -- triggered, and the echo has not ended
  signal hears          : std_ulogic := '0';              -- it has begun
  signal length         : echo_t := (others => '0');      -- of it so far
  signal is_long        : std_ulogic;
  signal ended, accept  : std_ulogic := '0';
  signal reason         : reason_t := fine;
  signal state          : std_ulogic_vector(15 downto 0);
  signal is_valid, void : std_ulogic;
  signal value          : echo_t := (others => '0');

begin

  assert timeout_us < period_us
    report "sonar: an echo of timeout_us must be over within period_us"
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "100", data_width => data_width, initial => (x"00000001", x"00000000", x"00000000"))
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words);

  read_words <= (
    0 => extended(write_words(0)(0 downto 0)),
    1 => extended(state),
    2 => extended(std_ulogic_vector(value)));

  enable    <= write_words(0)(0);
  void      <= not enable;
  echo_wire <= is_valid & std_ulogic_vector(resize(value, wire_bits - 1));

  microseconds : entity work.ticker
    generic map (clock_hz => clock_hz, rate_hz => 1_000_000)
    port map (clock => clock, reset => reset, tick => tick);

  line : entity work.input_filter
    port map (clock => clock, reset => reset, pins(0) => echo, levels(0) => raw);

  tries : entity work.sample_state
    generic map (failures_most => failures_most)
    port map (
      clock => clock, reset => reset, ended => ended, reason => reason, hold => wishbone_m2s.cyc, void => void,
      accept => accept, sampled => sampled, failed => failed, valid => is_valid, word => state);

  last    <= to_bit(now = period_us - 1);
  is_long <= to_bit(length = timeout_us);

  run : process (clock) is
  begin
    if rising_edge(clock) then
      if accept = '1' then
        ended <= '0';
        if reason = fine then
          value <= length;
        end if;
      end if;

      if tick = '1' then
        before <= raw;
        if raw = before then
          level <= raw;
        end if;

        now <= now + 1;
        if last = '1' then
          now <= (others => '0');
        end if;
        if now(3 downto 0) = trigger_us - 1 then -- which is first so in its first 16 us
          trigger <= '0';
        end if;

        if armed = '1' and level = '1' then
          hears <= '1';
          if is_long = '0' then
            length <= length + 1;
          end if;
        elsif hears = '1' then
          armed  <= '0';
          hears  <= '0';
          ended  <= '1';
          reason <= fine;
          if is_long = '1' then
            reason <= out_of_range;
          end if;
        end if;

        if last = '1' then
          if level = '1' then
            armed  <= '0';
            hears  <= '0';
            ended  <= '1';
            reason <= stuck;
          elsif hears = '0' and ended = '0' then
            ended   <= armed;
            reason  <= no_answer;
            armed   <= '1';
            length  <= (others => '0');
            trigger <= '1';
          end if;
        end if;
      end if;

      if enable = '0' then
        armed   <= '0';
        hears   <= '0';
        ended   <= '0';
        trigger <= '0';
      end if;
      if reset = '1' then
        now     <= (others => '0');
        before  <= '0';
        level   <= '0';
        armed   <= '0';
        hears   <= '0';
        ended   <= '0';
        value   <= (others => '0');
        trigger <= '0';
      end if;
    end if;
  end process;

end architecture;
