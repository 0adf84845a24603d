-- SPDX-License-Identifier: BSD-3-Clause
--
-- The gates of half bridges: dead time, enable, and a fault input that cuts. The logic around it says which side of
-- each leg shall conduct. It cannot switch on both, shorten the dead time, or undo a fault.
--
--   sides  __/‾‾‾‾‾‾‾‾‾‾‾\________      1: the high side of this leg shall conduct
--   high   ____/‾‾‾‾‾‾‾‾‾\________      each gate goes on a dead time late, and off at once
--   low    ‾‾\_____________/‾‾‾‾‾‾
--
-- A pulse shorter than the dead time vanishes: neither gate of the leg is on meanwhile. While `sides` stands still, the
-- gates do, so 0 % and 100 % have no edges.
--
-- Generics  dead_minimum_ns is the shortest dead time. A smaller `dead` counts as this one.
--           fault_level is the level of the pin `fault` that means a fault.
-- Ports     enable: its rising edge starts, 0 stops. driven: 0 switches both gates of a leg off.
--           running: the gates follow `sides`. tripped: a fault came since the last start. fault_seen: the pin now.
--           trip: high for one clock when tripped rises.
-- Latency   sides to a gate: off 1 clock, on 1 clock and the dead time later. The dead time is rounded up to whole
--           clocks, where a clock counts as a whole number of ns, rounded down. So it is never too short.
-- Fault     All gates are off within 2 clocks after the level on the pin, and stay off. A fault that is shorter than a
--           clock may be missed. Only a rise of enable starts again, and only without a fault.
-- Reset     All gates off. enable must rise after it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity bridge_gates is
  generic (
    clock_hz        : positive                   := 50_000_000;
    legs            : positive                   := 3;
    dead_minimum_ns : natural range 0 to 4095    := 500;
    fault_level     : natural range 0 to 1       := 1
  );
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic;                     -- synchronous
    enable     : in  std_ulogic;
    dead       : in  std_ulogic_vector(11 downto 0); -- ns
    dead_used  : out std_ulogic_vector(11 downto 0); -- the same, but at least the minimum; a clock later
    driven     : in  std_ulogic_vector(legs - 1 downto 0);
    sides      : in  std_ulogic_vector(legs - 1 downto 0);
    running    : out std_ulogic;
    tripped    : out std_ulogic;
    trip       : out std_ulogic;
    fault_seen : out std_ulogic;

    fault      : in  std_ulogic; -- asynchronous
    high       : out std_ulogic_vector(legs - 1 downto 0);
    low        : out std_ulogic_vector(legs - 1 downto 0)
  );
end entity;

architecture rtl of bridge_gates is

  constant clock_ns    : positive := 1_000_000_000 / clock_hz;
  constant dead_least  : std_ulogic_vector(11 downto 0) := std_ulogic_vector(to_unsigned(dead_minimum_ns, 12));

  function fault_is return std_ulogic is
  begin
    if fault_level = 1 then
      return '1';
    end if;
    return '0';
  end function;

  constant no_fault : std_ulogic := not fault_is;

  -- Time in ns, modulo 8192. A time is over when it is behind us by less than half of that.
  subtype time_t is unsigned(12 downto 0);
  type times_t is array (0 to legs - 1) of time_t;

  subtype legs_t is std_ulogic_vector(legs - 1 downto 0);

  signal dead_sum         : unsigned(12 downto 0); -- its highest bit: the dead time is at least the minimum
  signal level, seen      : std_ulogic;
  signal enabled_before   : std_ulogic;
  signal now_ns           : time_t;
  signal not_ends         : times_t; -- the inverse of the end of each leg's dead time: to add it costs no inverters
  signal side             : legs_t;  -- that conducts or will
  signal high_on, low_on  : legs_t := (others => '0'); -- off from power-up on

begin

  assert clock_hz >= 1_000_000
    report "bridge_gates: clock_hz must be at least 1 MHz, got " & integer'image(clock_hz)
    severity failure;

  fault_synchroniser : entity work.synchroniser
    generic map (idle => no_fault)
    port map (clock => clock, reset => reset, asynchronous(0) => fault, levels(0) => level);

  seen       <= level xor no_fault;
  fault_seen <= seen;

  -- The fault does not wait for the next clock.
  high <= high_on and not seen;
  low  <= low_on and not seen;

  dead_sum <= resize(unsigned(dead), 13) + to_unsigned(4096 - dead_minimum_ns, 13);

  process (clock) is
    variable over : unsigned(time_t'high + 1 downto 0); -- ns since the end, and a bit that carries 1 into them
  begin
    if rising_edge(clock) then
      enabled_before <= enable;
      trip           <= '0';
      if seen = '1' then
        running <= '0';
        tripped <= '1';
        trip    <= not tripped;
      elsif enable = '0' then
        running <= '0';
      elsif enabled_before = '0' then
        running <= '1';
        tripped <= '0';
      end if;

      now_ns    <= now_ns + clock_ns;
      dead_used <= dead;
      if dead_sum(dead_sum'high) = '0' then
        dead_used <= dead_least;
      end if;

      for leg in 0 to legs - 1 loop
        over := (now_ns & '1') + (not_ends(leg) & '1');
        if running = '0' or seen = '1' or driven(leg) = '0' or sides(leg) /= side(leg) then
          high_on(leg)  <= '0';
          low_on(leg)   <= '0';
          side(leg)     <= sides(leg);
          not_ends(leg) <= not (now_ns + unsigned(dead_used));
        elsif high_on(leg) = '0' and low_on(leg) = '0' and over(over'high) = '0' then
          high_on(leg) <= side(leg);
          low_on(leg)  <= not side(leg);
        end if;
      end loop;

      if reset = '1' then
        enabled_before <= '1';
        running        <= '0';
        tripped        <= '0';
        trip           <= '0';
        now_ns         <= (others => '0');
        dead_used      <= dead_least;
        high_on        <= (others => '0');
        low_on         <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
