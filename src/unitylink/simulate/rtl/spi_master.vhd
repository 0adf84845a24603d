-- SPDX-License-Identifier: BSD-3-Clause
--
-- The SPI port of a PC for compiled gateware, mode 0: clocks each byte of `out` and gives the one that came for it to
-- `in`.
--
--   out --> cs_n, sck, mosi --> FPGA
--   in  <-- miso <------------- FPGA
--
-- Transfer  cs_n is low from a byte to `pause` clocks without another one: bytes that follow each other are one
--           transfer.
-- Rate      sck is half the clock; 18 clocks a byte. gateware/test/spi_slave_tb.vhd is the one that tries rates and
--           breaks.

library ieee;
  use ieee.std_logic_1164.all;

entity spi_master is
  generic (
    pause : positive := 32
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic;

    sck  : out std_ulogic;
    cs_n : out std_ulogic;
    mosi : out std_ulogic;
    miso : in  std_ulogic;

    out_valid : in  std_ulogic;
    out_ready : out std_ulogic;
    out_data  : in  std_ulogic_vector(7 downto 0);
    in_valid  : out std_ulogic;
    in_ready  : in  std_ulogic;
    in_data   : out std_ulogic_vector(7 downto 0)
  );
end entity;

architecture rtl of spi_master is

  signal bits     : natural range 0 to 8     := 0; -- still to be clocked
  signal idle     : natural range 0 to pause := pause;
  signal clocked  : std_ulogic := '0';
  signal selected : std_ulogic := '0';
  signal has      : std_ulogic := '0';
  signal shift    : std_ulogic_vector(7 downto 0) := (others => '0');
  signal came     : std_ulogic_vector(7 downto 0) := (others => '0');
  signal take     : std_ulogic;

begin

  sck       <= clocked;
  cs_n      <= not selected;
  mosi      <= shift(7);
  take      <= '1' when selected = '1' and bits = 0 and has = '0' and out_valid = '1' else '0';
  out_ready <= take;
  in_valid  <= has;
  in_data   <= came;

  process (clock) is
  begin
    if rising_edge(clock) then
      if has = '1' and in_ready = '1' then
        has <= '0';
      end if;

      if bits > 0 then
        clocked <= not clocked;
        if clocked = '0' then
          came <= came(6 downto 0) & miso;
        else
          shift <= shift(6 downto 0) & '0';
          bits  <= bits - 1;
          if bits = 1 then
            has <= '1';
          end if;
        end if;
      elsif take = '1' then
        shift <= out_data;
        bits  <= 8;
        idle  <= 0;
      elsif out_valid = '1' then
        selected <= '1';
      elsif idle < pause then
        idle <= idle + 1;
      else
        selected <= '0';
      end if;

      if reset = '1' then
        bits     <= 0;
        clocked  <= '0';
        selected <= '0';
        has      <= '0';
        idle     <= pause;
      end if;
    end if;
  end process;

end architecture;
