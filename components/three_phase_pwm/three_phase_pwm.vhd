-- SPDX-License-Identifier: BSD-3-Clause
--
-- Three-phase, centre-aligned PWM on the Wishbone bus, with dead time and a fault input: the inverter of a motor.
--
--   +0      control: bit 0 enable, bit 1 sample at the start, bit 2 sample in the middle of each period
--   +1      status: bit 0 running, bit 1 tripped, bit 2 the fault input is active now, bit 3 lost   (read only)
--   +2      dead time in ns, 0 to 4095; a time below dead_minimum_ns becomes dead_minimum_ns
--   +3 + n  duty of phase n, signed: the largest number is always high, the smallest always low, 0 is half
--
--   counter  \    /\    /      one counter for all phases, of at most 2**(duty_bits - 2) levels
--             \  /  \  /
--              \/    \/
--   high     ___/‾\___/‾\__    from where the counter falls below the level of the phase until it rises above it
--            |-----|           a period begins where the counter is largest and all low sides conduct
--
-- New duties take effect at the start of a period. There the counter stands for 4 clocks, the turn, in which the phases
-- 2, 1 and 0 take their duties. So each pulse is a whole old one or a whole new one. Each phase follows the counter: it
-- keeps its level minus the counter, and adds the same step as the counter does. Duties are in block RAM, and in no
-- register. Dead time and fault: see bridge_gates. Bits that a register does not have read as zero and are not stored.
--
-- Generics  The counter has the largest power of two of levels with which no level lasts less than a clock, but at most
--           2**(duty_bits - 2). A duty is rounded to these.
-- Wires     While duty_n_wire is valid, duty n is that of the wire, and a read of +3 + n gives it. A wire that ends
--           while enable is 1 switches all gates off within 2 clocks. They stay off until enable rises; `lost` is 1.
--
-- Events    sample: at the start of a period, except the first one, and in the middle, as `control` says.
--           tripped: a fault cuts.
-- Latency   2 clocks per access. A write waits for the end of a turn, up to 4 clocks more. From the write of control to
--           the gates 3 clocks, and the dead time. From the counter to the gates 2 clocks.
-- Errors    err for a write to +1, for addresses from 6 on, and for writes that do not select all bytes.
-- Reset     Disabled, all gates off. Then all duties become 0, and the dead time the least one, in 4 clocks. Accesses
--           wait for that.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.dead_time_pkg.all;
  use work.rate_pkg.all;
  use work.width_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity three_phase_pwm is
  generic (
    clock_hz        : positive                := 50_000_000;
    frequency_hz    : positive                := 20_000;
    duty_bits       : positive range 6 to 16  := 13;
    dead_minimum_ns : natural range 0 to 4095 := 500;
    fault_level     : natural range 0 to 1    := 1;
    data_width      : positive range 16 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sample       : out std_ulogic;
    tripped      : out std_ulogic;

    duty_0_wire  : in  wire_t := no_wire; -- the duties, from another component
    duty_1_wire  : in  wire_t := no_wire;
    duty_2_wire  : in  wire_t := no_wire;

    fault        : in  std_ulogic; -- asynchronous
    high         : out std_ulogic_vector(2 downto 0);
    low          : out std_ulogic_vector(2 downto 0)
  );
end entity;

architecture rtl of three_phase_pwm is

  constant turn_clocks : positive := 4;
  constant word_bits   : positive := maximum(duty_bits, dead_bits + 1); -- so the highest bit of a dead time is 0
  constant all_bytes   : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  function counter_bits return positive is
    variable bits : positive := 1;
  begin
    while bits < duty_bits - 2 and 2 ** (bits + 2) + turn_clocks <= clock_hz / frequency_hz loop
      bits := bits + 1;
    end loop;
    return bits;
  end function;

  constant levels    : positive := 2 ** counter_bits;
  constant rate_hz   : positive := 2 * levels * frequency_hz;                    -- of the counter's steps
  constant moves_hz  : positive := maximum(1, clock_hz - turn_clocks * frequency_hz); -- of the clocks with steps
  constant bits      : positive := phase_bits(moves_hz, rate_hz);

  subtype place_t is unsigned(2 downto 0);
  subtype stored_t is std_ulogic_vector(word_bits - 1 downto 0);
  subtype level_t is signed(counter_bits + 1 downto 0); -- in half levels
  type memory_t is array (0 to 7) of stored_t;
  type terms_t is array (0 to 7) of level_t;
  type levels_t is array (0 to 2) of level_t;
  type wires_t is array (0 to 2) of wire_t;

  constant lowest : level_t := to_signed(1 - 2 * levels, level_t'length); -- level 0 minus the largest counter

  -- The dead time and the duties at their addresses, and the duties as levels. A memory is never read and written at
  -- once: what such a read gives depends on the chip.
  signal memory : memory_t := (others => (others => '0'));
  signal terms  : terms_t  := (others => (others => '0'));

  -- The bus.
  signal address                  : place_t;                          -- its lowest bits
  signal asked, known, takes      : std_ulogic;
  signal is_stored, writes        : std_ulogic;                       -- the word is in the memory, and is written
  signal ack, err                 : std_ulogic := '0';
  signal clearing                 : std_ulogic := '1';
  signal control                  : std_ulogic_vector(2 downto 0) := "000";
  signal place, slot_place        : place_t;                          -- that is written, and that of the slot
  signal is_dead                  : std_ulogic;                       -- the dead time is written
  signal data, found              : stored_t;
  signal few                      : std_ulogic_vector(3 downto 0);    -- of control or status
  signal by_wire                  : std_ulogic;                       -- the word that is read is that of a wire
  signal wire_word                : stored_t;

  -- The start.
  signal wires                           : wires_t;
  signal valid, valid_before             : std_ulogic_vector(2 downto 0); -- the wires
  signal ends                            : std_ulogic;                    -- a wire, now
  signal lost                            : std_ulogic := '0';             -- one has ended since the last start
  signal enable, enabled_before, drives  : std_ulogic;
  signal running, latched, fault_seen    : std_ulogic;

  -- The counter.
  signal fraction : unsigned(bits downto 0)         := (others => '0'); -- its highest bit: the counter steps
  signal position : unsigned(counter_bits downto 0) := (others => '0'); -- in the period, in levels
  signal stepped  : std_ulogic                      := '0';
  signal second   : std_ulogic;                                         -- the second half of the period
  signal half     : std_ulogic                      := '0';             -- the same, a clock ago
  signal turn     : std_ulogic                      := '1';             -- the counter stands
  signal slot     : unsigned(1 downto 0)            := "00";            -- of the turn, or of the clearing
  signal loading  : std_ulogic;                                         -- a turn before or in a run
  signal term     : level_t;                                            -- from the memory: what is added
  signal addend   : level_t;                                            -- the same, or that of a wire
  signal aboves   : levels_t;                                           -- level minus counter; not from 0 on is low
  signal sides    : std_ulogic_vector(2 downto 0);

  -- The duty in whole words, and as a level from 0.
  function signed_word (word : std_ulogic_vector) return stored_t is
  begin
    return std_ulogic_vector(resize(signed(word(duty_bits - 1 downto 0)), word_bits));
  end function;

  function level_of (word : stored_t) return level_t is
  begin
    return '0' & not word(duty_bits - 1) & signed(word(duty_bits - 2 downto duty_bits - 1 - counter_bits));
  end function;

begin

  assert clock_hz / frequency_hz >= 8
    report "three_phase_pwm: a period needs at least 8 clocks, and frequency_hz gives " &
           integer'image(clock_hz / frequency_hz)
    severity failure;

  -- The bus. Writes wait while the memory gives levels.
  address   <= unsigned(wishbone_m2s.adr(place_t'range));
  is_stored <= address(2) or address(1);
  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not clearing;
  known     <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto place_t'length)) = 0 and
                        address < 6 and
                        (wishbone_m2s.we = '0' or
                         (address /= 1 and wishbone_m2s.sel(all_bytes'range) = all_bytes)) else '0';
  takes     <= asked and known and not (wishbone_m2s.we and loading);
  writes    <= clearing or (takes and wishbone_m2s.we and is_stored);
  slot_place <= 5 - ('0' & slot);
  place     <= slot_place when clearing = '1' else address;
  is_dead   <= not place(2) and place(1) and not place(0);

  choose : process (all) is
  begin
    data <= signed_word(wishbone_m2s.dat);
    if clearing = '1' then
      data <= (others => '0');
    end if;
    if is_dead = '1' then
      data               <= (others => '0');
      data(dead_t'range) <= at_least(wishbone_m2s.dat(dead_t'range) and (dead_t'range => not clearing),
                                     dead_minimum_ns);
    end if;
  end process;

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack <= takes;
      err <= asked and not known;
      if (takes and wishbone_m2s.we and not is_stored) = '1' then
        control <= wishbone_m2s.dat(control'range);
      end if;
      if writes = '1' then
        memory(to_integer(place)) <= data;
        terms(to_integer(place))  <= level_of(data);
      end if;
      -- Not an `else` of the line above: GHDL 2.0 synthesises its condition without the `not`.
      if writes = '0' then
        found <= memory(to_integer(address));
        term  <= terms(to_integer(slot_place));
      end if;

      few <= "0000";
      if address = 0 then
        few <= '0' & control;
      elsif address = 1 then
        few <= lost & fault_seen & latched & running;
      end if;

      by_wire <= '0';
      for number in wires'range loop
        if address = 3 + number then
          by_wire   <= valid(number);
          wire_word <= signed_word(std_ulogic_vector(value_of(wires(number))));
        end if;
      end loop;

      if reset = '1' then
        ack     <= '0';
        err     <= '0';
        control <= "000";
      end if;
    end if;
  end process;

  -- Control and status are not in the memory, so the word found is zero there.
  reply : process (all) is
    variable whole : stored_t;
  begin
    whole := found;
    if by_wire = '1' then
      whole := wire_word;
    end if;
    whole(few'range) := whole(few'range) or few;

    wishbone_s2m                              <= wishbone_s2m_idle;
    wishbone_s2m.ack                          <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err                          <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.dat(data_width - 1 downto 0) <= std_ulogic_vector(resize(signed(whole), data_width));
  end process;

  -- The gates.
  wires <= (duty_0_wire, duty_1_wire, duty_2_wire);

  each_phase : for number in wires'range generate
    valid(number) <= is_valid(wires(number));
    sides(number) <= not aboves(number)(level_t'high);
  end generate;

  enable <= control(0);
  ends   <= or (valid_before and not valid);
  drives <= enable and not ends and (not lost or not enabled_before);

  start : process (clock) is
  begin
    if rising_edge(clock) then
      enabled_before <= enable;
      valid_before   <= valid;
      if enable = '1' and enabled_before = '0' then
        lost <= '0';
      end if;
      if enable = '1' and ends = '1' then
        lost <= '1';
      end if;
      if reset = '1' then
        lost <= '0';
      end if;
    end if;
  end process;

  gates : entity work.bridge_gates
    generic map (
      clock_hz => clock_hz, legs => 3, dead_minimum_ns => dead_minimum_ns, fault_level => fault_level)
    port map (
      clock => clock, reset => reset, enable => drives, dead => data(dead_t'range), dead_write => writes and is_dead,
      hold => or slot, driven => "111", sides => sides, running => running, tripped => latched, trip => tripped,
      fault_seen => fault_seen, fault => fault, high => high, low => low);

  second  <= position(counter_bits);
  loading <= turn and (running or or (slot));

  -- What is added to the levels: in a turn the levels of the duties, which the slot before has read, else a step up or
  -- down.
  come : process (all) is
  begin
    addend    <= (others => second);
    addend(1) <= '1';
    addend(0) <= '0';
    if loading = '1' then
      addend <= term;
    end if;
    for number in wires'range loop
      if loading = '1' and slot = 3 - number and valid(number) = '1' then
        addend <= level_of(signed_word(std_ulogic_vector(value_of(wires(number)))));
      end if;
    end loop;
  end process;

  -- The counter falls, then rises. `aboves` rise, then fall, a clock later.
  move : process (clock) is
    variable wraps : unsigned(counter_bits + 1 downto 0);
  begin
    if rising_edge(clock) then
      stepped <= fraction(bits) and not turn;
      half    <= second;
      sample  <= (control(1) and half and not second) or (control(2) and second and not half);
      if turn = '0' then
        fraction <= ('0' & fraction(bits - 1 downto 0)) + phase_increment(moves_hz, rate_hz);
      end if;
      if turn = '0' and fraction(bits) = '1' then
        wraps    := ('0' & position) + 1;
        position <= wraps(position'range);
        turn     <= wraps(wraps'high);
      end if;

      slot <= "00";
      if clearing = '1' or loading = '1' then
        slot <= slot + 1;
      end if;
      clearing <= clearing and nand slot;
      if slot = 3 then
        turn <= '0';
      end if;

      for number in aboves'range loop
        if (stepped = '1' and half = second) or (loading = '1' and slot = 3 - number) then
          aboves(number) <= aboves(number) + addend;
        end if;
        if (turn = '1' and slot = 0) or running = '0' then
          aboves(number) <= lowest;
        end if;
      end loop;

      if running = '0' then
        fraction <= (others => '0');
        position <= (others => '0');
        turn     <= '1';
        half     <= '0';
        sample   <= '0';
      end if;
      if reset = '1' then
        clearing <= '1';
        slot     <= "00";
      end if;
    end if;
  end process;

end architecture;
