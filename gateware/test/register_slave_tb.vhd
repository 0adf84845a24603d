-- SPDX-License-Identifier: BSD-3-Clause
--
-- register_slave, compared with an array of words: random reads, writes, refusals, pauses; snapshots of a block.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.register_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity register_slave_tb is
  generic (
    data_width : positive range 8 to 32 := 32;
    snapshot   : boolean := true;
    seed       : positive := 1
  );
end entity;

architecture test of register_slave_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  constant words    : positive := 8;
  constant writable : std_ulogic_vector(0 to words - 1) := "01101-01";

  -- The initial values of the writable words.
  constant initial : word_vector_t(0 to words - 1) := (1 => x"0000005A", 2 => x"000000C3", others => (others => '0'));

  signal read_words  : word_vector_t(0 to words - 1);
  signal write_words : word_vector_t(0 to words - 1);
  signal written     : std_ulogic_vector(0 to words - 1);
  signal status      : word_vector_t(0 to words - 1) := (others => (others => '0')); -- the words that logic offers
  signal strobes     : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.register_slave
    generic map (writable => writable, data_width => data_width, snapshot => snapshot, initial => initial)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m,
      read_words => read_words, write_words => write_words, written => written);

  mirror : for address in 0 to words - 1 generate
    read_words(address) <= write_words(address) when writable(address) = '1' else status(address);
  end generate;

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  count_strobes : process (clock) is
  begin
    if rising_edge(clock) then
      for address in 0 to words - 1 loop
        if written(address) = '1' then
          strobes <= strobes + 1;
        end if;
      end loop;
    end if;
  end process;

  master : process is

    variable random  : random_t;
    variable answer : bus_answer_t;

    variable model  : word_vector_t(0 to words - 1) := initial;
    variable writes : natural := 0;
    variable data   : word_t;
    variable address : natural;

    function is_writable (address : natural) return boolean is
    begin
      if address >= words then
        return false;
      end if;
      return writable(address) = '1';
    end function;

    function exists (address : natural) return boolean is
    begin
      if address >= words then
        return false;
      end if;
      return writable(address) /= '-';
    end function;

    function masked (value : word_t) return word_t is
    begin
      return std_ulogic_vector(resize(unsigned(value(data_width - 1 downto 0)), 32));
    end function;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    for index in 1 to 600 loop
      address := random.integer_between(0, words + 1);
      if random.chance(10) then
        address := 2 ** random.integer_between(3, 30); -- far outside, where the low bits alone would be inside
      end if;
      data := random.vector(32);
      case random.integer_between(0, 2) is
        when 0 =>
          bus_write(clock, m2s, s2m, address, data, answer);
          if is_writable(address) then
            check(not answer.refused, "a write was refused");
            model(address) := masked(data);
            writes         := writes + 1;
          else
            check(answer.refused, "a write of " & integer'image(address) & " was taken");
          end if;
          check_equal(answer.clocks, 2, "clocks of a write");
          wait_clocks(clock, 1); -- the next access is another block: a snapshot shows the new word, too
        when 1 =>
          bus_read(clock, m2s, s2m, address, answer);
          if exists(address) then
            check(not answer.refused, "a read was refused");
            check_equal(answer.word, model(address), "word " & integer'image(address));
          else
            check(answer.refused, "a read of " & integer'image(address) & " was answered");
          end if;
          check_equal(answer.clocks, 2, "clocks of a read");
        when others =>
          address := random.integer_between(0, words - 1);
          if writable(address) = '0' then
            status(address) <= data;
            model(address)  := masked(data);
          end if;
          wait_clocks(clock, 2);
      end case;
      if random.chance(30) then
        wait_clocks(clock, random.integer_between(1, 5));
      end if;
    end loop;
    wait_clocks(clock, 1);
    check_equal(strobes, writes, "written strobes");

    -- A write that does not select all bytes changes nothing.
    bus_refuse(clock, m2s, s2m, '1', 1, "a write of part of a word", not model(1), sel => "1110");
    bus_expect(clock, m2s, s2m, 1, model(1));

    -- A block sees the words of its first clock, or without snapshots the current words.
    status(0) <= masked(x"12345678");
    wait_clocks(clock, 3);
    bus_expect(clock, m2s, s2m, 0, masked(x"12345678"), keep => true);
    status(0) <= masked(x"9ABCDEF0");
    status(3) <= masked(x"0F1E2D3C");
    wait_clocks(clock, 3);
    if snapshot then
      bus_expect(clock, m2s, s2m, 0, masked(x"12345678"), keep => true);
      bus_expect(clock, m2s, s2m, 3, model(3), keep => true);
    else
      bus_expect(clock, m2s, s2m, 0, masked(x"9ABCDEF0"), keep => true);
      bus_expect(clock, m2s, s2m, 3, masked(x"0F1E2D3C"), keep => true);
    end if;
    -- It also sees the words that it writes itself. All other words stay as they were.
    bus_write(clock, m2s, s2m, 1, masked(x"13579BDF"), keep => true);
    wait_clocks(clock, 1);
    bus_expect(clock, m2s, s2m, 1, masked(x"13579BDF"), keep => true);
    bus_write(clock, m2s, s2m, 1, masked(x"2468ACE0"), keep => true);
    bus_write(clock, m2s, s2m, 2, masked(x"55AA55AA"), keep => true);
    bus_expect(clock, m2s, s2m, 1, masked(x"2468ACE0"), keep => true);
    wait_clocks(clock, 1);
    bus_expect(clock, m2s, s2m, 2, masked(x"55AA55AA"), keep => true);
    if snapshot then
      bus_expect(clock, m2s, s2m, 3, model(3), keep => true);
    end if;
    bus_read(clock, m2s, s2m, 0, answer);
    wait_clocks(clock, 2);
    bus_expect(clock, m2s, s2m, 0, masked(x"9ABCDEF0"));
    bus_expect(clock, m2s, s2m, 3, masked(x"0F1E2D3C"));

    -- An access that ends in the clock of its answer is not answered later.
    m2s <= (cyc => '1', stb => '1', we => '0', adr => x"00000001", dat => x"00000000", sel => "1111");
    wait_clocks(clock, 1);
    m2s <= wishbone_m2s_idle;
    wait_clocks(clock, 3);

    pulse(clock, reset);
    wait_clocks(clock, 1);
    bus_expect(clock, m2s, s2m, 1, initial(1));

    wait_clocks(clock, 2);
    report_passed("register_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "register_slave_tb");

end architecture;
