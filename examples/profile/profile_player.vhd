-- SPDX-License-Identifier: BSD-3-Clause
--
-- Plays the table of profile.ul: a point a millisecond is the goal of an axis, and where the axis is then goes into the
-- queue for the PC. The axis is a stand-in: each millisecond it goes a quarter of the way to its goal.
--
-- Ports    play: high for a clock starts at the first point; not heard while playing.
--          table_*: the user's side of double_buffer_slave: the word of table_address comes one clock later.
--          sample_*: the side of fifo_slave towards the PC.
-- Latency  The first sample comes a millisecond after play.
-- Errors   None. Pressure: where the queue is full the sample waits; the next one takes its place after a millisecond.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity profile_player is
  generic (
    clock_hz : positive := 12_000_000
  );
  port (
    clock         : in  std_ulogic;
    reset         : in  std_ulogic;
    play          : in  std_ulogic;
    playing       : out std_ulogic;
    table_address : out natural range 0 to 31;
    table_data    : in  std_ulogic_vector(31 downto 0);
    sample_valid  : out std_ulogic;
    sample_ready  : in  std_ulogic;
    sample_data   : out std_ulogic_vector(31 downto 0)
  );
end entity;

architecture rtl of profile_player is

  constant clocks_a_ms : positive := clock_hz / 1000;

  signal running  : std_ulogic;
  signal waiting  : std_ulogic; -- a sample, for the queue
  signal index    : natural range 0 to 31;
  signal clocks   : natural range 0 to clocks_a_ms - 1;
  signal position : signed(15 downto 0);

begin

  playing       <= running;
  table_address <= index;
  sample_valid  <= waiting;
  sample_data   <= std_ulogic_vector(resize(position, 32));

  process (clock) is
    variable way : signed(16 downto 0);
  begin
    if rising_edge(clock) then
      if sample_ready = '1' then
        waiting <= '0';
      end if;
      if running = '0' then
        running <= play;
        index   <= 0;
        clocks  <= 0;
      elsif clocks < clocks_a_ms - 1 then
        clocks <= clocks + 1;
      else
        clocks   <= 0;
        way      := resize(signed(table_data(15 downto 0)), 17) - position;
        position <= resize(position + shift_right(way, 2), 16);
        waiting  <= '1';
        if index = 31 then
          running <= '0';
        else
          index <= index + 1;
        end if;
      end if;
      if reset = '1' then
        running  <= '0';
        waiting  <= '0';
        index    <= 0;
        clocks   <= 0;
        position <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
