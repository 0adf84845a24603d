-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of servo_bus_receiver with Feetech and a timeout of 20 us. Any characters may come, whole or broken, at
-- any clock, and a us may end at any clock. A reference keeps the last bytes, and looks at them when a reply is good.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.servo_bus_pkg.all;

entity servo_bus_receiver_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    tick     : in std_ulogic;
    listens  : in std_ulogic;
    id       : in byte_t;
    rx_valid : in std_ulogic;                    -- shows that a character has come, as all of these show signals
    data     : in byte_t;
    rx_error : in std_ulogic_vector(2 downto 0);
    place    : in unsigned(4 downto 0);
    timer    : in unsigned(4 downto 0);
    counted  : in unsigned(5 downto 0);
    wrong    : in std_ulogic;
    extra    : in unsigned(1 downto 0);
    low      : in byte_t;
    summed   : in std_ulogic_vector(15 downto 0) -- the sum, inverted
  );
end entity;

architecture properties of servo_bus_receiver_formal is

  constant timeout : positive := 20;
  constant most    : positive := 63; -- bytes that are heard
  constant length  : positive := 12; -- bytes of a reply

  type history_t is array (0 to length - 1) of byte_t;
  subtype half_t is std_ulogic_vector(15 downto 0);
  type halves_t is array (0 to 7) of half_t;

  signal put, good, failed, any : std_ulogic;
  signal field       : unsigned(2 downto 0);
  signal word        : half_t;
  signal begun       : std_ulogic := '0';
  signal deaf        : std_ulogic := '1';                           -- a clock ago
  signal ended       : std_ulogic := '0';                           -- a result came a clock ago
  signal id_1        : byte_t := (others => '0');
  signal history     : history_t := (others => (others => '0'));    -- the newest byte first
  signal longs       : halves_t := (others => (others => '0'));     -- n: the last bytes n + 1 and n, as a word with a
  signal shorts      : halves_t := (others => (others => '0'));     -- sign in bit 15, and the same with one in bit 10
  signal sums        : history_t := (others => (others => '0'));    -- n: of the last n bytes
  signal sum         : byte_t := (others => '0');                   -- of the nine bytes before the last one
  signal heard       : natural range 0 to most + 1 := 0;
  signal is_broken   : std_ulogic := '0';                           -- a character was, since it listens
  signal came        : std_ulogic := '0';                           -- a byte, a clock ago
  signal is_right    : std_ulogic;                                  -- the last bytes are a reply of this servo
  signal silent      : natural range 0 to timeout + 2 := 0;         -- us
  signal since       : natural range 0 to 3 := 0;                   -- clocks since a character came
  signal position, speed, load, status : half_t := (others => '0'); -- that were put last
  signal position_now, speed_now, load_now, status_now : half_t;
  signal in_place    : std_ulogic;                                  -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.servo_bus_receiver
    generic map (clock_hz => 460_800, baud_hz => 57_600, protocol => 1, timeout_us => timeout)
    port map (
      clock => clk, reset => reset, tick => tick, listens => listens, id => id, put => put, field => field,
      word => word, good => good, failed => failed, any => any, line => '1');

  is_right <= to_bit(history(11) = x"FF" and history(10) = x"FF" and history(9) = id and history(8) = x"08" and
                     history(0) = not sum);

  position_now <= word when put = '1' and field = position_field else position;
  speed_now    <= word when put = '1' and field = speed_field else speed;
  load_now     <= word when put = '1' and field = load_field else load;
  status_now   <= word when put = '1' and field = status_field else status;

  watch : process (clk) is
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
      since <= minimum(since + 1, 3);
      if rx_valid = '1' then
        history <= data & history(0 to length - 2);
        longs   <= without_sign(data & history(0), 15) & longs(0 to 6);
        shorts  <= without_sign(data & history(0), 10) & shorts(0 to 6);
        for number in 1 to length - 1 loop
          sums(number) <= std_ulogic_vector(unsigned(sums(number - 1)) + unsigned(data));
        end loop;
        sum     <= sums(9);
        silent  <= 0;
        since   <= 0;
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
        sums      <= (others => (others => '0'));
        longs     <= (others => (others => '0'));
        shorts    <= (others => (others => '0'));
        heard     <= 0;
        is_broken <= '0';
        came      <= '0';
        silent    <= 0;
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits     : boolean;
    variable prefix   : boolean;              -- all bytes so far are the begin of a reply
    variable total    : unsigned(7 downto 0); -- of the bytes behind the header
    variable here     : natural range 0 to 31;
    variable is_reply : boolean;
  begin
    here := to_integer(place);
    fits := here <= heard and extra = 0 and timer = silent and counted = heard and heard <= most and
            (came = '0' or since = 0) and (put = '0' or came = '1') and (good = '0' or came = '1') and
            (is_broken = '0' or wrong = '1') and (wrong = '1' or here <= length) and
            (heard /= 0 or (here = 0 and wrong = '0' and is_broken = '0')) and (wrong = '0' or heard /= 0) and
            (silent <= timeout or good = '1' or failed = '1' or ended = '1') and
            (silent <= timeout + 1 or ended = '1') and
            (heard < most or since = 0 or (since = 1 and (failed = '1' or ended = '1')) or ended = '1') and
            (good = '0' or (here = length and wrong = '0')) and
            (here /= length or wrong = '1' or good = '1' or ended = '1') and
            (here /= 1 or history(0) = x"FF") and (here /= 2 or (history(0) = x"FF" and history(1) = x"FF"));

    for number in 2 to length loop
      is_reply := here = number and wrong = '0';
      total    := unsigned(sums(number - 2)); -- of the bytes from the id on
      if number < length then
        fits := fits and (not is_reply or summed = x"00" & not std_ulogic_vector(total));
      else
        fits := fits and (not is_reply or history(0) = not sum);
      end if;
      if number >= 3 then
        fits := fits and (not is_reply or (history(number - 3) = id_1 and history(number - 2) = x"FF" and
                                           history(number - 1) = x"FF"));
      end if;
      if number >= 4 then
        fits := fits and (not is_reply or history(number - 4) = x"08");
      end if;
      if number >= 5 then
        fits := fits and (not is_reply or status_now = "00000" & history(number - 5) & "000");
      end if;
      if number >= 6 and number < length then
        fits := fits and (not is_reply or low = history(0));
      end if;
      if number >= 7 then
        fits := fits and (not is_reply or
                          position_now = longs(number - 7));
      end if;
      if number >= 9 then
        fits := fits and (not is_reply or
                          speed_now = longs(number - 9));
      end if;
      if number >= 11 then
        fits := fits and (not is_reply or
                          load_now = shorts(number - 11));
      end if;
    end loop;

    for number in 1 to length loop
      prefix := is_broken = '0' and history(number - 1) = x"FF" and
                (number < 2 or history(maximum(number - 2, 0)) = x"FF") and
                (number < 3 or history(maximum(number - 3, 0)) = id_1) and
                (number < 4 or history(maximum(number - 4, 0)) = x"08");
      fits := fits and (heard /= number or not prefix or
                        (here = number and (wrong = '0' or (number = length and history(0) /= not sum))));
    end loop;
    if deaf = '1' then
      fits := heard = 0 and counted = 0 and here = 0 and timer = 0 and silent = 0 and wrong = '0' and extra = 0 and
              good = '0' and failed = '0' and put = '0' and is_broken = '0' and came = '0';
    end if;
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The receiver of characters gives none behind a clock in which it is reset (uart_bridge).
  deaf_is_silent : assume always begun = '1' and deaf = '1' -> rx_valid = '0';

  -- Two characters are some clocks apart.
  characters : assume always rx_valid = '0' or since = 3;

  -- It is told to listen until a result comes, and then not, for a clock at least. Meanwhile the id stays the same.
  listens_on : assume always begun = '1' -> (ended = '0' or listens = '0') and
                             (deaf = '1' or ended = '1' or listens = '1') and
                             (listens = '0' or deaf = '1' or id = id_1);

  -- An id is never FF.
  is_id : assume always id /= x"FF";

  -- At every clock, the design is where the last bytes say, and it has heard 63 bytes at most.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- A reply is good only if its last bytes are one of this servo, with the right length and check, and if no character
  -- was broken since it listens.
  good_is_right : assert always begun = '1' and good = '1' and ended = '0' ->
                            is_right = '1' and is_broken = '0' and came = '1';

  -- A reply of this servo, behind nothing else, is good with its last byte.
  right_is_good : assert always begun = '1' and came = '1' and heard = length and is_right = '1' and is_broken = '0' and
                                failed = '0' and ended = '0' -> good = '1';

  -- The position of a good reply is what came.
  right_position : assert always begun = '1' and good = '1' and ended = '0' ->
                             position_now = longs(5);
  -- The speed is.
  right_speed    : assert always begun = '1' and good = '1' and ended = '0' ->
                             speed_now = longs(3);
  -- The load is.
  right_load     : assert always begun = '1' and good = '1' and ended = '0' ->
                             load_now = shorts(1);
  -- The error byte is.
  right_status   : assert always begun = '1' and good = '1' and ended = '0' -> status = "00000" & history(7) & "000";

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
  behind_noise : cover {begun = '1' and good = '1' and heard > length};

end architecture;
