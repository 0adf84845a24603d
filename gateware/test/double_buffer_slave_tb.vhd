-- SPDX-License-Identifier: BSD-3-Clause
--
-- double_buffer_slave, compared with two arrays and a pointer: the hazard of the swap, one moment in a block, words
-- written by the FPGA.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity double_buffer_slave_tb is
  generic (
    words      : positive := 5;
    data_width : positive range 8 to 32 := 32;
    seed       : positive := 1
  );
end entity;

architecture test of double_buffer_slave_tb is

  constant clock_period : time := 20 ns;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal done  : boolean := false;

  signal committed          : std_ulogic;
  signal user_read_address  : natural range 0 to words - 1 := 0;
  signal user_read_data     : std_ulogic_vector(data_width - 1 downto 0);
  signal user_write_valid   : std_ulogic := '0';
  signal user_write_ready   : std_ulogic;
  signal user_write_address : natural range 0 to words - 1 := 0;
  signal user_write_data    : std_ulogic_vector(data_width - 1 downto 0) := (others => '0');
  signal pulses             : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.double_buffer_slave
    generic map (words => words, data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, committed => committed,
      user_read_address => user_read_address, user_read_data => user_read_data,
      user_write_valid => user_write_valid, user_write_ready => user_write_ready,
      user_write_address => user_write_address, user_write_data => user_write_data);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  count_pulses : process (clock) is
  begin
    if rising_edge(clock) and committed = '1' then
      pulses <= pulses + 1;
    end if;
  end process;

  master : process is

    variable random  : random_t;
    variable answer : bus_answer_t;

    type bank_t is array (0 to words - 1) of std_ulogic_vector(31 downto 0);
    type banks_t is array (0 to 1) of bank_t;
    variable banks   : banks_t := (others => (others => (others => '0')));
    variable visible : natural range 0 to 1 := 0;
    variable commits : natural := 0;
    variable address : natural;
    variable data    : std_ulogic_vector(31 downto 0);

    impure function random_word return std_ulogic_vector is
    begin
      return std_ulogic_vector(resize(unsigned(random.vector(data_width)), 32));
    end function;

    procedure commit is
    begin
      bus_write(clock, m2s, s2m, words, random_word);
      visible := 1 - visible;
      commits := commits + 1;
    end procedure;

    procedure user_write (at : natural; value : std_ulogic_vector(31 downto 0)) is
    begin
      user_write_valid   <= '1';
      user_write_address <= at;
      user_write_data    <= value(data_width - 1 downto 0);
      wait until rising_edge(clock) and user_write_ready = '1';
      user_write_valid <= '0';
      banks(visible)(at) := value;
    end procedure;

    procedure user_expect (at : natural) is
    begin
      user_read_address <= at;
      wait_clocks(clock, 3);
      check_equal(user_read_data, banks(visible)(at)(data_width - 1 downto 0), "the FPGA's word " & integer'image(at));
    end procedure;

  begin
    random.seed(seed);
    wait_clocks(clock, 6);
    reset <= '0';
    wait_clocks(clock, 2);

    for index in 1 to 800 loop
      address := random.integer_between(0, words - 1);
      data    := random_word;
      case random.integer_between(0, 6) is
        when 0 | 1 =>
          bus_write(clock, m2s, s2m, address, data, answer);
          check(not answer.refused, "a write was refused");
          banks(1 - visible)(address) := data;
          check_equal(answer.clocks, 2, "clocks of a write");
        when 2 =>
          bus_read(clock, m2s, s2m, address, answer);
          check(not answer.refused, "a read was refused");
          check_equal(answer.word, banks(visible)(address), "word " & integer'image(address));
          check_equal(answer.clocks, 2, "clocks of a read");
        when 3 =>
          user_write(address, data);
        when 4 =>
          user_expect(address);
        when 5 =>
          commit;
        when others =>
          bus_expect(clock, m2s, s2m, words, commits mod 2 ** integer'(minimum(data_width, 30)));
      end case;
      if random.chance(20) then
        wait_clocks(clock, random.integer_between(1, 4));
      end if;
    end loop;
    wait_clocks(clock, 2);
    check_equal(pulses, commits, "pulses of committed");

    -- The hazard: a word that is not rewritten before a commit has the value of two commits ago.
    bus_write(clock, m2s, s2m, 0, 16#11#);
    bus_write(clock, m2s, s2m, 1, 16#22#);
    commit;
    bus_write(clock, m2s, s2m, 0, 16#33#);
    bus_write(clock, m2s, s2m, 1, 16#44#);
    commit;
    bus_write(clock, m2s, s2m, 0, 16#55#);
    commit;
    bus_expect(clock, m2s, s2m, 0, 16#55#);
    bus_expect(clock, m2s, s2m, 1, 16#22#);
    banks(visible)(0)     := x"00000055";
    banks(visible)(1)     := x"00000022";
    banks(1 - visible)(0) := x"00000033";
    banks(1 - visible)(1) := x"00000044";

    -- During a block the FPGA's word waits. The next block sees it.
    bus_expect(clock, m2s, s2m, 0, 16#55#, keep => true);
    user_write_valid   <= '1';
    user_write_address <= 1;
    user_write_data    <= std_ulogic_vector(to_unsigned(16#66#, data_width));
    for index in 1 to 5 loop
      wait_clocks(clock, 1);
      check_equal(user_write_ready, '0', "user_write_ready in a block");
    end loop;
    bus_expect(clock, m2s, s2m, 1, 16#22#, keep => true);
    bus_expect(clock, m2s, s2m, 0, 16#55#);
    wait until rising_edge(clock) and user_write_ready = '1';
    user_write_valid <= '0';
    bus_expect(clock, m2s, s2m, 1, 16#66#);

    -- A refused access changes nothing.
    bus_refuse(clock, m2s, s2m, '1', words + 1, "a write beyond the commit");
    bus_refuse(clock, m2s, s2m, '0', words + 1, "a read beyond the commit");
    bus_refuse(clock, m2s, s2m, '1', words, "a commit without bytes", sel => "0000");
    bus_expect(clock, m2s, s2m, 0, 16#55#);

    -- A reset restarts the count, and keeps the words.
    pulse(clock, reset);
    wait_clocks(clock, 1);
    bus_expect(clock, m2s, s2m, words, 0);

    wait_clocks(clock, 2);
    report_passed("double_buffer_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "double_buffer_slave_tb");

end architecture;
