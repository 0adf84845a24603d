-- SPDX-License-Identifier: BSD-3-Clause
--
-- wishbone_memory: written words are read back, all others are zero, an address beyond the end is refused, one answer
-- per access.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.wishbone_pkg.all;

entity wishbone_memory_tb is
  generic (
    words      : positive := 24;
    data_width : positive := 32
  );
end entity;

architecture bench of wishbone_memory_tb is

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal ended        : boolean := false;
  signal wishbone_m2s : wishbone_m2s_t := wishbone_m2s_idle;
  signal wishbone_s2m : wishbone_s2m_t;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.wishbone_memory
    generic map (words => words, data_width => data_width)
    port map (clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

  play : process
    type model_t is array (0 to words - 1) of std_ulogic_vector(31 downto 0);
    variable model  : model_t := (others => (others => '0'));
    variable random : random_t;
    variable index  : natural;
    variable value  : std_ulogic_vector(31 downto 0);
    variable got    : std_ulogic_vector(31 downto 0);

    procedure access_word(address : std_ulogic_vector(31 downto 0); we : std_ulogic; inside : boolean) is
    begin
      wishbone_m2s <= (cyc => '1', stb => '1', we => we, adr => address, dat => value, sel => "1111");
      wait for 1 ps;
      check_equal(wishbone_s2m.ack or wishbone_s2m.err, '0', "answer in the first clock");
      tick(clock);
      got := wishbone_s2m.dat;
      if inside then
        check_equal(wishbone_s2m.ack, '1', "acknowledge");
        check_equal(wishbone_s2m.err, '0', "refusal");
      else
        check_equal(wishbone_s2m.ack, '0', "acknowledge beyond the end");
        check_equal(wishbone_s2m.err, '1', "refusal beyond the end");
      end if;
      tick(clock);
      wishbone_m2s.stb <= '0';
      wait for 1 ps;
      check_equal(wishbone_s2m.ack or wishbone_s2m.err, '0', "a second answer");
    end procedure;

  begin
    random.seed(9);
    tick(clock, 2);
    reset <= '0';
    for number in 1 to 400 loop
      index := random.integer_between(0, words - 1);
      value := random.vector(32);
      if random.chance(50) then
        access_word(std_ulogic_vector(to_unsigned(index, 32)), '1', true);
        model(index)(data_width - 1 downto 0) := value(data_width - 1 downto 0);
      else
        access_word(std_ulogic_vector(to_unsigned(index, 32)), '0', true);
        check_equal(got, model(index), "word " & integer'image(index));
      end if;
    end loop;
    value := x"FFFFFFFF";
    access_word(std_ulogic_vector(to_unsigned(words, 32)), '1', false);
    access_word(x"80000000", '1', false);
    access_word(x"FFFFFFFF", '0', false);
    for word in model'range loop
      access_word(std_ulogic_vector(to_unsigned(word, 32)), '0', true);
      check_equal(got, model(word), "word after refusals");
    end loop;
    report_passed("wishbone_memory_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "wishbone_memory_tb");

end architecture;
