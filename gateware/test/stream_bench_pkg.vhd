-- SPDX-License-Identifier: BSD-3-Clause
--
-- The host's side of a core's byte streams as a procedure: it sends a request, and receives the reply.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

package stream_bench_pkg is

  constant reply_clocks_most : positive := 5000;

  -- Sends `request` and a line feed, and checks that the received line is `reply`. tx_ready must be high all the time.
  procedure ask (
    signal clock    : in  std_ulogic;
    signal rx_valid : out std_ulogic;
    signal rx_ready : in  std_ulogic;
    signal rx_data  : out std_ulogic_vector(7 downto 0);
    signal tx_valid : in  std_ulogic;
    signal tx_data  : in  std_ulogic_vector(7 downto 0);
    request         : in  string;
    reply           : in  string
  );

  -- In lower case, as the gateware sends it.
  function digits (word : std_ulogic_vector) return string;

end package;

package body stream_bench_pkg is

  procedure ask (
    signal clock    : in  std_ulogic;
    signal rx_valid : out std_ulogic;
    signal rx_ready : in  std_ulogic;
    signal rx_data  : out std_ulogic_vector(7 downto 0);
    signal tx_valid : in  std_ulogic;
    signal tx_data  : in  std_ulogic_vector(7 downto 0);
    request         : in  string;
    reply           : in  string
  ) is
    constant line     : string(1 to request'length + 1) := request & LF;
    variable received : string(1 to 1000);
    variable length   : natural := 0;
  begin
    for index in line'range loop
      rx_valid <= '1';
      rx_data  <= std_ulogic_vector(to_unsigned(character'pos(line(index)), 8));
      wait until rising_edge(clock) and rx_ready = '1';
    end loop;
    rx_valid <= '0';
    for step in 1 to reply_clocks_most loop
      wait until rising_edge(clock);
      if tx_valid = '1' and tx_data = x"0A" then
        check(received(1 to length) = reply, request & ": received " & received(1 to length) & ", expected " & reply);
        return;
      elsif tx_valid = '1' then
        length           := length + 1;
        received(length) := character'val(to_integer(unsigned(tx_data)));
      end if;
    end loop;
    report request & " was not answered" severity failure;
  end procedure;

  function digits (word : std_ulogic_vector) return string is
    constant upper  : string := to_hstring(word);
    variable result : string(upper'range);
  begin
    for index in upper'range loop
      result(index) := upper(index);
      if upper(index) >= 'A' then
        result(index) := character'val(character'pos(upper(index)) + 32);
      end if;
    end loop;
    return result;
  end function;

end package body;
