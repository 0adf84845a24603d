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
--           dead_write: `dead` is taken in this clock. It counts for dead times that begin later. Take one before the
--           first start.
--           hold: `sides` is not looked at in this clock, except while the gates do not run.
-- Latency   sides to a gate: off 1 clock, on 1 clock and the dead time later. A table in block RAM makes clocks of it:
--           the longest time in its 8 ns, rounded up to whole clocks. So it is never too short.
-- Fault     All gates are off within 2 clocks after the level on the pin, and stay off. A fault that is shorter than a
--           clock may be missed. Only a rise of enable starts again, and only without a fault.
-- Reset     All gates off. enable must rise after it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.dead_time_pkg.all;

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
    dead       : in  dead_t;                         -- ns
    dead_write : in  std_ulogic := '1';
    hold       : in  std_ulogic := '0';
    driven     : in  std_ulogic_vector(legs - 1 downto 0);
    sides      : in  std_ulogic_vector(legs - 1 downto 0);
    running    : out std_ulogic := '0';              -- the gates are off from power-up on
    tripped    : out std_ulogic;
    trip       : out std_ulogic;
    fault_seen : out std_ulogic;

    fault      : in  std_ulogic; -- asynchronous
    high       : out std_ulogic_vector(legs - 1 downto 0);
    low        : out std_ulogic_vector(legs - 1 downto 0)
  );
end entity;

architecture rtl of bridge_gates is

  function fault_is return std_ulogic is
  begin
    if fault_level = 1 then
      return '1';
    end if;
    return '0';
  end function;

  constant no_fault : std_ulogic := not fault_is;

  subtype dead_code_t is std_ulogic_vector(code_bits(clock_hz) - 1 downto 0);
  type codes_t is array (0 to legs - 1) of dead_code_t;
  -- Downwards: from an upward constant GHDL 2.0 makes a table with an inverter at each bit of the place.
  type table_t is array (dead_place_t'high downto dead_place_t'low) of dead_code_t;

  constant code_last : dead_code_t := (others => '1');

  function table_of return table_t is
    variable table  : table_t;
    variable clocks : positive    := 1;
    variable code   : dead_code_t := code_last;
  begin
    for place in dead_place_t loop
      while clocks < dead_clocks(place, dead_minimum_ns, clock_hz) loop
        clocks := clocks + 1;
        code   := code_before(code);
      end loop;
      table(place) := code;
    end loop;
    return table;
  end function;

  constant table : table_t := table_of;

  subtype legs_t is std_ulogic_vector(legs - 1 downto 0);

  signal level, seen      : std_ulogic;
  signal enabled_before   : std_ulogic;
  signal dead_code        : dead_code_t; -- of the dead time
  signal codes            : codes_t;     -- what is left of that of each leg
  signal side             : legs_t;  -- that conducts or will
  signal high_on, low_on  : legs_t := (others => '0');

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

  process (clock) is
  begin
    if rising_edge(clock) then
      if dead_write = '1' then
        dead_code <= table(dead_place(dead));
      end if;
    end if;
  end process;

  process (clock) is
    variable over : std_ulogic; -- the dead time of this leg, now
  begin
    if rising_edge(clock) then
      -- A fault goes before all, then comes enable.
      enabled_before <= enable;
      running        <= enable and not seen and (running or not enabled_before);
      tripped        <= seen or (tripped and not (enable and not enabled_before));
      trip           <= seen and not tripped;

      for leg in 0 to legs - 1 loop
        over         := and codes(leg);
        codes(leg)   <= next_code(codes(leg));
        high_on(leg) <= side(leg) and (over or high_on(leg));
        low_on(leg)  <= not side(leg) and (over or low_on(leg));
        if reset = '1' or running = '0' or seen = '1' or driven(leg) = '0' or
           (sides(leg) /= side(leg) and hold = '0') then
          high_on(leg) <= '0';
          low_on(leg)  <= '0';
          side(leg)    <= sides(leg);
          codes(leg)   <= dead_code;
        end if;
      end loop;

      if reset = '1' then
        enabled_before <= '1';
        running        <= '0';
        tripped        <= '0';
        trip           <= '0';
      end if;
    end if;
  end process;

end architecture;
