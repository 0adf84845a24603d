-- SPDX-License-Identifier: BSD-3-Clause
--
-- sample_state: random tries, holds and voids, beside a model.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity sample_state_tb is
  generic (
    failures_most : positive := 3;
    seed          : positive := 1
  );
end entity;

architecture test of sample_state_tb is

  signal clock, reset, ended, hold, void : std_ulogic := '0';
  signal reason                          : std_ulogic_vector(2 downto 0) := "000";
  signal accept, sampled, failed, valid  : std_ulogic;
  signal word                            : std_ulogic_vector(15 downto 0);
  signal done                            : boolean := false;

begin

  clock <= not clock after 10 ns when not done;

  dut : entity work.sample_state
    generic map (failures_most => failures_most)
    port map (
      clock => clock, reset => reset, ended => ended, reason => reason, hold => hold, void => void, accept => accept,
      sampled => sampled, failed => failed, valid => valid, word => word);

  drive : process is
    variable random             : random_t;
    variable in_a_row, failures : natural := 0;
    variable is_valid           : std_ulogic := '0';
    variable last               : std_ulogic_vector(2 downto 0) := "000";
    variable takes, good, all_bad : boolean;
    variable longest            : natural := 0;
  begin
    random.seed(seed);
    reset <= '1';
    tick(clock, 2);
    reset <= '0';
    for number in 1 to 5000 loop
      all_bad := (number / 100) mod 3 = 0; -- long rows of failures
      if ended = '0' and random.chance(60) then
        ended  <= '1';
        reason <= random.vector(3);
        if random.chance(40) then
          reason <= "000";
        end if;
        if all_bad then
          reason <= "101";
        end if;
      end if;
      hold <= random.vector(1)(0);
      void <= '1' when random.chance(3) else '0';
      wait for 1 ns;
      takes := ended = '1' and hold = '0';
      good  := reason = "000";
      check((accept = '1') = takes, "a try is accepted unless it is held");
      if takes then
        last := reason;
        if good then
          in_a_row := 0;
          is_valid := '1';
        else
          in_a_row := in_a_row + 1;
          failures := failures + 1;
          if in_a_row >= failures_most then
            is_valid := '0';
          end if;
        end if;
        longest := maximum(longest, in_a_row);
      end if;
      if void = '1' then
        is_valid := '0';
      end if;
      tick(clock);
      check((sampled = '1') = (takes and good), "a sample has its event");
      check((failed = '1') = (takes and not good), "a failure has its event");
      check_equal(valid, is_valid, "valid");
      check_equal(word, is_valid & last & std_ulogic_vector(to_unsigned(minimum(in_a_row, 15), 4)) &
                  std_ulogic_vector(to_unsigned(failures mod 256, 8)), "the word");
      if takes then
        ended <= '0';
      end if;
      wait for 0 ns;
    end loop;
    check(longest > 15 and failures > 256, "rows were long, and failures have wrapped");
    reset <= '1';
    tick(clock);
    check_equal(word, x"0000", "the word behind a reset");
    report_passed("sample_state_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, 1 ms, "sample_state_tb");

end architecture;
