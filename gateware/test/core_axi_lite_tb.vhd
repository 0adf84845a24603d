-- SPDX-License-Identifier: BSD-3-Clause
--
-- core_axi_lite with a memory that delays all five channels: words, blocks, refusals, and a late answer that must not
-- be used.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.axi_lite_pkg.all;
  use work.bench_pkg.all;
  use work.settings_pkg.all;
  use work.stream_bench_pkg.all;

entity core_axi_lite_tb is
  generic (
    wait_clocks_most : natural  := 6;
    seed             : positive := 1
  );
end entity;

architecture test of core_axi_lite_tb is

  constant clock_period   : time     := 20 ns;
  constant timeout_clocks : positive := 60;

  signal clock              : std_ulogic := '0';
  signal reset              : std_ulogic := '1';
  signal done               : boolean := false;
  signal rx_valid, rx_ready : std_ulogic := '0';
  signal tx_valid           : std_ulogic;
  signal rx_data, tx_data   : std_ulogic_vector(7 downto 0) := x"00";
  signal axi_lite_m2s       : axi_lite_m2s_t;
  signal axi_lite_s2m       : axi_lite_s2m_t;
  signal hold               : std_ulogic;
  signal holds              : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.core_axi_lite
    generic map (settings => core_settings(protocol => protocol_classic, timeout_clocks => timeout_clocks))
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => '1', tx_data => tx_data,
      axi_lite_m2s => axi_lite_m2s, axi_lite_s2m => axi_lite_s2m, hold => hold);

  slave : entity work.axi_lite_bench_slave
    generic map (wait_clocks_most => wait_clocks_most, slow_clocks => 4 * timeout_clocks, seed => seed + 100)
    port map (
      clock => clock, reset => reset, axi_lite_m2s => axi_lite_m2s, axi_lite_s2m => axi_lite_s2m, executed => open);

  count : process (clock) is
    variable before : std_ulogic := '0';
  begin
    if rising_edge(clock) then
      if hold = '1' and before = '0' then
        holds <= holds + 1;
      end if;
      before := hold;
    end if;
  end process;

  play : process is

    variable random : random_t;

    procedure ask (request : string; reply : string) is
    begin
      ask(clock, rx_valid, rx_ready, rx_data, tx_valid, tx_data, request, reply);
    end procedure;

    type words_t is array (0 to 15) of std_ulogic_vector(31 downto 0);
    variable words        : words_t := (others => (others => '0'));
    variable here, there  : natural range 0 to 15;
    variable before       : natural;

    impure function hex (address : natural) return string is
    begin
      return digits(std_ulogic_vector(to_unsigned(address, 8)));
    end function;

  begin
    random.seed(seed);
    wait_clocks(clock, 3);
    reset <= '0';
    for turn in 1 to 60 loop
      here        := random.integer_between(0, 15);
      there       := random.integer_between(0, 15);
      words(here) := random.vector(32);
      ask("#W:" & hex(here) & digits(words(here)), "#S_W");
      before := holds;
      ask("#RM:03" & hex(there) & hex(here) & hex(there), "#S_RM:" & digits(words(there)) & digits(words(here))
                                                          & digits(words(there)));
      check_equal(holds, before + 1, "holds of a block");
      if turn mod 10 = 0 then
        ask("#R:E3", "#?E_FBR");
        ask("#W:E300000000", "#?E_FBW");
      end if;
      if turn mod 20 = 0 then
        -- Until the late answer has come, requests end like this one. After that they work again.
        ask("#R:F3", "#?E_BAT");
        ask("#R:" & hex(here), "#?E_BAT");
        wait_clocks(clock, 20 * timeout_clocks);
      end if;
      ask("#R:" & hex(there), "#S_R:" & digits(words(there)));
    end loop;
    report_passed("core_axi_lite_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 100000, "core_axi_lite_tb");

end architecture;
