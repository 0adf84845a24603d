-- SPDX-License-Identifier: BSD-3-Clause
--
-- pwm: each pulse at the pins is a whole old one or a whole new one, also when words change at any clock; 0 % and 100 %
-- have no edges; limits of servos; enable; words, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity pwm_tb is
  generic (
    clock_hz     : positive := 3_333_333;
    frequency_hz : positive := 20_000;
    servo        : natural  := 0;
    rounds       : positive := 60;
    seed         : positive := 1
  );
end entity;

architecture test of pwm_tb is

  constant channels     : positive := 3;
  constant clock_period : time := 20 ns;

  type lengths_t is array (0 to channels - 1) of natural;

  -- A period, in clocks.
  function period_clocks return positive is
  begin
    if servo = 1 then
      return clock_hz / 50;
    end if;
    return (clock_hz + frequency_hz / 2) / frequency_hz;
  end function;

  constant period   : positive := period_clocks;
  constant measured : positive := 3 - 2 * servo; -- periods

  -- How long a pulse is, in clocks. Those of servos may differ by one.
  function length_of (word : natural) return natural is
  begin
    if servo = 0 then
      return (minimum(word, 4096) * period + 4095) / 4096;
    elsif word = 0 then
      return 0;
    end if;
    return maximum(500, minimum(2500, word)) * (clock_hz / 1000) / 1000;
  end function;

  -- By how much it may be wrong: a µs of servos is 0.05 % and a clock wrong at most.
  function slack (length : natural) return natural is
  begin
    return servo * (1 + length / 1000);
  end function;

  function fits (length : natural; expected : natural) return boolean is
  begin
    return abs (length - expected) <= slack(expected);
  end function;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal pins           : std_ulogic_vector(channels - 1 downto 0);
  signal old, new_one   : lengths_t := (others => 0); -- the lengths that a pulse may have
  signal rises, highs   : lengths_t := (others => 0); -- so far
  signal any            : boolean := true;            -- a pulse may be cut: it is disabled

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.pwm
    generic map (clock_hz => clock_hz, channels => channels, frequency_hz => frequency_hz, servo => servo)
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, pins => pins);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  meters : for channel in 0 to channels - 1 generate
    process (clock) is
      variable before : std_ulogic := '0';
      variable high   : natural := 0; -- clocks of this pulse
    begin
      if rising_edge(clock) then
        if pins(channel) = '1' then
          high           := high + 1;
          highs(channel) <= highs(channel) + 1;
          if before = '0' then
            rises(channel) <= rises(channel) + 1;
          end if;
        elsif before = '1' then
          -- After whole periods there may be one more pulse in the same high time.
          while high > period loop
            high := high - period;
          end loop;
          check(any or fits(high, old(channel)) or fits(high, new_one(channel)) or high = period,
                "a pulse of channel " & integer'image(channel) & " has " & integer'image(high) & " clocks, not " &
                integer'image(old(channel)) & " or " & integer'image(new_one(channel)));
          high := 0;
        end if;
        before := pins(channel);
      end if;
    end process;
  end generate;

  master : process is

    variable random : random_t;
    variable words  : lengths_t := (others => 0);

    procedure give (channel : natural; word : natural) is
    begin
      words(channel)   := word;
      new_one(channel) <= length_of(word);
      bus_write(clock, m2s, s2m, 2 + channel, std_ulogic_vector(to_unsigned(word, 32)));
    end procedure;

    impure function some_word return natural is
    begin
      case random.integer_between(0, 7) is
        when 0 => return 0;
        when 1 => return 4096;
        when 2 => return 4095;
        when 3 => return 1;
        when 4 => return random.integer_between(4097, 8191);
        when 5 => return random.integer_between(400, 2600);
        when others => return random.integer_between(1, 4095);
      end case;
    end function;

    -- The pulses are those of `words` now. Measures three periods, or one of servos.
    procedure measure is
      variable rises_before, highs_before, rises_now, highs_now : lengths_t;
    begin
      wait_clocks(clock, (2 - servo) * period + 100);
      old <= new_one;
      rises_before := rises;
      highs_before := highs;
      wait_clocks(clock, measured * period);
      rises_now := rises;
      highs_now := highs;
      for channel in lengths_t'range loop
        check(abs (highs_now(channel) - highs_before(channel) - measured * new_one(channel)) <= servo * slack(period),
              "a share of the time: " & integer'image(highs_now(channel) - highs_before(channel)) &
              ", not so many periods of " & integer'image(new_one(channel)));
        if new_one(channel) = 0 or new_one(channel) = period then
          check_equal(rises_now(channel) - rises_before(channel), 0, "no edge");
        else
          check(abs (rises_now(channel) - rises_before(channel) - measured) <= servo, "a pulse in each period");
        end if;
        bus_expect(clock, m2s, s2m, 2 + channel, std_ulogic_vector(to_unsigned(words(channel), 32)));
      end loop;
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 3);
    reset <= '0';

    -- The first access waits until the words are cleared.
    for channel in lengths_t'range loop
      bus_expect(clock, m2s, s2m, 2 + channel, 0);
    end loop;
    bus_expect(clock, m2s, s2m, 0, 0);
    give(0, 1000);
    wait_clocks(clock, 2 * period);
    check(nor pins = '1' and rises(0) = 0, "nothing moves before it is enabled");

    any <= false;
    bus_write(clock, m2s, s2m, 0, x"00000003");
    bus_expect(clock, m2s, s2m, 0, 1);
    measure;

    -- Words change at any clock of a period.
    for number in 1 to rounds loop
      for channel in lengths_t'range loop
        if random.chance(70) then
          give(channel, some_word);
        end if;
        wait_clocks(clock, random.integer_between(0, 40));
      end loop;
      measure;
      wait_clocks(clock, random.integer_between(0, period / (1 + 3 * servo)));
    end loop;

    -- No pulse without enable, and a period begins with it.
    for channel in lengths_t'range loop
      give(channel, 2000);
    end loop;
    measure;
    any <= true;
    bus_write(clock, m2s, s2m, 0, x"00000000");
    wait_clocks(clock, 3);
    check(nor pins = '1', "all low");
    wait_clocks(clock, period);
    bus_write(clock, m2s, s2m, 0, x"00000001");
    wait_clocks(clock, 20 + servo * (clock_hz / 1_000_000 + 1));
    check(pins(0) = '1', "a period begins");
    wait_clocks(clock, 30);
    check(pins(2) = '1', "the others follow");

    bus_write(clock, m2s, s2m, 2, x"FFFFF064");
    bus_expect(clock, m2s, s2m, 2, x"00001064");
    bus_refuse(clock, m2s, s2m, '0', 1, "a read of +1");
    bus_refuse(clock, m2s, s2m, '1', 1, "a write of +1");
    bus_refuse(clock, m2s, s2m, '0', 5, "a read behind the last channel");
    bus_refuse(clock, m2s, s2m, '0', 8, "a read of +8");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write of some bytes", sel => "1110");

    reset <= '1';
    wait_clocks(clock, 2);
    reset <= '0';
    wait_clocks(clock, 2);
    check(nor pins = '1', "low after a reset");
    for channel in lengths_t'range loop
      bus_expect(clock, m2s, s2m, 2 + channel, 0);
    end loop;
    bus_expect(clock, m2s, s2m, 0, 0);

    report_passed("pwm_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * (rounds + 10) * 8 * period, "pwm_tb");

end architecture;
