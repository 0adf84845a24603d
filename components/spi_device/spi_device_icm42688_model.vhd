-- SPDX-License-Identifier: BSD-3-Clause
--
-- An ICM-42688-P at the pins of spi_device, for benches: its registers of bank 0 in modes 0 and 3.
--
-- Ports     plugged 0: it is not there, and miso is high. truth: temperature, acceleration x, y, z and turn x, y, z, of
--           16 bits. It shows in the registers 1D to 2A while both sensors are on, else they have their reset values.
--           frames: how often it was selected.
-- Errors    An assertion fails if sclk is faster than 24 MHz, if it has an edge while select_n is high, if a frame ends
--           inside a byte, and if a register is written within 200 us after the sensors were switched on, or within
--           1 ms after a reset.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity spi_device_icm42688_model is
  port (
    plugged  : in  std_ulogic;
    truth    : in  std_ulogic_vector(111 downto 0);
    select_n : in  std_ulogic;
    sclk     : in  std_ulogic;
    mosi     : in  std_ulogic;
    miso     : out std_ulogic := '1';
    frames   : out natural := 0
  );
end entity;

architecture simulation of spi_device_icm42688_model is

  subtype byte_t is std_ulogic_vector(7 downto 0);
  type registers_t is array (0 to 127) of byte_t;

  constant after_reset : registers_t := (16#4F# => x"06", 16#50# => x"06", 16#75# => x"47", others => x"00");

begin

  process is
    variable registers  : registers_t := after_reset;
    variable bits       : natural := 0;
    variable shifted    : byte_t;
    variable byte       : byte_t;
    variable reads      : boolean := false;
    variable index      : natural range 0 to 127 := 0;
    variable rose       : time := -1 sec;
    variable quiet_till : time := 0 sec;
    variable count      : natural := 0;

    impure function value return byte_t is
      variable place : natural range 0 to 13;
    begin
      if index >= 16#1D# and index <= 16#2A# then
        if registers(16#4E#)(3 downto 0) = x"F" then
          place := 16#2A# - index;
          return truth(8 * place + 7 downto 8 * place);
        end if;
        if index mod 2 = 1 then
          return x"80";
        end if;
        return x"00";
      end if;
      return registers(index);
    end function;

  begin
    wait on select_n, sclk, plugged;
    if plugged = '0' then
      registers := after_reset; -- it loses its power
      miso <= '1';
    elsif falling_edge(select_n) then
      bits  := 0;
      count := count + 1;
    elsif rising_edge(select_n) then
      assert bits mod 8 = 0 report "a frame ends inside a byte" severity error;
      miso <= '1' after 5 ns;
    elsif select_n = '1' then
      assert not sclk'event or bits = 0 or now < 1 us report "sclk without select_n" severity error;
    elsif rising_edge(sclk) then
      assert now - rose >= 41.6 ns report "sclk is faster than 24 MHz" severity error;
      rose    := now;
      shifted := shifted(6 downto 0) & mosi;
      bits    := bits + 1;
      if bits = 8 then
        reads := shifted(7) = '1';
        index := to_integer(unsigned(shifted(6 downto 0)));
      elsif bits mod 8 = 0 then
        if not reads then
          assert now >= quiet_till report "a register was written too early" severity error;
          registers(index) := shifted;
          if index = 16#11# and shifted(0) = '1' then
            registers  := after_reset;
            quiet_till := now + 1 ms;
          elsif index = 16#4E# and shifted(3 downto 0) = x"F" then
            quiet_till := now + 200 us;
          end if;
        end if;
        index := (index + 1) mod 128;
      end if;
    elsif falling_edge(sclk) and bits >= 8 and reads then
      byte := value;
      miso <= byte(7 - bits mod 8) after 20 ns;
    end if;
    frames <= count;
  end process;

end architecture;
