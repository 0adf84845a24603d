-- SPDX-License-Identifier: BSD-3-Clause
--
-- interrupt_slave: random events while a program enables, reads and clears, compared with a model. Each event is seen
-- by a read exactly once, and the interrupt is high exactly while an enabled one waits.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity interrupt_slave_tb is
  generic (
    lines : positive := 5;
    seed  : positive := 1
  );
end entity;

architecture test of interrupt_slave_tb is

  constant clock_period : time := 20 ns;

  -- From the clock on in which a write takes effect, an event stays.
  constant stays_c : positive := 2;

  subtype lines_t is std_ulogic_vector(lines - 1 downto 0);

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal done         : boolean    := false;
  signal wishbone_m2s : wishbone_m2s_t := wishbone_m2s_idle;
  signal wishbone_s2m : wishbone_s2m_t;
  signal events       : lines_t := (others => '0');
  signal interrupt    : std_ulogic;
  signal noisy        : boolean := false; -- events come
  signal due          : natural := 0;     -- … or one, so many clocks from now

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.interrupt_slave
    generic map (lines => lines)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      events => events, interrupt => interrupt);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

  stir : process is
    variable random : random_t;
  begin
    random.seed(seed);
    loop
      wait until rising_edge(clock);
      events <= (others => '0');
      if noisy and random.chance(30) then
        events <= random.vector(lines);
      elsif due > 0 then
        for clocks in 2 to due loop
          wait until rising_edge(clock);
        end loop;
        events(0) <= '1';
        wait until rising_edge(clock);
        events(0) <= '0';
        wait until rising_edge(clock) and due = 0;
      end if;
    end loop;
  end process;

  play : process is
    variable random  : random_t;
    variable answer  : bus_answer_t;
    variable pending : lines_t := (others => '0');
    variable mask    : lines_t;
  begin
    random.seed(seed + 1);
    tick(clock, 2);
    reset <= '0';
    tick(clock, 3);
    check_equal(interrupt, '0', "the interrupt behind a reset");
    bus_refuse(clock, wishbone_m2s, wishbone_s2m, '0', 2, "a word that is not there");
    bus_refuse(clock, wishbone_m2s, wishbone_s2m, '1', 1, "a part of a word", sel => "0001");
    noisy <= true;
    for round in 1 to 300 loop
      -- What is pending is enough for the interrupt, and only that.
      mask := random.vector(lines);
      bus_write(clock, wishbone_m2s, wishbone_s2m, 1, to_integer(unsigned(mask)));
      bus_expect(clock, wishbone_m2s, wishbone_s2m, 1, to_integer(unsigned(mask)));
      tick(clock, random.integer_between(0, 5));
      bus_read(clock, wishbone_m2s, wishbone_s2m, 0, answer);
      check(unsigned(answer.word(31 downto 0)) < 2 ** lines, "bits beyond the lines");
      pending := answer.word(lines_t'range);
      if (pending and mask) /= (lines_t'range => '0') then
        tick(clock, 2);
        check_equal(interrupt, '1', "the interrupt of what is pending");
      end if;
      bus_write(clock, wishbone_m2s, wishbone_s2m, 0, to_integer(unsigned(pending)));
    end loop;
    -- An event in the clock of its clear stays: nothing that came after the last read is missed.
    noisy <= false;
    bus_write(clock, wishbone_m2s, wishbone_s2m, 1, 2 ** lines - 1);
    for offset in 1 to 6 loop
      tick(clock, 3);
      bus_write(clock, wishbone_m2s, wishbone_s2m, 0, x"FFFFFFFF");
      tick(clock, 3);
      check_equal(interrupt, '0', "the interrupt when all is cleared");
      due <= offset;
      tick(clock);
      bus_write(clock, wishbone_m2s, wishbone_s2m, 0, x"FFFFFFFF");
      tick(clock, 8);
      check((interrupt = '1') = (offset >= stays_c), "an event at clock " & integer'image(offset));
      due <= 0;
      tick(clock);
    end loop;

    report_passed("interrupt_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "interrupt_slave_tb");

end architecture;
