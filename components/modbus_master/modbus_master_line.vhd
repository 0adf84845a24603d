-- SPDX-License-Identifier: BSD-3-Clause
--
-- The frames of Modbus RTU, a byte at a time, for bus_sequencer. It adds the CRC to what is sent, and checks the CRC of
-- what comes back.
--
--   tx         ‾‾‾‾‾‾‾‾‾‾\_/‾unit‾\_/‾function‾\_/ … \_/‾CRC‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
--   tx_enable  ________/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\________________
--   rx         ‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\_/‾unit‾\_/ …
--
-- Requests  The bytes that are sent come first, then those of the reply. The CRC goes out before the first of the
--           reply, or behind the last byte if there is no reply, as in a broadcast.
-- Pause     A frame begins when the line has been silent for 3.5 characters, 1.75 ms above 19,200 baud. A low level
--           counts as well as the end of a character, so no frame begins while a late reply comes in.
-- Failures  no answer: nothing has come for timeout_us, or the line was never silent for so long. A wrong reply: a
--           broken character, such a pause in the reply, or a wrong CRC. Refused: the second byte of the reply has
--           bit 7 set; then the data are the code of the exception.
-- Echo      The line is not heard while this side sends.
-- Latency   tx_enable rises a bit before the first start bit, and falls when the last stop bit has ended.
-- Reset     A frame is cut short.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.physical_pkg.all;
  use work.sequencer_pkg.all;
  use work.width_pkg.all;

entity modbus_master_line is
  generic (
    clock_hz   : positive                        := 50_000_000;
    baud_hz    : positive range 1200 to 1_000_000 := 19_200;
    parity     : natural range 0 to 2            := 1; -- 0 none, 1 even, 2 odd
    stop_bits  : positive range 1 to 2           := 1;
    timeout_us : positive range 1000 to 1_000_000 := 100_000
  );
  port (
    clock     : in  std_ulogic;
    reset     : in  std_ulogic; -- synchronous
    request   : in  bus_request_t;
    reply     : out bus_reply_t;

    rx        : in  std_ulogic; -- asynchronous
    tx        : out std_ulogic;
    tx_enable : out std_ulogic
  );
end entity;

architecture rtl of modbus_master_line is

  -- The end of a character is seen in its first stop bit, up to two bits before it is over.
  function pause_of (baud : positive) return positive is
    constant two_bits : positive := (2_000_000 + baud - 1) / baud;
  begin
    if baud > 19_200 then
      return 1750 + two_bits;
    end if;
    return (38_500_000 + baud - 1) / baud + two_bits;
  end function;

  constant pause_us    : positive := pause_of(baud_hz);
  constant lead_clocks : positive := (clock_hz + baud_hz - 1) / baud_hz;

  subtype crc_t is std_ulogic_vector(15 downto 0);

  type state_t is (
    idle,      -- no byte is asked for
    quiet,     -- until the line is silent
    leading,   -- a bit before the first start bit
    sending,   -- until the byte is taken
    low_sum,   -- the same for the two bytes of the CRC
    high_sum,
    draining,  -- until the last stop bit has ended
    listening, -- for a byte of the reply
    refusing,  -- for the code of an exception
    checking); -- for two bytes of the CRC

  -- The CRC with one byte more, lowest bit first: polynomial 8005, reflected.
  function crc_with (crc : crc_t; data : byte_t) return crc_t is
    variable found : crc_t := crc;
    variable bit_0 : std_ulogic;
  begin
    for place in 0 to 7 loop
      bit_0 := found(0) xor data(place);
      found := '0' & found(15 downto 1);
      if bit_0 = '1' then
        found := found xor x"A001";
      end if;
    end loop;
    return found;
  end function;

  signal state    : state_t := idle;
  signal crc      : crc_t := (others => '1');
  signal data     : byte_t := (others => '0');
  signal last     : std_ulogic := '0';
  signal receives : std_ulogic := '0';
  signal talks    : std_ulogic := '0';                -- the request is still to end
  signal heard    : unsigned(1 downto 0) := "00";     -- bytes of the reply, at most 2
  signal sums     : std_ulogic := '0';                -- the first byte of the CRC has come
  signal refuses  : std_ulogic := '0';
  signal tick     : std_ulogic;                       -- each us
  signal timer    : unsigned(bits_for(timeout_us + 1) - 1 downto 0) := (others => '0');
  signal silence  : unsigned(bits_for(pause_us + 1) - 1 downto 0) := (others => '0');
  signal level    : std_ulogic;                       -- of the line, synchronous
  signal silent   : std_ulogic;
  signal late     : std_ulogic;
  signal lead     : unsigned(bits_for(lead_clocks) - 1 downto 0) := (others => '0');
  signal drives   : std_ulogic := '0';
  signal deaf     : std_ulogic;
  signal tx_valid, tx_ready, rx_valid : std_ulogic;
  signal tx_data, rx_data             : byte_t;
  signal rx_error : receive_error_t;

begin

  us : entity work.ticker
    generic map (clock_hz => clock_hz, rate_hz => 1_000_000)
    port map (clock => clock, reset => reset, tick => tick);

  transmitter : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity_t'val(parity), stop_bits => stop_bits)
    port map (
      clock => clock, reset => reset, increment => open, tx_valid => tx_valid, tx_ready => tx_ready,
      tx_data => tx_data, line => tx);

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity_t'val(parity))
    port map (
      clock => clock, reset => deaf, increment => open, line => rx, line_break => open, rx_valid => rx_valid,
      rx_ready => '1', rx_data => rx_data, rx_error => rx_error);

  line_synchroniser : entity work.synchroniser
    generic map (idle => '1')
    port map (clock => clock, asynchronous(0) => rx, levels(0) => level);

  deaf      <= reset or drives;
  tx_enable <= drives;
  tx_valid  <= to_bit(state = sending or state = low_sum or state = high_sum);
  silent    <= to_bit(silence = pause_us) and level;
  late      <= to_bit(timer = timeout_us);

  with state select tx_data <=
    crc(7 downto 0)  when low_sum,
    crc(15 downto 8) when high_sum,
    data             when others;

  run : process (clock) is

    procedure finish is
    begin
      state        <= idle;
      reply.done   <= '1';
      reply.failed <= '0';
    end procedure;

    procedure fail (reason : failure_t) is
    begin
      state        <= idle;
      reply.done   <= '1';
      reply.failed <= '1';
      reply.reason <= reason;
    end procedure;

    variable right : boolean; -- a byte has come
  begin
    if rising_edge(clock) then
      reply.done <= '0';
      right      := rx_valid = '1' and rx_error = no_receive_error;
      if tick = '1' and late = '0' then
        timer <= timer + 1;
      end if;
      if rx_valid = '1' or drives = '1' or level = '0' then
        silence <= (others => '0');
      elsif tick = '1' and silent = '0' then
        silence <= silence + 1;
      end if;

      case state is
        when idle =>
          if request.go = '1' then
            data     <= request.data;
            last     <= request.last;
            receives <= request.receive;
            if request.first = '1' then
              talks <= '1';
              crc   <= (others => '1');
              timer <= (others => '0');
              state <= quiet;
            elsif request.receive = '0' then
              state <= sending;
            elsif talks = '1' then
              state <= low_sum;
            else
              state <= listening;
            end if;
          end if;

        when quiet =>
          lead <= to_unsigned(lead_clocks - 1, lead'length);
          if silent = '1' then
            drives <= '1';
            state  <= leading;
          elsif late = '1' then
            fail(failure_no_answer);
          end if;

        when leading =>
          lead <= lead - 1;
          if lead = 0 then
            state <= sending;
          end if;

        when sending =>
          if tx_ready = '1' then
            crc <= crc_with(crc, data);
            if last = '1' then
              state <= low_sum;
            else
              finish;
            end if;
          end if;

        when low_sum =>
          if tx_ready = '1' then
            state <= high_sum;
          end if;

        when high_sum =>
          if tx_ready = '1' then
            state <= draining;
          end if;

        when draining =>
          crc     <= (others => '1');
          heard   <= "00";
          sums    <= '0';
          refuses <= '0';
          timer   <= (others => '0');
          if tx_ready = '1' then
            drives <= '0';
            talks  <= '0';
            if receives = '1' then
              state <= listening;
            else
              finish;
            end if;
          end if;

        when others =>
          if right then
            crc  <= crc_with(crc, rx_data);
            if heard /= 2 then
              heard <= heard + 1;
            end if;
            if state = listening then
              reply.data <= rx_data;
              if heard = 1 and rx_data(7) = '1' then
                refuses <= '1';
                state   <= refusing;
              elsif last = '1' then
                state <= checking;
              else
                finish;
              end if;
            elsif state = refusing then
              reply.data <= rx_data;
              state      <= checking;
            else
              sums <= '1';
              if sums = '1' then
                if crc_with(crc, rx_data) /= x"0000" then
                  fail(failure_wrong_reply);
                elsif refuses = '1' then
                  fail(failure_refused);
                else
                  finish;
                end if;
              end if;
            end if;
          elsif rx_valid = '1' or (heard /= 0 and silent = '1') then
            fail(failure_wrong_reply);
          elsif heard = 0 and late = '1' then
            fail(failure_no_answer);
          end if;
      end case;

      if reset = '1' then
        state      <= idle;
        reply.done <= '0';
        drives     <= '0';
        talks      <= '0';
      end if;
    end if;
  end process;

end architecture;
