-- SPDX-License-Identifier: BSD-3-Clause
--
-- A control loop: it brings a value of one component to a target by an output of another one, loop_hz times a second.
--
--   target   --+--> error --> kp, ki ---+
--              |                        |    limit
--   feedback --+--> rate of change, kd -+--> _/‾ ----> output
--                                       |
--   target velocity, acceleration, kv, ka
--
--   +0   control: bit 0 enable. Its rise also ends a trip.
--   +1   status (read): bit 0 running, 1 the output is at its limit, 2 tripped, 3 the feedback was not valid
--   +2   target in counts of the feedback, two's complement
--   +3   target velocity in 1/256 count a period, 24 bits
--   +4   target acceleration in 1/2**24 count a period squared, 24 bits
--   +5   kp in 1/2**16 output counts per count, 24 bits       +6  ki in 1/2**24 per count and period
--   +7   kd in 1/256 per count a period                       +8  kv as kd, of the target velocity
--   +9   ka in 256 per count a period squared, of the target acceleration
--   +10  limit of the output, in its counts                   +11 error at which it trips, 24 bits; 0 never
--   +12  apply (write): the loop takes all gains, kp to ka, at its next period. It takes them when it starts, too.
--   +13  output (read)                                        +14 error (read)
--
-- Formats   The error is a difference of 32 bits, which may wrap, and is then limited to 24 bits. The rate of change is
--           filtered: each period it moves 1/2**filter_bits of its way. It is of the feedback, so a step of the target
--           gives no kick. Each product has 49 bits. The integral has 24 bits behind the point and is limited to
--           `limit`. It stands still while the output is at the limit to which the error leads. No sum overflows. The
--           output is limited last.
-- Safe      While enable is 0 the output is `safe`, and the integral is 0, from the clock after the write on. So 0 is
--           the safe value of the control word. A loop that trips does the same: its error is too large, or its
--           feedback is not valid. It stays so until enable rises.
-- Wires     feedback_wire: what is measured. target_wire: while it is valid, it is the target.
--           target_velocity_wire and target_acceleration_wire are the same for +3 and +4, limited to 24 bits.
--           output_wire is always valid.
-- Event     tripped is high for one clock.
-- Latency   A period begins with the feedback of that clock, and 127 clocks later the output is there. An access takes
--           2 clocks.
-- Errors    err for other addresses, for a write of +1, +13 or +14, and for one that does not select all bytes.
-- Reset     Disabled. Targets and gains are 0, and the limit is the most that the output can be.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.register_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity pid is
  generic (
    clock_hz    : positive                := 50_000_000;
    loop_hz     : positive                := 20_000;
    filter_bits : natural range 0 to 8    := 3;
    safe        : integer                 := 0;
    output_wire_bits : positive range 4 to 32  := 13;
    data_width  : positive range 32 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    tripped      : out std_ulogic;

    feedback_wire            : in  wire_t := no_wire;
    target_wire              : in  wire_t := no_wire;
    target_velocity_wire     : in  wire_t := no_wire;
    target_acceleration_wire : in  wire_t := no_wire;
    output_wire              : out wire_t
  );
end entity;

architecture rtl of pid is

  constant gain_bits   : positive := 24;
  constant terms       : positive := 4;  -- that are summed at once, a bit of all gains at a time
  constant bits        : positive := phase_bits(clock_hz, loop_hz);
  constant work_clocks : positive := 130;

  constant wide_bits   : positive := maximum(2 * gain_bits + 5, output_wire_bits + gain_bits + 1);

  constant most : unsigned(output_wire_bits - 2 downto 0) := (others => '1');

  subtype gain_t is unsigned(gain_bits - 1 downto 0);
  subtype term_t is signed(gain_bits downto 0);
  subtype sum_t is signed(2 * gain_bits + 3 downto 0);
  subtype integral_t is signed(wide_bits - 1 downto 0);
  subtype limit_t is unsigned(output_wire_bits - 2 downto 0);
  subtype value_t is signed(output_wire_bits - 1 downto 0);
  subtype total_t is signed(2 * gain_bits + 8 downto 0);
  type gains_t is array (0 to terms) of gain_t; -- kp, kd, kv, ka, and ki
  type term_vector_t is array (0 to terms - 1) of term_t;
  type state_t is (idle, look, smooth, integrate, add, clamp, weigh, total, give);

  constant ki : natural := terms;

  -- Too large a limit is the largest.
  function limit_of (word : word_t) return limit_t is
  begin
    if unsigned(word(30 downto 0)) > most then
      return most;
    end if;
    return unsigned(word(limit_t'range));
  end function;

  -- Is a number at the upper limit or above, or is it below the lower one? Most of its bits are only compared with its
  -- sign. So a long chain of carries is not needed.
  function is_above (number : signed; upper : limit_t) return boolean is
    constant bits : signed(number'length - 1 downto 0) := number;
  begin
    return bits(bits'high) = '0' and
           ((or bits(bits'high downto value_t'high)) = '1' or unsigned(bits(limit_t'range)) >= upper);
  end function;

  function is_below (number : signed; lower : value_t) return boolean is
    constant bits : signed(number'length - 1 downto 0) := number;
  begin
    return bits(bits'high) = '1' and ((and bits(bits'high downto value_t'high)) = '0' or bits(value_t'range) < lower);
  end function;

  -- What a wire or a register says of the target's motion. A wire that is valid comes first.
  function given (wire : wire_t; word : word_t) return term_t is
  begin
    if is_valid(wire) = '1' then
      return resize(limited(value_of(wire), gain_bits), term_t'length);
    end if;
    return resize(signed(word(gain_bits - 1 downto 0)), term_t'length);
  end function;

  constant first : word_vector_t(0 to 15) :=
    (10 => std_ulogic_vector(resize(most, word_t'length)), others => (others => '0'));

  signal read_words  : word_vector_t(0 to 15);
  signal write_words : word_vector_t(0 to 15);
  signal written     : std_ulogic_vector(0 to 15);

  signal enable           : std_ulogic;
  signal enabled_before   : std_ulogic := '0';
  signal is_tripped, lost : std_ulogic := '0';
  signal runs             : std_ulogic;
  signal applies          : std_ulogic := '0'; -- gains wait for the next period
  signal fresh            : std_ulogic := '1'; -- the first period: nothing has been measured before

  signal started          : std_ulogic := '0'; -- this period, and nothing has ended it

  signal phase     : unsigned(bits downto 0) := (others => '0');
  signal state     : state_t := idle;
  signal bit_count : natural range 0 to gain_bits - 1 := 0;
  signal term      : natural range 0 to terms - 1 := 0;

  signal gains     : gains_t := (others => (others => '0')); -- they turn, and so are whole again after gain_bits
  signal operands  : term_vector_t := (others => (others => '0'));
  signal error     : signed(31 downto 0) := (others => '0');
  signal before    : signed(31 downto 0) := (others => '0'); -- the feedback of the last period
  signal moved     : signed(31 downto 0) := (others => '0');
  signal filtered  : signed(gain_bits - 1 downto 0) := (others => '0');
  signal change    : term_t := (others => '0');
  signal sum       : sum_t := (others => '0');
  signal integral  : integral_t := (others => '0');
  signal result    : total_t := (others => '0');
  signal limit     : limit_t := (others => '0');             -- of this period
  signal limit_low : value_t := (others => '0');             -- and the other one, below zero
  signal value     : value_t := to_signed(safe, output_wire_bits);
  signal is_high, is_low : std_ulogic := '0';                -- the output is at its limit

begin

  assert clock_hz / loop_hz >= work_clocks
    report "pid: a period is at least " & integer'image(work_clocks) & " clocks"
    severity failure;

  registers : entity work.register_slave
    generic map (
      writable   => "101111111111100-",
      data_width => data_width,
      initial    => first)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  process (all) is
  begin
    read_words     <= (others => (others => '0'));
    read_words(0)  <= (0 => enable, others => '0');
    read_words(1)  <= (0 => runs, 1 => is_high or is_low, 2 => is_tripped, 3 => lost, others => '0');
    read_words(2)  <= write_words(2);
    for address in 3 to 4 loop
      read_words(address) <=
        std_ulogic_vector(resize(signed(write_words(address)(gain_bits - 1 downto 0)), word_t'length));
    end loop;
    for address in 5 to 9 loop
      read_words(address) <= extended(write_words(address)(gain_bits - 1 downto 0));
    end loop;
    read_words(10) <= extended(std_ulogic_vector(limit_of(write_words(10))));
    read_words(11) <= extended(write_words(11)(gain_bits - 1 downto 0));
    read_words(13) <= std_ulogic_vector(resize(value, word_t'length));
    read_words(14) <= std_ulogic_vector(error);
  end process;

  enable <= write_words(0)(0);
  runs   <= enable and not is_tripped;
  output_wire <= wire_of(value);

  run : process (clock) is
    variable now, goal : signed(31 downto 0);
    variable size      : unsigned(31 downto 0);
    variable wide      : integral_t;
    variable addend    : term_t;
    variable doubled   : sum_t;
    variable whole     : signed(total_t'high - 16 downto 0);
    variable trips     : boolean;
  begin
    if rising_edge(clock) then
      phase          <= ('0' & phase(bits - 1 downto 0)) + phase_increment(clock_hz, loop_hz);
      enabled_before <= enable;
      tripped        <= '0';
      applies        <= applies or written(12);
      trips          := false;

      -- Before the period, which may begin in this clock and lose its feedback.
      if enable = '1' and enabled_before = '0' then
        is_tripped <= '0';
        lost       <= '0';
      end if;

      case state is
        when idle =>
          now  := value_of(feedback_wire);
          goal := signed(write_words(2));
          if is_valid(target_wire) = '1' then
            goal := value_of(target_wire);
          end if;
          if phase(bits) = '1' and runs = '1' then
            state   <= look;
            started <= '1';
            error   <= goal - now;
            moved   <= now - before;
            before  <= now;
            lost    <= not is_valid(feedback_wire);
            limit   <= limit_of(write_words(10));
            if fresh = '1' then
              moved <= (others => '0');
            end if;
            fresh <= '0';
            operands(2) <= given(target_velocity_wire, write_words(3));
            operands(3) <= given(target_acceleration_wire, write_words(4));
            if applies = '1' or fresh = '1' then
              gains   <= (unsigned(write_words(5)(gain_t'range)), unsigned(write_words(7)(gain_t'range)),
                          unsigned(write_words(8)(gain_t'range)), unsigned(write_words(9)(gain_t'range)),
                          unsigned(write_words(6)(gain_t'range)));
              applies <= written(12);
            end if;
          end if;
        when look =>
          state       <= smooth;
          operands(0) <= resize(limited(error, gain_bits), term_t'length);
          operands(1) <= resize(limited(moved, gain_bits - 8) & x"00", term_t'length);
          limit_low   <= -signed('0' & limit);
          -- The size of a negative error is one more than its bits turned over. So no sum is before the comparison.
          size        := unsigned(error xor (error'range => error(error'high)));
          trips       := lost = '1' or (unsigned(write_words(11)(gain_t'range)) /= 0 and
                                        (size > unsigned(write_words(11)(gain_t'range)) or
                                         (error(error'high) = '1' and size = unsigned(write_words(11)(gain_t'range)))));
        when smooth =>
          state  <= integrate;
          change <= operands(1) - resize(filtered, term_t'length);
          sum    <= (others => '0');
        when integrate =>
          if bit_count = 0 and started = '1' then
            filtered <= resize(filtered + shift_right(change, filter_bits), gain_bits);
          end if;
          addend := operands(0) and (term_t'range => gains(ki)(gain_bits - 1));
          sum    <= shift_left(sum, 1) + addend;
          gains(ki) <= rotate_left(gains(ki), 1);
          if bit_count = gain_bits - 1 then
            bit_count <= 0;
            state     <= add;
          else
            bit_count <= bit_count + 1;
          end if;
        when add =>
          state <= clamp;
          wide  := integral;
          -- Not further to the side where the output is at its limit.
          if (is_high = '0' or sum(sum'high) = '1') and (is_low = '0' or sum(sum'high) = '0') then
            wide := resize(sum, wide_bits) + integral;
          end if;
          integral <= wide;
        when clamp =>
          state <= weigh;
          if is_above(integral(integral_t'high downto gain_bits), limit) then
            integral <= signed(resize(limit & (gain_bits - 1 downto 0 => '0'), integral_t'length));
          elsif is_below(integral(integral_t'high downto gain_bits), limit_low) then
            integral <= resize(limit_low & (gain_bits - 1 downto 0 => '0'), integral_t'length);
          end if;
          operands(1) <= -resize(filtered, term_t'length);
          sum         <= (others => '0');
        when weigh =>
          addend  := operands(term) and (term_t'range => gains(term)(gain_bits - 1));
          doubled := sum;
          if term = 0 then
            doubled := shift_left(sum, 1);
          end if;
          sum         <= doubled + addend;
          gains(term) <= rotate_left(gains(term), 1);
          if term /= terms - 1 then
            term <= term + 1;
          else
            term <= 0;
            if bit_count = gain_bits - 1 then
              bit_count <= 0;
              state     <= total;
            else
              bit_count <= bit_count + 1;
            end if;
          end if;
        when total =>
          state  <= give;
          result <= resize(sum, total_t'length) + resize(shift_right(integral, gain_bits - 16), total_t'length);
        when give =>
          state   <= idle;
          whole   := result(total_t'high downto 16);
          is_high <= '0';
          is_low  <= '0';
          if started = '0' then
            null;
          elsif is_above(whole, limit) then
            value   <= signed('0' & limit);
            is_high <= '1';
          elsif is_below(whole, limit_low) or whole = limit_low then
            value  <= limit_low;
            is_low <= '1';
          else
            value <= whole(value_t'range);
          end if;
      end case;

      if trips and runs = '1' then
        is_tripped <= '1';
        tripped    <= '1';
      end if;
      if runs = '0' or trips then
        value   <= to_signed(safe, output_wire_bits);
        is_high <= '0';
        is_low  <= '0';
        fresh   <= '1';
        started <= '0';
      end if;
      if runs = '0' then -- also a clock after it trips
        integral <= (others => '0');
        filtered <= (others => '0');
      end if;

      if reset = '1' then
        phase      <= (others => '0');
        tripped    <= '0';
        state      <= idle;
        bit_count  <= 0;
        term       <= 0;
        applies    <= '0';
        gains      <= (others => (others => '0'));
        is_tripped <= '0';
        lost       <= '0';
        error      <= (others => '0');
        value      <= to_signed(safe, output_wire_bits);
        integral   <= (others => '0');
        filtered   <= (others => '0');
        fresh      <= '1';
        started    <= '0';
      end if;
    end if;
  end process;

end architecture;
