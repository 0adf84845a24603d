-- SPDX-License-Identifier: BSD-3-Clause
--
-- Three-phase, centre-aligned PWM on the Wishbone bus, with dead time and a fault input: the inverter of a motor.
--
--   +0      control: bit 0 enable, bit 1 sample at the start, bit 2 sample in the middle of each period
--   +1      status: bit 0 running, bit 1 tripped, bit 2 the fault input is active now, bit 3 lost   (read only)
--   +2      dead time in ns, 0 to 4095; a time below dead_minimum_ns becomes dead_minimum_ns
--   +3 + n  duty of phase n, signed: the largest number is always high, the smallest always low, 0 is half
--
--   counter  \    /\    /      one counter for all phases, 2**(duty_bits - 2) levels
--             \  /  \  /
--              \/    \/
--   high     ___/‾\___/‾\__    from where the counter falls below the level of the phase until it rises above it
--            |-----|           a period begins where the counter is largest and all low sides conduct
--
-- New duties of all phases take effect together, at the start of a period. So each pulse is a whole old one or a whole
-- new one. Dead time and fault: see bridge_gates. Bits that a register does not have read as zero and are not stored.
--
-- Wires     While duty_n_wire is valid, duty n is that of the wire, and a read of +3 + n gives it. A wire that ends
--           while enable is 1 switches all gates off within 2 clocks. They stay off until enable rises; `lost` is 1.
--
-- Events    sample: at the start and in the middle of a period, as `control` says. tripped: a fault cuts.
-- Latency   2 clocks per access (register_slave). From the write of control to the gates 3 clocks, and the dead time.
--           From the counter to the gates 2 clocks.
-- Errors    err for a write to +1 and for addresses from 6 on.
-- Reset     Disabled, all gates off, all duties 0, and the least dead time.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
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

  constant bits : positive := phase_bits(clock_hz, frequency_hz);

  subtype duty_t is unsigned(duty_bits - 1 downto 0);
  subtype level_t is unsigned(duty_bits - 2 downto 0);
  type levels_t is array (0 to 2) of level_t;
  type wires_t is array (0 to 2) of wire_t;

  signal read_words  : word_vector_t(0 to 5);
  signal write_words : word_vector_t(0 to 5);

  signal wires      : wires_t;
  signal duties     : word_vector_t(0 to 2);         -- of the registers, or of the wires
  signal valid      : std_ulogic_vector(2 downto 0); -- of the wires
  signal valid_before : std_ulogic_vector(2 downto 0);
  signal ends       : std_ulogic;                    -- a wire, now
  signal lost       : std_ulogic := '0';             -- a wire has ended since the last start

  signal enable, enabled_before, drives, running, latched, fault_seen : std_ulogic;
  signal dead_used : std_ulogic_vector(11 downto 0);
  signal phase     : unsigned(bits downto 0); -- of the period; its highest bit is the tick of rate_pkg
  signal second    : std_ulogic;              -- the second half of the period
  signal half      : std_ulogic;              -- the same, a clock ago
  signal inverse   : level_t;                 -- of the counter: to add it costs less than to compare
  signal levels    : levels_t;                -- of this period
  signal sides     : std_ulogic_vector(2 downto 0);

  -- The duty as a number from 0, without its last bit. So the smallest two are 0.
  function level_of (word : word_t) return level_t is
    variable duty : duty_t;
  begin
    duty            := unsigned(word(duty_t'range));
    duty(duty'high) := not duty(duty'high);
    return duty(duty'high downto 1);
  end function;

  function signed_word (word : word_t) return word_t is
  begin
    return std_ulogic_vector(resize(signed(word(duty_t'range)), word_t'length));
  end function;

begin

  assert duty_bits < bits
    report "three_phase_pwm: duty_bits is at most " & integer'image(bits - 1) & " at this clock and frequency, got " &
           integer'image(duty_bits)
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "101111", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words);

  read_words <= (
    0 => extended(write_words(0)(2 downto 0)),
    1 => (0 => running, 1 => latched, 2 => fault_seen, 3 => lost, others => '0'),
    2 => extended(dead_used),
    3 => duties(0),
    4 => duties(1),
    5 => duties(2));

  wires <= (duty_0_wire, duty_1_wire, duty_2_wire);

  each_phase : for number in duties'range generate
    valid(number)  <= is_valid(wires(number));
    duties(number) <= signed_word(std_ulogic_vector(value_of(wires(number)))) when valid(number) = '1' else
                      signed_word(write_words(3 + number));
  end generate;

  enable <= write_words(0)(0);
  ends   <= or (valid_before and not valid);
  drives <= enable and not ends and (not lost or not enabled_before);

  gates : entity work.bridge_gates
    generic map (
      clock_hz => clock_hz, legs => 3, dead_minimum_ns => dead_minimum_ns, fault_level => fault_level)
    port map (
      clock => clock, reset => reset, enable => drives, dead => write_words(2)(11 downto 0), dead_used => dead_used,
      driven => "111", sides => sides, running => running, tripped => latched, trip => tripped,
      fault_seen => fault_seen, fault => fault, high => high, low => low);

  -- The counter falls, then rises. Its last bit is 0, so that the largest level is always above it.
  second  <= phase(bits - 1);
  inverse <= (phase(bits - 2 downto bits - duty_bits + 1) xor (duty_bits - 3 downto 0 => second)) & '1';

  process (clock) is
    variable sum : unsigned(level_t'high + 1 downto 0); -- its highest bit: the counter is below the level
  begin
    if rising_edge(clock) then
      phase  <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, frequency_hz);
      half   <= second;
      sample <= (write_words(0)(1) and phase(bits)) or (write_words(0)(2) and second and not half);
      if running = '0' then
        phase  <= (others => '0');
        sample <= '0';
      end if;

      for number in levels'range loop
        if running = '0' or phase(bits) = '1' then
          levels(number) <= level_of(duties(number));
        end if;
        sum           := ('0' & inverse) + levels(number);
        sides(number) <= sum(sum'high);
      end loop;

      enabled_before <= enable;
      valid_before   <= valid;
      if enable = '1' then
        lost <= ends or (lost and enabled_before);
      end if;

      if reset = '1' then
        sample <= '0';
        lost   <= '0';
      end if;
    end if;
  end process;

end architecture;
