-- SPDX-License-Identifier: BSD-3-Clause
--
-- wishbone_interconnect with slaves at aligned and unaligned places: which slave was asked, at which address, and its
-- answer.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.address_map_pkg.all;
  use work.bench_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_interconnect_tb is
  generic (
    broken_map : natural := 0; -- 1: two slaves overlap, 2: one passes the last address; both must fail to elaborate
    seed       : positive := 1
  );
end entity;

architecture test of wishbone_interconnect_tb is

  constant clock_period : time := 20 ns;

  function broken (base : unsigned(31 downto 0); when_map : natural; instead : unsigned(31 downto 0)) return unsigned is
  begin
    if broken_map = when_map then
      return instead;
    end if;
    return base;
  end function;

  constant address_map : address_map_t := (
    (base => x"00000000", words => 64),
    (base => broken(x"00000040", 1, x"0000003F"), words => 3), -- directly after the one before, not a power of two
    (base => x"00000065", words => 16),                        -- a power of two at an unaligned place
    (base => broken(x"FFFFFF00", 2, x"FFFFFF01"), words => 256),
    (base => x"00001000", words => 1));

  constant slaves : positive := address_map'length;

  signal clock  : std_ulogic := '0';
  signal reset  : std_ulogic := '1';
  signal m2s    : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m    : wishbone_s2m_t;
  signal to_slaves   : wishbone_m2s_vector_t(0 to slaves - 1);
  signal from_slaves : wishbone_s2m_vector_t(0 to slaves - 1) := (others => wishbone_s2m_idle);
  signal done   : boolean := false;

  -- A slave answers with its number, whether it was a write, its address, and the low bits of the written word.
  function answer_of (slave : natural; we : std_ulogic; address : unsigned(31 downto 0);
                      data  : std_ulogic_vector(31 downto 0))
    return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned(slave, 7)) & we & std_ulogic_vector(address(11 downto 0)) & data(11 downto 0);
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.wishbone_interconnect
    generic map (address_map => address_map)
    port map (master_m2s => m2s, master_s2m => s2m, slaves_m2s => to_slaves, slaves_s2m => from_slaves);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m);

  -- Slaves take a random time, refuse their address 2, and put random values on dat while they are not asked.
  slave_models : for slave in 0 to slaves - 1 generate
    process is
      variable random : random_t;
    begin
      random.seed(seed + 1 + slave);
      loop
        from_slaves(slave)     <= wishbone_s2m_idle;
        from_slaves(slave).dat <= random.vector(32);
        wait until (rising_edge(clock) and to_slaves(slave).stb = '1') or done;
        exit when done;
        check_equal(to_slaves(slave).cyc, '1', "cyc with stb");
        wait_clocks(clock, random.integer_between(0, 5));
        from_slaves(slave).dat <= answer_of(
          slave, to_slaves(slave).we, unsigned(to_slaves(slave).adr), to_slaves(slave).dat);
        if unsigned(to_slaves(slave).adr) = 2 then
          from_slaves(slave).err <= '1';
        else
          from_slaves(slave).ack <= '1';
        end if;
        wait until rising_edge(clock);
      end loop;
      wait;
    end process;
  end generate;

  master : process is
    variable random  : random_t;
    variable address : unsigned(31 downto 0);
    variable data    : std_ulogic_vector(31 downto 0);
    variable we      : std_ulogic;
    variable answer  : bus_answer_t;
    variable asked   : integer; -- the slave, or -1
    variable hits    : natural := 0;
  begin
    random.seed(seed);
    wait until rising_edge(clock);
    reset <= '0';
    for count in 1 to 1500 loop
      if random.chance(75) then
        -- An address within, or just outside, one of them.
        asked   := random.integer_between(0, slaves - 1);
        address := address_map(asked).base + to_unsigned(random.integer_between(0, address_map(asked).words), 32);
        if random.chance(10) then
          address := address_map(asked).base - 1;
        end if;
      else
        address := unsigned(random.vector(32));
      end if;
      asked := -1;
      for slave in 0 to slaves - 1 loop
        if address >= address_map(slave).base and address - address_map(slave).base < address_map(slave).words then
          asked := slave;
        end if;
      end loop;

      we   := random.vector(1)(0);
      data := random.vector(32);
      bus_access(clock, m2s, s2m, we, address, data, answer, keep => random.chance(50));
      if asked < 0 then
        check(answer.refused, "an access that no slave has was answered");
        check_equal(answer.clocks, 1, "clocks of an access that no slave has");
      elsif address - address_map(asked).base = 2 then
        check(answer.refused, "the slave's err was lost");
      else
        hits := hits + 1;
        check(not answer.refused, "an access was refused");
        check_equal(answer.word, answer_of(asked, we, address - address_map(asked).base, data), "answer");
      end if;

      -- A held cyc reaches all slaves, and stb reaches none.
      wait for 0 ns;
      wait for 0 ns;
      for slave in 0 to slaves - 1 loop
        check_equal(to_slaves(slave).cyc, m2s.cyc, "cyc of a slave");
        check_equal(to_slaves(slave).stb, '0', "stb of a slave");
      end loop;
      wait until rising_edge(clock);
    end loop;
    check(hits > 400, "the bench met too few slaves");
    report_passed("wishbone_interconnect_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 50000, "wishbone_interconnect_tb");

end architecture;
