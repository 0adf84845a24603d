-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the framed protocol's transmitter, on any payloads and any stalls: its output consists of whole frames,
-- each with its kind, its payload and its check. Kind, COBS and check are computed again here: the check bit by bit,
-- and COBS for one place of the payload, which is any.
--
-- The memory is here instead of in the design. Only the watched place is kept, in both banks. Any other place is read
-- as any byte but 00. That is no loss: the place is any, so each byte that is read is also the watched one.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.one_thing_pkg.all;
use work.protocol_pkg.all;
use work.serial_crc_pkg.all;

entity frame_transmitter_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    epoch    : in crc16_t;
    put      : in std_ulogic;
    kind     : in std_ulogic;
    restart  : in std_ulogic;
    finish   : in std_ulogic;
    data     : in byte_t;
    tx_ready : in std_ulogic;
    watched  : in unsigned(7 downto 0);  -- the place of the encoded payload that is watched
    read_else : in byte_t;               -- what the memory reads at another place
    looked   : out byte_t;               -- what the memory has read
    -- Observed signals of the design.
    bank, whole, complete, puts, ends, drops, writes, kind_waits, full, read_bank : in std_ulogic;
    position, zero, write_index, read_index, read_next, unsent : in unsigned(7 downto 0);
    pending, written, kind_kept, encoded : in byte_t;
    crc      : in crc16_t;
    turn     : in unsigned(1 downto 0);
    state    : in unsigned(2 downto 0)
  );
end entity;

architecture properties of frame_transmitter_formal is

  constant payload_most : positive := 254;
  constant resting  : natural := 0;
  constant opened   : natural := 1;
  constant filling  : natural := 2;
  constant sending  : natural := 3;
  constant checking : natural := 4;
  constant closing  : natural := 5;

  signal begun : std_ulogic := '0';  -- the reset of power-up is over
  signal reply : frame_reply_t;
  signal ready, idle, tx_valid, tx_last, tx_publish : std_ulogic;
  signal tx_data, data_before : byte_t;
  signal epoch_before : crc16_t;
  signal watched_before : unsigned(7 downto 0);
  signal stalled      : std_ulogic := '0';  -- a byte was offered and not taken
  signal goes         : std_ulogic;
  signal fits         : std_ulogic;         -- the payload has room for one more byte

  -- The watched place of both banks.
  signal kept_0, kept_1 : byte_t;
  signal kept_looked  : byte_t;
  signal collided     : std_ulogic := '0';  -- it was written while it was read
  signal at_watched, needed : std_ulogic;   -- it was read; what was read will be sent

  -- The payload in hand, and what its encoding has at the watched place.
  signal given        : std_ulogic := '0';  -- its kind was given
  signal ended        : std_ulogic := '0';  -- all of it was given
  signal kind_in_hand : byte_t := (others => '0');
  signal size         : natural range 0 to 255 := 0;
  signal byte_in_hand : byte_t := (others => '0');
  signal open_code    : std_ulogic := '0';  -- a code, whose next one has not come

  -- The outgoing frame.
  signal handed       : std_ulogic := '0';  -- its payload is no longer in hand
  signal kind_sent    : byte_t := (others => '0');
  signal size_sent    : natural range 0 to 255 := 0;
  signal byte_sent    : byte_t := (others => '0');
  signal number       : natural range 0 to 511 := 0;  -- bytes of it that were taken
  signal kind_now     : byte_t;
  signal last_1, last_2, last_3 : byte_t;
  signal crc_0, crc_1, crc_2, crc_3 : crc16_t;  -- of all its bytes, of all but the last, and so on
  signal crc_start    : crc16_t;
  signal checked      : std_ulogic;          -- the last three bytes are their check

  signal hand_true, kinds_true, frame_true, crc_true, bytes_true : std_ulogic;

  function may_begin_frame(kind : byte_t) return boolean is
  begin
    return kind(7 downto 4) = x"C" or kind(7 downto 2) = "110100";
  end function;

begin

  default clock is rising_edge(clk);
  reply <= (put => put, kind => kind, restart => restart, finish => finish, data => data);
  dut : entity work.frame_transmitter
    port map (
      clock => clk, reset => reset, epoch => epoch, reply => reply, ready => ready, idle => idle, tx_valid => tx_valid,
      tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  goes <= tx_valid and tx_ready;
  fits <= to_bit(size < payload_most or (ended = '1' and ready = '1'));

  crc_start <= x"FFFF" when tx_data = x"D0" or tx_data = x"D1" or tx_data = x"D3" else epoch;
  kind_now  <= kind_sent when handed = '1' else kind_in_hand;
  checked   <= to_bit(number >= 4 and last_3 = '1' & crc_3(6 downto 0) and last_2 = '1' & crc_3(13 downto 7) and
                      last_1 = "100000" & crc_3(15 downto 14));

  at_watched <= to_bit(read_index = watched);
  needed     <= to_bit(state = filling or (state = sending and unsent >= 2));
  looked     <= kept_looked when at_watched = '1' and collided = '0' else read_else;

  remember : process (clk) is
  begin
    if rising_edge(clk) then
      kept_looked <= kept_0;
      if read_bank = '1' then
        kept_looked <= kept_1;
      end if;
      collided <= writes and to_bit(read_bank = bank and read_next = write_index);
      if writes = '1' and write_index = watched then
        if bank = '0' then
          kept_0 <= written;
        else
          kept_1 <= written;
        end if;
      end if;
    end if;
  end process;

  take : process (clk) is
    variable bytes : natural range 0 to 255;  -- of the payload in hand
    variable open_then : std_ulogic;
  begin
    if rising_edge(clk) then
      bytes     := size;
      open_then := open_code;
      if ended = '1' and ready = '1' then
        ended     <= '0';
        handed    <= '1';
        kind_sent <= kind_in_hand;
        size_sent <= size;
        byte_sent <= byte_in_hand;
        bytes     := 0;
        open_then := to_bit(watched = 0);
      end if;
      if ready = '1' then
        if put = '1' then
          bytes := bytes + 1;
          if bytes = watched then
            byte_in_hand <= data;
            open_then    := nor data;
          elsif data = x"00" and open_then = '1' then
            byte_in_hand <= byte_t(to_unsigned(bytes, 8) - watched);
            open_then    := '0';
          end if;
        end if;
        if restart = '1' then
          bytes     := 0;
          open_then := to_bit(watched = 0);
        end if;
        if kind = '1' then
          given        <= '1';
          kind_in_hand <= data;
        end if;
        if finish = '1' then
          given <= '0';
          ended <= '1';
          if open_then = '1' then
            byte_in_hand <= byte_t(to_unsigned(bytes + 1, 8) - watched);
            open_then    := '0';
          end if;
        end if;
      end if;
      if goes = '1' and tx_last = '1' then
        handed <= '0';
      end if;
      if reset = '1' then
        given     <= '0';
        ended     <= '0';
        handed    <= '0';
        size_sent <= 0;
        bytes     := 0;
        open_then := to_bit(watched = 0);
      end if;
      size      <= bytes;
      open_code <= open_then;
    end if;
  end process;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun          <= '1';
      epoch_before   <= epoch;
      watched_before <= watched;
      data_before    <= tx_data;
      stalled        <= tx_valid and not tx_ready;
      if goes = '1' then
        last_1 <= tx_data;
        last_2 <= last_1;
        last_3 <= last_2;
        crc_0  <= serial_crc(crc_0, tx_data);
        crc_1  <= crc_0;
        crc_2  <= crc_1;
        crc_3  <= crc_2;
        if number = 0 then
          crc_0 <= serial_crc(crc_start, tx_data);
          crc_1 <= crc_start;
        end if;
        if number < 511 then
          number <= number + 1;
        end if;
        if tx_last = '1' then
          number <= 0;
        end if;
      end if;
      if reset = '1' then
        number  <= 0;
        stalled <= '0';
      end if;
    end if;
  end process;

  -- The payload in hand: what the design knows of it, and what is in the memory at the watched place.
  know_hand : process (all) is
    variable ok, open_now : boolean;
    variable kept : byte_t;
    variable place, come : natural range 0 to 511;
  begin
    kept := kept_0;
    if bank = '1' then
      kept := kept_1;
    end if;
    place    := to_integer(watched);
    come     := to_integer(position);
    open_now := open_code = '1';
    ok := (puts and ends) = '0' and ((puts or ends) and drops) = '0' and ((puts or drops) = '0' or whole = '0') and
          (complete and ends) = '0' and whole = (complete or ends) and size <= payload_most;
    if state = filling then
      ok := ok and position = 1 and zero = 0 and (puts or drops or whole) = '0' and not open_now and
            (place > size or byte_in_hand /= x"00");
    elsif drops = '1' then
      ok := ok and size = 0 and open_now = (place = 0);
    else
      ok := ok and come + to_integer(unsigned'("" & puts)) = size + 1 and come > 0 and zero < position and
            (open_now or place > size or byte_in_hand /= x"00");
      if place > size then
        ok := ok and not open_now;
      elsif place = come then
        ok := ok and byte_in_hand = pending and open_now = (pending = x"00");
      elsif zero = watched and complete = '0' then
        ok := ok and open_now = (ends = '0' and not (puts = '1' and pending = x"00")) and
              (open_now or unsigned(byte_in_hand) = come - place);
      else
        ok := ok and not open_now and kept = byte_in_hand;
      end if;
    end if;
    hand_true <= to_bit(ok);
  end process;

  know_kinds : process (all) is
  begin
    kinds_true <= to_bit(
      (given and whole) = '0' and ended = (whole or to_bit(state = filling)) and
      (given or whole) = (kind_waits or to_bit(state = opened)) and
      (kind_waits = '0' or (state /= opened and kind_kept = kind_in_hand)) and
      ((given or ended) = '0' or may_begin_frame(kind_in_hand)) and (handed = '0' or may_begin_frame(kind_sent)));
  end process;

  know_frame : process (all) is
    variable ok : boolean;
  begin
    ok := (full = '0' or (tx_last = '1') = (state = resting)) and
          ((full = '0' and state = resting) or tx_publish = to_bit(unsigned(kind_now) = device_kind_publish_c));
    case to_integer(state) is
      when resting =>
        ok := ok and handed = full and ((full = '1' and number = size_sent + 5) or (full = '0' and number = 0));
      when opened | filling =>
        ok := ok and handed = '0' and turn = 0 and tx_data = kind_in_hand and
              ((full = '1' and number = 0) or (full = '0' and number = 1));
        if state = filling then
          ok := ok and read_index = 0 and unsent = size + 1;
        end if;
      when sending =>
        ok := ok and handed = '1' and turn = 0 and unsent > 0 and read_index > 0 and
              to_integer(unsent) + to_integer(read_index) = size_sent + 2 and
              ((full = '1' and number + 1 = to_integer(read_index)) or (full = '0' and number = 1 and read_index = 1));
      when checking =>
        ok := ok and handed = '1' and full = '1' and turn <= 2 and number = size_sent + 1 + to_integer(turn);
      when closing =>
        ok := ok and handed = '1' and full = '1' and number = size_sent + 4;
      when others =>
        ok := false;
    end case;
    frame_true <= to_bit(ok and size_sent <= payload_most);
  end process;

  know_crc : process (all) is
    variable ok : boolean;
  begin
    ok := true;
    if state = resting then
      ok := full = '0' or checked = '1';
    elsif state < checking or (state = checking and turn = 0) then
      if full = '0' then
        ok := crc = crc_1 and tx_data = last_1 and crc_0 = serial_crc(crc_1, last_1);
      elsif number = 0 then
        ok := reset = '1' or crc = crc_start;
      else
        ok := crc = crc_0;
      end if;
    elsif state = checking and turn = 1 then
      ok := crc = crc_0 and tx_data = '1' & crc(6 downto 0);
    elsif state = checking then
      ok := crc = crc_1 and last_1 = '1' & crc(6 downto 0) and tx_data = '1' & crc(13 downto 7);
    else
      ok := crc = crc_2 and last_2 = '1' & crc(6 downto 0) and last_1 = '1' & crc(13 downto 7) and
            tx_data = "100000" & crc(15 downto 14);
    end if;
    crc_true <= to_bit(ok);
  end process;

  -- The bytes on their way from the memory to tx.
  know_bytes : process (all) is
    variable ok : boolean;
    variable kept, wanted : byte_t;
    variable place, last : natural range 0 to 511;
  begin
    kept := kept_1;
    if bank = '1' then
      kept := kept_0;
    end if;
    place  := to_integer(watched);
    last   := size_sent;
    wanted := byte_sent;
    ok     := true;
    if state = filling then
      last   := size;
      wanted := byte_in_hand;
    end if;
    if state = filling or state = sending then
      ok := (place > last or (kept = wanted and wanted /= x"00")) and
            (needed = '0' or at_watched = '0' or (collided = '0' and kept_looked = wanted));
    end if;
    if state = sending then
      ok := ok and encoded /= x"00" and (to_integer(read_index) /= place + 1 or encoded = wanted);
    end if;
    if state = resting then
      ok := ok and (full = '0' or tx_data = x"00");
    elsif full = '1' then
      ok := ok and tx_data /= x"00" and (number > 0 or tx_data = kind_now);
      if state = sending or (state = checking and turn = 0) then
        ok := ok and (number /= place + 1 or tx_data = wanted);
      end if;
    elsif state = sending then
      ok := ok and tx_data = kind_sent;
    end if;
    bytes_true <= to_bit(ok);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The program does one thing at a time. It gives the kind once for each payload, and waits while the transmitter is
  -- not ready.
  one_thing_at_a_time : assume always one_thing(reply, given, ready);

  -- A payload has at most 254 bytes.
  payload_fits : assume always put = '1' -> fits = '1';

  -- The epoch changes only while nothing is being sent.
  epoch_stands : assume always begun = '1' -> epoch = epoch_before or reset = '1' or (idle = '1' and given = '0');

  -- The watched place is any, and stays the same.
  one_is_watched : assume always begun = '1' -> watched = watched_before;

  -- What is read at other places and will be sent is not 00. `no_zero_is_read` asserts this of the watched place.
  others_are_codes : assume always needed = '1' and at_watched = '0' -> read_else /= x"00";

  -- What is read at the watched place and will be sent is not 00.
  no_zero_is_read : assert always begun = '1' and needed = '1' and at_watched = '1' -> looked /= x"00";

  -- The byte 00 ends a frame, and stands nowhere else in it.
  zero_ends : assert always begun = '1' and tx_valid = '1' -> (tx_data = x"00" and tx_last = '1') or
              (tx_data /= x"00" and tx_last = '0');

  -- A frame begins with a kind that a device may send.
  kind_first : assert always begun = '1' and tx_valid = '1' and number = 0 -> tx_data(7 downto 5) = "110";

  -- It is the kind that was given for its payload. There is no frame without a payload that has begun.
  kind_is_given : assert always begun = '1' and tx_valid = '1' and number = 0 ->
                  tx_data = kind_now and (handed or given or ended) = '1';

  -- What the payload's encoding has at the watched place is sent at this place, behind the kind. So the payload can be
  -- decoded.
  payload_is_sent : assert always begun = '1' and tx_valid = '1' and number = to_integer(watched) + 1 and
                    watched <= size_sent and handed = '1' -> tx_data = byte_sent;

  -- A frame has its kind, the payload with one code more, three bytes of check, and the 00.
  length_is_right : assert always begun = '1' and tx_valid = '1' and tx_last = '1' ->
                    handed = '1' and number = size_sent + 5;

  -- A frame ends with the check of all bytes before it. The check starts from the epoch of the session, or from FFFF
  -- outside a session.
  check_is_right : assert always begun = '1' and tx_valid = '1' and tx_last = '1' -> checked = '1';

  -- All bytes of a publish are marked as such, and no others.
  publish_is_marked : assert always begun = '1' and tx_valid = '1' ->
                      tx_publish = to_bit(unsigned(kind_now) = device_kind_publish_c);

  -- A byte on offer stays the same until it is taken.
  offer_stands : assert always begun = '1' and stalled = '1' and reset = '0' ->
                 tx_valid = '1' and tx_data = data_before;

  -- While it is idle, no frame has begun, and the one before has ended.
  idle_between : assert always begun = '1' and idle = '1' -> tx_valid = '0' and number = 0;

  -- It stays idle until it gets something to send. The proof of frame_application assumes this.
  idle_stands : assert always begun = '1' and idle = '1' and (kind or put or finish) = '0' and reset = '0' ->
                next (idle = '1');

  -- The invariant: the payload in hand is in the memory as far as it has come.
  hand_is_true : assert always begun = '1' -> hand_true = '1';

  -- A payload in hand has one kind, which waits or was sent.
  kinds_are_true : assert always begun = '1' -> kinds_true = '1';

  -- The frame is as far as the state says.
  frame_is_true : assert always begun = '1' -> frame_true = '1';

  -- So is its check.
  crc_is_true : assert always begun = '1' -> crc_true = '1';

  -- The bytes between memory and tx are those of their places.
  bytes_are_true : assert always begun = '1' -> bytes_true = '1';

  -- A whole frame is sent.
  frame_seen : cover {begun = '1' and goes = '1' and tx_last = '1'};

  -- A byte of a payload with 00 in it is sent, and it is no code.
  payload_seen : cover {begun = '1' and goes = '1' and handed = '1' and watched = 2 and number = 3 and size_sent = 3};

end architecture;
