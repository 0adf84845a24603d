-- SPDX-License-Identifier: BSD-3-Clause
--
-- The three Hall sensors of a brushless motor: the sector of its rotor, its angle between two edges, and its velocity.
--
--   +0  status (read): bits 2..0 the sector, 3 valid, 4 the last edge was backward, 5 the angle is interpolated
--   +1  position (read): sectors so far, two's complement; it wraps
--   +2  angle (read): the electrical angle, 2**16 a turn; 0 is where line 0 rises
--   +3  failures (read): codes that cannot be, 16 bits; it wraps
--   +4  velocity (read), with with_velocity: sectors in a second, in 1/256, two's complement
--
--   line 0  /‾‾‾‾‾‾‾‾‾‾‾\___________/‾‾‾    a third of an electrical turn apart, forward to the right
--   line 1  ________/‾‾‾‾‾‾‾‾‾‾‾\_______
--   line 2  ‾‾‾‾\___________/‾‾‾‾‾‾‾‾‾‾‾
--   sector    0 | 1 | 2 | 3 | 4 | 5 | 0
--
-- Angle     At an edge it is that of the edge. From there it goes on as fast as the last sector was passed, in 63 steps
--           of 0.94 deg, and then it waits: it never passes the sector. No division is needed: each tick of the time
--           adds 64, and each step takes a period away. Without a period of the same direction, and after 2**16 ticks
--           without an edge, it is that of the middle of the sector. A tick is 0.5 to 1 us.
-- Filter    A level counts when it has been stable for filter_ns.
-- Events    moved: the sector has changed. failed: a code that cannot be has come: 000, 111, or a sector that is no
--           neighbour of the last one. stopped: no edge has come for stall_us; it needs with_velocity.
-- Wires     position, angle and velocity. They are valid while the lines have a code that can be.
-- Latency   2 clocks and the filter from a pin to its level, and one more to the words. An access takes 2 clocks.
-- Errors    err for any write and for other addresses.
-- Reset     The position is 0 in the sector that the lines then show. Hold it for 5 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity hall is
  generic (
    clock_hz      : positive                      := 50_000_000;
    filter_ns     : natural range 0 to 2000       := 1000;
    with_velocity : natural range 0 to 1          := 0;
    velocity_us   : positive range 100 to 100_000 := 1000;
    stall_us      : positive range 200 to 500_000 := 100_000;
    data_width    : positive range 32 to 32       := 32
  );
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic; -- synchronous
    wishbone_m2s  : in  wishbone_m2s_t;
    wishbone_s2m  : out wishbone_s2m_t;
    moved         : out std_ulogic := '0';
    failed        : out std_ulogic := '0';
    stopped       : out std_ulogic;

    position_wire : out wire_t;
    angle_wire    : out wire_t;
    velocity_wire : out wire_t;

    lines         : in  std_ulogic_vector(2 downto 0) -- asynchronous
  );
end entity;

architecture rtl of hall is

  constant words     : positive := 4 + with_velocity;
  constant steps     : positive := 64; -- of the angle in a sector
  constant step_size : positive := 171;

  -- A power of two.
  function tick_clocks return positive is
    variable found : positive := 1;
  begin
    while clock_hz / found >= 2_000_000 loop
      found := found * 2;
    end loop;
    return found;
  end function;

  subtype lines_t is std_ulogic_vector(2 downto 0);
  subtype sector_t is unsigned(2 downto 0);
  subtype angle_t is unsigned(15 downto 0);
  subtype time_t is signed(16 downto 0); -- 64 less the ticks
  type sectors_t is array (0 to 7) of sector_t;
  type angles_t is array (0 to 15) of angle_t;

  constant next_of : sectors_t := ("001", "010", "011", "100", "101", "000", "000", "000");

  -- The sector of a code, line 2 first. 000 and 111 have none.
  function sector_of (code : lines_t) return sector_t is
  begin
    case code is
      when "101" => return "000";
      when "001" => return "001";
      when "011" => return "010";
      when "010" => return "011";
      when "110" => return "100";
      when others => return "101";
    end case;
  end function;

  -- Twelfths of a turn.
  function twelfths return angles_t is
    variable found : angles_t := (others => (others => '0'));
  begin
    for number in 0 to 11 loop
      found(number) := to_unsigned((number * 65_536 + 6) / 12, 16);
    end loop;
    return found;
  end function;

  constant twelfth   : angles_t := twelfths;
  constant time_full : time_t := to_signed(steps - 65_535, time_t'length);

  signal read_words : word_vector_t(0 to words - 1);
  signal levels     : lines_t := "000";
  signal sector     : sector_t := (others => '0');
  signal known      : std_ulogic := '0';                -- there has been a sector since the reset
  signal valid      : std_ulogic := '0';
  signal bad_before : std_ulogic := '0';
  signal position   : signed(31 downto 0) := (others => '0');
  signal failures   : unsigned(15 downto 0) := (others => '0');
  signal fine       : natural range 0 to tick_clocks - 1 := 0;
  signal passed     : time_t := to_signed(steps, time_t'length);  -- since the last edge
  signal timed      : std_ulogic := '0';                -- `passed` is the time since an edge
  signal back       : std_ulogic := '0';
  signal period     : time_t := (others => '0');
  signal due        : time_t := (others => '0');        -- a step of the angle comes when it is not negative
  signal runs       : std_ulogic := '0';                -- with a period
  signal taken      : unsigned(5 downto 0) := (others => '0'); -- steps since the edge
  signal angle      : angle_t := (others => '0');

  -- A valid value, or none.
  function wire_when (valid : std_ulogic; value : signed) return wire_t is
    variable found : wire_t := wire_of(value);
  begin
    found(found'high) := valid;
    return found;
  end function;

begin

  registers : entity work.register_slave
    generic map (writable => (0 to words - 1 => '0'))
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => open, written => open);

  read_words(0) <= extended(runs & back & valid & std_ulogic_vector(sector));
  read_words(1) <= std_ulogic_vector(position);
  read_words(2) <= extended(std_ulogic_vector(angle));
  read_words(3) <= extended(std_ulogic_vector(failures));
  position_wire <= wire_when(valid, position);
  angle_wire    <= wire_when(valid, signed('0' & angle));

  inputs : entity work.input_filter
    generic map (width => 3, stable_clocks => clocks_lasting(filter_ns, clock_hz))
    port map (clock => clock, reset => reset, pins => lines, levels => levels);

  follow : process (clock) is
    variable found          : sector_t;
    variable up, down, good : boolean;
    variable tick           : boolean;
    variable place          : unsigned(3 downto 0); -- of the angle, in twelfths
  begin
    if rising_edge(clock) then
      found := sector_of(levels);
      good  := levels /= "000" and levels /= "111";
      up    := found = next_of(to_integer(sector));
      down  := sector = next_of(to_integer(found));
      tick  := fine = tick_clocks - 1;
      fine  <= (fine + 1) mod tick_clocks;

      moved      <= '0';
      failed     <= '0';
      valid      <= to_bit(good);
      bad_before <= to_bit(not good);

      if tick then
        if passed = time_full then
          timed <= '0';
          runs  <= '0';
          if timed = '1' then
            angle <= twelfth(to_integer(sector & '1'));
          end if;
        else
          passed <= passed - 1;
          if runs = '1' and taken /= steps - 1 then
            if due >= 0 then
              due   <= due + period;
              taken <= taken + 1;
              if back = '1' then
                angle <= angle - step_size;
              else
                angle <= angle + step_size;
              end if;
            else
              due <= due + steps;
            end if;
          end if;
        end if;
      end if;

      if good and (known = '0' or found /= sector) then
        sector <= found;
        known  <= '1';
        moved  <= known;
        passed <= to_signed(steps, time_t'length);
        taken  <= (others => '0');
        timed  <= '0';
        runs   <= '0';
        place  := found & '1';
        if known = '1' and (up or down) then
          timed  <= '1';
          back   <= to_bit(down);
          period <= passed;
          due    <= passed;
          if timed = '1' and back = to_bit(down) then
            runs  <= '1';
            place := found & '0';
            if down then
              place := sector & '0';
            end if;
          end if;
          if up then
            position <= position + 1;
          else
            position <= position - 1;
          end if;
        end if;
        angle <= twelfth(to_integer(place));
      end if;
      if (good and known = '1' and found /= sector and not up and not down) or (not good and bad_before = '0') then
        failures <= failures + 1;
        failed   <= '1';
      end if;

      if reset = '1' then
        known      <= '0';
        valid      <= '0';
        bad_before <= '0';
        moved      <= '0';
        failed     <= '0';
        position   <= (others => '0');
        failures   <= (others => '0');
        fine       <= 0;
        timed      <= '0';
        runs       <= '0';
        back       <= '0';
        angle      <= (others => '0');
        sector     <= (others => '0');
      end if;
    end if;
  end process;

  times : if with_velocity = 1 generate
    signal speed        : unsigned(30 downto 0);
    signal is_back      : std_ulogic;
    signal value        : signed(31 downto 0) := (others => '0');
    signal first, second : std_ulogic; -- the position as the lines of an encoder
  begin
    second <= position(1);
    first  <= position(1) xor position(0);

    velocity : entity work.quadrature_encoder_velocity
      generic map (clock_hz => clock_hz, window_us => velocity_us, stall_us => stall_us, data_width => data_width)
      port map (
        clock => clock, reset => reset, a => first, b => second, hold => '0', speed => speed, back => is_back,
        stopped => stopped);

    tell : process (clock) is
    begin
      if rising_edge(clock) then
        value <= signed('0' & speed);
        if is_back = '1' then
          value <= -signed('0' & speed);
        end if;
        if reset = '1' then
          value <= (others => '0');
        end if;
      end if;
    end process;

    velocity_wire <= wire_when(valid, value);
    read_words(4) <= std_ulogic_vector(value);
  else generate
    velocity_wire <= no_wire;
    stopped       <= '0';
  end generate;

end architecture;
