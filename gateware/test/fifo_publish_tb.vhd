-- SPDX-License-Identifier: BSD-3-Clause
--
-- The core with a fifo_slave at x40, whose event is the edge input of group 1. Words come at the clocks in words_file,
-- and requests at the clocks in requests_file. The bytes from the core go to answers_file, which
-- tests/gateware/test_fifo_publish.py checks.
--
-- Lines: CLOCK WORD in words_file, CLOCK BYTES in requests_file (both hexadecimal after the clock), CLOCK BYTE in
-- answers_file.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.textio.all;
  use work.address_map_pkg.all;
  use work.bench_pkg.all;
  use work.settings_pkg.all;
  use work.wishbone_pkg.all;

entity fifo_publish_tb is
  generic (
    words_file    : string;
    requests_file : string;
    answers_file  : string;
    last_clock    : positive;
    depth         : positive := 16;
    remind_clocks : positive := 20000;
    clock_hz      : positive := 1_000_000;
    publish_mode  : positive := 2
  );
end entity;

architecture test of fifo_publish_tb is

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean := false;
  signal now_clock : natural := 0;

  signal rx_valid, rx_ready, tx_valid : std_ulogic := '0';
  signal rx_data, tx_data             : std_ulogic_vector(7 downto 0) := x"00";
  signal events                       : std_ulogic_vector(1 downto 0) := "00";
  signal m2s                          : wishbone_m2s_t;
  signal s2m                          : wishbone_s2m_t;
  signal to_slaves                    : wishbone_m2s_vector_t(0 to 1);
  signal from_slaves                  : wishbone_s2m_vector_t(0 to 1);
  signal put_valid, put_ready         : std_ulogic := '0';
  signal put_data                     : std_ulogic_vector(31 downto 0) := (others => '0');

  procedure read_hex (variable from : inout line; result : out std_ulogic_vector) is
    variable gap : character;
  begin
    read(from, gap);
    hread(from, result);
  end procedure;

begin

  clock     <= not clock after 10 ns when not done;
  now_clock <= now_clock + 1 when rising_edge(clock) and reset = '0';

  core : entity work.core
    generic map (
      settings => core_settings(
        protocol => protocol_classic, clock_hz => clock_hz, groups => 2, group_size => 16, publish_mode => publish_mode,
        edge_events => (1 => '1', others => '0')))
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => '1', tx_data => tx_data,
      events => events, wishbone_m2s => m2s, wishbone_s2m => s2m);

  interconnect : entity work.wishbone_interconnect
    generic map (address_map => ((base => x"00000000", words => 16), (base => x"00000040", words => 3)))
    port map (master_m2s => m2s, master_s2m => s2m, slaves_m2s => to_slaves, slaves_s2m => from_slaves);

  memory : entity work.wishbone_memory
    generic map (words => 16)
    port map (clock => clock, reset => reset, wishbone_m2s => to_slaves(0), wishbone_s2m => from_slaves(0));

  fifo : entity work.fifo_slave
    generic map (depth => depth, remind_clocks => remind_clocks)
    port map (
      clock => clock, reset => reset, wishbone_m2s => to_slaves(1), wishbone_s2m => from_slaves(1),
      arrival => events(1), not_empty => open,
      to_pc_valid => put_valid, to_pc_ready => put_ready, to_pc_data => put_data,
      from_pc_valid => open, from_pc_ready => '0', from_pc_data => open);

  start : process is
  begin
    wait for 65 ns;
    reset <= '0';
    wait until rising_edge(clock) and now_clock = last_clock;
    report_passed("fifo_publish_tb");
    done <= true;
    wait;
  end process;

  putting : process is
    file words     : text open read_mode is words_file;
    variable entry : line;
    variable at    : natural;
    variable word  : std_ulogic_vector(31 downto 0);
  begin
    wait until reset = '0';
    while not endfile(words) loop
      readline(words, entry);
      read(entry, at);
      read_hex(entry, word);
      while now_clock < at loop
        wait until rising_edge(clock);
      end loop;
      send(clock, put_valid, put_ready, put_data, word);
    end loop;
    wait;
  end process;

  asking : process is
    file requests  : text open read_mode is requests_file;
    variable entry : line;
    variable at    : natural;
    variable byte  : std_ulogic_vector(7 downto 0);
    variable gap   : character;
  begin
    wait until reset = '0';
    while not endfile(requests) loop
      readline(requests, entry);
      read(entry, at);
      read(entry, gap);
      while now_clock < at loop
        wait until rising_edge(clock);
      end loop;
      while entry'length > 0 loop
        hread(entry, byte);
        send(clock, rx_valid, rx_ready, rx_data, byte);
      end loop;
    end loop;
    wait;
  end process;

  listening : process (clock) is
    file answers    : text open write_mode is answers_file;
    variable answer : line;
  begin
    if rising_edge(clock) and reset = '0' and tx_valid = '1' then
      write(answer, integer'image(now_clock) & " " & integer'image(to_integer(unsigned(tx_data))));
      writeline(answers, answer);
    end if;
  end process;

end architecture;
