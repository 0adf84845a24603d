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
-- keeps its level minus the counter, and adds the same step as the counter does. Duties and steps are in block RAM, and
-- in no register. Dead time and fault: see bridge_gates. Bits that a register does not have read as zero and are not
-- stored.
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
-- Reset     Disabled, all gates off. Then the steps are written, all duties become 0, and the dead time the least one,
--           in 6 clocks. Accesses wait for that.

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
  constant word_bits   : positive := maximum(duty_bits, dead_bits) + 1; -- of all words, with a sign
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
  subtype term_place_t is unsigned(3 downto 0);
  type terms_t is array (0 to 15) of level_t;
  type levels_t is array (0 to 2) of level_t;
  type wires_t is array (0 to 2) of wire_t;

  constant lowest : level_t := to_signed(1 - levels, level_t'length); -- half a level minus the largest counter

  -- A step of the counter, as a duty.
  constant step : stored_t := std_ulogic_vector(to_unsigned(2 ** (duty_bits - counter_bits), word_bits));

  -- The slots of a turn, in their order. A slot is also the end of the address of the duty that is read in it.
  subtype slot_t is unsigned(1 downto 0);
  constant slot_idle : slot_t := "01"; -- also the first one
  constant slot_last : slot_t := "10";

  -- The dead time and the duties at their addresses. What the phases add: a duty in a slot, else a step, up in the
  -- first half and down in the second one. No place is read and written at once: what that gives depends on the chip.
  signal memory : memory_t := (others => (others => '0'));
  signal terms  : terms_t  := (others => (others => '0'));

  -- The bus.
  signal address                  : place_t;                          -- its lowest bits
  signal asked, known, takes      : std_ulogic;
  signal is_stored, writes        : std_ulogic;                       -- the word is in the memory, and is written
  signal step_up, step_down       : std_ulogic;                       -- that is written
  signal ack, err                 : std_ulogic := '0';
  signal clearing, stepping       : std_ulogic := '1';                -- after a reset, see `move`
  signal busy                     : std_ulogic;                       -- one of them
  signal control                  : std_ulogic_vector(2 downto 0) := "000";
  signal place                    : place_t;                          -- that is written
  signal term_place, added_place  : term_place_t;                     -- the same of a term, and the one that is read
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
  signal counter  : unsigned(counter_bits + bits downto 0) := (others => '0'); -- in the period: levels and a fraction
  signal odd      : std_ulogic;                    -- the lowest bit of the levels
  signal odd_1    : std_ulogic := '0';             -- the same, a clock ago
  signal second   : std_ulogic;                    -- the second half of the period
  signal half     : std_ulogic := '0';             -- the same, a clock ago
  signal steps    : std_ulogic;                    -- the phases step
  signal moving   : std_ulogic := '0';             -- the counter: it is not in a turn
  signal slot     : slot_t     := slot_idle;       -- of the turn, or of the clearing
  signal holds    : std_ulogic;                    -- not all phases have their new duties
  signal loading  : std_ulogic;                    -- a turn before or in a run
  signal term     : level_t;                       -- from the memory: what is added
  signal addend   : level_t;                       -- the same, or the duty of a wire
  signal aboves   : levels_t;                      -- level minus counter; not from 0 on is low
  signal sides    : std_ulogic_vector(2 downto 0);

  -- A duty as a whole word, and in half levels.
  function signed_word (word : std_ulogic_vector) return stored_t is
  begin
    return std_ulogic_vector(resize(signed(word(duty_bits - 1 downto 0)), word_bits));
  end function;

  -- The slot in which a phase takes its duty: phase 2 in the second one.
  function loads_in (number : natural) return slot_t is
  begin
    return to_unsigned((number + 2) mod 4, slot_t'length);
  end function;

  function level_of (word : stored_t) return level_t is
  begin
    return resize(signed(word(word_bits - 1 downto duty_bits - 1 - counter_bits)), level_t'length);
  end function;

begin

  assert clock_hz / frequency_hz >= 8
    report "three_phase_pwm: a period needs at least 8 clocks, and frequency_hz gives " &
           integer'image(clock_hz / frequency_hz)
    severity failure;

  -- The bus. Writes wait while the memory gives levels.
  busy      <= clearing or stepping;
  address   <= unsigned(wishbone_m2s.adr(place_t'range));
  is_stored <= address(2) or address(1);
  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not busy;
  known     <= '1' when unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto place_t'length)) = 0 and
                        address < 6 and
                        (wishbone_m2s.we = '0' or
                         (address /= 1 and wishbone_m2s.sel(all_bytes'range) = all_bytes)) else '0';
  takes     <= asked and known and not (wishbone_m2s.we and loading);
  writes    <= busy or (takes and wishbone_m2s.we and is_stored);
  place     <= not slot(1) & slot when busy = '1' else address;
  is_dead   <= not place(2) and place(1) and not place(0);

  step_up     <= stepping and clearing;
  step_down   <= stepping and not clearing;
  term_place  <= stepping & step_down & place(slot'range);
  added_place <= moving & second & slot;

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
    if step_up = '1' then
      data <= step;
    elsif step_down = '1' then
      data <= std_ulogic_vector(-signed(step));
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
        memory(to_integer(place))     <= data;
        terms(to_integer(term_place)) <= level_of(data);
      end if;
      -- Not an `else` of the line above: GHDL 2.0 synthesises its condition without the `not`.
      if writes = '0' then
        found <= memory(to_integer(address));
      end if;
      -- A step is read in each clock, for none may be late. The place above is that of a duty then.
      if writes = '0' or (moving = '1' and stepping = '0') then
        term <= terms(to_integer(added_place));
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
      hold => holds, driven => "111", sides => sides, running => running, tripped => latched, trip => tripped,
      fault_seen => fault_seen, fault => fault, high => high, low => low);

  second  <= counter(counter'high);
  odd     <= counter(bits);
  steps   <= (odd xor odd_1) and (second xnor half);
  holds   <= '1' when slot /= slot_idle else '0';
  loading <= not moving and (running or holds);

  -- What is added to the levels: what was read in the slot before, or the duty of a wire.
  come : process (all) is
  begin
    addend <= term;
    for number in wires'range loop
      if moving = '0' and slot = loads_in(number) and valid(number) = '1' then
        addend <= level_of(signed_word(std_ulogic_vector(value_of(wires(number)))));
      end if;
    end loop;
  end process;

  -- The counter falls, then rises. `aboves` rise, then fall, a clock later.
  move : process (clock) is
    variable sum : unsigned(counter'high + 1 downto 0);
  begin
    if rising_edge(clock) then
      sum := ('0' & counter) + phase_increment(moves_hz, rate_hz);
      if moving = '1' then
        counter <= sum(counter'range);
      end if;
      moving <= '0';
      if sum(sum'high) = '0' and (moving = '1' or slot = slot_last) then
        moving <= '1';
      end if;
      odd_1  <= odd;
      half   <= second;
      sample <= (control(1) and half and not second) or (control(2) and second and not half);

      slot <= slot_idle;
      if loading = '1' or (clearing = '1' and stepping = '0') then
        slot <= slot - 1;
      end if;
      -- After a reset: the step up is written, then the step down, then the registers in four slots.
      if stepping = '1' then
        clearing <= not clearing;
        stepping <= clearing;
      elsif slot = slot_last then
        clearing <= '0';
      end if;

      for number in aboves'range loop
        if steps = '1' or (moving = '0' and slot = loads_in(number)) then
          aboves(number) <= aboves(number) + addend;
        end if;
        if running = '0' or (moving = '0' and holds = '0') then
          aboves(number) <= lowest;
        end if;
      end loop;

      if running = '0' then
        counter <= (others => '0');
        moving  <= '0';
        half    <= '0';
        sample  <= '0';
      end if;
      if reset = '1' then
        clearing <= '1';
        stepping <= '1';
        slot     <= slot_idle;
      end if;
    end if;
  end process;

end architecture;
