-- SPDX-License-Identifier: BSD-3-Clause
--
-- Field-oriented control of the currents of a three-phase motor, loop_hz times a second.
--
--   a, b --> Clarke --> Park --> d, q --> two PI --> vd, vq --> inverse --> SVPWM --> duties of three phases
--                        ^                                          ^
--   position --> electrical angle ---------------> + 1.5 periods ---'
--
--   +0   control: bit 0 enable, its rise also ends a trip; bit 1 align: the electrical angle is 0
--   +1   status (read): bit 0 running, 1 the voltage is at its limit, 2 tripped
--   +2   target d, +3 target q, in counts of a current, 16 bits, two's complement
--   +4   kp in 1/2**12 voltage counts per count, 17 bits    +5  ki in 1/2**16 per count and period, 17 bits
--   +6   limit of the voltage, 17 bits                      +7  offset: the electrical angle at the position 0, 16 bits
--   +8   apply (write): the loop takes kp and ki at its next period
--   +9   current d, +10 current q of the last period (read)               +11 its electrical angle, 2**16 a turn (read)
--
-- Formats   A count of a current is 2**current_shift counts of its wire, limited to 16 bits. The third current is the
--           negative sum of both. 2**16 voltage counts are half of the supply. So 75,674 is the most that a sine can
--           have, the supply over sqrt 3. Products have 36 bits. sine and cosine have 16 bits, of 1024 angles a turn.
-- Angle     position * pole_pairs / 2**angle_bits turns, and the offset. A duty takes effect about 1.5 periods later.
--           So the voltage is turned by so much, with the speed of the last periods, which a filter smooths.
-- PI        The voltage of d is at most 3/4 of the limit, and that of q the limit less half of that of d. So both are
--           within the circle. An integral that would lead beyond its limit stands there: it does not wind up.
-- SVPWM     Half of the sum of the largest and the smallest phase is taken away, so a sine may have 15 % more.
-- Safe      While enable is 0, no output wire is valid, and the integrals are 0, from the clock after the write on. So
--           0 is the safe value of the control word. An input that is not valid does the same in the next clock, and
--           trips: it stays so until enable rises. three_phase_pwm switches its gates off when the wires end.
-- Wires     current_a_wire, current_b_wire and position_wire are inputs. While target_q_wire is valid, the target q is
--           that of the wire, and a read of +3 gives it. The duties are valid from the end of the first period on.
-- Event     tripped is high for one clock.
-- Latency   A period begins with the currents of that clock, and 379 clocks later the duties are there. An access takes
--           2 clocks.
-- Errors    err for other addresses, for a write of +1 and of +9 to +11.
-- Reset     Disabled. Targets, gains and offset are 0, and the limit is 75,674.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity foc is
  generic (
    clock_hz         : positive                := 50_000_000;
    loop_hz          : positive                := 20_000;
    pole_pairs       : positive range 1 to 63  := 7;
    angle_bits       : positive range 4 to 16  := 14;
    current_shift    : natural range 0 to 10   := 2;
    duty_0_wire_bits : positive range 4 to 16  := 13;
    duty_1_wire_bits : positive range 4 to 16  := 13;
    duty_2_wire_bits : positive range 4 to 16  := 13;
    data_width       : positive range 32 to 32 := 32
  );
  port (
    clock          : in  std_ulogic;
    reset          : in  std_ulogic; -- synchronous
    wishbone_m2s   : in  wishbone_m2s_t;
    wishbone_s2m   : out wishbone_s2m_t;
    tripped        : out std_ulogic;

    current_a_wire : in  wire_t := no_wire;
    current_b_wire : in  wire_t := no_wire;
    position_wire  : in  wire_t := no_wire;
    target_q_wire  : in  wire_t := no_wire;
    duty_0_wire    : out wire_t;
    duty_1_wire    : out wire_t;
    duty_2_wire    : out wire_t
  );
end entity;

architecture rtl of foc is

  constant bits        : positive := phase_bits(clock_hz, loop_hz);
  constant work_clocks : positive := 384;
  constant limit_first : natural  := 75_674;

  constant inverse_root_3 : signed(17 downto 0) := to_signed(37_837, 18); -- * 2**16
  constant half_root_3    : signed(17 downto 0) := to_signed(56_756, 18);

  subtype number_t is signed(17 downto 0);
  subtype current_t is signed(15 downto 0);
  subtype integral_t is signed(35 downto 0); -- with 16 bits behind the point
  type number_vector_t is array (natural range <>) of number_t;

  type step_t is (
    idle, turn, beta_of, d_cosine, d_sine, q_cosine, q_sine, d_kp, d_ki, q_kp, q_ki, alpha_cosine, alpha_sine,
    beta_sine, beta_cosine, root, extremes, middle, give);
  type steps_t is array (step_t) of step_t;

  constant step_after : steps_t := (
    turn, beta_of, d_cosine, d_sine, q_cosine, q_sine, d_kp, d_ki, q_kp, q_ki, alpha_cosine, alpha_sine, beta_sine,
    beta_cosine, root, extremes, middle, give, idle);

  -- A current in 16 bits: too large a one becomes the largest.
  function current_of (value : signed(31 downto 0)) return current_t is
  begin
    if value > 32_767 then
      return to_signed(32_767, 16);
    elsif value < -32_767 then
      return to_signed(-32_767, 16);
    end if;
    return value(15 downto 0);
  end function;

  -- A duty in so many bits, of a voltage.
  function duty_of (voltage : signed; duty_bits : positive; valid : std_ulogic) return wire_t is
    constant most  : integer := 2 ** (duty_bits - 1) - 1;
    variable value : signed(voltage'length - 1 downto 0);
  begin
    value := shift_right(voltage, 17 - duty_bits);
    if value > most then
      value := to_signed(most, value'length);
    elsif value < -most then
      value := to_signed(-most, value'length);
    end if;
    return valid & std_ulogic_vector(resize(value, 32));
  end function;

  signal read_words  : word_vector_t(0 to 11);
  signal write_words : word_vector_t(0 to 11);
  signal written     : std_ulogic_vector(0 to 11);

  signal enable, aligns  : std_ulogic;
  signal enabled_before  : std_ulogic := '0';
  signal inputs_valid    : std_ulogic;
  signal is_tripped      : std_ulogic := '0';
  signal runs            : std_ulogic;
  signal given           : std_ulogic := '0'; -- a period has ended since the start
  signal stops           : std_ulogic;
  signal applies         : std_ulogic := '0';
  signal fresh           : std_ulogic := '1'; -- the first period: no speed is known

  signal phase : unsigned(bits downto 0) := (others => '0');
  signal step  : step_t := idle;
  signal loads : std_ulogic := '0'; -- the operands of this step are to be set

  signal start, done : std_ulogic := '0';
  signal left, right : number_t := (others => '0');
  signal product     : signed(35 downto 0);
  signal late       : std_ulogic_vector(1 to 4) := (others => '0'); -- so many clocks after `done`

  signal target_q     : current_t;
  signal kp, ki       : number_t := (others => '0');
  signal a, b         : current_t := (others => '0');
  signal targets      : number_vector_t(0 to 1) := (others => (others => '0'));
  signal limit        : number_t := (others => '0');
  signal offset       : unsigned(15 downto 0) := (others => '0');
  signal zeroed       : std_ulogic := '0';
  signal electrical   : unsigned(15 downto 0) := (others => '0');
  signal before       : unsigned(15 downto 0) := (others => '0');
  signal speed        : signed(18 downto 0) := (others => '0'); -- in 1/8 of the angle's counts a period
  signal change       : signed(18 downto 0) := (others => '0');
  signal lead         : unsigned(15 downto 0) := (others => '0'); -- what the angle moves in 1.5 periods
  signal angle        : unsigned(15 downto 0) := (others => '0'); -- of the table
  signal sine, cosine : signed(15 downto 0);
  signal beta         : number_t := (others => '0');
  signal sum          : signed(35 downto 0) := (others => '0');
  signal d, q         : number_t := (others => '0');
  signal error        : number_t := (others => '0');
  signal vd, vq       : number_t := (others => '0');
  signal integral_d, integral_q : integral_t := (others => '0');
  signal integral     : integral_t := (others => '0'); -- of this axis
  signal most, least  : number_t := (others => '0');   -- of the voltage of this axis
  signal is_above, is_below : boolean := false;
  signal voltage      : number_t := (others => '0');
  signal high_d, high_q : std_ulogic := '0'; -- the voltage is at its limit
  signal alpha        : number_t := (others => '0');
  signal highest, lowest : number_t := (others => '0');
  signal phases       : number_vector_t(0 to 2) := (others => (others => '0'));

  signal shown_d, shown_q : number_t := (others => '0');
  signal shown_angle      : unsigned(15 downto 0) := (others => '0');
  signal is_limited       : std_ulogic := '0';
  signal voltages         : number_vector_t(0 to 2) := (others => (others => '0'));
  signal duties_valid     : std_ulogic;

begin

  assert clock_hz / loop_hz >= work_clocks
    report "foc: a period is at least " & integer'image(work_clocks) & " clocks" severity failure;

  registers : entity work.register_slave
    generic map (
      writable   => "101111111000",
      data_width => data_width,
      initial    => (0 to 5 => (others => '0'), 6 => std_ulogic_vector(to_unsigned(limit_first, 32)),
                     7 to 11 => (others => '0')))
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  read_words <= (
    0  => extended(write_words(0)(1 downto 0)),
    1  => (0 => runs, 1 => is_limited, 2 => is_tripped, others => '0'),
    2  => std_ulogic_vector(resize(signed(write_words(2)(15 downto 0)), 32)),
    3  => std_ulogic_vector(resize(target_q, 32)),
    4  => extended(write_words(4)(16 downto 0)),
    5  => extended(write_words(5)(16 downto 0)),
    6  => extended(write_words(6)(16 downto 0)),
    7  => extended(write_words(7)(15 downto 0)),
    8  => (others => '0'),
    9  => std_ulogic_vector(resize(shown_d, 32)),
    10 => std_ulogic_vector(resize(shown_q, 32)),
    11 => extended(std_ulogic_vector(shown_angle)));

  enable       <= write_words(0)(0);
  aligns       <= write_words(0)(1);
  inputs_valid <= is_valid(current_a_wire) and is_valid(current_b_wire) and is_valid(position_wire);
  runs         <= enable and not is_tripped;
  stops        <= reset or not runs or not inputs_valid;

  target_q     <= current_of(value_of(target_q_wire)) when is_valid(target_q_wire) = '1' else
                  signed(write_words(3)(15 downto 0));

  duties_valid <= given and runs;
  duty_0_wire  <= duty_of(voltages(0), duty_0_wire_bits, duties_valid);
  duty_1_wire  <= duty_of(voltages(1), duty_1_wire_bits, duties_valid);
  duty_2_wire  <= duty_of(voltages(2), duty_2_wire_bits, duties_valid);

  multiplier : entity work.foc_multiplier
    port map (
      clock => clock, reset => stops, start => start, left => left, right => right, product => product, done => done);

  angles : entity work.foc_sine
    port map (clock => clock, angle => angle, sine => sine, cosine => cosine);

  run : process (clock) is
    variable whole : number_t;
    variable high  : std_ulogic;
  begin
    if rising_edge(clock) then
      phase          <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, loop_hz);
      enabled_before <= enable;
      tripped        <= '0';
      applies        <= applies or written(8);
      start          <= '0';
      loads          <= '0';
      late          <= done & late(1 to 3);

      if step = idle then
        if phase(bits) = '1' and runs = '1' then
          step    <= turn;
          loads   <= '1';
          a       <= current_of(shift_right(value_of(current_a_wire), current_shift));
          b       <= current_of(shift_right(value_of(current_b_wire), current_shift));
          targets <= (resize(signed(write_words(2)(15 downto 0)), 18), resize(target_q, 18));
          limit   <= signed('0' & write_words(6)(16 downto 0));
          offset  <= unsigned(write_words(7)(15 downto 0));
          zeroed  <= aligns;
          alpha   <= number_t(resize(signed('0' & std_ulogic_vector(value_of(position_wire)(15 downto 0))), 18));
          if applies = '1' then
            kp      <= signed('0' & write_words(4)(16 downto 0));
            ki      <= signed('0' & write_words(5)(16 downto 0));
            applies <= written(8);
          end if;
        end if;
      elsif loads = '1' then
        start <= '1';
        case step is
          when turn =>
            left  <= alpha;
            right <= to_signed(pole_pairs, 18);
          when beta_of =>
            left  <= resize(a, 18) + shift_left(resize(b, 18), 1);
            right <= inverse_root_3;
          when d_cosine =>
            left  <= resize(a, 18);
            right <= resize(cosine, 18);
          when d_sine =>
            left  <= beta;
            right <= resize(sine, 18);
          when q_cosine =>
            left  <= beta;
            right <= resize(cosine, 18);
          when q_sine =>
            left  <= resize(a, 18);
            right <= resize(sine, 18);
          when d_kp | q_kp =>
            left  <= error;
            right <= kp;
          when d_ki | q_ki =>
            left  <= error;
            right <= ki;
          when alpha_cosine | beta_cosine =>
            left  <= vd when step = alpha_cosine else vq;
            right <= resize(cosine, 18);
          when alpha_sine | beta_sine =>
            left  <= vd when step = beta_sine else vq;
            right <= resize(sine, 18);
          when root =>
            left  <= beta;
            right <= half_root_3;
          when others => null;
        end case;
      elsif done = '1' then
        case step is
          when turn =>
            electrical <= resize(unsigned(shift_left(product, 16 - angle_bits)), 16) + offset;
            if zeroed = '1' then
              electrical <= (others => '0');
            end if;
          when beta_of => beta <= product(33 downto 16);
          when d_cosine | q_cosine | alpha_cosine | beta_sine => sum <= product;
          when d_sine | beta_cosine => sum <= sum + product;
          when q_sine | alpha_sine => sum <= sum - product;
          when d_kp =>
            sum  <= shift_right(product, 12);
            most <= limit - shift_right(limit, 2);
          when q_kp =>
            sum  <= shift_right(product, 12);
            most <= limit - shift_right(vd, 1);
            if vd < 0 then
              most <= limit + shift_right(vd, 1);
            end if;
          when d_ki =>
            integral <= integral_d;
            if high_d = '0' or product(35) /= vd(17) then -- not further to the side where it is at its limit
              integral <= integral_d + product;
            end if;
          when q_ki =>
            integral <= integral_q;
            if high_q = '0' or product(35) /= vq(17) then
              integral <= integral_q + product;
            end if;
          when root =>
            phases <= (alpha, product(33 downto 16) - shift_right(alpha, 1),
                       -product(33 downto 16) - shift_right(alpha, 1));
          when others => null;
        end case;
      elsif late(1) = '1' then
        whole := limited(shift_right(sum, 15), 18);
        case step is
          when turn =>
            angle  <= electrical;
            before <= electrical;
            change <= shift_left(resize(signed(electrical - before), 19), 3);
          when d_sine      => d <= whole;
          when q_sine      =>
            q     <= whole;
            angle <= electrical + lead;
          when alpha_sine  => alpha <= whole;
          when beta_cosine => beta <= whole;
          when d_kp | q_kp => least <= -most;
          when others =>
            is_above <= shift_right(integral, 16) > most;
            is_below <= shift_right(integral, 16) < least;
        end case;
      elsif late(2) = '1' then
        case step is
          when turn   => change <= resize(shift_right(resize(change, 20) - speed, 3), 19);
          when d_sine => error <= limited(resize(targets(0), 19) - d, 18);
          when others =>
            if is_above then
              integral <= shift_left(resize(most, 36), 16);
            elsif is_below then
              integral <= shift_left(resize(least, 36), 16);
            end if;
        end case;
      elsif late(3) = '1' then
        if step = turn then
          fresh <= '0';
          speed <= speed + change when fresh = '0' else (others => '0');
        end if;
        voltage <= limited(sum + shift_right(integral, 16), 18);
      elsif late(4) = '1' then
        step  <= step_after(step);
        loads <= '1';
        whole := most when voltage >= most else least when voltage <= least else voltage;
        high  := to_bit(voltage >= most or voltage <= least);
        case step is
          when turn => lead <= unsigned(resize(shift_right(speed, 3) + shift_right(speed, 4), 16));
          when d_ki =>
            integral_d <= integral;
            vd         <= whole;
            high_d     <= high;
            error      <= limited(resize(targets(1), 19) - q, 18);
          when q_ki =>
            integral_q <= integral;
            vq         <= whole;
            high_q     <= high;
          when root   => loads <= '0';
          when others => null;
        end case;
      elsif step = extremes then
        highest <= phases(0);
        lowest  <= phases(0);
        for number in 1 to 2 loop -- maximum of numeric_std does not go through GHDL's Verilog
          if phases(number) >= phases(0) and phases(number) >= phases(3 - number) then
            highest <= phases(number);
          end if;
          if phases(number) <= phases(0) and phases(number) <= phases(3 - number) then
            lowest <= phases(number);
          end if;
        end loop;
        step <= middle;
      elsif step = middle then
        beta <= resize(shift_right(resize(highest, 19) + lowest, 1), 18);
        step <= give;
      elsif step = give then
        step        <= idle;
        shown_d     <= d;
        shown_q     <= q;
        shown_angle <= electrical;
        is_limited  <= high_d or high_q;
        given       <= '1';
        for number in 0 to 2 loop
          voltages(number) <= limited(resize(phases(number), 19) - beta, 18);
        end loop;
      end if;

      if enable = '1' and enabled_before = '0' then
        is_tripped <= '0';
      end if;
      if runs = '1' and inputs_valid = '0' then
        is_tripped <= '1';
        tripped    <= '1';
      end if;
      if stops = '1' then
        step       <= idle;
        loads      <= '0';
        late      <= (others => '0');
        integral_d <= (others => '0');
        integral_q <= (others => '0');
        high_d     <= '0';
        high_q     <= '0';
        is_limited <= '0';
        fresh      <= '1';
        given      <= '0';
      end if;

      if reset = '1' then
        phase       <= (others => '0');
        applies     <= '0';
        kp          <= (others => '0');
        ki          <= (others => '0');
        is_tripped  <= '0';
        tripped     <= '0';
        shown_d     <= (others => '0');
        shown_q     <= (others => '0');
        shown_angle <= (others => '0');
        voltages    <= (others => (others => '0'));
      end if;
    end if;
  end process;

end architecture;
