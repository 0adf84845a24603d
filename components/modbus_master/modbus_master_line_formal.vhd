-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the frames of modbus_master. A bit may have any number of clocks, on both sides, and so may the pause
-- and the timeout: what counts is only when they begin anew, and what their ends do. The sequencer asks for any bytes,
-- and the line may do anything. That the bits of a character are right is proven in uart_tx and uart_rx.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.sequencer_pkg.all;

entity modbus_master_line_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    go       : in std_ulogic;
    first    : in std_ulogic;
    last     : in std_ulogic;
    receive  : in std_ulogic;
    byte     : in byte_t;
    rx       : in std_ulogic;
    tx_ticks : in unsigned(13 downto 0);          -- the phases of both UARTs: any value in any clock
    rx_ticks : in unsigned(13 downto 0);
    tx_phase : out unsigned(13 downto 0);         -- the same, for the design
    rx_phase : out unsigned(13 downto 0);
    tx_valid : in std_ulogic;                    -- shows that a byte is offered to the transmitter; all of these show
    tx_ready : in std_ulogic;                    -- signals of the design
    tx_data  : in byte_t;
    rx_valid : in std_ulogic;
    rx_data  : in byte_t;
    rx_error : in std_ulogic_vector(2 downto 0);
    level    : in std_ulogic;                    -- of the line
    silence  : in unsigned(10 downto 0);         -- us
    silent   : in std_ulogic;                    -- it is a pause, and the line is high
    timer    : in unsigned(9 downto 0);          -- us
    late     : in std_ulogic;                    -- it is the timeout
    hears    : in unsigned(3 downto 0);          -- the place in the frame
    sum      : in std_ulogic_vector(15 downto 0); -- the CRC
    data     : in byte_t;
    is_last  : in std_ulogic;
    receives : in std_ulogic;
    talks    : in std_ulogic;
    heard    : in unsigned(1 downto 0);
    refuses  : in std_ulogic;
    lead     : in unsigned(2 downto 0);
    left     : in unsigned(3 downto 0);          -- bits of the character that is sent
    shift    : in std_ulogic_vector(9 downto 0)
  );
end entity;

architecture properties of modbus_master_line_formal is

  constant lead_clocks : positive := 8;
  constant ask_clocks  : positive := 4; -- at most, until the sequencer asks for the next byte
  constant char_clocks : positive := 8; -- at least, between two characters
  constant wait_most   : positive := lead_clocks;

  -- The places of `hears` in its type.
  constant idle      : natural := 0;
  constant quiet     : natural := 1;
  constant leading   : natural := 2;
  constant sending   : natural := 3;
  constant low_sum   : natural := 4;
  constant high_sum  : natural := 5;
  constant draining  : natural := 6;
  constant listening : natural := 7;
  constant refusing  : natural := 8;
  constant checking  : natural := 9;
  constant bits      : natural := 11; -- of a character

  subtype crc_t is std_ulogic_vector(15 downto 0);
  type part_t is (bytes, high_byte, over); -- of the frame that is sent

  signal request             : bus_request_t;
  signal reply               : bus_reply_t;
  signal tx, tx_enable       : std_ulogic;
  signal begun               : std_ulogic := '0';
  signal reset_1             : std_ulogic := '1';
  signal enable_1            : std_ulogic := '0';
  signal busy                : std_ulogic := '0';                        -- a byte is asked for
  signal open_frame          : std_ulogic := '0';                        -- a frame has begun, and has not ended
  signal replying            : std_ulogic := '0';                        -- a byte of its reply was asked for
  signal own_byte            : byte_t := (others => '0');
  signal own_last, own_receive : std_ulogic := '0';
  signal taken               : std_ulogic;
  signal owed                : std_ulogic := '0';                        -- the byte is still to be sent
  signal part                : part_t := over;
  signal crc                 : crc_t := (others => '1');                 -- its first bit leftmost
  signal is_broken           : std_ulogic := '0';                        -- the reply, so far
  signal came                : natural range 0 to 3 := 0;                -- bytes of the reply
  signal newest              : byte_t := (others => '0');
  signal rx_1                : std_ulogic := '0';                        -- a character came a clock ago
  signal event_1             : std_ulogic := '1';                        -- the line was not silent a clock ago
  signal silent_1, late_1    : std_ulogic := '0';
  signal silence_1           : unsigned(10 downto 0) := (others => '0');
  signal level_1             : std_ulogic := '0';
  signal place_1             : unsigned(3 downto 0) := x"0";
  signal starts_1            : std_ulogic := '0';                        -- the timer began anew
  signal driven              : natural range 0 to lead_clocks + 2 := 0;  -- clocks
  signal waits               : natural range 0 to wait_most + 1 := 0;    -- clocks of a driven line without a bit
  signal rests               : natural range 0 to ask_clocks + 1 := 0;   -- clocks in which no byte is asked for
  signal since               : natural range 0 to char_clocks := 0;      -- clocks since a character came
  signal dones               : natural range 0 to 2 := 0;                -- results of this byte
  signal resets              : std_ulogic;
  signal is_open             : std_ulogic;                               -- a frame, with the result of this clock
  signal in_place            : std_ulogic;                               -- the design is where these are

  -- The polynomial 8005, and the register turned round: its first bit leaves at the left.
  function turned_crc (crc : crc_t; data : byte_t) return crc_t is
    variable found : crc_t := crc;
    variable leaves : std_ulogic;
  begin
    for place in 0 to 7 loop
      leaves := found(15) xor data(place);
      found  := found(14 downto 0) & '0';
      if leaves = '1' then
        found := found xor x"8005";
      end if;
    end loop;
    return found;
  end function;

  function turned (value : std_ulogic_vector) return byte_t is
    variable found : byte_t;
  begin
    for place in 0 to 7 loop
      found(place) := value(value'high - place);
    end loop;
    return found;
  end function;

begin

  default clock is rising_edge(clk);

  request <= (go => go, first => first, last => last, receive => receive, data => byte);

  dut : entity work.modbus_master_line
    generic map (clock_hz => 8_000_000, baud_hz => 1_000_000, timeout_us => 1000)
    port map (
      clock => clk, reset => resets, request => request, reply => reply, rx => rx, tx => tx, tx_enable => tx_enable);

  taken    <= tx_valid and tx_ready;
  resets   <= reset or not begun; -- at power-up, and at any later clock
  tx_phase <= tx_ticks;
  rx_phase <= rx_ticks;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun    <= '1';
      reset_1  <= resets;
      enable_1 <= tx_enable;
      rx_1     <= rx_valid;
      event_1  <= rx_valid or tx_enable or not level;
      silent_1  <= silent;
      silence_1 <= silence;
      late_1   <= late;
      level_1  <= level;
      place_1  <= hears;
      starts_1 <= '0';
      if since < char_clocks then
        since <= since + 1;
      end if;

      if reply.done = '1' then
        busy  <= '0';
        dones <= dones + 1;
        if reply.failed = '1' or own_last = '1' then
          open_frame <= '0';
        end if;
      end if;
      rests <= 0;
      if busy = '0' and open_frame = '1' and go = '0' then
        rests <= minimum(rests + 1, ask_clocks + 1);
      end if;
      if go = '1' then
        busy        <= '1';
        dones       <= 0;
        own_byte    <= byte;
        own_last    <= last;
        own_receive <= receive;
        owed        <= not receive;
        open_frame  <= '1';
        if first = '1' then
          part     <= bytes;
          replying <= '0';
          starts_1 <= '1';
        end if;
        if receive = '1' then
          replying <= '1';
        end if;
      end if;

      if taken = '1' then
        case part is
          when bytes =>
            owed <= '0';
            if owed = '0' then
              part <= high_byte;
            end if;
          when others => part <= over;
        end case;
      end if;
      if taken = '1' and hears = sending then
        crc <= turned_crc(crc, tx_data);
      end if;
      if hears = idle and go = '1' and first = '1' then
        crc <= (others => '1');
      end if;
      if hears = draining then
        starts_1 <= '1';
        crc      <= (others => '1');
      end if;

      if rx_valid = '1' then
        since  <= 0;
        newest <= rx_data;
        came   <= minimum(came + 1, 3);
        if or rx_error = '1' then
          is_broken <= '1';
        elsif hears >= listening then
          crc <= turned_crc(crc, rx_data);
        end if;
      elsif silent = '1' and came /= 0 then
        is_broken <= '1';
      end if;
      if tx_enable = '1' then
        came      <= 0;
        is_broken <= '0';
      end if;

      driven <= 0;
      waits  <= 0;
      if tx_enable = '1' then
        driven <= minimum(driven + 1, lead_clocks + 2);
        if tx_ready = '1' and taken = '0' then
          waits <= minimum(waits + 1, wait_most + 1);
        end if;
      end if;

      if resets = '1' then
        busy       <= '0';
        open_frame <= '0';
        enable_1   <= '0';
        event_1    <= '0';
        since      <= 0;
        dones      <= 0;
        part       <= over;
        place_1    <= x"0";
        starts_1   <= '0';
      end if;
    end if;
  end process;

  is_open <= open_frame and not (reply.done and (reply.failed or own_last));

  compare : process (all) is
    variable fits : boolean;
    variable turn : crc_t;
  begin
    for place in 0 to 15 loop
      turn(place) := crc(15 - place);
    end loop;
    fits := sum = turn and hears <= checking and left <= bits;
    for place in 0 to 9 loop
      fits := fits and (shift(place) = '1' or place + 1 < left); -- behind the bits to come there are ones
    end loop;
    fits := fits and (reply.done = '0' or (hears = idle and busy = '1' and dones = 0)) and
            (hears = idle or (busy = '1' and dones = 0 and open_frame = '1' and reply.done = '0')) and
            (hears /= idle or busy = reply.done) and
            (busy = '0' or (is_last = own_last and receives = own_receive));

    -- The driver.
    fits := fits and (tx_enable = '1' or left = 0) and (enable_1 = '0' or rx_valid = '0') and
            (tx_enable = '0' or enable_1 = '1' or (silent_1 = '1' and level_1 = '1' and hears = leading)) and
            (tx_enable = '1' or enable_1 = '0' or part = over) and
            (tx_enable = '0' or (came = 0 and is_broken = '0') or enable_1 = '0') and
            (left = 0 or driven > lead_clocks) and driven <= lead_clocks + 2;

    case to_integer(hears) is
      when idle =>
        if is_open = '0' then
          fits := fits and tx_enable = '0';
        elsif replying = '0' then
          fits := fits and tx_enable = '1' and talks = '1' and part = bytes and owed = '0' and own_last = '0' and
                  driven > lead_clocks and waits = 0 and enable_1 = '1' and
                  ((reply.done = '1' and rests = 0 and left = bits) or
                   (busy = '0' and rests <= ask_clocks + 1 and to_integer(left) + rests + 1 >= bits));
        else
          fits := fits and tx_enable = '0' and talks = '0' and part = over and is_broken = '0' and refuses = '0' and
                  heard = minimum(came, 2) and came /= 0 and own_last = '0' and rx_valid = '0' and
                  ((reply.done = '1' and rests = 0 and since = 0) or
                   (busy = '0' and rests <= ask_clocks + 1 and since = rests + 1));
        end if;

      when quiet =>
        fits := fits and tx_enable = '0' and talks = '1' and part = bytes and owed = '1' and data = own_byte and
                waits = 0 and driven = 0 and replying = '0' and own_receive = '0';

      when leading =>
        fits := fits and tx_enable = '1' and talks = '1' and part = bytes and owed = '1' and data = own_byte and
                left = 0 and driven + to_integer(lead) + 1 = lead_clocks and waits = driven and replying = '0' and
                own_receive = '0' and (enable_1 = '1' or driven = 0);

      when sending =>
        fits := fits and tx_enable = '1' and talks = '1' and part = bytes and owed = '1' and data = own_byte and
                driven >= lead_clocks and replying = '0' and own_receive = '0' and enable_1 = '1' and
                ((driven = lead_clocks and waits = lead_clocks and left = 0) or (waits = 0 and left /= 0));

      when low_sum =>
        fits := fits and tx_enable = '1' and talks = '1' and part = bytes and owed = '0' and driven > lead_clocks and
                (own_last = '1' or own_receive = '1') and replying = own_receive and waits = 0 and left >= 1 and
                enable_1 = '1';

      when high_sum =>
        fits := fits and tx_enable = '1' and part = high_byte and replying = own_receive and waits = 0 and
                left >= 1 and driven > lead_clocks and (own_last = '1' or own_receive = '1') and enable_1 = '1';

      when draining =>
        fits := fits and tx_enable = '1' and part = over and replying = own_receive and waits = 0 and left >= 1 and
                driven > lead_clocks and (own_last = '1' or own_receive = '1') and enable_1 = '1';

      when others => -- listening, refusing, checking
        fits := fits and tx_enable = '0' and talks = '0' and part = over and replying = '1' and own_receive = '1' and
                is_broken = '0' and heard = minimum(came, 2);
        if hears = listening then
          fits := fits and refuses = '0' and (came = 0 or since = char_clocks or since <= ask_clocks + 3);
        elsif hears = refusing then
          fits := fits and refuses = '1';
        else
          fits := fits and (refuses = '1' or own_last = '1');
        end if;
    end case;

    if reply.done = '1' and reply.failed = '0' and own_receive = '1' then
      fits := fits and (own_last = '0' or crc = x"0000") and
              (own_last = '1' or (reply.data = newest and rx_1 = '1' and is_broken = '0'));
    end if;
    in_place <= to_bit(fits);
  end process;

  -- At every clock, the design is where the reference is.
  stays_in_place : assert always begun = '1' -> in_place = '1';


  -- The sequencer asks for one byte at a time. A frame begins with a byte that is sent, and its reply comes behind what
  -- is sent. While a frame is open, the next byte is asked for within 4 clocks.
  asks : assume always (go = '0' or busy = '0') and (go = '0' or first = not open_frame) and
                       (go = '0' or first = '0' or receive = '0') and
                       (go = '0' or receive = '1' or first = '1' or replying = '0') and rests <= ask_clocks;

  -- Two characters are at least 8 clocks apart.
  characters : assume always rx_valid = '0' or since = char_clocks;

  -- The silence begins anew when the line is low, when it is driven, and when a character comes. Else it never falls,
  -- and a pause has more than 8 clocks. The timer begins anew when a frame is asked for, and when it has been sent.
  counters : assume always begun = '1' -> (event_1 = '0' or silence = 0) and (event_1 = '1' or silence >= silence_1) and
                           (starts_1 = '0' or timer = 0) and (since = char_clocks or silent = '0');

  -- A frame begins only when the line is silent, and high: never while a character comes in.
  starts_silent : assert always begun = '1' and tx_enable = '1' and enable_1 = '0' ->
                          silent_1 = '1' and level_1 = '1';

  -- The line is low only while its driver is on, and that is on for a bit before.
  low_is_driven : assert always begun = '1' and tx = '0' -> tx_enable = '1' and driven > lead_clocks;

  -- It hears nothing of what it sends.
  no_echo : assert always begun = '1' and rx_valid = '1' -> enable_1 = '0';

  -- The bytes go out in the order in which they are asked for, each once, and behind them the two bytes of the CRC.
  right_byte : assert always begun = '1' and taken = '1' and part = bytes and owed = '1' -> tx_data = own_byte;
  -- The low byte of the CRC comes behind the last byte, and before the first byte of the reply is awaited.
  right_low  : assert always begun = '1' and taken = '1' and part = bytes and owed = '0' ->
                        tx_data = turned(crc(15 downto 8)) and (own_last = '1' or own_receive = '1');
  -- Then comes the high one.
  right_high : assert always begun = '1' and taken = '1' and part = high_byte -> tx_data = turned(crc(7 downto 0));
  -- Nothing else is sent.
  no_more    : assert always begun = '1' and taken = '1' -> part = bytes or part = high_byte;

  -- The driver goes off only behind the CRC, when the last stop bit has ended. Only a reset ends that sooner.
  whole_frame : assert always begun = '1' and reset_1 = '0' and tx_enable = '0' and enable_1 = '1' ->
                         part = over and tx = '1';

  -- A driven line is never at rest: only the lead and the sequencer make the transmitter wait. So it is let go again.
  lets_go : assert always begun = '1' and tx_enable = '1' -> waits <= wait_most;

  -- A reset releases the line in the next clock.
  reset_lets_go : assert always begun = '1' and reset_1 = '1' -> tx_enable = '0' and tx = '1';

  -- Each byte that is asked for has one result.
  one_result : assert always begun = '1' and reply.done = '1' -> busy = '1' and dones = 0;

  -- A byte of a reply is the one that came last.
  right_reply : assert always begun = '1' and reply.done = '1' and reply.failed = '0' and own_receive = '1' and
                              own_last = '0' ->
                         reply.data = newest and rx_1 = '1' and is_broken = '0';

  -- A reply that ends well has the right CRC.
  right_end : assert always begun = '1' and reply.done = '1' and reply.failed = '0' and own_receive = '1' and
                            own_last = '1' -> crc = x"0000";

  -- A line that is never silent for the timeout ends the wait for it.
  ends_quiet : assert always begun = '1' and reset_1 = '0' and place_1 = quiet and late_1 = '1' ->
                        tx_enable = '1' or (reply.done = '1' and reply.failed = '1');

  -- A device that does not begin within the timeout ends the wait for it.
  ends_silence : assert always begun = '1' and reset_1 = '0' and place_1 = listening and came = 0 and late_1 = '1' ->
                          reply.done = '1' and reply.failed = '1' and reply.reason = failure_no_answer;

  -- A device that stops within its reply ends the wait for the rest.
  ends_pause : assert always begun = '1' and reset_1 = '0' and place_1 >= listening and came /= 0 and silent_1 = '1' and
                             rx_1 = '0' -> reply.done = '1' and reply.failed = '1';

  -- A reply ends well.
  good_seen : cover {begun = '1' and reply.done = '1' and reply.failed = '0' and own_receive = '1' and own_last = '1'};

end architecture;
