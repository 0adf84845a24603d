-- SPDX-License-Identifier: BSD-3-Clause
--
-- An MPU-6050 on the lines of i2c_device, for benches. It checks the times of fast mode, at 400 kHz.
--
-- Ports     plugged 0: it is not there. hung 1: it holds sda low until scl has risen five times. stretch: for so long
--           it holds scl low before it acknowledges its address. truth: acceleration x, y, z, temperature and turn x,
--           y, z, of 16 bits. It shows in the registers 3B to 48 while the device is awake. starts, stops: what it has
--           seen.
-- Errors    While it is not hung, an assertion fails if scl is low for less than 1.3 us or high for less than 0.6 us,
--           if the bus is free for less than 1.3 us, if sda is not stable for 100 ns before scl rises, and if a frame
--           starts again or stops inside a byte.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity i2c_device_mpu6050_model is
  port (
    plugged : in    std_ulogic;
    hung    : in    std_ulogic;
    stretch : in    time;
    truth   : in    std_ulogic_vector(111 downto 0);
    scl     : inout std_logic := 'Z';
    sda     : inout std_logic := 'Z';
    starts  : out   natural := 0;
    stops   : out   natural := 0
  );
end entity;

architecture simulation of i2c_device_mpu6050_model is

  subtype byte_t is std_ulogic_vector(7 downto 0);
  type registers_t is array (0 to 127) of byte_t;

  constant after_reset : registers_t := (16#6B# => x"40", 16#75# => x"68", others => x"00");

  signal clock, data : std_ulogic;

begin

  clock <= to_x01(scl);
  data  <= to_x01(sda);

  process is
    variable registers : registers_t := after_reset;
    variable bits      : natural := 0;       -- of the frame, nine for each byte
    variable shifted   : byte_t;
    variable byte      : byte_t;
    variable index     : natural range 0 to 127 := 0;
    variable inside, reads, mine, numbered : boolean := false;
    variable rose, fell, changed, freed : time := -1 sec;
    variable pulses    : natural := 0;
    variable count_starts, count_stops : natural := 0;

    impure function value return byte_t is
      variable place : natural range 0 to 13;
    begin
      if index >= 16#3B# and index <= 16#48# and registers(16#6B#)(6) = '0' then
        place := 16#48# - index;
        return truth(8 * place + 7 downto 8 * place);
      end if;
      return registers(index);
    end function;

  begin
    wait on clock, data, hung, plugged;
    if hung'event and hung = '1' then
      sda    <= '0';
      pulses := 0;
      inside := false;
    end if;
    if plugged = '0' then
      registers := after_reset;
      inside    := false;
    end if;

    if data'event and clock = '1' and not clock'event then
      if data = '0' then
        if inside then
          assert bits mod 9 = 1 or not mine report "a repeated start inside a byte" severity error;
        else
          assert now - freed >= 1.3 us report "a start too early" severity error;
        end if;
        inside       := plugged = '1' and hung = '0';
        bits         := 0;
        mine         := false;
        numbered     := false;
        count_starts := count_starts + 1;
      elsif inside then
        assert bits mod 9 = 1 or not mine report "a stop inside a byte" severity error;
        inside      := false;
        freed       := now;
        count_stops := count_stops + 1;
      end if;
    end if;

    if rising_edge(clock) and now > 1 us then
      assert hung = '1' or now - fell >= 1.3 us report "scl was low too shortly" severity error;
      assert hung = '1' or now - changed >= 100 ns report "sda changed too late" severity error;
      rose   := now;
      pulses := pulses + 1;
      if hung = '1' and pulses >= 5 then
        sda <= 'Z' after 300 ns;
      end if;
      if inside then
        bits := bits + 1;
        if bits mod 9 /= 0 then
          shifted := shifted(6 downto 0) & data;
        elsif mine and reads and data = '1' and bits > 9 then
          mine := false; -- not acknowledged: the last byte
        end if;
        if bits = 8 then
          mine  := shifted(7 downto 1) = 7x"68";
          reads := shifted(0) = '1';
        elsif bits mod 9 = 8 and mine and not reads then
          if numbered then
            registers(index) := shifted;
            if index = 16#6B# and shifted(7) = '1' then
              registers := after_reset;
            end if;
            index := (index + 1) mod 128;
          else
            index    := to_integer(unsigned(shifted(6 downto 0)));
            numbered := true;
          end if;
        end if;
      end if;
    elsif falling_edge(clock) then
      assert hung = '1' or now - rose >= 0.6 us report "scl was high too shortly" severity error;
      fell := now;
      if inside and mine then
        if bits = 8 then
          sda <= '0' after 200 ns;
          if stretch > 0 ns then
            scl <= '0', 'Z' after stretch;
            fell := now + stretch - 1.3 us;
          end if;
        elsif bits mod 9 = 8 and not reads then
          sda <= '0' after 200 ns;
        elsif reads and bits mod 9 /= 8 then
          byte := value;
          sda <= 'Z' after 200 ns;
          if byte(7 - bits mod 9) = '0' then
            sda <= '0' after 200 ns;
          end if;
          if bits mod 9 = 7 then
            index := (index + 1) mod 128;
          end if;
        else
          sda <= 'Z' after 200 ns;
        end if;
      elsif hung = '0' then
        sda <= 'Z' after 200 ns;
      end if;
    end if;
    if data'event then
      changed := now;
    end if;
    starts <= count_starts;
    stops  <= count_stops;
  end process;

end architecture;
