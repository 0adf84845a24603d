-- SPDX-License-Identifier: BSD-3-Clause
--
-- Slaves of Unity-Link for a LiteX SoC, with the plain ports that LiteX connects: 8 pins, whose changes interrupt.
--
--   word 0 to 5   gpio               word 8, 9   interrupt_slave: bit 0 is a change of a watched pin
--
-- `adr` is the address on LiteX's bus, which begins with that of the region. The region has 1024 words, so the lowest
-- ten bits are the word. Latency, errors: those of the slaves. Put further slaves into the address map.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.address_map_pkg.all;
  use unitylink.wishbone_pkg.all;

entity litex_registers is
  port (
    clock     : in  std_ulogic;
    reset     : in  std_ulogic;
    cyc       : in  std_ulogic;
    stb       : in  std_ulogic;
    we        : in  std_ulogic;
    adr       : in  std_ulogic_vector(29 downto 0);
    dat_w     : in  std_ulogic_vector(31 downto 0);
    sel       : in  std_ulogic_vector(3 downto 0);
    dat_r     : out std_ulogic_vector(31 downto 0);
    ack       : out std_ulogic;
    err       : out std_ulogic;
    interrupt : out std_ulogic;

    pin_in    : in  std_ulogic_vector(7 downto 0);
    pin_out   : out std_ulogic_vector(7 downto 0);
    pin_drive : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of litex_registers is

  constant address_map : address_map_t(0 to 1) := (
    0 => (base => x"00000000", words => 8),
    1 => (base => x"00000008", words => 2));

  signal master_m2s : wishbone_m2s_t;
  signal master_s2m : wishbone_s2m_t;
  signal slaves_m2s : wishbone_m2s_vector_t(0 to 1);
  signal slaves_s2m : wishbone_s2m_vector_t(0 to 1);
  signal gpio_s2m   : wishbone_s2m_t;
  signal irq_s2m    : wishbone_s2m_t;
  signal events     : std_ulogic_vector(0 downto 0);

begin

  master_m2s <= (cyc => cyc, stb => stb, we => we, adr => 22x"0" & adr(9 downto 0), dat => dat_w, sel => sel);
  dat_r      <= master_s2m.dat;
  ack        <= master_s2m.ack;
  err        <= master_s2m.err;

  decode : entity unitylink.wishbone_interconnect
    generic map (address_map => address_map)
    port map (
      master_m2s => master_m2s, master_s2m => master_s2m, slaves_m2s => slaves_m2s, slaves_s2m => slaves_s2m);

  slaves_s2m <= (gpio_s2m, irq_s2m);

  pins : entity unitylink.gpio
    port map (
      clock => clock, reset => reset, wishbone_m2s => slaves_m2s(0), wishbone_s2m => gpio_s2m, changed => events(0),
      pin_in => pin_in, pin_out => pin_out, pin_drive => pin_drive);

  interrupts : entity unitylink.interrupt_slave
    generic map (lines => 1)
    port map (
      clock => clock, reset => reset, wishbone_m2s => slaves_m2s(1), wishbone_s2m => irq_s2m, events => events,
      interrupt => interrupt);

end architecture;
