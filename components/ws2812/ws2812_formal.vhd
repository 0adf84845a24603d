-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the line of ws2812 with one LED, a clock of 8 MHz (a 0 is 2 clocks high, a 1 is 6, a bit is 10), and
-- a pause of 25 us, which is 200 clocks. The bus may do anything at any clock, and the memory may give any colour. That
-- it gives the one that was written last is not proven; the bench checks it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wishbone_pkg.all;

entity ws2812_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    found   : in std_ulogic_vector(23 downto 0); -- shows what the memory gives, as all of these show signals
    place   : in unsigned(1 downto 0);           -- that is read
    fetch   : in std_ulogic;                     -- the colour is wanted
    fetches : in std_ulogic;                     -- it is read
    fetched : in std_ulogic;                     -- it is there
    ack     : in std_ulogic;                     -- the bus has its answer
    err     : in std_ulogic;
    on_now  : in std_ulogic;
    sending : in std_ulogic;                     -- a frame or its pause is under way
    quiet   : in std_ulogic;                     -- it is the pause
    clocks  : in unsigned(3 downto 0);           -- of the bit
    left    : in unsigned(4 downto 0);           -- bits behind this one
    ahead   : in unsigned(2 downto 0);           -- the next LED
    shift   : in std_ulogic_vector(23 downto 0)
  );
end entity;

architecture properties of ws2812_formal is

  constant zero_clocks  : positive := 2;
  constant one_clocks   : positive := 6;
  constant bit_clocks   : positive := 10;
  constant pause_clocks : positive := 200;
  constant bits         : positive := 24;

  subtype colour_t is std_ulogic_vector(bits - 1 downto 0);

  signal s2m            : wishbone_s2m_t;
  signal data           : std_ulogic;
  signal begun          : std_ulogic := '0';
  signal reset_1        : std_ulogic := '1';
  signal data_1         : std_ulogic := '0';
  signal rises, falls   : std_ulogic;
  signal high           : natural range 0 to one_clocks + 1 := 0;   -- clocks of this pulse
  signal low            : natural range 0 to pause_clocks := 0;     -- clocks of the line
  signal since          : natural range 0 to bit_clocks + 1 := 0;   -- the last rise
  signal count          : natural range 0 to bits + 1 := 0;         -- bits of this frame
  signal to_send        : colour_t := (others => '0');
  signal answers        : std_ulogic;
  signal fits           : std_ulogic;                               -- the state of the design to that of the reference

begin

  default clock is rising_edge(clk);

  dut : entity work.ws2812
    generic map (clock_hz => 8_000_000, leds => 1, channels => 3, reset_us => 25, data_width => 24)
    port map (clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sent => open, data => data);

  answers <= ack or err;

  rises <= data and not data_1;
  falls <= data_1 and not data;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun     <= '1';
      reset_1   <= reset;
      data_1    <= data;

      high <= 0;
      low  <= minimum(low + 1, pause_clocks);
      if data = '1' then
        high <= minimum(high + 1, one_clocks + 1);
        low  <= 0;
      end if;
      since <= minimum(since + 1, bit_clocks + 1);
      if rises = '1' then
        since <= 1;
        count <= minimum(count + 1, bits + 1);
        if low = pause_clocks then
          count <= 1;
        end if;
      end if;

      if falls = '1' then
        to_send <= to_send(bits - 2 downto 0) & '0';
      end if;
      if fetched = '1' then
        to_send <= found and (colour_t'range => on_now);
      end if;

      if reset = '1' then
        data_1  <= '0';
        low     <= 0;
        count   <= 0;
        since   <= bit_clocks + 1;
      end if;
    end if;
  end process;

  -- Where the design is, and what the reference must then have.
  relate : process (all) is
    variable past  : natural range 0 to 31;    -- bits of this part that are over
    variable is_up : boolean;                  -- the bit on the line is high now
    variable good  : boolean;
  begin
    past  := 31;
    if left < bits then
      past := bits - 1 - to_integer(left);
    end if;
    is_up := clocks >= 1 and (clocks <= zero_clocks or (clocks <= one_clocks and shift(bits - 1) = '1'));
    good  := clocks < bit_clocks and left < bits and ahead >= 2 and
             (ahead <= 4 or sending = '0') and (fetch = '0' or clocks = one_clocks + 1 or clocks = one_clocks + 2);
    -- The next colour is read in the low end of a last bit. The bus lets it wait for a clock at most.
    if sending = '0' or left /= 0 or clocks <= one_clocks then
      good := good and fetch = '0' and fetched = '0';
    elsif clocks = one_clocks + 1 then
      good := good and fetch = '1' and fetched = '0';
    elsif clocks = one_clocks + 2 then
      good := good and fetched = not fetch and (fetch = '0' or answers = '1');
    else
      good := good and fetch = '0';
    end if;
    if sending = '0' then
      -- Before the first clock of the rest, and in it.
      good := good and data = '0' and low = pause_clocks and (count = 0 or count = bits) and since = bit_clocks + 1 and
              fetch = '0' and data_1 = '0';
    elsif quiet = '1' then
      -- The pause. The line is low, and `low` counts its clocks.
      good := good and ahead = 4 and data = '0' and (count = 0 or count = bits) and (fetch = '0' or left = 0) and
              (data_1 = '0') and
              low >= minimum(pause_clocks, bit_clocks * past + to_integer(clocks)) and
              (count = 0 or
               since >= minimum(bit_clocks + 1, bit_clocks * past + to_integer(clocks) + bit_clocks - 1)) and
              (count = bits or since = bit_clocks + 1);
    elsif ahead = 2 then
      -- The low end of a bit, in which the colour is fetched.
      good := good and left = 0 and clocks >= one_clocks and data = '0' and low = pause_clocks and
              (count = 0 or count = bits) and since = bit_clocks + 1 and data_1 = '0' and
              (clocks /= bit_clocks - 1 or fetched = '1' or shift = to_send);
    else
      -- The LED.
      good := good and ahead = 3 and (data = '1') = is_up;
      if clocks = 0 and past = 0 then
        good := good and (count = 0 or count = bits) and low = pause_clocks and since = bit_clocks + 1 and
                shift = to_send;
      elsif clocks = 0 then
        good := good and count = past and since = bit_clocks - 1 and low <= bit_clocks - 2 and shift = to_send;
      elsif clocks = 1 then
        good := good and data_1 = '0' and shift = to_send and high = 0;
        if past = 0 then
          good := good and (count = 0 or count = bits) and low = pause_clocks and since = bit_clocks + 1;
        else
          good := good and count = past and since = bit_clocks and low <= bit_clocks - 1;
        end if;
      else
        good := good and count = past + 1 and since = clocks - 1 and low <= to_integer(clocks) - 2;
        if is_up then
          good := good and high = clocks - 1 and data_1 = '1' and shift = to_send;
        elsif data_1 = '1' then
          good := good and shift = to_send and ((clocks = zero_clocks + 1 and high = zero_clocks and shift(23) = '0') or
                                               (clocks = one_clocks + 1 and high = one_clocks and shift(23) = '1'));
        elsif left /= 0 then
          good := good and to_send = shift(bits - 2 downto 0) & '0';
        end if;
      end if;
    end if;
    fits <= to_bit(good);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A pulse is that of a 0 or that of a 1, unless a reset ends it.
  right_pulse : assert always begun = '1' and falls = '1' and reset_1 = '0' -> high = zero_clocks or high = one_clocks;

  -- No pulse is longer than that of a 1.
  never_longer : assert always begun = '1' and data = '1' -> high < one_clocks;

  -- A bit follows the one before it after the time of a bit. Only a frame begins later, behind a whole pause: the first
  -- one behind a reset, too.
  in_step : assert always begun = '1' and rises = '1' and low < pause_clocks -> since = bit_clocks;

  -- A frame is as long as its LED: nothing else comes before the pause.
  whole_frame : assert always begun = '1' and reset_1 = '0' and rises = '1' and low = pause_clocks ->
                         count = bits or count = 0;

  -- The pulses are the bits of the colour that the memory gave, the highest one first. Without `on` they are 0.
  right_colour : assert always begun = '1' and falls = '1' and reset_1 = '0' ->
                          (high = one_clocks) = (to_send(bits - 1) = '1');

  -- The colour is that of the LED.
  right_place : assert always begun = '1' and sending = '1' and quiet = '0' and ahead = 2 and fetches = '1' ->
                         place = 2;

  -- A reset makes the line low in the next clock.
  reset_is_low : assert always begun = '1' and reset_1 = '1' -> data = '0';

  -- The reference is where the design is. The other properties need this.
  in_place : assert always begun = '1' -> fits = '1';

  -- A frame that has a 1.
  lit_seen : cover {begun = '1' and falls = '1' and high = one_clocks};

end architecture;
