-- SPDX-License-Identifier: BSD-3-Clause
--
-- Drives a DC motor in both directions through an H-bridge, with dead time and a fault input.
--
--   +0  control: bit 0 enable, bit 1 coast: off times switch all gates off, else both low sides brake
--   +1  status: bit 0 running, bit 1 tripped, bit 2 the fault input is active now          (read only)
--   +2  dead time in ns, 0 to 4095; a time below dead_minimum_ns becomes dead_minimum_ns
--   +3  duty, signed: its size is the share of a period for which the motor is driven, its sign the direction
--
--   on   ____/‾‾\____/‾‾\      the pulse is at the end of a period, so the sign changes when it has just ended
--        |------|              a period
--
-- Pins      form 0, four gates: 0 high A, 1 low A, 2 high B, 3 low B. Forward is high A and low B.
--           form 1, IN/IN: 0 IN1, 1 IN2. 10 is forward, 01 back, 11 brakes, 00 coasts.
--           form 2, PH/EN: 0 PH, 1 EN. PH 1 is forward. EN 0 does what the driver does then, so coast means nothing.
-- Wire      While duty_wire is valid, the duty is that of the wire, and a read of +3 gives it.
-- A new duty takes effect at the start of a period. Dead time and fault: see bridge_gates, also for forms 1 and 2.
--
-- Events    tripped: a fault cuts.
-- Latency   2 clocks per access (register_slave). From the write of control to the pins 3 clocks, and the dead time.
-- Errors    err for a write to +1 and for addresses from 4 on.
-- Reset     Disabled, all gates off, duty 0, and the least dead time.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.dead_time_pkg.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity h_bridge is
  generic (
    clock_hz        : positive                := 50_000_000;
    frequency_hz    : positive                := 20_000;
    duty_bits       : positive range 6 to 16  := 13;
    form            : natural range 0 to 2    := 0;
    dead_minimum_ns : natural range 0 to 4095 := 500;
    fault_level     : natural range 0 to 1    := 1;
    data_width      : positive range 16 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    tripped      : out std_ulogic;

    duty_wire    : in  wire_t := no_wire; -- the duty, from another component

    fault        : in  std_ulogic; -- asynchronous
    pins         : out std_ulogic_vector(3 downto 0)
  );
end entity;

architecture rtl of h_bridge is

  constant bits : positive := phase_bits(clock_hz, frequency_hz);

  subtype size_t is unsigned(duty_bits - 2 downto 0);
  subtype legs_t is std_ulogic_vector(1 downto 0); -- A is 0, B is 1

  signal read_words  : word_vector_t(0 to 3);
  signal write_words : word_vector_t(0 to 3);

  signal duty : std_ulogic_vector(duty_bits - 1 downto 0); -- of the register, or of the wire

  signal running, latched, fault_seen : std_ulogic;
  signal dead        : dead_t;                  -- that is used
  signal phase       : unsigned(bits downto 0); -- of the period; its highest bit is the tick of rate_pkg
  signal size        : size_t;                  -- of the duty of this period; one less if it is negative
  signal back        : std_ulogic;              -- it is negative
  signal sides       : legs_t;
  signal driven      : legs_t;
  signal high, low   : legs_t;
  signal forward     : std_ulogic_vector(1 downto 0); -- 0 as in `sides`, 1 a clock later, as the gates

begin

  assert duty_bits < bits
    report "h_bridge: duty_bits is at most " & integer'image(bits - 1) & " at this clock and frequency, got " &
           integer'image(duty_bits)
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "1011", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words);

  read_words <= (
    0 => extended(write_words(0)(1 downto 0)),
    1 => (0 => running, 1 => latched, 2 => fault_seen, others => '0'),
    2 => extended(dead),
    3 => std_ulogic_vector(resize(signed(duty), word_t'length)));

  duty <= duty_wire(duty'range) when is_valid(duty_wire) = '1' else write_words(3)(duty'range);

  dead <= at_least(write_words(2)(dead_t'range), dead_minimum_ns);

  gates : entity work.bridge_gates
    generic map (
      clock_hz => clock_hz, legs => 2, dead_minimum_ns => dead_minimum_ns, fault_level => fault_level)
    port map (
      clock => clock, reset => reset, enable => write_words(0)(0), dead => dead, dead_write => not reset,
      driven => driven, sides => sides, running => running, tripped => latched,
      trip => tripped, fault_seen => fault_seen, fault => fault, high => high, low => low);

  process (clock) is
    variable sum    : unsigned(duty_bits downto 0); -- its highest bit: on. Its lowest carries 1 into a negative size
    variable on_now : std_ulogic;
  begin
    if rising_edge(clock) then
      phase <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, frequency_hz);
      if running = '0' then
        phase <= (others => '0');
      end if;

      if running = '0' or phase(bits) = '1' then
        back <= duty(duty_bits - 1);
        size <= unsigned(duty(size_t'range)) xor (size_t'range => duty(duty_bits - 1));
      end if;

      -- The last bit of the counter is 1, so that the size 0 is never on, and the largest always is.
      sum     := ('0' & phase(bits - 1 downto bits - duty_bits + 2) & "11") + (size & back);
      on_now  := sum(sum'high);
      sides   <= (on_now and back) & (on_now and not back);
      driven  <= (others => on_now or not write_words(0)(1));
      forward <= forward(0) & not back;

      if reset = '1' then
        forward <= "00";
      end if;
    end if;
  end process;

  four_gates : if form = 0 generate
    pins <= low(1) & high(1) & low(0) & high(0);
  end generate;

  in_in : if form = 1 generate
    pins <= "00" & (high or (high'range => and low));
  end generate;

  ph_en : if form = 2 generate
    pins <= "00" & ((high(0) and low(1)) or (high(1) and low(0))) & forward(1);
  end generate;

end architecture;
