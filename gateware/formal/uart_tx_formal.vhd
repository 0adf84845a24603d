-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the UART transmitter, 8N1 at four clocks a bit. They compare the line with the frame of the byte that
-- was taken.

library ieee;
  use ieee.std_logic_1164.all;

entity uart_tx_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    tx_valid : in std_ulogic;
    tx_data  : in std_ulogic_vector(7 downto 0)
  );
end entity;

architecture properties of uart_tx_formal is

  constant bit_clocks   : positive := 4;
  constant frame_clocks : positive := 10 * bit_clocks;

  signal tx_ready, line : std_ulogic;
  signal begun          : std_ulogic := '0';
  signal elapsed        : natural range 0 to frame_clocks := frame_clocks;  -- clocks of the frame; then it is idle
  signal frame          : std_ulogic_vector(9 downto 0) := (others => '1'); -- the bit that is sent, and those to come
  signal part           : natural range 0 to bit_clocks - 1 := 0;

begin

  default clock is rising_edge(clk);

  dut : entity work.uart_tx
    generic map (clock_hz => bit_clocks, baud_hz => 1)
    port map (clock => clk, reset => reset, tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data,
              line => line);

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if elapsed < frame_clocks then
        elapsed <= elapsed + 1;
      end if;
      if part = bit_clocks - 1 then
        part  <= 0;
        frame <= '1' & frame(9 downto 1);
      else
        part <= part + 1;
      end if;
      if tx_valid = '1' and tx_ready = '1' then
        frame   <= '1' & tx_data & '0';
        elapsed <= 0;
        part    <= 0;
      end if;
      if reset = '1' then
        frame   <= (others => '1');
        elapsed <= frame_clocks;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The line is the start bit, eight data bits and the stop bit of the byte, four clocks each. It is high between
  -- frames.
  line_is_the_frame : assert always begun = '0' or line = frame(0);

  -- A byte is taken between frames, or in the last clock of a frame. So no frame is cut short, and none waits.
  ready_between_frames : assert always begun = '0' or (tx_ready = '1') = (elapsed >= frame_clocks - 1);

  -- One frame follows another without a gap.
  no_gap : cover {tx_valid = '1' and tx_ready = '1' and elapsed = frame_clocks - 1};

end architecture;
