-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_line_out and tosnet_line_in: all bytes and both control symbols over a line between two clocks, the bits on
-- it, alignment at any bit, symbols that do not exist, and a line without edges.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_code_pkg.all;

entity tosnet_line_tb is
  generic (
    clocks_per_bit    : positive := 4;
    samples_per_clock : positive := 1;
    apart_ppm         : integer  := 0; -- the receiver's clock is slower by so much
    seed              : positive := 1
  );
end entity;

architecture test of tosnet_line_tb is

  subtype item_t is std_ulogic_vector(8 downto 0); -- control, data
  type plan_t is array (natural range <>) of item_t;

  constant idle   : item_t   := '1' & x"3C";
  constant begins : item_t   := '1' & x"BC";
  constant before : positive := 4;                      -- idle symbols before the first K28.5
  constant length : positive := before + 2 * 257 + 100; -- symbols of an episode
  constant none   : positive := length + 1;
  constant turns  : positive := 12;

  constant period      : time := 20 ns;
  constant far_period  : time := (20_000_000 + 20 * apart_ppm) * 1 fs;
  constant symbol_time : time := 10 * clocks_per_bit * period;

  signal clock, far_clock : std_ulogic := '0';
  signal reset, far_reset : std_ulogic := '1';
  signal done    : boolean := false;

  signal plan    : plan_t(0 to length - 1) := (others => idle);
  signal index   : natural range 0 to length := length; -- of the plan: what is sent next
  signal now_out : item_t;
  signal take    : std_ulogic;
  signal line    : std_ulogic; -- as it leaves the transmitter
  signal far     : std_ulogic; -- as it comes to the receiver
  signal promised : std_ulogic := 'U'; -- what must be on it
  signal stuck   : std_ulogic := '0';
  signal level   : std_ulogic := '0';

  signal samples : std_ulogic_vector(samples_per_clock - 1 downto 0) := (others => '0');
  signal symbol_valid, control, wrong, lost : std_ulogic;
  signal data    : byte_t;

  signal turn    : natural := 0;
  signal spoiled : natural := none;  -- the symbol of the plan that is spoiled on the line
  signal good    : natural := 0;      -- symbols of the plan that came and that were as they must be
  signal came_wrong : natural := 0;

begin

  clock     <= not clock after period / 2 when not done;
  far_clock <= not far_clock after far_period / 2 when not done;

  transmitter : entity work.tosnet_line_out
    generic map (clocks_per_bit => clocks_per_bit)
    port map (
      clock => clock, reset => reset, take => take, data => now_out(7 downto 0), control => now_out(8), line => line);

  now_out <= plan(index) when index < length else idle;
  far     <= level when stuck = '1' else line;

  one_sample : if samples_per_clock = 1 generate
    entry : entity work.synchroniser
      port map (clock => far_clock, asynchronous(0) => far, levels => samples);
  end generate;

  many_samples : if samples_per_clock > 1 generate
    process is
      variable taken : std_ulogic_vector(samples_per_clock - 1 downto 0) := (others => '0');
    begin
      wait until rising_edge(far_clock);
      samples <= taken;
      for sample in 0 to samples_per_clock - 1 loop
        taken(sample) := far;
        if sample < samples_per_clock - 1 then
          wait for far_period / samples_per_clock;
        end if;
      end loop;
    end process;
  end generate;

  receiver : entity work.tosnet_line_in
    generic map (clocks_per_bit => clocks_per_bit, samples_per_clock => samples_per_clock)
    port map (
      clock => far_clock, reset => far_reset, samples => samples, symbol_valid => symbol_valid, data => data,
      control => control, wrong => wrong, lost => lost);

  -- What is on the line, bit by bit, at the time that the transmitter promises.
  promise : process is
    variable encoded : encoded_t := (symbol => "0000000000", disparity => '0');
    variable run     : natural   := 0; -- equal bits in a row
    variable last    : std_ulogic := '0';
  begin
    wait until rising_edge(clock);
    if reset = '1' then
      promised <= transport 'U';
      encoded.disparity := '0';
      run := 0;
    elsif take = '1' then
      encoded := encode(now_out(7 downto 0), now_out(8), encoded.disparity);
      for number in 0 to 9 loop
        promised <= transport encoded.symbol(number)
                    after (2 + number) * clocks_per_bit * period + period / 4;
        run  := run + 1 when encoded.symbol(number) = last else 1;
        last := encoded.symbol(number);
        check(run <= 5, "more than five equal bits in a row");
      end loop;
    end if;
  end process;

  check_line : process is
  begin
    wait until falling_edge(clock);
    if promised /= 'U' then
      check_equal(line, promised, "the bit on the line");
    end if;
  end process;

  check_symbols : process is
    type state_t is (hunting, aligned, silent);
    variable state    : state_t := hunting;
    variable expected : natural := 0;
    variable this     : natural := 0;
    variable item     : item_t;

    procedure next_begin is
    begin
      while plan(expected) /= begins loop
        expected := expected + 1;
      end loop;
      state := aligned;
    end procedure;

  begin
    wait until rising_edge(far_clock) and symbol_valid = '1';
    item := control & data;
    if turn /= this then
      this     := turn;
      expected := 0;
      state    := hunting; -- one of the two begins anew, so bits of two symbols may come as one
    end if;
    if state = silent then
      check_equal(item, begins, "the first symbol after one that does not exist");
    end if;
    if state /= aligned and wrong = '0' and item = begins then
      next_begin;
    end if;
    if state = aligned and expected = spoiled then
      check_equal(wrong, '1', "a symbol that does not exist");
      came_wrong <= came_wrong + 1;
      expected   := expected + 1;
      state      := silent;
    elsif state = aligned then
      check_equal(wrong, '0', "a symbol exists");
      check_equal(lost, '0', "lost while symbols come");
      if expected < length then
        check_equal(item, plan(expected), "a symbol");
        expected := expected + 1;
        good     <= good + 1;
      else
        check_equal(item, idle, "a symbol after the last one");
      end if;
    end if;
  end process;

  play : process is

    variable random : random_t;
    variable next_plan : plan_t(plan'range);

    procedure shuffle is
      variable other : natural;
      variable held  : item_t;
    begin
      next_plan := (others => idle);
      for byte in 0 to 255 loop
        next_plan(before + 1 + byte)   := '0' & std_ulogic_vector(to_unsigned(byte, 8));
        next_plan(before + 258 + byte) := '0' & std_ulogic_vector(to_unsigned(byte, 8));
      end loop;
      for place in length - 80 to length - 10 loop
        if random.chance(50) then
          next_plan(place) := begins;
        end if;
      end loop;
      for place in before + 1 to length - 5 loop
        other := random.integer_between(before + 1, length - 5);
        held  := next_plan(place);
        next_plan(place) := next_plan(other);
        next_plan(other) := held;
      end loop;
      next_plan(before)     := begins;
      next_plan(length - 5) := begins;
    end procedure;

    procedure play_turn (spoil : boolean) is
    begin
      shuffle;
      plan    <= next_plan;
      spoiled <= none;
      if spoil then
        spoiled <= random.integer_between(before + 1, length - 6);
      end if;
      index   <= 0;
      wait for 0 ps;
      while index < length loop
        wait until rising_edge(clock) and take = '1';
        if index = spoiled then
          level <= random.vector(1)(0);
          stuck <= transport '1' after 2 * clocks_per_bit * period,
                   '0' after 12 * clocks_per_bit * period;
        end if;
        index <= index + 1;
        wait for 0 ps;
      end loop;
      wait for 6 * symbol_time;
      turn <= turn + 1;
    end procedure;

    variable before_good, before_wrong : natural;
    variable began : time;

  begin
    random.seed(seed);
    wait_clocks(clock, 4);
    reset <= '0';
    wait for 3 * symbol_time;
    check_equal(lost, '1', "lost after the reset");
    far_reset <= '0';
    for number in 1 to turns loop
      before_good  := good;
      before_wrong := came_wrong;
      play_turn(number > turns / 2);
      if number <= turns / 2 then
        check_equal(good - before_good, length - before, "symbols of a turn");
      else
        check_equal(came_wrong - before_wrong, 1, "symbols that were spoiled");
        check(good - before_good > 5, "no symbol after one that does not exist");
      end if;
      -- One of the two begins anew, anywhere.
      wait_clocks(clock, random.integer_between(1, 40 * clocks_per_bit));
      if random.chance(50) then
        reset <= '1';
      else
        far_reset <= '1';
      end if;
      wait_clocks(clock, random.integer_between(1, 10));
      reset     <= '0';
      far_reset <= '0';
      wait_clocks(clock, random.integer_between(1, 40 * clocks_per_bit));
    end loop;

    play_turn(false);
    for number in 0 to 1 loop
      level <= to_unsigned(number, 1)(0);
      stuck <= '1';
      began := now;
      wait until lost = '1' for 4 * symbol_time;
      check_equal(lost, '1', "lost without edges");
      check(now - began > 26 * clocks_per_bit * period, "lost too early");
      check(now - began < 33 * clocks_per_bit * period + 8 * far_period, "lost too late");
      stuck <= '0';
      wait for 3 * symbol_time;
      check_equal(lost, '1', "lost until a K28.5 comes");
      before_good := good;
      play_turn(false);
      check_equal(lost, '0', "lost after a K28.5");
      check_equal(good - before_good, length - before, "symbols after the loss");
    end loop;
    report_passed("tosnet_line_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 sec, "tosnet_line_tb");

end architecture;
