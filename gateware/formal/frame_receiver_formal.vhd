-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the framed protocol's verify buffer, on any bytes. They compare what it passes on with the bytes that
-- came. The check is computed again here, bit by bit. Any one frame is followed from its closing 00 until it is done.
--
-- The memory of the FIFO of frames is here instead of in the design. Only the followed frame is kept. Another frame is
-- read as any frame that the properties allow. That is no loss: the followed frame is any.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;
use work.serial_crc_pkg.all;

entity frame_receiver_formal is
  port (
    clk         : in std_ulogic;
    reset       : in std_ulogic;
    epoch       : in crc16_t;
    frame_valid : in std_ulogic;
    frame_data  : in byte_t;
    take        : in std_ulogic;
    rewind      : in std_ulogic;
    done        : in std_ulogic;
    mark        : in std_ulogic;  -- follow the frame that ends now
    record_else : in std_ulogic_vector(15 downto 0);   -- what the FIFO reads of another frame
    record_read : out std_ulogic_vector(15 downto 0);  -- what it has read
    -- Observed signals of the design.
    present     : in std_ulogic_vector(2 downto 0);
    kind_kept   : in byte_t;
    delay       : in std_ulogic_vector(23 downto 0);   -- the newest byte first
    outside_kept, in_cobs, coded_kept, whole, beyond, too_long, closed_before, at_code : in std_ulogic;
    planned     : in entry_t;
    crc_kept    : in crc16_t;
    run_kept, length_kept : in unsigned(7 downto 0);
    record_in   : in std_ulogic_vector(15 downto 0);
    write_index, read_index : in unsigned(3 downto 0);  -- of the FIFO
    is_full, loads : in std_ulogic
  );
end entity;

architecture properties of frame_receiver_formal is

  constant request_max : positive := 2;
  constant ring_bytes  : positive := 32;
  constant waiting_most : positive := 17;  -- frames that wait behind each other

  signal begun       : std_ulogic := '0';  -- the reset of power-up is over
  signal frame_ready : std_ulogic;
  signal request     : frame_request_t;
  signal entry       : natural range 0 to 31;
  signal comes, ends : std_ulogic;         -- a byte comes; a frame that has bytes ends
  signal epoch_before : crc16_t;
  signal alive       : std_ulogic;
  signal in_session  : std_ulogic;

  -- The incoming frame: its last three bytes, and what is known of the bytes before them.
  signal last_1, last_2, last_3 : byte_t;
  signal bytes       : natural range 0 to 4 := 0;
  signal outside     : std_ulogic := '0';
  signal crc         : crc16_t;
  signal headed      : std_ulogic := '0';  -- the kind has come
  signal coded       : std_ulogic := '0';  -- and a code byte after it
  signal run         : natural range 0 to 255 := 0;
  signal closed      : std_ulogic := '1';  -- the block before has no zero at its end
  signal size        : natural range 0 to 255 := 0;
  signal right       : std_ulogic;         -- the check is right, and no block is cut short
  signal waiting     : natural range 0 to waiting_most + 1 := 0;

  -- The followed frame.
  signal followed    : std_ulogic := '0';
  signal ahead       : natural range 0 to waiting_most := 0;
  signal was_right, was_outside, was_in_session : std_ulogic;
  signal was_size    : natural range 0 to 255;
  signal taken       : natural range 0 to 255 := 0;
  signal rewound     : std_ulogic := '0';  -- since the frame was passed on
  signal slot        : unsigned(3 downto 0) := "0000";  -- its place in the FIFO
  signal record_kept : std_ulogic_vector(15 downto 0);
  signal record_now  : std_ulogic_vector(15 downto 0);  -- of the frame that is passed on
  signal is_it       : std_ulogic;         -- that is the followed one
  signal entry_next  : natural range 0 to 31;           -- of `record_else`

  signal incoming_true, fifo_true, followed_true, left_true : std_ulogic;

begin

  default clock is rising_edge(clk);

  dut : entity work.frame_receiver
    generic map (request_max => request_max, ring_bytes => ring_bytes)
    port map (
      clock => clk, reset => reset, epoch => epoch, frame_valid => frame_valid, frame_ready => frame_ready,
      frame_data => frame_data, request => request, take => take, rewind => rewind, done => done, alive => alive);

  record_read <= record_now;
  entry_next  <= to_integer(unsigned(record_else(14 downto 10)));
  in_session  <= nand epoch(15 downto 8);
  is_it       <= followed and request.valid and to_bit(ahead = 0);

  entry <= to_integer(unsigned(request.entry));
  comes <= frame_valid and frame_ready;
  ends  <= '1' when comes = '1' and frame_data = x"00" and bytes > 0 else '0';
  right <= '1' when coded = '1' and run = 0 and last_3 = '1' & crc(6 downto 0) and last_2 = '1' & crc(13 downto 7) and
                    last_1 = "100000" & crc(15 downto 14) else '0';

  watch : process (clk) is
    variable others_waiting : natural range 0 to waiting_most + 1;
  begin
    if rising_edge(clk) then
      begun        <= '1';
      epoch_before <= epoch;

      if comes = '1' and frame_data /= x"00" then
        last_1 <= frame_data;
        last_2 <= last_1;
        last_3 <= last_2;
        if bytes < 4 then
          bytes <= bytes + 1;
        end if;
        if bytes = 0 then
          outside <= '0';
          crc     <= epoch;
          if frame_data = x"80" or frame_data = x"81" then
            outside <= '1';
            crc     <= x"FFFF";
          end if;
        end if;
        if bytes > 2 then
          crc    <= serial_crc(crc, last_3);
          headed <= '1';
          if headed = '1' and run > 0 then
            run <= run - 1;
            if size < 255 then
              size <= size + 1;
            end if;
          elsif headed = '1' then
            coded  <= '1';
            run    <= (to_integer(unsigned(last_3)) + 255) mod 256;
            closed <= '0';
            if last_3 = x"FF" then
              closed <= '1';
            end if;
            if closed = '0' and size < 255 then
              size <= size + 1;
            end if;
          end if;
        end if;
      end if;

      others_waiting := waiting;
      if done = '1' then
        others_waiting := waiting - 1;
        taken   <= 0;
        rewound <= '0';
        if followed = '1' and ahead = 0 then
          followed <= '0';
        elsif followed = '1' then
          ahead <= ahead - 1;
        end if;
      elsif rewind = '1' then
        taken   <= 0;
        rewound <= request.valid;
      elsif take = '1' and taken < to_integer(request.length) then
        taken <= taken + 1;
      end if;
      if loads = '1' then
        record_now <= record_else;
        if followed = '1' and slot = read_index then
          record_now <= record_kept;
        end if;
      end if;
      waiting <= others_waiting;
      if ends = '1' then
        waiting <= others_waiting + 1;
        if followed = '0' and mark = '1' then
          followed       <= '1';
          ahead          <= others_waiting;
          was_right      <= right;
          was_outside    <= outside;
          was_size       <= size;
          was_in_session <= in_session;
          slot           <= write_index;
          record_kept    <= record_in;
        end if;
      end if;
      if (comes = '1' and frame_data = x"00") or reset = '1' then
        bytes  <= 0;
        headed <= '0';
        coded  <= '0';
        run    <= 0;
        closed <= '1';
        size   <= 0;
      end if;
      if reset = '1' then
        waiting  <= 0;
        followed <= '0';
        taken    <= 0;
        rewound  <= '0';
      end if;
    end if;
  end process;

  -- The frame that comes.
  know_incoming : process (all) is
    variable ok : boolean;
  begin
    ok := (bytes = 0 and present = "000") or (bytes = 1 and present = "001") or (bytes = 2 and present = "011") or
          ((bytes = 3 or bytes = 4) and present = "111");
    ok := ok and headed = to_bit(bytes = 4) and in_cobs = headed and coded_kept = coded and run_kept = run and
          at_code = to_bit(run = 0) and whole = closed and (closed_before = '0' or bytes = 0) and
          (coded = '0' or headed = '1') and (coded = '1' or (run = 0 and size = 0 and closed = '1'));
    if bytes > 0 then
      ok := ok and delay(23 downto 16) = last_1 and crc_kept = crc and outside_kept = outside and
            outside = to_bit(kind_kept = x"80" or kind_kept = x"81") and last_1 /= x"00" and
            (bytes < 2 or (delay(15 downto 8) = last_2 and last_2 /= x"00")) and
            (bytes < 3 or (delay(7 downto 0) = last_3 and last_3 /= x"00"));
    end if;
    if bytes > 1 and outside = '1' then
      ok := ok and (unsigned(planned) = entry_hello or unsigned(planned) = entry_open);
    elsif bytes > 1 then
      ok := ok and (unsigned(planned) < entry_hello or unsigned(planned) = entry_kind);
    end if;
    if closed_before = '0' then
      ok := ok and beyond = to_bit(length_kept > request_max) and too_long = to_bit(length_kept > request_max + 2) and
            length_kept <= request_max + 3 and
            (length_kept = size or (too_long = '1' and size > request_max + 2));
    end if;
    incoming_true <= to_bit(ok);
  end process;

  -- The FIFO holds as many frames as wait, and the followed one in its place.
  know_fifo : process (all) is
    variable inside : natural range 0 to 16;  -- in its memory
    variable ok     : boolean;
  begin
    inside := to_integer(write_index - read_index);
    ok     := is_full = '0' or inside = 0;
    if is_full = '1' then
      inside := 16;
    end if;
    ok := ok and waiting = inside + to_integer(unsigned'("" & request.valid));
    if followed = '1' then
      ok := ok and ahead < waiting;
      if request.valid = '0' then
        ok := ok and slot = read_index + ahead;
      elsif ahead > 0 then
        ok := ok and slot = read_index + (ahead - 1);
      else
        ok := ok and record_now = record_kept;
      end if;
    end if;
    fifo_true <= to_bit(ok);
  end process;

  -- The record of the followed frame, as its bytes were.
  know_followed : process (all) is
    variable kept, length : natural range 0 to 255;
  begin
    kept   := to_integer(unsigned(record_kept(14 downto 10)));
    length := to_integer(unsigned(record_kept(7 downto 0)));
    followed_true <= to_bit(
      followed = '0' or (kept >= entry_check and length = 0) or
      (kept < entry_check and was_right = '1' and length = was_size and
       ((was_outside = '1' and (kept = entry_hello or kept = entry_open)) or
        (was_outside = '0' and was_in_session = '1' and kept < entry_hello and was_size <= request_max))));
  end process;

  left_true <= to_bit(rewound = '0' or (request.valid = '1' and
                                        to_integer(request.left) + taken = to_integer(request.length)));

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- Only a frame that was passed on is marked as done.
  done_when_valid : assume always done = '1' -> request.valid = '1';

  -- The epoch changes only during an OPEN or CLOSE, or with a reset.
  epoch_stands : assume always begun = '1' -> epoch = epoch_before or reset = '1' or
                 (request.valid = '1' and (entry = entry_open or entry = request_kind_close_c mod 16));

  -- Nothing is passed on before its check was right and its blocks were complete. This holds for HELLO, OPEN and
  -- requests.
  checked_before_handed_on : assert always begun = '1' and followed = '1' and ahead = 0 and request.valid = '1' and
                             entry < entry_check -> was_right = '1';

  -- A request of a session is passed on only in a session. HELLO and OPEN are passed on as such.
  session_only : assert always begun = '1' and followed = '1' and ahead = 0 and request.valid = '1' and
                 entry < entry_check ->
                 (was_outside = '1' or was_in_session = '1') and
                 (was_outside = '0' or entry = entry_hello or entry = entry_open) and
                 (was_outside = '1' or not (entry >= entry_hello));

  -- The payload is as long as its blocks say, and not longer than a request may be.
  length_is_told : assert always begun = '1' and followed = '1' and ahead = 0 and request.valid = '1' and
                   entry < entry_check -> to_integer(request.length) = was_size and
                   (was_outside = '1' or was_size <= request_max);

  -- A dropped frame has no payload.
  dropped_is_empty : assert always begun = '1' and is_it = '1' and entry >= entry_check -> request.length = 0;

  -- Other frames than the followed one are such, too.
  others_are_empty : assume always entry_next < entry_check or record_else(7 downto 0) = x"00";

  -- A frame with a wrong check is reported once, as a dropped frame.
  wrong_is_dropped : assert always begun = '1' and followed = '1' and ahead = 0 and request.valid = '1' and
                     was_right = '0' -> entry >= entry_check;

  -- As many frames wait as have ended and are not done. None is lost, doubled or invented.
  none_lost : assert always begun = '1' and request.valid = '1' -> waiting > 0;

  -- After a rewind, the bytes left are those not taken since.
  left_is_right : assert always begun = '1' and request.valid = '1' and rewound = '1' ->
                  to_integer(request.left) + taken = to_integer(request.length);

  -- The dead-man is told of a frame when it ends with the right check, in the session to which it belongs.
  alive_is_checked : assert always begun = '1' and alive = '1' ->
                     ends = '1' and right = '1' and outside = '0' and in_session = '1';

  -- The invariant: the design knows the frame that comes as it is computed here.
  incoming_is_true : assert always begun = '1' -> incoming_true = '1';

  -- The FIFO holds the frames that wait, and the followed one where it was put.
  fifo_is_true : assert always begun = '1' -> fifo_true = '1';

  -- What was put there is what its bytes were.
  followed_is_true : assert always begun = '1' -> followed_true = '1';

  -- The bytes left are counted for a frame that is passed on.
  left_is_true : assert always begun = '1' -> left_true = '1';

  -- A request is passed on.
  good_seen : cover {begun = '1' and followed = '1' and ahead = 0 and request.valid = '1' and
                     entry = 2 and request.length = 1};

end architecture;
