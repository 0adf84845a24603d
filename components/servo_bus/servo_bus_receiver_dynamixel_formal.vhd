-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of servo_bus_receiver with Dynamixel and a timeout of 20 us. Any characters may come, whole or broken,
-- with 8 clocks between them, and a us may end at any clock. A reference keeps the last bytes, and looks at them when a
-- reply is good.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.servo_bus_pkg.all;

entity servo_bus_receiver_dynamixel_formal is
  port (
    clk      : in std_ulogic;
    again    : in std_ulogic;                    -- a reset later than at power-up
    tick     : in std_ulogic;
    listens  : in std_ulogic;
    id       : in byte_t;
    comes    : in std_ulogic;                    -- a character, as soon as one can
    steady   : in std_ulogic;                    -- so do the first 22 characters, whatever `comes` says
    arrives  : out std_ulogic;                   -- one does
    data     : in byte_t;                        -- shows a signal of the design, as all of these do
    rx_error : in std_ulogic_vector(2 downto 0);
    place    : in unsigned(4 downto 0);
    timer    : in unsigned(4 downto 0);
    counted  : in unsigned(5 downto 0);
    wrong    : in std_ulogic;
    extra    : in unsigned(1 downto 0);
    run      : in unsigned(1 downto 0);
    low      : in byte_t;
    shift    : in byte_t;                        -- of the check: what is left of a byte
    left     : in unsigned(3 downto 0);
    summed   : in std_ulogic_vector(15 downto 0)
  );
end entity;

architecture properties of servo_bus_receiver_dynamixel_formal is

  constant timeout    : positive := 20;
  constant most       : positive := 63; -- bytes that are heard
  constant length     : positive := 21; -- bytes of a reply without stuffed ones
  constant extra_most : positive := 3;  -- stuffed ones
  constant apart      : positive := 8;  -- clocks between two characters, at least, in which a CRC is made
  constant checked    : positive := 16; -- bytes between the header and the check, without stuffed ones

  subtype half_t is std_ulogic_vector(15 downto 0);
  type history_t is array (natural range <>) of byte_t;
  type halves_t is array (natural range <>) of half_t;

  signal put, good, failed, any : std_ulogic;
  signal field       : unsigned(2 downto 0);
  signal word        : half_t;
  signal begun       : std_ulogic := '0';
  signal reset       : std_ulogic;
  signal rx_valid    : std_ulogic;
  signal deaf        : std_ulogic := '1';                           -- a clock ago
  signal ended       : std_ulogic := '0';                           -- a result came a clock ago
  signal id_1        : byte_t := (others => '0');
  signal history     : history_t(0 to length + extra_most - 1) := (others => (others => '0')); -- the newest byte first
  signal plain       : history_t(0 to 12) := (others => (others => '0')); -- the same, without stuffed bytes
  signal crcs        : halves_t(1 to checked + extra_most) := (others => (others => '0')); -- n: of the header and the
                                                                                           -- last n bytes
  signal crcs_1, crcs_2 : halves_t(checked to checked + extra_most) := (others => (others => '0')); -- a byte ago, and 2
  signal stuffs      : natural range 0 to extra_most + 1 := 0;      -- stuffed bytes of this reply
  signal clean       : std_ulogic := '1';                           -- nothing in it had to be stuffed
  signal is_marked   : std_ulogic;                                  -- the last bytes are FF FF FD
  signal heard       : natural range 0 to most + 1 := 0;
  signal is_broken   : std_ulogic := '0';                           -- a character was, since it listens
  signal came        : std_ulogic := '0';                           -- a byte, a clock ago
  signal is_right    : std_ulogic;                                  -- the last bytes are a reply of this servo
  signal is_plain_right : std_ulogic;                               -- without stuffed bytes
  signal silent      : natural range 0 to timeout + 2 := 0;         -- us
  signal since       : natural range 0 to apart := 0;               -- clocks since a character came
  signal position, speed, load, status : half_t := (others => '0'); -- that were put last
  signal position_now, speed_now, load_now, status_now : half_t;
  signal in_place    : std_ulogic;                                  -- the design is where these are

  -- A CRC with the polynomial x**16 + x**15 + x**2 + 1 behind some more bits, the highest one first.
  function crc_with (crc : half_t; bits : byte_t; number : natural) return half_t is
    variable found : half_t;
    variable top   : std_ulogic;
  begin
    found := crc;
    for place in 7 downto 0 loop
      if 7 - place < number then
        top       := found(15) xor bits(place);
        found     := found(14 downto 0) & top;
        found(15) := found(15) xor top;
        found(2)  := found(2) xor top;
      end if;
    end loop;
    return found;
  end function;

  function header_crc return half_t is
    variable found : half_t := (others => '0');
  begin
    found := crc_with(found, x"FF", 8);
    found := crc_with(found, x"FF", 8);
    return crc_with(found, x"FD", 8);
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.servo_bus_receiver
    generic map (clock_hz => 460_800, baud_hz => 57_600, protocol => 0, timeout_us => timeout)
    port map (
      clock => clk, reset => reset, tick => tick, listens => listens, id => id, put => put, field => field,
      word => word, good => good, failed => failed, any => any, line => '1');

  look : process (all) is
    variable found : std_ulogic;
  begin
    is_right       <= '0';
    is_plain_right <= '0';
    for more in 0 to extra_most loop
      found := to_bit(history(20 + more) = x"FF" and history(19 + more) = x"FF" and history(18 + more) = x"FD" and
                      history(17 + more) = x"00" and history(16 + more) = id and
                      unsigned(history(15 + more)) = 14 + more and history(14 + more) = x"00" and
                      history(13 + more) = x"55" and history(1) = crcs_2(checked + more)(7 downto 0) and
                      history(0) = crcs_2(checked + more)(15 downto 8));
      if found = '1' then
        is_right <= '1';
      end if;
      if more = 0 then
        is_plain_right <= found;
      end if;
    end loop;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset    <= again or not begun;

  -- Two characters have some clocks between them: one has 10 bits of 8 clocks or more. The receiver of characters gives
  -- none behind a clock in which it is reset (uart_bridge).
  rx_valid <= (comes or (steady and to_bit(heard < 22))) and to_bit(since = apart) and not deaf;
  arrives  <= rx_valid;

  is_marked    <= to_bit(history(0) = x"FD" and history(1) = x"FF" and history(2) = x"FF");
  position_now <= word when put = '1' and field = position_field else position;
  speed_now    <= word when put = '1' and field = speed_field else speed;
  load_now     <= word when put = '1' and field = load_field else load;
  status_now   <= word when put = '1' and field = status_field else status;

  watch : process (clk) is
    variable is_stuffed : boolean;
  begin
    if rising_edge(clk) then
      begun <= '1';
      deaf  <= reset or not listens;
      ended <= good or failed;
      id_1  <= id;
      came  <= rx_valid;
      if tick = '1' and silent <= timeout + 1 then
        silent <= silent + 1;
      end if;
      since <= minimum(since + 1, apart);
      if rx_valid = '1' then
        is_stuffed := is_marked = '1' and place >= 8 and place <= 19;
        history <= data & history(0 to history'high - 1);
        if is_stuffed then
          stuffs <= minimum(stuffs + 1, extra_most + 1);
          clean  <= '0';
        else
          plain <= data & plain(0 to plain'high - 1);
        end if;
        if place < 3 then
          stuffs <= 0;
        end if;
        crcs(1) <= crc_with(header_crc, data, 8);
        for number in 2 to crcs'high loop
          crcs(number) <= crc_with(crcs(number - 1), data, 8);
        end loop;
        for number in crcs_1'range loop
          crcs_1(number) <= crcs(number);
        end loop;
        crcs_2 <= crcs_1;
        silent <= 0;
        since  <= 0;
        if heard <= most then
          heard <= heard + 1;
        end if;
        if or rx_error = '1' then
          is_broken <= '1';
        end if;
      end if;
      position <= position_now;
      speed    <= speed_now;
      load     <= load_now;
      status   <= status_now;
      if reset = '1' or listens = '0' then
        history   <= (others => (others => '0'));
        stuffs    <= 0;
        clean     <= '1';
        heard     <= 0;
        is_broken <= '0';
        came      <= '0';
        silent    <= 0;
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits     : boolean;
    variable prefix   : boolean; -- all bytes so far are the begin of a reply
    variable here     : natural range 0 to 31;
    variable behind   : natural range 0 to 31; -- bytes behind the header
    variable is_reply : boolean;
    variable crc      : half_t;  -- that the design is about to have
  begin
    here := to_integer(place);
    crc  := crc_with(summed, shift, to_integer(left));
    fits := here <= heard and timer = silent and counted = heard and heard <= most and left <= 8 and
            (left = 0 or to_integer(left) + since <= 8) and
            (came = '0' or since = 0) and (put = '0' or came = '1') and (good = '0' or came = '1') and
            (is_broken = '0' or wrong = '1') and
            (heard /= 0 or (here = 0 and wrong = '0' and is_broken = '0' and clean = '1')) and
            (wrong = '0' or heard /= 0) and
            (silent <= timeout or good = '1' or failed = '1' or ended = '1') and
            (silent <= timeout + 1 or ended = '1') and
            (heard < most or since = 0 or (since = 1 and (failed = '1' or ended = '1')) or ended = '1') and
            (good = '0' or (here = length and wrong = '0' and extra = 0)) and
            (here /= length or wrong = '1' or extra /= 0 or good = '1' or ended = '1') and
            (here /= 1 or wrong = '1' or (history(0) = x"FF" and run /= 0)) and
            (here /= 2 or wrong = '1' or (history(0) = x"FF" and history(1) = x"FF" and run = 2));

    if here >= 3 and here < length and wrong = '0' then
      fits := fits and (run = 3) = (is_marked = '1') and
              (run = 2) = (history(0) = x"FF" and history(1) = x"FF") and
              (run = 1) = (history(0) = x"FF" and history(1) /= x"FF") and
              (here < 10 or here > 19 or low = plain(0));
    end if;
    if here >= 3 and here <= length and wrong = '0' then
      fits := fits and (here > 8 or stuffs = 0) and (here < 6 or stuffs + to_integer(extra) <= extra_most);
    end if;

    for number in 3 to length loop
      for more in 0 to extra_most loop
        is_reply := here = number and stuffs = more and wrong = '0';
        behind   := number - 3 + more;
        fits := fits and (not is_reply or (history(behind) = x"FD" and history(behind + 1) = x"FF" and
                                           history(behind + 2) = x"FF"));
        if number = 3 then
          fits := fits and (not is_reply or crc = header_crc);
        elsif number <= 19 then
          fits := fits and (not is_reply or crc = crcs(minimum(maximum(behind, 1), crcs'high)));
        elsif number = 20 then
          fits := fits and (not is_reply or (summed = crcs_1(checked + more) and left = 0 and
                                             history(0) = summed(7 downto 0)));
        else
          fits := fits and (not is_reply or (history(1) = crcs_2(checked + more)(7 downto 0) and
                                             history(0) = crcs_2(checked + more)(15 downto 8)));
        end if;
        if number >= 4 then
          fits := fits and (not is_reply or history(maximum(behind - 1, 0)) = x"00");
        end if;
        if number >= 5 then
          fits := fits and (not is_reply or history(maximum(behind - 2, 0)) = id_1);
        end if;
        if number >= 6 then
          fits := fits and (not is_reply or unsigned(history(maximum(behind - 3, 0))) = 14 + more + to_integer(extra));
        end if;
        if number >= 7 then
          fits := fits and (not is_reply or history(maximum(behind - 4, 0)) = x"00");
        end if;
        if number >= 8 then
          fits := fits and (not is_reply or history(maximum(behind - 5, 0)) = x"55");
        end if;
      end loop;
      is_reply := here = number and wrong = '0';
      if number >= 9 then
        fits := fits and (not is_reply or status_now = "00000" & plain(number - 9) & "000");
      end if;
      if number >= 11 then
        fits := fits and (not is_reply or load_now = plain(number - 11) & plain(number - 10));
      end if;
      if number >= 13 then
        fits := fits and (not is_reply or speed_now = plain(number - 13) & plain(number - 12));
      end if;
      if number >= 17 then
        fits := fits and (not is_reply or position_now = plain(number - 17) & plain(number - 16));
      end if;
    end loop;

    -- A reply behind nothing else, with nothing that must be stuffed.
    for number in 1 to length loop
      prefix := is_broken = '0' and clean = '1' and history(number - 1) = x"FF" and
                (number < 2 or history(maximum(number - 2, 0)) = x"FF") and
                (number < 3 or history(maximum(number - 3, 0)) = x"FD") and
                (number < 4 or history(maximum(number - 4, 0)) = x"00") and
                (number < 5 or history(maximum(number - 5, 0)) = id_1) and
                (number < 6 or history(maximum(number - 6, 0)) = x"0E") and
                (number < 7 or history(maximum(number - 7, 0)) = x"00") and
                (number < 8 or history(maximum(number - 8, 0)) = x"55");
      fits := fits and (heard /= number or not prefix or (here = number and stuffs = 0 and
                        (wrong = '0' or (number = 20 and history(0) /= crcs_1(checked)(7 downto 0)) or
                         (number = 21 and (history(1) /= crcs_2(checked)(7 downto 0) or
                                           history(0) /= crcs_2(checked)(15 downto 8))))));
    end loop;

    if deaf = '1' then
      fits := heard = 0 and counted = 0 and here = 0 and timer = 0 and silent = 0 and wrong = '0' and extra = 0 and
              run = 0 and good = '0' and failed = '0' and put = '0' and is_broken = '0' and came = '0' and
              clean = '1' and stuffs = 0 and left <= 8 and (left = 0 or to_integer(left) + since <= 8);
    end if;
    in_place <= to_bit(fits);
  end process;

  -- It is told to listen until a result comes, and then not, for a clock at least. Meanwhile the id stays the same.
  listens_on : assume always begun = '1' -> (ended = '0' or listens = '0') and
                             (deaf = '1' or ended = '1' or listens = '1') and
                             (listens = '0' or deaf = '1' or id = id_1);

  -- An id is never FF.
  is_id : assume always id /= x"FF";

  -- At every clock, the design is where the last bytes say, and it has heard 63 bytes at most.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- A reply is good only if its last bytes are one of this servo, with the right length and CRC, and if no character
  -- was broken since it listens. Its stuffed bytes belong to length and CRC.
  good_is_right : assert always begun = '1' and good = '1' and ended = '0' ->
                            is_right = '1' and is_broken = '0' and came = '1';

  -- A reply of this servo, behind nothing else, and with nothing that must be stuffed, is good with its last byte.
  right_is_good : assert always begun = '1' and came = '1' and heard = length and is_plain_right = '1' and
                            clean = '1' and is_broken = '0' and failed = '0' and ended = '0' -> good = '1';

  -- The position of a good reply is what came, without the stuffed bytes.
  right_position : assert always begun = '1' and good = '1' and ended = '0' -> position_now = plain(4) & plain(5);
  -- The speed is.
  right_speed    : assert always begun = '1' and good = '1' and ended = '0' -> speed_now = plain(8) & plain(9);
  -- The load is.
  right_load     : assert always begun = '1' and good = '1' and ended = '0' -> load_now = plain(10) & plain(11);
  -- The error byte is.
  right_status   : assert always begun = '1' and good = '1' and ended = '0' -> status = "00000" & plain(12) & "000";

  -- It never listens for longer when nothing comes.
  always_ends : assert always begun = '1' and listens = '1' -> silent <= 21;

  -- No question fails sooner: a servo that is still sending is not interrupted, but by a byte
  -- in the very clock of the timeout.
  never_early : assert always begun = '1' and failed = '1' ->
                          silent >= timeout or heard = most or came = '1';

  -- There is no result while it does not listen.
  none_when_deaf : assert always begun = '1' and deaf = '1' -> good = '0' and failed = '0' and put = '0';

  -- `any` says whether bytes came.
  right_any : assert always begun = '1' and failed = '1' and heard < most -> (any = '1') = (heard > 0);

  -- A reply comes behind noise.
  behind_noise : cover {begun = '1' and good = '1' and clean = '1' and heard > length};

  -- A reply has a stuffed byte.
  stuffed_seen : cover {begun = '1' and good = '1' and stuffs = 1};

end architecture;
