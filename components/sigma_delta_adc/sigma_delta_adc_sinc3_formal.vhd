-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of sigma_delta_adc_sinc3 with an osr of 3, and a bit at each clock. The bits are any, and there may be a
-- reset at any clock. What is expected is a weighted sum of the last bits, without the sums and differences of the
-- design.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity sigma_delta_adc_sinc3_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    bit_in : in std_ulogic
  );
end entity;

architecture properties of sigma_delta_adc_sinc3_formal is

  constant osr    : positive := 3;
  constant width  : positive := 5;
  constant taps   : positive := 3 * osr - 2;
  -- Bits that a value has not seen: the sums follow each other by two, and 3 come until it is there.
  constant behind : positive := 5;

  type weights_t is array (0 to taps - 1) of natural range 0 to 7;

  -- Three boxes of osr, one into the other.
  constant weight : weights_t := (1, 3, 6, 7, 6, 3, 1);

  signal value   : unsigned(width - 1 downto 0);
  signal fresh   : std_ulogic;
  signal begun   : std_ulogic := '0';
  signal reset_1 : std_ulogic := '1';
  signal bits    : std_ulogic_vector(0 to behind + taps - 1) := (others => '0'); -- the newest first
  signal sum     : unsigned(width - 1 downto 0);
  signal since   : natural range 0 to osr := osr;          -- clocks since the last value
  signal known   : natural range 0 to 3   := 0;            -- values since the reset

begin

  default clock is rising_edge(clk);

  dut : entity work.sigma_delta_adc_sinc3
    generic map (osr => osr, width => width)
    port map (clock => clk, reset => reset, take => '1', bit_in => bit_in, value => value, fresh => fresh);

  weigh : process (all) is
    variable found : unsigned(width - 1 downto 0);
  begin
    found := (others => '0');
    for place in weight'range loop
      if bits(behind + place) = '1' then
        found := found + weight(place);
      end if;
    end loop;
    sum <= found;
  end process;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun   <= '1';
      reset_1 <= reset;
      bits    <= bit_in & bits(0 to bits'high - 1);
      since   <= minimum(since + 1, osr);
      if fresh = '1' then
        since <= 1;
        known <= minimum(known + 1, 3);
      end if;
      if reset = '1' then
        bits  <= (others => '0');
        since <= 0;
        known <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A value is the sum of its bits with their weights, also those that are not whole.
  right_sum : assert always begun = '1' and fresh = '1' -> value = sum;

  -- A value is never beyond osr**3.
  no_more : assert always begun = '1' and fresh = '1' -> value <= osr ** 3;

  -- A value comes for each osr bits.
  in_time : assert always begun = '1' and fresh = '1' and known /= 0 -> since = osr;

  -- The largest value, of ones alone.
  full_seen : cover {begun = '1' and fresh = '1' and value = osr ** 3};

end architecture;
