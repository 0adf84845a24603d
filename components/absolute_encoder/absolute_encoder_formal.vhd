-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the lines of absolute_encoder with SSI: 2 bits, half a period of 3 clocks, a pause of 10. The device
-- may answer anything, and a reading may be asked for and accepted at any clock.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity absolute_encoder_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    ask    : in std_ulogic;
    accept : in std_ulogic;
    miso   : in std_ulogic
  );
end entity;

architecture properties of absolute_encoder_formal is

  constant bits  : positive := 2;
  constant half  : positive := 3;
  constant pause : positive := 10;

  signal rests, ready, begins, ended : std_ulogic;
  signal sclk, select_n, mosi, warns : std_ulogic;
  signal reason  : std_ulogic_vector(1 downto 0);
  signal value   : unsigned(bits - 1 downto 0);
  signal began   : unsigned(31 downto 0);

  signal begun   : std_ulogic := '0';
  signal sclk_1  : std_ulogic := '1';
  signal reset_1 : std_ulogic := '1';
  signal lasted  : natural range 0 to pause := 0;     -- clocks since sclk changed
  signal falls   : natural range 0 to bits + 2 := 0;  -- of this frame

begin

  default clock is rising_edge(clk);

  begins <= ask and ready;

  dut : entity work.absolute_encoder_line
    generic map (clock_hz => 10_000_000, kind => 0, bits => bits, sclk_hz => 2_000_000, pause_us => 1)
    port map (
      clock => clk, reset => reset, rests => rests, ready => ready, begins => begins, now => x"00000000",
      ended => ended, accept => accept, reason => reason, value => value, warns => warns, began => began,
      sclk => sclk, select_n => select_n, mosi => mosi, miso => miso);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun   <= '1';
      reset_1 <= reset;
      sclk_1  <= sclk;
      lasted  <= minimum(lasted + 1, pause);
      if sclk /= sclk_1 then
        lasted <= 1;
      end if;
      if sclk = '0' and sclk_1 = '1' then
        falls <= minimum(falls + 1, bits + 2);
      end if;
      if rests = '1' then
        falls <= 0;
      end if;
      if reset = '1' then
        lasted <= 0;
        falls  <= 0;
        sclk_1 <= '1';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- sclk is high at rest.
  high_at_rest : assert always begun = '1' and rests = '1' -> sclk = '1';
  -- sclk is high for the whole pause before a frame.
  pause_is_kept : assert always begun = '1' and reset_1 = '0' and sclk = '0' and sclk_1 = '1' and falls = 0 ->
                           lasted = pause;

  -- Neither half of a period is shorter than its rate.
  never_faster : assert always begun = '1' and reset_1 = '0' and sclk /= sclk_1 -> lasted >= half;

  -- A frame that is good has each bit, and a fall to latch it.
  whole_frame : assert always begun = '1' and ended = '1' and reason = "00" -> falls = bits + 1;
  -- No frame has more.
  no_more     : assert always begun = '1' -> falls <= bits + 1;

  -- The lines of SPI are at rest.
  no_spi : assert always begun = '1' and reset_1 = '0' -> select_n = '1' and mosi = '0';

  -- A reading is good.
  good_seen : cover {begun = '1' and ended = '1' and reason = "00" and value = 2};

end architecture;
