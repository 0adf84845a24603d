-- SPDX-License-Identifier: BSD-3-Clause
--
-- Drives lockstep_design from a file, clock by clock, through registers as in the compiled model. It writes down all
-- outputs of the design. A file has one line per clock, and the other simulator must write the same file.
--
-- Stimulus  RESET RX_VALID RX_DATA RX_ERROR TX_READY EVENTS WORD VALUE, all decimal. They apply from the next clock on,
--           but the word applies at once. A byte stays on offer until the next line, taken or not.
-- Response  RX_READY TX_VALID TX_DATA W0 .. W7, in the clock that has begun. TX_DATA is 0 while TX_VALID is 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use std.textio.all;

entity lockstep_tb is
  generic (
    stimulus_file : string;
    response_file : string;
    address_width : positive := 8;
    data_width    : positive := 32;
    base_hz       : positive := 50_000;
    groups        : positive := 2;
    group_size    : positive := 16;
    rate_bytes    : positive := 2;
    read_many     : natural  := 32;
    publish_mode  : natural  := 2;
    datalink      : string   := "full";
    checksum      : string   := "crc8";
    protocol      : string   := "classic"
  );
end entity;

architecture bench of lockstep_tb is

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic := '0';
  signal rx_valid    : std_ulogic := '0';
  signal rx_ready    : std_ulogic;
  signal rx_data     : std_ulogic_vector(7 downto 0) := x"00";
  signal rx_error    : std_ulogic_vector(2 downto 0) := "000";
  signal tx_valid    : std_ulogic;
  signal tx_ready    : std_ulogic := '0';
  signal tx_data     : std_ulogic_vector(7 downto 0);
  signal events      : std_ulogic_vector(groups - 1 downto 0) := (others => '0');
  signal read_words  : std_ulogic_vector(8 * 32 - 1 downto 0) := (others => '0');
  signal write_words : std_ulogic_vector(8 * 32 - 1 downto 0);

begin

  design : entity work.lockstep_design
    generic map (
      address_width => address_width, data_width => data_width, base_hz => base_hz, groups => groups,
      group_size => group_size, rate_bytes => rate_bytes, read_many => read_many, publish_mode => publish_mode,
      datalink => datalink, checksum => checksum, protocol => protocol)
    port map (
      clock => clock, reset => reset,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, events => events,
      read_words => read_words, write_words => write_words);

  play : process
    file stimuli  : text open read_mode is stimulus_file;
    file answers  : text open write_mode is response_file;
    variable step   : line;
    variable answer : line;
    type numbers_t is array (0 to 7) of integer;
    variable number : numbers_t;

    impure function bits(index : natural; width : positive) return std_ulogic_vector is
    begin
      return std_ulogic_vector(to_unsigned(number(index), width));
    end function;
  begin
    while not endfile(stimuli) loop
      readline(stimuli, step);
      for index in number'range loop
        read(step, number(index));
      end loop;
      read_words(32 * number(6) + 31 downto 32 * number(6)) <= bits(7, 32);
      wait for 1 ns;
      clock <= '1';
      wait for 0 ns;
      reset    <= bits(0, 1)(0);
      rx_valid <= bits(1, 1)(0);
      rx_data  <= bits(2, 8);
      rx_error <= bits(3, 3);
      tx_ready <= bits(4, 1)(0);
      events   <= bits(5, groups);
      wait for 1 ns;
      write(answer, std_ulogic'image(rx_ready)(2) & ' ' & std_ulogic'image(tx_valid)(2) & ' ');
      if tx_valid = '1' then
        write(answer, to_integer(unsigned(tx_data)));
      else
        write(answer, 0);
      end if;
      for index in 0 to 7 loop
        write(answer, ' ' & to_hstring(write_words(32 * index + 31 downto 32 * index)));
      end loop;
      writeline(answers, answer);
      clock <= '0';
    end loop;
    report "lockstep_tb: passed" severity note;
    wait;
  end process;

end architecture;
