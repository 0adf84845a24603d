-- SPDX-License-Identifier: BSD-3-Clause
--
-- UART transmitter: turns a stream of bytes into an asynchronous line.
--
--   line   ‾‾‾‾\_____/ d0 X d1 X … X d7 X parity X‾stop‾‾       idle high, least significant bit first
--
-- Baud rate   Any up to clock_hz / 4: a phase accumulator divides the clock by fractions. An edge is at most one clock
--             late. Over many frames the rate is exact to 0.05 %, and frames follow one another without a gap.
--             increment, if it is not left open, is another rate: it is what the phase of phase_bits(clock_hz, baud_hz)
--             bits gains in a clock. Then baud_hz is the slowest rate. Change it between frames.
-- Latency     The start bit begins in the clock after tx_valid and tx_ready.
-- Pressure    tx_ready is high for one clock per frame while there is something to send.
-- Errors      None: every byte that is taken is sent.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;
  use work.rate_pkg.all;

entity uart_tx is
  generic (
    clock_hz  : positive              := 50_000_000;
    baud_hz   : positive              := 3_000_000;
    parity    : parity_t              := none;
    stop_bits : positive range 1 to 2 := 1
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous; cuts the current frame short

    increment : in unsigned(phase_bits(clock_hz, baud_hz) - 1 downto 0) :=
      to_unsigned(phase_increment(clock_hz, baud_hz), phase_bits(clock_hz, baud_hz));

    tx_valid : in  std_ulogic;
    tx_ready : out std_ulogic;
    tx_data  : in  std_ulogic_vector(7 downto 0);

    line : out std_ulogic
  );
end entity;

architecture rtl of uart_tx is

  constant bits : positive := phase_bits(clock_hz, baud_hz);

  function parity_bits return natural is
  begin
    if parity = none then
      return 0;
    end if;
    return 1;
  end function;

  constant frame_bits : positive := 1 + 8 + parity_bits + stop_bits;

  signal phase : unsigned(bits downto 0);
  signal tick  : std_ulogic;
  signal shift : std_ulogic_vector(9 downto 0);      -- the bit on the line, then those to come, then ones
  signal left  : natural range 0 to frame_bits;      -- bits of the frame that are still to end; 0 is idle

begin

  assert clock_hz / 4 >= baud_hz
    report "uart_tx: a bit needs 4 clocks or more; " & integer'image(baud_hz) & " baud needs a clock of "
           & integer'image(baud_hz) & " * 4 Hz"
    severity failure;

  tick     <= phase(bits);
  tx_ready <= '1' when left = 0 or (left = 1 and tick = '1') else '0';
  line     <= shift(0);

  process (clock) is
    variable check : std_ulogic;
  begin
    if rising_edge(clock) then
      -- Between frames without a gap the phase runs on, so that fractions of a clock add up to whole ones.
      if left = 0 then
        phase <= resize(increment, bits + 1);
      else
        phase <= ('0' & phase(bits - 1 downto 0)) + increment;
      end if;

      if tx_valid = '1' and tx_ready = '1' then
        check := xor tx_data;
        if parity = odd then
          check := not check;
        elsif parity = none then
          check := '1';
        end if;
        shift <= check & tx_data & '0';
        left  <= frame_bits;
      elsif left > 0 and tick = '1' then
        shift <= '1' & shift(9 downto 1);
        left  <= left - 1;
      end if;

      if reset = '1' then
        phase <= (others => '0');
        shift <= (others => '1');
        left  <= 0;
      end if;
    end if;
  end process;

end architecture;
