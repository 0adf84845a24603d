-- SPDX-License-Identifier: BSD-3-Clause
--
-- fifo_slave, compared with two queues: irregular data in both directions with stalls on both sides, full, empty, the
-- event line.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity fifo_slave_tb is
  generic (
    depth      : positive := 8;
    data_width : positive range 8 to 32 := 32;
    seed       : positive := 1
  );
end entity;

architecture test of fifo_slave_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  subtype data_t is std_ulogic_vector(data_width - 1 downto 0);

  constant remind_clocks : positive := 200;

  signal arrival       : std_ulogic;
  signal not_empty     : std_ulogic;
  signal to_pc_valid   : std_ulogic := '0';
  signal to_pc_ready   : std_ulogic;
  signal to_pc_data    : data_t := (others => '0');
  signal from_pc_valid : std_ulogic;
  signal from_pc_ready : std_ulogic := '0';
  signal from_pc_data  : data_t;

  signal put_percent  : natural := 0; -- how often the FPGA puts a word …
  signal take_percent : natural := 0; -- … and takes a word
  signal watching     : boolean := false;
  signal edges        : natural := 0;
  signal put_count    : natural := 0;
  signal take_count   : natural := 0;

  -- Word n of a stream, so that both sides know the next word.
  function word_of (n : natural) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned((n * 193 + n / 7) mod 2 ** 16, 32));
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.fifo_slave
    generic map (depth => depth, data_width => data_width, remind_clocks => remind_clocks)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, arrival => arrival,
      not_empty => not_empty,
      to_pc_valid => to_pc_valid, to_pc_ready => to_pc_ready, to_pc_data => to_pc_data,
      from_pc_valid => from_pc_valid, from_pc_ready => from_pc_ready, from_pc_data => from_pc_data);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  count_edges : process (arrival) is
  begin
    if rising_edge(arrival) and watching then
      edges <= edges + 1;
    end if;
  end process;

  fpga : process is
    variable random : random_t;
    variable next_word : natural := 0;
  begin
    random.seed(seed + 50);
    loop
      wait until rising_edge(clock) or done;
      exit when done;
      if to_pc_valid = '1' and to_pc_ready = '1' then
        put_count   <= put_count + 1;
        next_word   := next_word + 1;
        to_pc_valid <= '0';
      end if;
      if (to_pc_valid = '0' or to_pc_ready = '1') and random.chance(put_percent) then
        to_pc_valid <= '1';
        to_pc_data  <= word_of(next_word)(data_t'range);
      end if;
      if from_pc_valid = '1' and from_pc_ready = '1' then
        check_equal(from_pc_data, word_of(take_count)(data_t'range),
                    "word " & integer'image(take_count) & " from the PC");
        take_count <= take_count + 1;
      end if;
      from_pc_ready <= '1' when random.chance(take_percent) else '0';
    end loop;
    wait;
  end process;

  master : process is

    variable random  : random_t;
    variable answer : bus_answer_t;

    variable got, given : natural := 0; -- words read, and written
    variable silence    : natural;      -- clocks in which a word waited and no edge came
    variable served     : natural := 0; -- edges of the event line that were served

    procedure read_one is
      variable before : natural;
    begin
      before := put_count;
      bus_read(clock, m2s, s2m, 0, answer);
      if answer.refused then
        check_equal(before, got, "words that wait at a refusal");
      else
        check_equal(answer.word(data_t'range), word_of(got)(data_t'range), "word " & integer'image(got) & " to the PC");
        got := got + 1;
      end if;
    end procedure;

    procedure write_one is
    begin
      bus_write(clock, m2s, s2m, 0, word_of(given), answer);
      if answer.refused then
        check(given - take_count >= depth - 2, "a word was refused with room for it");
      else
        given := given + 1;
      end if;
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    -- Empty: nothing to read, and room for `depth` words.
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, depth);
    check_equal(not_empty, '0', "not_empty of an empty queue");
    read_one;
    check(answer.refused, "a word came from an empty queue");

    -- Full in both directions: exactly `depth` words and no more.
    for index in 1 to depth + 2 loop
      write_one;
      check(answer.refused = (index > depth), "write " & integer'image(index) & " of " & integer'image(depth));
    end loop;
    bus_expect(clock, m2s, s2m, 2, 0);
    put_percent <= 100;
    wait_clocks(clock, depth + 10);
    check_equal(to_pc_ready, '0', "to_pc_ready of a full queue");
    check_equal(put_count, depth, "words put into a full queue");
    check_equal(not_empty, '1', "not_empty of a full queue");
    bus_expect(clock, m2s, s2m, 1, depth);

    -- Irregular data, at every combination of speeds.
    for mixture in 0 to 8 loop
      put_percent  <= (mixture mod 3) * 25 + 3;
      take_percent <= (mixture / 3) * 25 + 3;
      for index in 1 to 150 loop
        case random.integer_between(0, 4) is
          when 0 | 1 =>
            write_one;
          when 2 | 3 =>
            read_one;
          when others =>
            wait_clocks(clock, random.integer_between(1, 8));
        end case;
      end loop;
    end loop;

    -- Now the queue is empty. From here only the edges of the event line say when to read, as for a subscription group.
    -- An edge while another one is pending is not counted twice. Every word arrives, and no word is requested that is
    -- not there.
    put_percent  <= 0;
    take_percent <= 100;
    wait_clocks(clock, depth + 10);
    while not_empty = '1' loop
      read_one;
      wait_clocks(clock, 1);
    end loop;
    watching    <= true;
    put_percent <= 20;
    for index in 1 to 150 loop
      if index = 100 then
        put_percent <= 1;
      end if;
      silence := 0;
      while edges = served loop
        wait_clocks(clock, 1);
        silence := silence + 1 when not_empty = '1' else 0;
        check(silence < 5, "a word waits and the event line does not say so");
      end loop;
      served := edges;
      wait_clocks(clock, random.integer_between(0, 12));
      read_one;
      check(not answer.refused, "the event line asked for a word that is not there");
      wait_clocks(clock, 2);
    end loop;
    put_percent <= 0;
    wait_clocks(clock, depth + 10);

    -- Without a read, it rises again.
    put_percent <= 100;
    wait_clocks(clock, depth + 10);
    served := edges;
    wait_clocks(clock, 5 * remind_clocks);
    check(edges - served = 5, "reminders: " & integer'image(edges - served));
    put_percent <= 0;
    wait_clocks(clock, 2);

    -- After all words are read, the counts agree.
    put_percent  <= 0;
    take_percent <= 100;
    wait_clocks(clock, depth + 10);
    while not_empty = '1' loop
      read_one;
      wait_clocks(clock, 1);
    end loop;
    check_equal(to_pc_valid, '0', "a word left over");
    check_equal(got, put_count, "words to the PC");
    check_equal(given, take_count, "words from the PC");
    bus_expect(clock, m2s, s2m, 1, 0);
    bus_expect(clock, m2s, s2m, 2, depth);

    -- A word counts from the clock after it was put in, even on its way through the queue.
    for distance in 0 to 5 loop
      put_percent <= 100;
      wait_clocks(clock, 1);
      put_percent <= 0;
      wait_clocks(clock, distance);
      read_one;
      check(answer.refused = (distance = 0), "a read " & integer'image(distance) & " clocks after a word was put in");
      wait_clocks(clock, 4);
      if distance = 0 then
        read_one;
      end if;
    end loop;

    -- Refused accesses.
    bus_refuse(clock, m2s, s2m, '1', 1, "a write of +1");
    bus_refuse(clock, m2s, s2m, '1', 2, "a write of +2");
    bus_refuse(clock, m2s, s2m, '0', 3, "a read of +3");
    bus_refuse(clock, m2s, s2m, '1', 0, "a write without bytes", sel => "0000");
    bus_expect(clock, m2s, s2m, 2, depth);

    -- A reset empties both queues.
    take_percent <= 0;
    wait_clocks(clock, 2);
    write_one;
    wait_clocks(clock, 4);
    pulse(clock, reset);
    wait_clocks(clock, 1);
    check_equal(from_pc_valid, '0', "from_pc_valid after a reset");
    bus_expect(clock, m2s, s2m, 2, depth);

    wait_clocks(clock, 2);
    report_passed("fifo_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "fifo_slave_tb");

end architecture;
