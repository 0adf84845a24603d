-- SPDX-License-Identifier: BSD-3-Clause
--
-- core: a reset at every clock while a message comes in, is executed and answered. Each time the core is quiet
-- afterwards. Then it answers a read correctly, with no subscription and no publishing left.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.settings_pkg.all;
use work.wishbone_pkg.all;

entity reset_tb is
  generic (
    message  : string := "23523a31320a";  -- bytes in hex
    datalink : string := "full"
  );
end entity;

architecture bench of reset_tb is

  constant size : positive := message'length / 2;

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal ended        : boolean := false;
  signal rx_valid     : std_ulogic := '0';
  signal rx_ready     : std_ulogic;
  signal rx_data      : std_ulogic_vector(7 downto 0) := x"00";
  signal tx_valid     : std_ulogic;
  signal tx_data      : std_ulogic_vector(7 downto 0);
  signal wishbone_m2s : wishbone_m2s_t;
  signal wishbone_s2m : wishbone_s2m_t;
  signal heard        : string(1 to 300);
  signal length       : natural := 0;
  signal clear        : boolean := false;

  function byte(text : string; place : positive) return std_ulogic_vector is
    constant high : positive := text'low + 2 * place - 2;
  begin
    return std_ulogic_vector(to_unsigned(16 * digit_value(text(high)) + digit_value(text(high + 1)), 8));
  end function;

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.core
    generic map (
      settings => core_settings(
        -- Publishes come before the last reset.
        protocol => protocol_classic, base_hz => 400_000, groups => 2, group_size => 16,
        datalink => datalink_of(datalink)))
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => '1', tx_data => tx_data,
      wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

  memory : entity work.bench_memory
    generic map (address_width => 8, data_width => 32)
    port map (clock => clock, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

  listen : process (clock)
  begin
    if rising_edge(clock) then
      if clear then
        length <= 0;
      elsif tx_valid = '1' and reset = '0' then
        heard(length + 1) <= character_of(tx_data);
        length <= length + 1;
      end if;
    end if;
  end process;

  play : process

    procedure ask(text : string; reply : string) is
    begin
      clear <= true;
      wait_clocks(clock, 1);
      clear <= false;
      for place in text'range loop
        send(clock, rx_valid, rx_ready, rx_data, byte_of(text(place)));
      end loop;
      wait_clocks(clock, 45);
      assert heard(1 to length) = reply
        report "after a reset: " & heard(1 to length) & " instead of " & reply severity failure;
    end procedure;

  begin
    wait_clocks(clock, 3);
    for moment in 1 to size + 160 loop
      reset <= '0';
      wait_clocks(clock, 1);
      for c in 1 to moment loop
        if c <= size then
          rx_valid <= '1';
          rx_data  <= byte(message, c);
        else
          rx_valid <= '0';
        end if;
        wait until rising_edge(clock);
      end loop;
      rx_valid <= '0';
      reset <= '1';
      clear <= true;
      wait_clocks(clock, 1);
      reset <= '0';
      clear <= false;
      wait_clocks(clock, 5);
      check_equal(length, 0, "bytes after a reset at clock " & integer'image(moment));
      check_equal(wishbone_m2s.cyc, '0', "bus cycle after a reset");
      if datalink = "none" then
        ask("#R:4" & LF, "#S_R:" & character'val(16#40#) & character'val(16#DE#) & "44" & LF);
        ask("#RSI:" & NUL & LF, "#S_RSI:" & NUL & NUL & NUL & LF);
      else
        ask("#R:34" & LF, "#S_R:40de3434" & LF);
        ask("#RSI:00" & LF, "#S_RSI:000000" & LF);
      end if;
      reset <= '1';
      wait_clocks(clock, 1);
    end loop;
    report_passed("reset_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "reset_tb");

end architecture;
