-- SPDX-License-Identifier: BSD-3-Clause
--
-- async_fifo: two clocks of any ratio and phase, order, no word lost or doubled under random stalls of both sides,
-- capacity, margin, one word per clock, reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity async_fifo_tb is
  generic (
    width           : positive range 1 to 16 := 8;
    depth           : positive := 16;
    margin          : natural  := 0;
    write_period_ps : positive := 16_667;
    read_period_ps  : positive := 20_000;
    seed            : positive := 1
  );
end entity;

architecture test of async_fifo_tb is

  constant write_period : time := write_period_ps * 1 ps;
  constant read_period  : time := read_period_ps * 1 ps;
  constant long         : time := (depth + 12) * maximum(write_period, read_period);

  signal write_clock, read_clock : std_ulogic := '0';
  signal write_reset, read_reset : std_ulogic := '1';
  signal write_valid, read_ready : std_ulogic := '0';
  signal write_ready, read_valid : std_ulogic;
  signal write_data, read_data   : std_ulogic_vector(width - 1 downto 0) := (others => '0');

  signal write_percent, read_percent : natural := 0; -- chance of a word in a clock
  signal written, taken              : natural := 0;
  signal done                        : boolean := false;

  function word (number : natural) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned((number * 40503) mod 65536, 16)(15 downto 16 - width));
  end function;

begin

  write_clock <= not write_clock after write_period / 2 when not done;
  read_clock  <= not read_clock after read_period / 2 when not done;

  dut : entity work.async_fifo
    generic map (width => width, depth => depth, margin => margin)
    port map (
      write_clock => write_clock, write_reset => write_reset,
      write_valid => write_valid, write_ready => write_ready, write_data => write_data,
      read_clock => read_clock, read_reset => read_reset,
      read_valid => read_valid, read_ready => read_ready, read_data => read_data);

  source : process is
    variable random    : random_t;
    variable next_word : natural := 0;
    variable ready_then : std_ulogic_vector(0 to margin) := (others => '0'); -- its values, so many clocks before
  begin
    random.seed(seed);
    loop
      wait until rising_edge(write_clock);
      ready_then := write_ready & ready_then(0 to margin - 1);
      if write_reset = '1' then
        next_word   := 0;
        write_valid <= '0';
      elsif margin = 0 then
        if write_valid = '1' and write_ready = '1' then
          next_word := next_word + 1;
        end if;
        if write_valid = '0' or write_ready = '1' then
          write_valid <= '1' when random.chance(write_percent) else '0';
        end if;
      else
        -- It sees write_ready late, and its words must still be taken.
        if write_valid = '1' then
          next_word := next_word + 1;
        end if;
        write_valid <= '1' when ready_then(margin - 1) = '1' and random.chance(write_percent) else '0';
      end if;
      write_data <= word(next_word);
      written    <= next_word;
    end loop;
  end process;

  sink : process is
    variable random : random_t;
  begin
    random.seed(seed + 1);
    loop
      wait until rising_edge(read_clock);
      if read_reset = '1' then
        taken <= 0;
      elsif read_valid = '1' and read_ready = '1' then
        check_equal(read_data, word(taken), "word " & integer'image(taken));
        taken <= taken + 1;
      end if;
      read_ready <= '1' when random.chance(read_percent) else '0';
    end loop;
  end process;

  play : process is
    variable before : natural;
    variable start  : time;
  begin
    wait for 4 * maximum(write_period, read_period);
    check_equal(write_ready, '0', "write_ready in reset");
    check_equal(read_valid, '0', "read_valid in reset");
    write_reset <= '0';
    wait for seed * 1 ns;
    read_reset <= '0';

    -- Full: as many words as promised, then not ready.
    write_percent <= 100;
    wait for long;
    check_equal(written, depth + 1, "capacity with the margin");
    check_equal(write_ready, '0', "write_ready when full");
    write_percent <= 0;
    read_percent  <= 100;
    wait for long;
    check_equal(taken, written, "words out of the full buffer");
    check_equal(read_valid, '0', "read_valid when empty");

    -- One word per clock of the slower side.
    if depth - margin >= 8 then
      write_percent <= 100;
      wait for long;
      before := taken;
      start  := now;
      wait until taken = before + 200;
      check(now - start <= 202 * maximum(write_period, read_period), "200 words took " & time'image(now - start));
    end if;

    for round in 1 to 20 loop
      write_percent <= (round * 37) mod 101;
      read_percent  <= (round * 61) mod 101;
      wait for 200 * maximum(write_period, read_period);
    end loop;
    write_percent <= 0;
    read_percent  <= 100;
    wait for long;
    check_equal(taken, written, "words after random traffic");
    check(taken > 500, "there was traffic");

    -- A reset of both sides with words inside leaves it empty, whichever side leaves the reset first.
    for turn in 1 to 2 loop
      read_percent  <= 0;
      write_percent <= 100;
      wait for long;
      write_percent <= 0;
      wait until falling_edge(write_clock);
      write_reset <= '1';
      read_reset  <= '1';
      wait for 3 * maximum(write_period, read_period);
      if turn = 1 then
        write_reset <= '0';
        wait for long;
        read_reset <= '0';
      else
        read_reset <= '0';
        wait for long;
        write_reset <= '0';
      end if;
      wait for long;
      check_equal(read_valid, '0', "read_valid after reset");
      check_equal(write_ready, '1', "write_ready after reset");
    end loop;

    report_passed("async_fifo_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 40000 * maximum(write_period, read_period), "async_fifo_tb");

end architecture;
