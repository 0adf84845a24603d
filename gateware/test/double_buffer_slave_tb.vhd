-- SPDX-License-Identifier: BSD-3-Clause
--
-- double_buffer_slave, compared with two arrays and a pointer: the hazard of the swap, one moment in a block, words written
-- by the FPGA.

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
    variable word    : std_ulogic_vector(31 downto 0);
    variable refused : boolean;
    variable clocks  : positive;
    variable in_block : boolean := false; -- cyc stays high between accesses

    procedure write (address : natural; data : std_ulogic_vector(31 downto 0)) is
    begin
      bus_access(clock, m2s, s2m, '1', to_unsigned(address, 32), data, "1111", in_block, word, refused, clocks);
    end procedure;

    procedure read (address : natural) is
    begin
      bus_access(clock, m2s, s2m, '0', to_unsigned(address, 32), x"00000000", "1111", in_block, word, refused, clocks);
    end procedure;

    procedure write_ok (address : natural; data : std_ulogic_vector(31 downto 0)) is
    begin
      write(address, data);
      check(not refused, "write of " & integer'image(address) & " was refused");
    end procedure;

    procedure write_ok (address : natural; data : natural) is
    begin
      write_ok(address, std_ulogic_vector(to_unsigned(data, 32)));
    end procedure;

    procedure read_expect (address : natural; expected : std_ulogic_vector(31 downto 0)) is
    begin
      read(address);
      check(not refused, "read of " & integer'image(address) & " was refused");
      check_equal(word, expected, "word " & integer'image(address));
    end procedure;

    procedure read_expect (address : natural; expected : natural) is
    begin
      read_expect(address, std_ulogic_vector(to_unsigned(expected, 32)));
    end procedure;

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
      write_ok(words, random_word);
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
          write_ok(address, data);
          banks(1 - visible)(address) := data;
          check_equal(clocks, 2, "clocks of a write");
        when 2 =>
          read_expect(address, banks(visible)(address));
          check_equal(clocks, 2, "clocks of a read");
        when 3 =>
          user_write(address, data);
        when 4 =>
          user_expect(address);
        when 5 =>
          commit;
        when others =>
          read_expect(words, commits mod 2 ** integer'(minimum(data_width, 30)));
      end case;
      if random.chance(20) then
        wait_clocks(clock, random.integer_between(1, 4));
      end if;
    end loop;
    wait_clocks(clock, 2);
    check_equal(pulses, commits, "pulses of committed");

    -- The hazard: a word that is not rewritten before a commit has the value of two commits ago.
    write_ok(0, 16#11#);
    write_ok(1, 16#22#);
    commit;
    write_ok(0, 16#33#);
    write_ok(1, 16#44#);
    commit;
    write_ok(0, 16#55#);
    commit;
    read_expect(0, 16#55#);
    read_expect(1, 16#22#);
    banks(visible)(0)     := x"00000055";
    banks(visible)(1)     := x"00000022";
    banks(1 - visible)(0) := x"00000033";
    banks(1 - visible)(1) := x"00000044";

    -- During a block the FPGA's word waits. The next block sees it.
    in_block := true;
    read_expect(0, 16#55#);
    user_write_valid   <= '1';
    user_write_address <= 1;
    user_write_data    <= std_ulogic_vector(to_unsigned(16#66#, data_width));
    for index in 1 to 5 loop
      wait_clocks(clock, 1);
      check_equal(user_write_ready, '0', "user_write_ready in a block");
    end loop;
    read_expect(1, 16#22#);
    in_block := false;
    read_expect(0, 16#55#);
    wait until rising_edge(clock) and user_write_ready = '1';
    user_write_valid <= '0';
    read_expect(1, 16#66#);

    -- A refused access changes nothing.
    write(words + 1, x"000000FF");
    check(refused, "a write beyond the commit was taken");
    read(words + 1);
    check(refused, "a read beyond the commit was answered");
    bus_access(clock, m2s, s2m, '1', to_unsigned(words, 32), x"00000001", "0000", false, word, refused, clocks);
    check(refused, "a commit without bytes was taken");
    read_expect(0, 16#55#);

    -- A reset restarts the count, and keeps the words.
    reset <= '1';
    wait_clocks(clock, 1);
    reset <= '0';
    wait_clocks(clock, 1);
    read_expect(words, 0);

    wait_clocks(clock, 2);
    report_passed("double_buffer_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog : process is
  begin
    wait until done for clock_period * 100000;
    assert done
      report "double_buffer_slave_tb: not done in time"
      severity failure;
    wait;
  end process;

end architecture;
