-- SPDX-License-Identifier: BSD-3-Clause
--
-- The velocity of an encoder, from the times of its edges (1/T): counts between two edges, over the time between them.
--
--   a        ___/‾‾‾‾‾‾‾\_______/‾‾‾        window   |---------|---------|
--   b        _______/‾‾‾‾‾‾‾\______         edges      x  x  x      x  x
--                                         way             |----------|   of the second window: from the last edge of
--                                                                        the window before to its own last edge
--
-- Way       An edge has a place: that of the line between two counts. So a step up and back is no way, and a shaft that
--           rests on an edge has the velocity 0.
-- Slow      In a window without an edge the speed is at most a count over the time since the last edge. After stall_us
--           without an edge it is 0, and `stopped` is high for a clock. The next edge only begins a way.
-- Result    `speed` and its direction, in 1/256 count/s, rounded down. It is at most the largest word.
-- Latency   A result comes work_clocks after the end of a window: twice the bits of a way and those of the clock, some
--           80 clocks. While `hold` is high it waits.
-- Generics  window_us: how often there is a result. stall_us is at least twice as long.
-- Errors    None. A step of both lines at once is no edge.
-- Reset     Stopped, and speed 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.width_pkg.all;

entity quadrature_encoder_velocity is
  generic (
    clock_hz   : positive                      := 50_000_000;
    window_us  : positive range 100 to 100_000 := 1000;
    stall_us   : positive range 200 to 500_000 := 100_000;
    data_width : positive range 8 to 32        := 32
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic; -- synchronous
    a       : in  std_ulogic; -- synchronous and filtered
    b       : in  std_ulogic;
    hold    : in  std_ulogic;
    speed   : out unsigned(data_width - 2 downto 0);
    back    : out std_ulogic; -- it turns down
    stopped : out std_ulogic := '0'
  );
end entity;

architecture rtl of quadrature_encoder_velocity is

  function clocks_of (time_us : positive) return positive is
    constant clock_khz : positive := maximum(1, clock_hz / 1000);
  begin
    return maximum(1, (time_us / 1000) * clock_khz + ((time_us mod 1000) * clock_khz) / 1000);
  end function;

  constant window_clocks : positive := clocks_of(window_us);
  constant stall_clocks  : positive := clocks_of(stall_us);
  constant factor        : unsigned(bits_for(clock_hz + 1) - 1 downto 0) :=
    to_unsigned(clock_hz, bits_for(clock_hz + 1));
  -- A product has so many zeros at its end, for 1/256 count/s. They are no part of the factor, because GHDL 2.0 cannot
  -- synthesise an addition of a constant of more than 32 bits.
  constant zeros         : unsigned(7 downto 0) := x"00";

  subtype window_t is unsigned(bits_for(window_clocks) - 1 downto 0);
  subtype time_t is unsigned(bits_for(stall_clocks + window_clocks + 1) - 1 downto 0);
  subtype way_t is signed(bits_for(window_clocks + 2) downto 0);
  subtype speed_t is unsigned(data_width - 2 downto 0);

  -- The way is multiplied with the factor, a bit at a time, and the product is divided by the time.
  constant way_bits     : positive := way_t'length - 1;
  constant product_bits : positive := way_bits + factor'length + zeros'length;
  constant work_clocks  : positive := way_bits + product_bits + 1;

  subtype product_t is unsigned(product_bits - 1 downto 0);
  subtype high_t is unsigned(factor'length downto 0);

  signal a_before, b_before  : std_ulogic := '0';
  signal window              : window_t := (others => '0');
  signal ends                : std_ulogic := '0'; -- the last clock of a window
  signal since               : time_t := (others => '0'); -- clocks since the last edge
  signal elapsed             : time_t := (others => '0'); -- since the edge where the way begins
  signal span                : time_t := (others => '0'); -- from there to the last edge
  signal moved               : way_t := (others => '0');  -- counts from there
  signal begins_up, ends_up  : std_ulogic := '0';         -- the directions of these two edges
  signal has_edge            : std_ulogic := '0';         -- the way has an end
  signal rests               : std_ulogic := '1';

  signal working   : std_ulogic := '0';
  signal step      : natural range 0 to work_clocks := 0;
  signal product   : product_t := (others => '0');
  signal remainder : time_t := (others => '0');
  signal divisor   : time_t := (others => '0');
  signal turns     : std_ulogic := '0'; -- the result is down
  signal is_bound  : std_ulogic := '0'; -- the result is no velocity, but the most that it can be
  signal last      : speed_t := (others => '0');
  signal is_back   : std_ulogic := '0';
  signal clears    : std_ulogic := '0'; -- the result becomes 0 as soon as hold allows

begin

  assert stall_us >= 2 * window_us
    report "quadrature_encoder: stall_us is at least twice velocity_us"
    severity failure;
  assert window_clocks > work_clocks + 5
    report "quadrature_encoder: velocity_us is at least " & integer'image(work_clocks + 6) & " clocks"
    severity failure;

  speed <= last;
  back  <= is_back;

  follow : process (clock) is
    variable edge, up       : std_ulogic;
    variable one            : signed(1 downto 0); -- up or down
    variable begun          : time_t; -- clocks since the way began
    variable way            : way_t;
  begin
    if rising_edge(clock) then
      a_before <= a;
      b_before <= b;
      edge     := (a xor a_before) xor (b xor b_before);
      up       := a xor b_before;
      ends     <= '1' when window = window_clocks - 2 else '0';

      stopped <= '0';
      window  <= window + 1;
      if ends = '1' then
        window <= (others => '0');
      end if;

      since   <= since + 1;
      elapsed <= elapsed + 1;
      begun   := elapsed;
      way     := moved;
      if ends = '1' and has_edge = '1' then
        begun     := since;
        elapsed   <= since + 1;
        way       := (others => '0');
        begins_up <= ends_up;
        has_edge  <= '0';
      end if;
      if edge = '1' then
        span    <= begun + 1;
        since   <= (others => '0');
        ends_up <= up;
        if rests = '1' then
          rests     <= '0';
          elapsed   <= (others => '0');
          way       := (others => '0');
          begins_up <= up;
        else
          has_edge <= '1';
          one      := not up & '1';
          way      := way + one;
        end if;
      end if;
      moved <= way;

      if rests = '1' or (since = stall_clocks and edge = '0') then
        if edge = '0' then
          rests   <= '1';
          since   <= since;
          stopped <= not rests;
        end if;
        has_edge <= '0';
      end if;

      if reset = '1' then
        window   <= (others => '0');
        ends     <= '0';
        rests    <= '1';
        has_edge <= '0';
        moved    <= (others => '0');
        stopped  <= '0';
      end if;
    end if;
  end process;

  compute : process (clock) is
    variable way    : way_t;
    variable high   : high_t;
    variable rest   : unsigned(time_t'length downto 0);
    variable less   : unsigned(time_t'length + 1 downto 0); -- its highest bit: the divisor is larger
    variable result : speed_t;
    variable fits   : std_ulogic;
  begin
    if rising_edge(clock) then
      if working = '0' then
        step     <= 0;
        is_bound <= not has_edge;
        way      := to_signed(1, way_t'length);
        divisor  <= since;
        turns    <= is_back;
        if has_edge = '1' then
          way     := moved;
          if begins_up = '1' and ends_up = '0' then
            way := moved + 1;
          elsif begins_up = '0' and ends_up = '1' then
            way := moved - 1;
          end if;
          divisor <= span;
          turns   <= way(way'high);
        end if;
        if way(way'high) = '1' then
          way := -way;
        end if;
        product   <= resize(unsigned(way(way_bits - 1 downto 0)), product_bits - zeros'length) & zeros;
        remainder <= (others => '0');
        if ends = '1' and rests = '0' then
          working <= '1';
        end if;
      elsif step < way_bits then
        high := '0' & product(product_bits - 1 downto way_bits + zeros'length);
        if product(zeros'length) = '1' then
          high := high + factor;
        end if;
        product <= high & product(way_bits + zeros'length - 1 downto zeros'length + 1) & zeros;
        step    <= step + 1;
      elsif step < way_bits + product_bits then
        rest      := remainder & product(product_bits - 1);
        product   <= product(product_bits - 2 downto 0) & '0';
        remainder <= rest(time_t'range);
        less      := ('0' & rest) - divisor;
        if less(less'high) = '0' then
          remainder  <= less(time_t'range);
          product(0) <= '1';
        end if;
        step <= step + 1;
      elsif hold = '0' then
        working <= '0';
        result  := product(speed_t'range);
        fits    := '1' when last <= result else '0'; -- beside the look at the high bits, not behind it
        if product(product_bits - 1 downto data_width - 1) /= 0 then
          result := (others => '1');
          fits   := '1';
        end if;
        if is_bound = '0' or fits = '0' then
          last    <= result;
          is_back <= turns;
        end if;
      end if;

      if clears = '1' and hold = '0' then
        clears  <= '0';
        last    <= (others => '0');
        is_back <= '0';
      end if;
      if rests = '1' then
        working <= '0';
        clears  <= '1';
      end if;

      if reset = '1' then
        working <= '0';
        last    <= (others => '0');
        is_back <= '0';
      end if;
    end if;
  end process;

end architecture;
