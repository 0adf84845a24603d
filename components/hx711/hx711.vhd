-- SPDX-License-Identifier: BSD-3-Clause
--
-- A load cell behind an HX711, the 24-bit converter for bridges: each conversion is read as soon as it is ready.
--
--   sck   ________/‾\_/‾\_/‾\_ ... _/‾\_/‾\____     a pulse for each bit, 1 us high and 1 us low, and 1 to 3 more,
--   dout  ‾‾‾‾\____x 23 x 22 x     x 0 x‾‾‾‾‾‾‾     which choose the next input. The first of them lets dout rise.
--             ready
--
--   +0  control: bit 0 enable, 1 after a reset; 0 powers the chip down. Bits 2:1 the input: 0 A with a gain of 128,
--       1 B with 32, 2 A with 64
--   +1  state (sample_state): bits 7:0 failures, 11:8 failures in a row, 14:12 why the last try failed, 15 valid
--         1 no answer: dout stayed high for timeout_us. The chip is away, or has no power.
--         2 out of range: the value is the largest or the smallest one
--         3 stuck: dout did not rise behind the last bit, so no chip drives it
--   +2  value of the last sample, two's complement in bits 23:0
--
-- Settling  Behind power-up, and when another input is chosen, the conversion that is under way and `settle` more are
--           dropped. The value is not valid until then.
-- Recovery  Behind a failure 1 or 3, and a reset, sck is high for 64 us, which resets the chip.
-- Ready     dout is low for two looks, 1 us apart. A spike below 1 us reads nothing.
-- Block     A try that ends while cyc is high is taken behind it. So all words of a block are of one moment. The next
--           try begins behind that.
-- Wire      value_wire has the value, and is valid with it.
-- Events    sampled: there is a new value. failed: a try has failed.
-- Latency   2 clocks per access (register_slave). From ready to sampled 53 to 61 us.
-- Errors    err for a write to +1 and +2, and for addresses from 3 on.
-- Reset     All words are 0, but for enable.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wire_pkg.all;
  use work.wishbone_pkg.all;

entity hx711 is
  generic (
    clock_hz      : positive                        := 50_000_000;
    settle        : natural range 0 to 14           := 4;
    timeout_us    : positive range 100 to 1_000_000 := 600_000;
    failures_most : positive range 1 to 15          := 3;
    data_width    : positive range 24 to 32         := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;
    value_wire   : out wire_t; -- for other components

    sck          : out std_ulogic := '0';
    dout         : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of hx711 is

  constant bits      : positive := 24;
  constant reset_bit : positive := 6; -- of the time that resets the chip

  subtype reason_t is std_ulogic_vector(2 downto 0);
  subtype value_t is std_ulogic_vector(bits - 1 downto 0);
  subtype time_t is unsigned(bits_for(timeout_us) - 1 downto 0);
  type state_t is (
    down,     -- sck is high, until the chip is reset, and until enable
    waiting,  -- for a conversion
    shifting, -- its bits come
    judging   -- dout must be high now
  );

  constant fine         : reason_t := "000";
  constant no_answer    : reason_t := "001";
  constant out_of_range : reason_t := "010";
  constant stuck        : reason_t := "011";

  signal read_words  : word_vector_t(0 to 2);
  signal write_words : word_vector_t(0 to 2);
  signal enable      : std_ulogic;
  signal wanted      : unsigned(1 downto 0); -- input

  signal tick          : std_ulogic;                              -- a us is over
  signal raw           : std_ulogic;                              -- dout, synchronous
  signal before        : std_ulogic := '1';                       -- a us ago
  signal state         : state_t := down;
  signal now           : time_t := (others => '0');               -- us in this state
  signal chosen        : unsigned(1 downto 0) := "00";            -- the input of the next conversion
  signal other         : std_ulogic;                              -- another one is wanted
  signal left          : unsigned(3 downto 0) := (others => '0'); -- conversions to drop
  signal shift         : value_t := (others => '0');
  signal at_rail       : std_ulogic := '0';                       -- it may be the largest or the smallest value
  signal ended, accept : std_ulogic := '0';
  signal reason        : reason_t := fine;
  signal word          : std_ulogic_vector(15 downto 0);
  signal is_valid      : std_ulogic;
  signal void          : std_ulogic;
  signal value         : value_t := (others => '0');

begin

  assert clock_hz >= 4_000_000
    report "hx711: clock_hz must be 4 MHz or more, got " & integer'image(clock_hz)
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "100", data_width => data_width, initial => (x"00000001", x"00000000", x"00000000"))
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words);

  read_words <= (
    0 => extended(write_words(0)(2 downto 0)),
    1 => extended(word),
    2 => extended(value));

  enable     <= write_words(0)(0);
  wanted     <= write_words(0)(2) & (write_words(0)(1) and not write_words(0)(2)); -- 3 is 2
  other      <= to_bit(wanted /= chosen);
  void       <= not enable or other;
  value_wire <= is_valid & std_ulogic_vector(resize(signed(value), wire_bits - 1));

  microseconds : entity work.ticker
    generic map (clock_hz => clock_hz, rate_hz => 1_000_000)
    port map (clock => clock, reset => reset, tick => tick);

  line : entity work.input_filter
    port map (clock => clock, reset => reset, pins(0) => dout, levels(0) => raw);

  tries : entity work.sample_state
    generic map (failures_most => failures_most)
    port map (
      clock => clock, reset => reset, ended => ended, reason => reason, hold => wishbone_m2s.cyc, void => void,
      accept => accept, sampled => sampled, failed => failed, valid => is_valid, word => word);

  run : process (clock) is

    procedure go (target : state_t) is
    begin
      state <= target;
      now   <= (others => '0');
    end procedure;

  begin
    if rising_edge(clock) then
      if accept = '1' then
        ended <= '0';
        if reason = fine then
          value <= shift;
        end if;
      end if;

      if tick = '1' then
        before <= raw;
        now    <= now + 1;
        case state is
          when down =>
            sck  <= '1';
            left <= to_unsigned(settle + 1, left'length);
            if now(reset_bit) = '1' then
              now <= now; -- it stays
              if enable = '1' then
                sck <= '0';
                go(waiting);
              end if;
            end if;

          when waiting =>
            if ended = '1' then
              now <= (others => '0'); -- the bits of the sample stay until it is taken
            elsif raw = '0' and before = '0' then
              chosen <= wanted;
              if other = '1' then
                left <= to_unsigned(settle + 1, left'length);
              end if;
              go(shifting);
            elsif now = timeout_us - 1 then
              ended  <= '1';
              reason <= no_answer;
              go(down);
            end if;

          when shifting =>
            sck <= not now(0);
            if now(0) = '1' then
              if now(5 downto 4) /= 3 then
                shift <= shift(bits - 2 downto 0) & raw;
                -- Behind the first bit, all others are its opposite.
                if now(5 downto 1) = 0 then
                  at_rail <= '1';
                elsif now(5 downto 1) = 1 then
                  at_rail <= raw xor shift(0);
                else
                  at_rail <= at_rail and not (raw xor shift(0));
                end if;
              elsif now(2 downto 1) = chosen then
                go(judging);
              end if;
            end if;

          when judging =>
            reason <= fine;
            if at_rail = '1' then
              reason <= out_of_range;
            end if;
            if raw = '0' then
              ended  <= '1';
              reason <= stuck;
              go(down);
            else
              go(waiting);
              if left /= 0 then
                left <= left - 1;
              elsif other = '0' then
                ended <= '1';
              end if;
            end if;
        end case;
      end if;

      if enable = '0' and state /= down then
        ended <= '0';
        sck   <= '1';
        go(down);
      end if;
      if reset = '1' then
        before <= '1';
        chosen <= "00";
        ended  <= '0';
        sck    <= '0';
        value  <= (others => '0');
        go(down);
      end if;
    end if;
  end process;

end architecture;
