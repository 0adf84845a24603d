-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of hx711 with a `settle` of 0, a timeout of 100 us, and failures_most 2. A us may end at any clock, the
-- chip may do anything, and so may the bus. Times are counted in us that end.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity hx711_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    dout    : in std_ulogic;
    control : in std_ulogic_vector(2 downto 0);  -- what is written in +0
    words   : out std_ulogic_vector(95 downto 0); -- the same, for the design
    raw     : in std_ulogic;                     -- shows dout behind the synchroniser
    tick    : in std_ulogic;                     -- a us ends
    ticks   : out std_ulogic;                    -- the same, for the design

    -- These show the registers of the design.
    state    : in unsigned(1 downto 0);
    now      : in unsigned(6 downto 0);
    chosen   : in unsigned(1 downto 0);
    left     : in unsigned(3 downto 0);
    shift    : in std_ulogic_vector(23 downto 0);
    at_rail  : in std_ulogic;
    ended    : in std_ulogic;
    reason   : in std_ulogic_vector(2 downto 0);
    in_a_row : in unsigned(3 downto 0)
  );
end entity;

architecture properties of hx711_formal is

  constant timeout    : positive := 100;
  constant reset_us   : positive := 64;
  constant bits       : positive := 24;
  constant apart      : positive := 2;  -- us of sck low that no reading has between two pulses
  constant input_most : positive := 2;
  constant silence    : positive := timeout + 3; -- us without a pulse, at most

  -- The states of the design.
  constant down     : natural := 0;
  constant waiting  : natural := 1;
  constant shifting : natural := 2;
  constant judging  : natural := 3;

  subtype value_t is std_ulogic_vector(bits - 1 downto 0);
  subtype pulses_t is natural range 0 to bits + input_most + 2;

  signal s2m              : wishbone_s2m_t;
  signal sampled, failed  : std_ulogic;
  signal value_wire       : wire_t;
  signal sck              : std_ulogic;
  signal enable           : std_ulogic;
  signal wanted, wanted_1 : natural range 0 to input_most := 0;
  signal reset_1          : std_ulogic := '1';
  signal off_1            : std_ulogic := '1';                  -- a reset, or not enabled, a clock ago
  signal sck_1            : std_ulogic := '0';
  signal raw_1            : std_ulogic := '1';
  signal rises, falls     : std_ulogic;
  signal high             : natural range 0 to reset_us := 0;   -- us of sck
  signal low              : natural range 0 to apart := apart;
  signal silent           : natural range 0 to silence + 1 := 0; -- us of sck low while no block was open
  signal pulses           : pulses_t := 0;                      -- of this reading
  signal pulses_before    : pulses_t := 0;                      -- of the one before it, or 0
  signal pulses_now, before_now : pulses_t;                     -- with an edge of this clock
  signal got              : value_t := (others => '0');         -- what came with the pulses
  signal judges           : std_ulogic := '0';                  -- the us behind a pulse
  signal released         : std_ulogic := '0';                  -- dout was high then
  signal got_now          : value_t;
  signal bad, bad_now     : natural range 0 to 2 := 0;          -- failures in a row
  signal in_place         : std_ulogic;                         -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.hx711
    generic map (clock_hz => 4_000_000, settle => 0, timeout_us => timeout, failures_most => 2, data_width => 24)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      value_wire => value_wire, sck => sck, dout => dout);

  words  <= (66 => control(2), 65 => control(1), 64 => control(0), others => '0');
  enable <= control(0);
  wanted <= 2 when control(2) = '1' else 1 when control(1) = '1' else 0;
  rises  <= sck and not sck_1;
  falls  <= sck_1 and not sck;

  ticks  <= tick;

  edge : process (all) is
  begin
    pulses_now <= pulses;
    before_now <= pulses_before;
    got_now    <= got;
    bad_now    <= bad;
    if rises = '1' and low = apart then
      before_now <= pulses;
      pulses_now <= 0;
    end if;
    if falls = '1' and high = reset_us then
      pulses_now <= 0;
      before_now <= 0;
    end if;
    if falls = '1' and high /= reset_us then
      pulses_now <= minimum(pulses + 1, pulses_t'high);
      if pulses < bits then
        got_now <= got(bits - 2 downto 0) & raw_1;
      end if;
    end if;
    if sampled = '1' then
      bad_now <= 0;
    elsif failed = '1' then
      bad_now <= minimum(bad + 1, 2);
    end if;
  end process;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      reset_1       <= reset;
      off_1         <= reset or not enable;
      wanted_1      <= wanted;
      sck_1         <= sck;
      raw_1         <= raw;
      pulses        <= pulses_now;
      pulses_before <= before_now;
      got           <= got_now;
      bad           <= bad_now;

      if tick = '1' then
        silent <= minimum(silent + 1, silence + 1);
        if sck = '1' then
          high <= minimum(high + 1, reset_us);
        else
          low <= minimum(low + 1, apart);
        end if;
        if judges = '1' or falls = '1' then
          released <= raw;
        end if;
        judges <= '0';
      elsif falls = '1' then
        judges <= '1';
      end if;
      if sck = '1' then
        low    <= 0;
        judges <= '0';
      else
        high <= 0;
      end if;
      if sck = '1' or m2s.cyc = '1' then
        silent <= 0;
      end if;

      if reset = '1' then
        sck_1         <= '0';
        high          <= 0;
        low           <= apart;
        silent        <= 0;
        pulses        <= 0;
        pulses_before <= 0;
        bad           <= 0;
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits  : boolean;
    variable count : natural range 0 to 63; -- pulses of this reading
    variable whole : pulses_t;              -- pulses of a whole reading
    variable rail  : std_ulogic;            -- the bits that have come are those of the smallest or the largest value
  begin
    count := to_integer(now(6 downto 1));
    whole := bits + 1 + to_integer(chosen);
    fits  := chosen <= input_most and left <= 1 and pulses_now <= bits + 1 + input_most and
             low <= apart and bad_now = minimum(to_integer(in_a_row), 2) and
             (is_valid(value_wire) = '0' or in_a_row <= 1) and silent <= silence;

    case to_integer(state) is
      when down =>
        fits := fits and now <= reset_us and (ended = '0' or reason /= "000");
        if sck = '0' then
          fits := fits and now = 0 and sck_1 = '0' and silent < silence;
        else
          fits := fits and high + 1 >= now;
        end if;

      when waiting =>
        fits := fits and sck = '0' and now < timeout and silent <= now + 2 and low >= minimum(to_integer(now), 2) and
                (left = 1 or pulses_now = whole) and
                (sck_1 = '0' or (high = reset_us and now = 0 and left = 1 and (ended = '0' or reason /= "000")));
        if ended = '1' then
          fits := fits and now = 0 and silent <= 1;
        end if;
        if ended = '1' and reason = "000" then
          fits := fits and left = 0 and before_now = whole and released = '1' and judges = '0' and
                  shift = got_now and shift /= x"800000" and shift /= x"7FFFFF";
        end if;

      when shifting =>
        fits := fits and ended = '0' and sck = now(0) and now <= 2 * whole - 1;
        if now = 0 then
          fits := fits and sck_1 = '0' and low >= 1 and silent < silence and
                  (left = 1 or pulses_now = whole);
        else
          fits := fits and pulses_now = count and (left = 1 or before_now = whole);
          for bit in 0 to bits - 1 loop
            fits := fits and (bit >= count or shift(bit) = got_now(bit));
          end loop;
          if now(0) = '1' then
            fits := fits and high = 0 and (sck_1 = '1' or now = 1 or low <= 1) and
                    (sck_1 = '1' or now /= 1 or low = apart) and (sck_1 = '0' or low = 0);
          else
            fits := fits and low = 0 and silent = 0 and (sck_1 = '0' or high = 1);
          end if;
          for ended in 2 to bits loop
            rail := shift(ended - 1) xor shift(ended - 2);
            for bit in 1 to ended - 2 loop
              rail := rail and not (shift(bit) xor shift(bit - 1));
            end loop;
            fits := fits and (minimum(count, bits) /= ended or at_rail = rail);
          end loop;
          fits := fits and (count /= 1 or at_rail = '1');
        end if;

      when others => -- judging
        fits := fits and ended = '0' and sck = '0' and low = 0 and silent = 0 and (falls or judges) = '1' and
                (sck_1 = '0' or high = 1) and pulses_now = whole and
                (left = 1 or before_now = whole) and shift = got_now and
                to_bit(shift = x"800000" or shift = x"7FFFFF") = at_rail;
    end case;

    if sampled = '1' and off_1 = '0' then
      fits := fits and state = waiting and ended = '0' and sck_1 = '0' and
              pulses_now = whole and before_now = pulses_now and released = '1' and
              value_wire(bits - 1 downto 0) = got_now and value_wire(bits - 1 downto 0) /= x"800000" and
              value_wire(bits - 1 downto 0) /= x"7FFFFF" and (is_valid(value_wire) = '0' or chosen = wanted_1);
    end if;
    if sampled = '1' and off_1 = '1' then
      fits := fits and is_valid(value_wire) = '0';
    end if;
    in_place <= to_bit(fits);
  end process;

  -- At every clock, the design is where the reference is.
  stays_in_place : assert always in_place = '1';

  -- sck is high for 1 us, or so long that it resets the chip. Only a reset ends that sooner.
  right_pulse : assert always falls = '1' and reset_1 = '0' -> high = 1 or high = reset_us;

  -- A reading has never more pulses than the highest input takes.
  no_more : assert always pulses <= 27;

  -- A valid sample has chosen its input again, and so had the reading before it: what it gives is of the input that is
  -- written in the register when it is taken.
  right_input : assert always sampled = '1' and is_valid(value_wire) = '1' ->
                         pulses = bits + 1 + wanted_1 and pulses_before = pulses;

  -- A sample is the bits that came, the highest one first, however long the bus holds it back.
  right_value : assert always sampled = '1' and off_1 = '0' ->
                         value_wire(bits - 1 downto 0) = got;

  -- A sample is neither the smallest nor the largest value.
  not_at_the_rail : assert always sampled = '1' and off_1 = '0' ->
                             value_wire(bits - 1 downto 0) /= x"800000" and value_wire(bits - 1 downto 0) /= x"7FFFFF";

  -- A chip has let dout rise behind the bits of a sample.
  not_stuck : assert always sampled = '1' and off_1 = '0' -> released = '1';

  -- A chip that does not answer ends in a failure, or is reset: sck is never low for longer than the timeout.
  time_out : assert always silent <= 103;

  -- Two failures in a row end the validity.
  too_many : assert always bad = 2 and sampled = '0' -> is_valid(value_wire) = '0';

  -- Without enable, nothing is valid.
  void_when_off : assert always off_1 = '1' -> is_valid(value_wire) = '0';

  -- A sample of the third input.
  sample_seen : cover {sampled = '1' and is_valid(value_wire) = '1' and wanted = 2};

  -- A failure while the last sample is still valid.
  bad_seen : cover {failed = '1' and is_valid(value_wire) = '1'};

end architecture;
