-- SPDX-License-Identifier: BSD-3-Clause
--
-- fifo: order, no word lost or doubled under random stalls of both sides, capacity, one word per clock, reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;

entity fifo_tb is
  generic (
    depth : positive := 16;
    seed  : positive := 1
  );
end entity;

architecture bench of fifo_tb is

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic := '1';
  signal ended       : boolean := false;
  signal write_valid : std_ulogic := '0';
  signal write_ready : std_ulogic;
  signal write_data  : std_ulogic_vector(15 downto 0) := (others => '0');
  signal read_valid  : std_ulogic;
  signal read_ready  : std_ulogic := '0';
  signal read_data   : std_ulogic_vector(15 downto 0);

  signal write_percent, read_percent : natural := 0;  -- chance of a word in a clock
  signal written, taken : natural := 0;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.fifo
    generic map (width => 16, depth => depth)
    port map (
      clock => clock, reset => reset,
      write_valid => write_valid, write_ready => write_ready, write_data => write_data,
      read_valid => read_valid, read_ready => read_ready, read_data => read_data);

  source : process (clock)
    variable random : random_t;
    variable seeded : boolean := false;
    variable next_word : natural := 0;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(seed);
        seeded := true;
      end if;
      if reset = '1' then
        next_word   := 0;
        written     <= 0;
        write_valid <= '0';
      else
        if write_valid = '1' and write_ready = '1' then
          next_word := next_word + 1;
          written   <= next_word;
          write_valid <= '0';
        end if;
        if write_valid = '0' or write_ready = '1' then
          if random.chance(write_percent) then
            write_valid <= '1';
            write_data  <= std_ulogic_vector(to_unsigned((next_word * 40503) mod 65536, 16));
          end if;
        end if;
      end if;
    end if;
  end process;

  sink : process (clock)
    variable random : random_t;
    variable seeded : boolean := false;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(seed + 1);
        seeded := true;
      end if;
      if reset = '1' then
        taken <= 0;
      elsif read_valid = '1' and read_ready = '1' then
        check_equal(read_data, std_ulogic_vector(to_unsigned((taken * 40503) mod 65536, 16)), "word read");
        taken <= taken + 1;
      end if;
      read_ready <= '0';
      if random.chance(read_percent) then
        read_ready <= '1';
      end if;
    end if;
  end process;

  play : process

    variable before : natural;
  begin
    wait_clocks(clock, 3);
    reset <= '0';
    -- Full: as many words as promised, then not ready.
    write_percent <= 100;
    wait_clocks(clock, depth + 10);
    check_equal(written, depth + 1, "capacity");
    check_equal(write_ready, '0', "write_ready when full");
    -- Empty again.
    write_percent <= 0;
    read_percent  <= 100;
    wait_clocks(clock, depth + 10);
    check_equal(taken, written, "words out of the full buffer");
    check_equal(read_valid, '0', "read_valid when empty");
    -- One word per clock through both sides.
    write_percent <= 100;
    wait_clocks(clock, 20);
    before := taken;
    wait_clocks(clock, 100);
    check_equal(taken - before, 100, "words in 100 clocks");
    -- Everything at random.
    for round in 1 to 20 loop
      write_percent <= (round * 37) mod 101;
      read_percent  <= (round * 61) mod 101;
      wait_clocks(clock, 200);
    end loop;
    write_percent <= 0;
    read_percent  <= 100;
    wait_clocks(clock, depth + 10);
    check_equal(taken, written, "words after random traffic");
    check(taken > 500, "there was traffic");
    -- A reset empties it.
    read_percent  <= 0;
    write_percent <= 100;
    wait_clocks(clock, 6);
    reset <= '1';
    wait_clocks(clock, 2);
    write_percent <= 0;
    reset <= '0';
    wait_clocks(clock, 5);
    check_equal(read_valid, '0', "read_valid after reset");
    report_passed("fifo_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "fifo_tb");

end architecture;
