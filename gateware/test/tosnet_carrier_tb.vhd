-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_carrier between words and a bus of registers: what is written when, what is read, a register that refuses,
-- and the clocks that its header promises.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_carrier_tb is
end entity;

architecture test of tosnet_carrier_tb is

  constant clock_period : time     := 20 ns;
  constant refusing     : natural  := 31; -- the register that answers err
  constant reads        : positive := 3;
  constant writes       : positive := 4;

  signal clock    : std_ulogic := '0';
  signal reset    : std_ulogic := '1';
  signal done     : boolean    := false;
  signal running  : std_ulogic := '0';
  signal exchange : std_ulogic := '0';

  -- Two constants, two words of the ring.
  signal given  : word_vector_t(0 to writes - 1) := (x"00000A00", x"00000A01", x"00000B00", x"00000B01");
  signal taken  : word_vector_t(0 to reads - 1);
  signal m2s    : wishbone_m2s_t;
  signal s2m    : wishbone_s2m_t := wishbone_s2m_idle;

  signal registers : word_vector_t(0 to 31) := (9 => x"00000009", 10 => x"0000000A", others => (others => '0'));
  signal frozen    : word_vector_t(0 to 31) := (others => (others => '0')); -- as they were before cyc rose
  signal counted   : integer_vector(0 to 31) := (others => 0);              -- writes so far
  signal steps     : natural := 0;                                          -- added to the registers 9 and 10

begin

  clock <= not clock after clock_period / 2 when not done;
  watchdog(done, 100 us, "tosnet_carrier_tb");

  dut : entity work.tosnet_carrier
    generic map (
      write_addresses => (0 => 1, 1 => 2, 2 => 3, 3 => 4), read_addresses => (0 => 9, 1 => refusing, 2 => 10),
      constants => 2)
    port map (
      clock => clock, reset => reset, running => running, exchange => exchange, write_words => given,
      read_words => taken, wishbone_m2s => m2s, wishbone_s2m => s2m);

  -- Registers that keep one moment in a block. Two of them change in each clock.
  slave : process (clock) is
    variable place : natural range 0 to 31;
    variable asked : std_ulogic;
    variable last  : wishbone_m2s_t := wishbone_m2s_idle; -- an access that waits for its answer
  begin
    if rising_edge(clock) then
      place := to_integer(unsigned(m2s.adr(4 downto 0)));
      asked := m2s.cyc and m2s.stb and not s2m.ack and not s2m.err;
      steps <= steps + 1;
      check(last.stb = '0' or reset = '1' or m2s = last, "an access changed before its answer");
      last     := m2s;
      last.stb := asked;
      if m2s.cyc = '0' then
        frozen     <= registers;
        frozen(9)  <= std_ulogic_vector(to_unsigned(9 + steps, 32));
        frozen(10) <= std_ulogic_vector(to_unsigned(10 + steps, 32));
      end if;
      s2m.ack <= '0';
      s2m.err <= '0';
      s2m.dat <= (others => '1');
      if asked = '1' then
        s2m.ack <= '0' when place = refusing else '1';
        s2m.err <= '1' when place = refusing else '0';
        if m2s.we = '1' then
          registers(place) <= m2s.dat;
          counted(place)   <= counted(place) + 1;
        elsif place /= refusing then
          s2m.dat <= frozen(place);
        end if;
      end if;
    end if;
  end process;

  process is

    -- The longest way of a new word: the block under way, and the block of writes. One more to look.
    constant written_clocks : positive := 2 * (reads + writes) + 1 + 1;

    procedure expect_writes (constants, words : natural; what : string) is
    begin
      for place in 1 to 2 loop
        check(counted(place) = constants, what & ": constant " & to_string(place) & " was written " &
              to_string(counted(place)) & " times, not " & to_string(constants));
      end loop;
      for place in 3 to 4 loop
        check(counted(place) = words, what & ": word " & to_string(place) & " was written " &
              to_string(counted(place)) & " times, not " & to_string(words));
      end loop;
      for place in given'range loop
        check(registers(place + 1) = given(place), what & ": register " & to_string(place + 1));
      end loop;
    end procedure;

    variable before, now : natural;

  begin
    wait_clocks(clock, 4);
    reset <= '0';
    wait_clocks(clock, written_clocks);
    expect_writes(1, 1, "after a reset");

    wait_clocks(clock, 2 * reads + 1); -- the first block of reads

    -- One moment, in all blocks, and nothing of a register that refuses.
    for turn in 1 to 10 loop
      before := to_integer(unsigned(taken(0)));
      wait_clocks(clock, 2 * reads + 1);
      now := to_integer(unsigned(taken(0)));
      check(now = before + 2 * reads + 1, "a block took " & to_string(now - before) & " clocks");
      check(unsigned(taken(2)) = now + 1, "two registers of two moments");
      check(taken(1) = x"00000000", "a refused read");
    end loop;

    -- The ring's words with each exchange, whenever it comes; the constants only with a change of `running`.
    for turn in 1 to 20 loop
      wait_clocks(clock, turn);
      given(2) <= std_ulogic_vector(to_unsigned(100 * turn, 32));
      given(3) <= std_ulogic_vector(to_unsigned(100 * turn + 1, 32));
      exchange <= '1';
      wait_clocks(clock, 1);
      exchange <= '0';
      wait_clocks(clock, written_clocks);
      expect_writes(1, 1 + turn, "exchange");
    end loop;
    for turn in 1 to 20 loop
      wait_clocks(clock, turn);
      running <= not running;
      given(0) <= std_ulogic_vector(to_unsigned(7 * turn, 32));
      wait_clocks(clock, written_clocks);
      expect_writes(1 + turn, 21 + turn, "running");
    end loop;

    reset <= '1';
    wait_clocks(clock, 2);
    check(taken(0) = x"00000000" and m2s.cyc = '0', "a reset");
    done <= true;
    report_passed("tosnet_carrier_tb");
    wait;
  end process;

end architecture;
