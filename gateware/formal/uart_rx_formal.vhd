-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the UART receiver, 8N1 at eight clocks a bit. The sender sends frames with any byte and any stop bit,
-- at any moment, also without a gap.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity uart_rx_formal is
  port (
    clk       : in std_ulogic;
    send      : in std_ulogic;                     -- begin a frame, if none is being sent
    byte      : in std_ulogic_vector(7 downto 0);  -- with this byte
    stop_bit  : in std_ulogic;                     -- and this stop bit; low means a broken frame
    rx_ready  : in std_ulogic
  );
end entity;

architecture properties of uart_rx_formal is

  constant bit_clocks   : positive := 8;
  constant frame_clocks : positive := 10 * bit_clocks;
  constant arrival      : positive := 4;  -- clocks from the middle of the stop bit to the item

  signal reset      : std_ulogic := '1';
  signal line_break : std_ulogic;
  signal rx_valid   : std_ulogic;
  signal rx_data    : std_ulogic_vector(7 downto 0);
  signal rx_error   : receive_error_t;

  -- The sender.
  signal frame      : std_ulogic_vector(9 downto 0) := (others => '1'); -- the bit that is sent now, and those to come
  signal part       : natural range 0 to bit_clocks - 1 := 0;           -- clocks of this bit so far
  signal left       : natural range 0 to 10 := 0;                       -- bits of the frame that are still to end
  signal pause      : natural range 0 to 2 * bit_clocks := bit_clocks; -- clocks before the next frame may begin
  signal sent       : std_ulogic_vector(7 downto 0) := (others => '0');
  signal whole      : std_ulogic := '1';                                -- its stop bit is high
  signal coming     : natural range 0 to arrival := 0;                  -- clocks until the frame arrives; 0 means none

  -- The expected output.
  signal offered, lost, framing, overrun, breaks : std_ulogic := '0';
  signal offered_byte : std_ulogic_vector(7 downto 0) := (others => '0');

begin

  default clock is rising_edge(clk);

  dut : entity work.uart_rx
    generic map (clock_hz => bit_clocks, baud_hz => 1)
    port map (
      clock => clk, reset => reset, line => frame(0), line_break => line_break,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

  sender : process (clk) is
  begin
    if rising_edge(clk) then
      reset <= '0';
      if pause > 0 then
        pause <= pause - 1;
      end if;
      if coming > 0 then
        coming <= coming - 1;
      end if;
      if left > 0 then
        if part = bit_clocks - 1 then
          part  <= 0;
          left  <= left - 1;
          frame <= '1' & frame(9 downto 1);
          if left = 1 and whole = '0' then
            pause <= 2 * bit_clocks;  -- after a broken frame the line must be high for a while
          end if;
        else
          part <= part + 1;
        end if;
        if left = 1 and part = bit_clocks / 2 - 1 then
          coming <= arrival;
        end if;
      end if;
      if send = '1' and pause = 0 and (left = 0 or (left = 1 and part = bit_clocks - 1 and whole = '1')) then
        frame <= stop_bit & byte & '0';
        part  <= 0;
        left  <= 10;
        sent  <= byte;
        whole <= stop_bit;
      end if;
    end if;
  end process;

  expect : process (clk) is
  begin
    if rising_edge(clk) then
      breaks <= '0';
      if offered = '0' or rx_ready = '1' then
        offered <= lost;
        overrun <= lost;
        framing <= '0';
        lost    <= '0';
      end if;
      if coming = 1 then
        breaks <= not whole and nor sent;
        if offered = '0' or rx_ready = '1' then
          offered      <= '1';
          offered_byte <= sent;
          framing      <= not whole;
        else
          lost <= '1';
        end if;
      end if;
    end if;
  end process;

  -- There is one item for each frame, at its time, and no other. It stays until it is taken.
  item_a_frame : assert always reset = '1' or rx_valid = offered;

  -- The byte is the one that was sent.
  byte_is_the_one_sent : assert always reset = '1' or offered = '0' or framing = '1' or overrun = '1' or
                         rx_data = offered_byte;

  -- An item is marked broken exactly if its stop bit was low, or if frames before it found no room.
  errors_are_told : assert always reset = '1' or offered = '0' or
                    (rx_error(framing_error_bit) = framing and rx_error(overrun_error_bit) = overrun and
                     rx_error(parity_error_bit) = '0');

  -- A break is reported exactly for a frame that was low throughout.
  break_is_told : assert always reset = '1' or line_break = breaks;

  -- A byte arrives.
  byte_seen : cover {reset = '0' and rx_valid = '1' and rx_error = "000" and rx_data = x"A5"};

  -- A broken frame arrives.
  broken_seen : cover {reset = '0' and rx_valid = '1' and rx_error(framing_error_bit) = '1'};

end architecture;
