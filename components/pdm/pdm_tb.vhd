-- SPDX-License-Identifier: BSD-3-Clause
--
-- pdm: a meter at each pin adds up the densities of its own bits, and the ones must follow them within one; bits last
-- as long as they must, 0 and all have no edges, a density holds from the next bit on; words, errors and reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity pdm_tb is
  generic (
    clock_hz : positive := 10_000_000;
    channels : positive := 3;
    rate_hz  : positive := 1_100_000;
    bits     : positive := 15;
    start    : natural  := 9000;
    pulse_ns : natural  := 900;
    rounds   : positive := 60;
    seed     : positive := 1
  );
end entity;

architecture test of pdm_tb is

  constant clock_period : time     := 20 ns;
  constant whole        : positive := 2 ** bits;
  constant period       : positive := (clock_hz + rate_hz - 1) / rate_hz; -- clocks of a bit

  type numbers_t is array (0 to channels - 1) of integer;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal pins    : std_ulogic_vector(channels - 1 downto 0);
  signal steady  : boolean   := false;              -- `density` is in force
  signal density : numbers_t := (others => 0);
  signal measured, edges : numbers_t := (others => 0); -- bits since it is steady, and edges

  -- A density from 2**bits on is all ones.
  function share_of (word : natural) return natural is
  begin
    return minimum(word, whole);
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.pdm
    generic map (
      clock_hz => clock_hz, channels => channels, rate_hz => rate_hz, bits => bits, start => start,
      pulse_ns => pulse_ns)
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, pins => pins);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  -- What the ones are off from the densities, from any bit to any later one, is its range. It is less than one.
  meters : for channel in 0 to channels - 1 generate
    process (clock) is
      variable before           : std_ulogic := '0';
      variable first            : boolean    := true; -- no edge yet since the reset
      variable same             : natural    := 0;    -- clocks since the last edge
      variable clocks           : natural    := 0;    -- since it is steady
      variable off, least, most : integer    := 0;    -- in 1/2**bits of a bit
    begin
      if rising_edge(clock) then
        same := same + 1;
        if pins(channel) /= before then
          check(first or reset = '1' or same mod period = 0,
                "a level of channel " & integer'image(channel) & " lasts " & integer'image(same) & " clocks");
          edges(channel) <= edges(channel) + 1;
          first          := false;
          same           := 0;
        end if;
        first  := first or reset = '1';
        before := pins(channel);
        if not steady then
          clocks := 0;
          off    := 0;
          least  := 0;
          most   := 0;
        else
          clocks := clocks + 1;
          if clocks mod period = 0 then
            off := off - share_of(density(channel));
            if pins(channel) = '1' then
              off := off + whole;
            end if;
            least := minimum(least, off);
            most  := maximum(most, off);
            check(most - least < whole, "channel " & integer'image(channel) & " is a bit off from its density");
          end if;
        end if;
        measured(channel) <= clocks / period;
      end if;
    end process;
  end generate;

  master : process is

    variable random : random_t;
    variable words  : numbers_t := (others => start);

    procedure give (channel : natural; word : natural) is
    begin
      words(channel) := word;
      bus_write(clock, m2s, s2m, channel, std_ulogic_vector(to_unsigned(word, 32)));
    end procedure;

    impure function some_word return natural is
    begin
      case random.integer_between(0, 7) is
        when 0 => return 0;
        when 1 => return whole;
        when 2 => return whole - 1;
        when 3 => return 1;
        when 4 => return random.integer_between(whole + 1, 2 * whole - 1);
        when 5 => return whole / 2;
        when others => return random.integer_between(1, whole - 1);
      end case;
    end function;

    -- All densities hold, at the latest a bit and 3 clocks after the last strobe. The meters look at some bits.
    procedure measure (length : positive) is
      variable before : numbers_t;
    begin
      wait_clocks(clock, period + 4);
      before  := edges;
      density <= words;
      steady  <= true;
      wait_clocks(clock, length * period);
      for channel in numbers_t'range loop
        check(measured(channel) >= length - 1, "the meter has measured");
        if words(channel) = 0 or words(channel) >= whole then
          check_equal(edges(channel) - before(channel), 0, "no edge");
        end if;
        bus_expect(clock, m2s, s2m, channel, std_ulogic_vector(to_unsigned(words(channel), 32)));
      end loop;
      steady <= false;
      wait_clocks(clock, 1);
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 3);
    reset <= '0';

    -- The first access waits until all words are `start`. It is in force without a write.
    for channel in numbers_t'range loop
      bus_expect(clock, m2s, s2m, channel, std_ulogic_vector(to_unsigned(start, 32)));
    end loop;
    measure(100);

    -- Densities change at any clock of a bit.
    for number in 1 to rounds loop
      for channel in numbers_t'range loop
        if random.chance(70) then
          give(channel, some_word);
        end if;
        wait_clocks(clock, random.integer_between(0, period));
      end loop;
      measure(random.integer_between(2, 200));
    end loop;

    -- From 0 to all and back within a bit.
    for number in 1 to period loop
      for channel in numbers_t'range loop
        give(channel, whole);
      end loop;
      wait_clocks(clock, period + 3);
      check(and pins = '1', "all high");
      for channel in numbers_t'range loop
        give(channel, 0);
      end loop;
      wait_clocks(clock, period + 3);
      check(nor pins = '1', "all low");
      wait_clocks(clock, 1);
    end loop;

    bus_write(clock, m2s, s2m, 0, x"FFFFFFFF");
    bus_expect(clock, m2s, s2m, 0, std_ulogic_vector(to_unsigned(2 * whole - 1, 32)));
    bus_refuse(clock, m2s, s2m, '0', channels, "a read behind the last channel");
    bus_refuse(clock, m2s, s2m, '1', channels, "a write behind the last channel");
    bus_refuse(clock, m2s, s2m, '0', 16, "a read of +16");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write of some bytes", sel => "1110");
    bus_expect(clock, m2s, s2m, 0, std_ulogic_vector(to_unsigned(2 * whole - 1, 32)));

    reset <= '1';
    wait_clocks(clock, 2);
    check(nor pins = '1', "low in a reset");
    reset <= '0';
    for channel in numbers_t'range loop
      bus_expect(clock, m2s, s2m, channel, std_ulogic_vector(to_unsigned(start, 32)));
    end loop;

    report_passed("pdm_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * (rounds + 20) * 300 * period, "pdm_tb");

end architecture;
