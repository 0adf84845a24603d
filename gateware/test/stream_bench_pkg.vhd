-- SPDX-License-Identifier: BSD-3-Clause
--
-- The host's side of a core's byte streams as procedures: it sends a request and receives the reply, or exchanges bytes
-- as the master of SPI.

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

  -- Sends each byte of `data`, the leftmost first.
  procedure send_all (
    signal clock : in  std_ulogic;
    signal valid : out std_ulogic;
    signal ready : in  std_ulogic;
    signal lane  : out std_ulogic_vector(7 downto 0);
    data         : in  std_ulogic_vector
  );

  -- Waits until `counted`, for instance of frames, is at least `most`, and lets signals settle.
  procedure wait_count (signal clock : in std_ulogic; signal counted : in natural; most : in natural);

  -- Sends the first `bits` of `give`, and receives as many. The chip select is the caller's.
  procedure spi_exchange (
    signal sck  : out std_ulogic;
    signal mosi : out std_ulogic;
    signal miso : in  std_ulogic;
    half_bit    : in  time;
    give        : in  std_ulogic_vector(7 downto 0);
    take        : out std_ulogic_vector(7 downto 0);
    bits        : in  positive := 8
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
      send(clock, rx_valid, rx_ready, rx_data, byte_of(line(index)));
    end loop;
    for step in 1 to reply_clocks_most loop
      wait until rising_edge(clock);
      if tx_valid = '1' and tx_data = x"0A" then
        check(received(1 to length) = reply, request & ": received " & received(1 to length) & ", expected " & reply);
        return;
      elsif tx_valid = '1' then
        length           := length + 1;
        received(length) := character_of(tx_data);
      end if;
    end loop;
    report request & " was not answered" severity failure;
  end procedure;

  procedure send_all (
    signal clock : in  std_ulogic;
    signal valid : out std_ulogic;
    signal ready : in  std_ulogic;
    signal lane  : out std_ulogic_vector(7 downto 0);
    data         : in  std_ulogic_vector
  ) is
    constant bytes : std_ulogic_vector(0 to data'length - 1) := data;
  begin
    for index in 0 to data'length / 8 - 1 loop
      send(clock, valid, ready, lane, bytes(8 * index to 8 * index + 7));
    end loop;
  end procedure;

  procedure wait_count (signal clock : in std_ulogic; signal counted : in natural; most : in natural) is
  begin
    while counted < most loop
      wait until rising_edge(clock);
    end loop;
    wait for 1 ns;
  end procedure;

  procedure spi_exchange (
    signal sck  : out std_ulogic;
    signal mosi : out std_ulogic;
    signal miso : in  std_ulogic;
    half_bit    : in  time;
    give        : in  std_ulogic_vector(7 downto 0);
    take        : out std_ulogic_vector(7 downto 0);
    bits        : in  positive := 8
  ) is
  begin
    for index in 7 downto 8 - bits loop
      mosi <= give(index);
      wait for half_bit;
      sck         <= '1';
      take(index) := miso;
      wait for half_bit;
      sck <= '0';
    end loop;
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
