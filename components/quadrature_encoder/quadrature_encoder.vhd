-- SPDX-License-Identifier: BSD-3-Clause
--
-- Incremental encoder on the Wishbone bus: position from two signals a quarter period apart, four counts per period.
--
--   a      __/‾‾‾\___/‾‾‾\__        a before b counts up
--   b      ____/‾‾‾\___/‾‾‾\
--   index  ____/‾\__________        once per turn
--
--   +0  position, two's complement; wraps at the word          write: preset
--   +1  position at the last rising edge of index              (with_index 1, else zero)
--   +2  rising edges of index so far; wraps at the word        (with_index 1, else zero)
--   +3  impossible steps: both signals changed at once         write: sets the number
--   +4  clock of the last step, since the reset                (with_stamps 1, else zero)
--   +5  clock of the last rising edge of index                 (with both 1, else zero)
--   +6  velocity in 1/256 count/s, two's complement            (with_velocity 1, else err)
--
-- The words are in block RAM: see quadrature_encoder_counts. All words are of one moment, also in a block of accesses,
-- and a publish of many encoders has one moment for all, to 16 clocks. A preset loses no step.
--
-- Velocity  is measured by the times of the edges, a result for each velocity_us: see quadrature_encoder_velocity. It
--           is never faster than the largest word: 8.3 million counts a second, with 32 bits.
-- Events    indexed: a rising edge of index. failed: an impossible step. stopped: no edge has come for stall_us, and
--           the velocity is 0 (with_velocity 1).
-- Wires     position_wire and velocity_wire have both values for other components. They follow the words by 2 clocks.
-- Filter    A level counts when it has been stable for filter_ns, rounded up to whole clocks and at least one. Below,
--           these clocks are called the filter.
-- Speed     At most one step per filter. A faster step is counted in +3, and the position is then wrong by at
--           least two counts. +2 and +3 count at most one in 16 clocks.
-- Latency   2 clocks for a read, at most 34 for a write: it is acknowledged when it is in force and can be read. The
--           position follows the pins at most 35 clocks and the filter later. The events follow them 3 clocks and the
--           filter later.
-- Errors    err for writes to other addresses than +0 and +3, and for addresses from 7 on, without velocity
--           from 6 on.
-- Reset     All words are zero. The levels of the pins at that time are not counted as a step, if the reset lasts at
--           least 5 clocks. The first access waits for up to 17 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity quadrature_encoder is
  generic (
    clock_hz    : positive                := 50_000_000;
    filter_ns   : natural range 0 to 2000 := 40;
    with_index  : natural range 0 to 1    := 0;
    with_stamps : natural range 0 to 1    := 0;
    with_velocity : natural range 0 to 1  := 0;
    velocity_us : positive range 100 to 100_000 := 1000;
    stall_us    : positive range 200 to 500_000 := 100_000;
    data_width  : positive range 8 to 32  := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    indexed      : out std_ulogic;
    failed       : out std_ulogic;
    stopped      : out std_ulogic;

    position_wire : out wire_t; -- for other components
    velocity_wire : out wire_t;

    a     : in std_ulogic; -- asynchronous, like the next two
    b     : in std_ulogic;
    index : in std_ulogic := '0'
  );
end entity;

architecture rtl of quadrature_encoder is

  signal levels : std_ulogic_vector(2 downto 0); -- index, b, a
  signal speed  : unsigned(data_width - 2 downto 0);
  signal back   : std_ulogic;
  signal hold   : std_ulogic;
  signal newest : unsigned(data_width - 1 downto 0);

begin

  inputs : entity work.input_filter
    generic map (width => 3, stable_clocks => clocks_lasting(filter_ns, clock_hz))
    port map (
      clock => clock, reset => reset,
      pins(0) => a, pins(1) => b, pins(2) => index, levels => levels);

  counts : entity work.quadrature_encoder_counts
    generic map (
      channels => 1, with_index => with_index, with_stamps => with_stamps, with_velocity => with_velocity,
      data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      indexed => indexed, failed => failed, speed => speed, back => back, hold => hold,
      newest => newest, a => levels(0 downto 0), b => levels(1 downto 1), index => levels(2 downto 2));

  position_wire <= wire_of(signed(newest));

  times : if with_velocity = 1 generate
    velocity : entity work.quadrature_encoder_velocity
      generic map (clock_hz => clock_hz, window_us => velocity_us, stall_us => stall_us, data_width => data_width)
      port map (
        clock => clock, reset => reset, a => levels(0), b => levels(1), hold => hold, speed => speed, back => back,
        stopped => stopped);

    tell : process (clock) is
      variable value : signed(data_width - 1 downto 0);
    begin
      if rising_edge(clock) then
        value := signed('0' & speed);
        if back = '1' then
          value := -value;
        end if;
        velocity_wire <= wire_of(value);
        if reset = '1' then
          velocity_wire <= wire_of(to_signed(0, data_width));
        end if;
      end if;
    end process;
  else generate
    speed   <= (others => '0');
    back    <= '0';
    stopped <= '0';
    velocity_wire <= no_wire;
  end generate;

end architecture;
