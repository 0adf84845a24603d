-- SPDX-License-Identifier: BSD-3-Clause
--
-- The check of a packet of servo_bus_pkg: the CRC-16 of Dynamixel, low byte first, or the byte of Feetech.
--
--   begins: the byte in this clock is the last one of the header. takes: `data` is a byte behind it.
--
-- Latency   A byte takes 8 clocks with Dynamixel, in which `busy` is high, and one with Feetech.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.servo_bus_pkg.all;

entity servo_bus_check is
  generic (
    feetech : boolean
  );
  port (
    clock  : in  std_ulogic;
    begins : in  std_ulogic;
    takes  : in  std_ulogic;
    data   : in  byte_t;
    busy   : out std_ulogic;
    check  : out std_ulogic_vector(15 downto 0)
  );
end entity;

architecture rtl of servo_bus_check is
begin

  sums : if feetech generate
    signal sum : unsigned(7 downto 0) := (others => '0');
  begin
    busy  <= '0';
    check <= x"00" & not std_ulogic_vector(sum);

    process (clock) is
    begin
      if rising_edge(clock) then
        if begins = '1' then
          sum <= (others => '0');
        elsif takes = '1' then
          sum <= sum + unsigned(data);
        end if;
      end if;
    end process;
  end generate;

  divides : if not feetech generate
    signal shift : byte_t := (others => '0');
    signal left  : unsigned(3 downto 0) := (others => '0'); -- bits of the byte
    signal crc   : std_ulogic_vector(15 downto 0) := (others => '0');
  begin
    busy  <= or left;
    check <= crc;

    process (clock) is
    begin
      if rising_edge(clock) then
        if begins = '1' then
          crc  <= header_check;
          left <= (others => '0');
        elsif takes = '1' then
          shift <= data;
          left  <= to_unsigned(8, left'length);
        elsif left /= 0 then
          crc   <= check_with(crc, shift(7));
          shift <= shift(6 downto 0) & '0';
          left  <= left - 1;
        end if;
      end if;
    end process;
  end generate;

end architecture;
