-- SPDX-License-Identifier: BSD-3-Clause
--
-- UART receiver: turns an asynchronous line into a stream of characters, with the broken ones in their place.
--
--   line   ‾‾‾‾\_____/ d0 X d1 X … X d7 X parity X‾stop‾‾       idle high, least significant bit first
--                 |     |    |        |      |       |
--              sampled once, in the middle of each bit
--
-- Baud rate   Any up to clock_hz / 8: a phase accumulator divides the clock by fractions. The sender may be 3 % fast or
--             slow at any of them. Sampling is at most 1/8 bit off the middle, and 3 % is 0.32 bit at the stop bit.
--             increment, if it is not left open, is another rate: it is what the phase of phase_bits(clock_hz, baud_hz)
--             bits gains in a clock. Then baud_hz is the slowest rate. Change it while reset is high.
-- Guard       A synchroniser against metastability, then the median of three samples. So a spike shorter than one clock
--             period is ignored, and edges do not move. A start bit that is over by its middle is ignored.
-- Errors      rx_error, with rx_valid, gives the error. If it is not zero, the item is not a byte, and rx_data is void.
--             The bits are parity, framing (no stop bit), and overrun (at least one character found no room at this
--             place). After a broken frame, the line must be high before the next start bit is accepted.
-- Break       A frame that is low throughout pulses line_break once, and is also a framing error.
-- Pressure    rx_ready may stay low for the length of one character. After that, characters are lost, with an overrun.
-- Latency     5 clocks from the middle of the stop bit at the pin to rx_valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;
  use work.rate_pkg.all;

entity uart_rx is
  generic (
    clock_hz : positive := 50_000_000;
    baud_hz  : positive := 3_000_000;
    parity   : parity_t := none
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    increment : in unsigned(phase_bits(clock_hz, baud_hz) - 1 downto 0) :=
      to_unsigned(phase_increment(clock_hz, baud_hz), phase_bits(clock_hz, baud_hz));

    line       : in  std_ulogic; -- asynchronous
    line_break : out std_ulogic; -- for one clock

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);
    rx_error : out receive_error_t
  );
end entity;

architecture rtl of uart_rx is

  constant bits     : positive := phase_bits(clock_hz, baud_hz);
  constant half_bit : positive := 2 ** (bits - 1);

  type state_t is (
    recover,     -- after reset or a broken frame, until the line is high
    idle,        -- until the line is low
    start,       -- until the middle of the start bit
    data,        -- eight bits
    parity_bit,
    stop         -- until the middle of the stop bit
  );

  signal settled  : std_ulogic;                    -- the line, synchronised
  signal samples  : std_ulogic_vector(1 downto 0); -- of it, newest first
  signal level    : std_ulogic;                    -- the line, synchronised and filtered
  signal phase    : unsigned(bits downto 0);
  signal tick     : std_ulogic;
  signal state    : state_t;
  signal shift    : std_ulogic_vector(7 downto 0);
  signal count    : unsigned(2 downto 0);
  signal odd_ones : std_ulogic;                    -- of the data and parity bits so far
  signal all_low  : std_ulogic;                    -- no bit of this frame was high so far
  signal lost     : std_ulogic;                    -- an overrun is not yet reported

begin

  assert clock_hz / 8 >= baud_hz
    report "uart_rx: a bit needs 8 clocks or more; " & integer'image(baud_hz) & " baud needs a clock of "
           & integer'image(baud_hz) & " * 8 Hz"
    severity failure;

  line_synchroniser : entity work.synchroniser
    generic map (idle => '1')
    port map (clock => clock, asynchronous(0) => line, levels(0) => settled);

  tick <= phase(bits);

  process (clock) is
    variable ended : std_ulogic; -- a frame ends in this clock, with …
    variable error : receive_error_t;
    variable free  : boolean;
  begin
    if rising_edge(clock) then
      samples <= samples(0) & settled;
      level   <= (settled and samples(0)) or (samples(0) and samples(1)) or (settled and samples(1));

      phase      <= ('0' & phase(bits - 1 downto 0)) + increment;
      line_break <= '0';
      ended      := '0';
      error      := no_receive_error;

      case state is
        when recover =>
          if level = '1' then
            state <= idle;
          end if;

        when idle =>
          -- The first tick comes half a bit after the start edge, less two clocks. The edge was, on average, half a
          -- clock before it was seen. A tick comes half a clock late, and takes effect one clock later.
          phase    <= to_unsigned(half_bit, bits + 1) + (increment & '0');
          odd_ones <= '0';
          all_low  <= '1';
          count    <= (others => '0');
          if level = '0' then
            state <= start;
          end if;

        when start =>
          if tick = '1' then
            if level = '0' then
              state <= data;
            else
              state <= idle;
            end if;
          end if;

        when data =>
          if tick = '1' then
            shift    <= level & shift(7 downto 1);
            odd_ones <= odd_ones xor level;
            all_low  <= all_low and not level;
            count    <= count + 1;
            if count = 7 then
              if parity = none then
                state <= stop;
              else
                state <= parity_bit;
              end if;
            end if;
          end if;

        when parity_bit =>
          if tick = '1' then
            odd_ones <= odd_ones xor level;
            all_low  <= all_low and not level;
            state    <= stop;
          end if;

        when stop =>
          if tick = '1' then
            ended := '1';
            if level = '1' then
              state <= idle;
            else
              error(framing_error_bit) := '1';
              line_break               <= all_low;
              state                    <= recover;
            end if;
            if (parity = even and odd_ones = '1') or (parity = odd and odd_ones = '0') then
              error(parity_error_bit) := '1';
            end if;
          end if;
      end case;

      free := rx_valid = '0' or rx_ready = '1';
      if free then
        -- An overrun is reported as soon as there is room, so that it stands before the later characters.
        rx_valid                 <= ended or lost;
        rx_data                  <= shift;
        error(overrun_error_bit) := lost;
        rx_error                 <= error;
        lost                     <= '0';
      elsif ended = '1' then
        lost <= '1';
      end if;

      if reset = '1' then
        samples    <= (others => '1');
        level      <= '1';
        state      <= recover;
        line_break <= '0';
        rx_valid   <= '0';
        lost       <= '0';
      end if;
    end if;
  end process;

end architecture;
