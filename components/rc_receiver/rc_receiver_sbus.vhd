-- SPDX-License-Identifier: BSD-3-Clause
--
-- The frames of S.Bus: 25 characters of 100 kBd with an even parity, on a line that rests low if it is inverted.
--
-- Frames    A frame begins behind 600 us without a character. put gives a channel in 1/8 us while the frame comes in:
--           5 v + 7040, which is 5/8 v + 880 us. Behind the last character whole is high for a clock, with the flags. A
--           frame that is broken makes broken high for a clock, and the rest of it is not looked at.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.physical_pkg.all;

entity rc_receiver_sbus is
  generic (
    clock_hz : positive              := 50_000_000;
    channels : positive range 1 to 16 := 16;
    inverted : natural range 0 to 1  := 1
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic;
    line    : in  std_ulogic; -- asynchronous
    tick    : in  std_ulogic; -- each us
    put     : out std_ulogic;
    channel : out unsigned(3 downto 0);
    value   : out std_ulogic_vector(15 downto 0);
    whole   : out std_ulogic := '0';
    broken  : out std_ulogic := '0';
    flags   : out std_ulogic_vector(3 downto 0)
  );
end entity;

architecture rtl of rc_receiver_sbus is

  constant pause_us     : positive := 600;
  constant first_byte   : std_ulogic_vector(7 downto 0) := x"0F";
  constant flags_place  : positive := 23;
  constant last_place   : positive := 24;
  constant channel_bits : positive := 11;
  constant lowest       : positive := 7040; -- of a channel, in 1/8 us

  type state_t is (
    waiting,  -- for a pause
    ready,    -- a pause is over
    in_frame);

  signal upright  : std_ulogic;
  signal rx_valid : std_ulogic;
  signal rx_data  : std_ulogic_vector(7 downto 0);
  signal rx_error : receive_error_t;
  signal right    : std_ulogic;                                    -- it is a byte
  signal is_end   : std_ulogic;                                    -- the last one of a frame
  signal state    : state_t := waiting;
  signal passed   : natural range 0 to pause_us := 0;              -- us since the last character
  signal place    : natural range 0 to last_place := 0;            -- of the next byte
  signal shift    : std_ulogic_vector(7 downto 0) := (others => '0'); -- its lowest bit is next
  signal left     : unsigned(3 downto 0) := (others => '0');       -- bits of it
  signal word     : unsigned(channel_bits - 1 downto 0) := (others => '0');
  signal have     : natural range 0 to channel_bits := 0;          -- bits of the word
  signal count    : unsigned(4 downto 0) := (others => '0');       -- of channels so far

begin

  upright <= line xor to_bit(inverted = 1);

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => 100_000, parity => even)
    port map (
      clock => clock, reset => reset, increment => open, line => upright, line_break => open, rx_valid => rx_valid,
      rx_ready => '1', rx_data => rx_data, rx_error => rx_error);

  right  <= to_bit(rx_error = no_receive_error);
  is_end <= to_bit(rx_data = x"00") or to_bit((rx_data and x"CF") = x"04");

  put     <= to_bit(have = channel_bits) and to_bit(count < channels);
  channel <= count(channel'range);
  value   <= std_ulogic_vector(lowest + shift_left(resize(word, 16), 2) + word);

  run : process (clock) is
  begin
    if rising_edge(clock) then
      whole  <= '0';
      broken <= '0';

      -- A byte goes into the channels bit by bit, long before the next one comes.
      if have = channel_bits then
        have  <= 0;
        count <= count + 1;
      elsif left /= 0 then
        shift <= '0' & shift(7 downto 1);
        word  <= shift(0) & word(channel_bits - 1 downto 1);
        left  <= left - 1;
        have  <= have + 1;
      end if;

      if rx_valid = '1' then
        passed <= 0;
        case state is
          when waiting =>
            null;
          when ready =>
            place  <= 1;
            count  <= (others => '0');
            have   <= 0;
            left   <= (others => '0');
            state  <= in_frame;
            if right = '0' or rx_data /= first_byte then
              broken <= '1';
              state  <= waiting;
            end if;
          when in_frame =>
            if place < flags_place then
              place <= place + 1;
              shift <= rx_data;
              left  <= to_unsigned(8, left'length);
            elsif place = flags_place then
              place <= last_place;
              flags <= rx_data(3 downto 0);
            else
              whole  <= right and is_end;
              broken <= not is_end;
              state  <= waiting;
            end if;
            if right = '0' then
              broken <= '1';
              state  <= waiting;
            end if;
        end case;
      elsif tick = '1' and passed /= pause_us then
        passed <= passed + 1;
      elsif passed = pause_us then
        broken <= to_bit(state = in_frame);
        state  <= ready;
      end if;

      if reset = '1' then
        state  <= waiting;
        passed <= 0;
        left   <= (others => '0');
        have   <= 0;
        whole  <= '0';
        broken <= '0';
      end if;
    end if;
  end process;

end architecture;
