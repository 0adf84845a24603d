-- SPDX-License-Identifier: BSD-3-Clause
--
-- core_bii with sixteen words directly on the bus-independent interface. A block is held from its first word to its
-- last, and each way in which an access can end has its reply.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bii_pkg.all;
  use work.settings_pkg.all;
  use work.stream_bench_pkg.all;

entity core_bii_tb is
end entity;

architecture test of core_bii_tb is

  constant clock_period : time := 20 ns;

  signal clock              : std_ulogic := '0';
  signal reset              : std_ulogic := '1';
  signal done               : boolean := false;
  signal rx_valid, rx_ready : std_ulogic := '0';
  signal tx_valid           : std_ulogic;
  signal rx_data, tx_data   : std_ulogic_vector(7 downto 0) := x"00";
  signal bii_request        : bii_request_t;
  signal bii_response       : bii_response_t := bii_response_idle;

  signal held   : std_ulogic_vector(1 to 16) := (others => '0'); -- block_hold at each access since the last check
  signal access_count : natural := 0;
  signal forget : boolean := false;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.core_bii
    generic map (settings => core_settings(protocol => protocol_classic))
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => '1', tx_data => tx_data,
      bii_request => bii_request, bii_response => bii_response);

  memory : process (clock) is
    type words_t is array (0 to 15) of std_ulogic_vector(31 downto 0);
    variable words   : words_t := (others => (others => '0'));
    variable address : natural range 0 to 255;
  begin
    if rising_edge(clock) then
      bii_response <= bii_response_idle;
      if forget then
        access_count <= 0;
      end if;
      if bii_request.valid = '1' and bii_response.done = '0' then
        address := to_integer(unsigned(bii_request.address(7 downto 0)));
        access_count           <= access_count + 1;
        held(access_count + 1) <= bii_request.block_hold;
        bii_response.done <= '1';
        if address < 16 then
          bii_response.data <= words(address);
          if bii_request.write = '1' then
            words(address) := bii_request.data;
          end if;
        elsif address < 32 then
          bii_response.status <= error;
        else
          bii_response.status <= silent;
        end if;
      end if;
    end if;
  end process;

  play : process is

    procedure ask (request : string; reply : string) is
    begin
      forget <= true;
      wait until rising_edge(clock);
      forget <= false;
      ask(clock, rx_valid, rx_ready, rx_data, tx_valid, tx_data, request, reply);
    end procedure;

  begin
    wait_clocks(clock, 3);
    reset <= '0';
    ask("#W:0312345678", "#S_W");
    ask("#R:03", "#S_R:12345678");
    check_equal(access_count, 1, "accesses of a read");
    check_equal(held(1), '0', "a block of a single word");
    ask("#RM:03030403", "#S_RM:123456780000000012345678");
    check_equal(access_count, 3, "accesses of a read-many");
    check_equal(held(1 to 3), std_ulogic_vector'("111"), "a block from its first word to its last");
    check_equal(bii_request.block_hold, '0', "a block after its last word");
    ask("#R:10", "#?E_FBR");
    ask("#W:1000000000", "#?E_FBW");
    ask("#R:20", "#?E_BAT");
    ask("#RM:020310", "#S_RM:12345678?E_FBR");
    check_equal(bii_request.block_hold, '0', "a block after an error");
    report_passed("core_bii_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * 20000, "core_bii_tb");

end architecture;
