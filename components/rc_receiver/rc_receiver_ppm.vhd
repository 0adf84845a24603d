-- SPDX-License-Identifier: BSD-3-Clause
--
-- The frames of PPM: the distances of its edges are the channels, and a long pause is between two frames.
--
-- Frames    put gives a channel in 1/8 us while the frame comes in. When the pause behind it has lasted for 2.7 ms,
--           whole or broken is high for a clock. Before the first pause there is no frame.
-- Glitches  A distance that is not 0.7 to 2.3 ms, and a number of distances that is not `channels`, break the frame.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;

entity rc_receiver_ppm is
  generic (
    clock_hz  : positive              := 50_000_000;
    channels  : positive range 1 to 16 := 8;
    inverted  : natural range 0 to 1  := 0;
    filter_ns : natural range 0 to 2000 := 1000
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic;
    line    : in  std_ulogic; -- asynchronous
    put     : out std_ulogic;
    channel : out unsigned(3 downto 0);
    value   : out std_ulogic_vector(15 downto 0);
    whole   : out std_ulogic := '0';
    broken  : out std_ulogic := '0'
  );
end entity;

architecture rtl of rc_receiver_ppm is

  constant eighths_hz : positive := 8_000_000;
  constant shortest   : positive := 8 * 700;
  constant longest    : positive := 8 * 2300;
  constant pause      : positive := 8 * 2700;
  constant tick_bits  : positive := phase_bits(clock_hz, eighths_hz);

  signal level       : std_ulogic;
  signal before      : std_ulogic := '1';
  signal marks       : std_ulogic; -- an edge that counts
  signal phase       : unsigned(tick_bits downto 0) := (others => '0'); -- its highest bit is a tick each 1/8 us
  signal passed      : unsigned(14 downto 0) := (others => '0');        -- ticks since the last edge, at most a pause
  signal in_frame    : std_ulogic := '0'; -- its first edge has come
  signal may_begin   : std_ulogic := '0'; -- a pause is over
  signal wrong       : std_ulogic := '0';
  signal count       : unsigned(4 downto 0) := (others => '0'); -- of channels so far
  signal fits, ends  : std_ulogic;

begin

  filter : entity work.input_filter
    generic map (stable_clocks => clocks_lasting(filter_ns, clock_hz))
    port map (clock => clock, reset => reset, pins(0) => line, levels(0) => level);

  marks   <= (level xor before) and (level xor to_bit(inverted = 1));
  fits    <= to_bit(passed >= shortest) and to_bit(passed <= longest) and to_bit(count < channels);
  put     <= marks and in_frame and fits;
  channel <= count(channel'range);
  value   <= '0' & std_ulogic_vector(passed);
  ends    <= to_bit(passed = pause - 1) and phase(tick_bits) and not marks;

  run : process (clock) is
  begin
    if rising_edge(clock) then
      before <= level;
      phase  <= ('0' & phase(tick_bits - 1 downto 0)) + phase_increment(clock_hz, eighths_hz);
      whole  <= '0';
      broken <= '0';
      if phase(tick_bits) = '1' and passed /= pause then
        passed <= passed + 1;
      end if;
      if marks = '1' then
        passed <= (others => '0');
        if in_frame = '1' then
          wrong <= wrong or not fits;
          if fits = '1' then
            count <= count + 1;
          end if;
        elsif may_begin = '1' then
          in_frame <= '1';
          wrong    <= '0';
          count    <= (others => '0');
        end if;
      elsif ends = '1' then
        may_begin <= '1';
        in_frame  <= '0';
        whole     <= in_frame and not wrong and to_bit(count = channels);
        broken    <= in_frame and (wrong or to_bit(count /= channels));
      end if;
      if reset = '1' then
        before    <= level;
        phase     <= (others => '0');
        passed    <= (others => '0');
        may_begin <= '0';
        in_frame  <= '0';
        whole     <= '0';
        broken    <= '0';
      end if;
    end if;
  end process;

end architecture;
