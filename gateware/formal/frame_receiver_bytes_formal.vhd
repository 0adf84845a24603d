-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the ring in the framed protocol's verify buffer, on any bytes: what is handed out is what came in.
-- COBS is decoded again here. One byte of one frame is followed from its arrival until its frame is done. The frame is
-- any, and so are the number of the byte in it and its place in the ring.
--
-- The memory of the ring is here instead of in the design. Only the watched place is kept. Another place is read as
-- any byte. That is no loss, because the place is any. The memory of the FIFO of frames is here, too, with the followed
-- frame. Another one is read as any that the properties allow. The check has any value, so each frame may be right or
-- wrong: frame_receiver_formal proves which it is.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_receiver_bytes_formal is
  port (
    clk         : in std_ulogic;
    reset       : in std_ulogic;
    epoch       : in crc16_t;
    frame_valid : in std_ulogic;
    frame_data  : in byte_t;
    take        : in std_ulogic;
    takes_many  : in std_ulogic;
    take_more   : in unsigned(7 downto 0);
    rewind      : in std_ulogic;
    done        : in std_ulogic;
    mark        : in std_ulogic;            -- follow the frame that ends now
    number      : in unsigned(2 downto 0);  -- of the watched byte in its frame
    place       : in unsigned(3 downto 0);  -- of the watched byte in the ring
    look_else   : in byte_t;                -- what is read at another place
    looked      : out byte_t;               -- what the ring has read
    record_else : in std_ulogic_vector(15 downto 0);   -- what the FIFO reads of another frame
    record_read : out std_ulogic_vector(15 downto 0);  -- what the FIFO has read
    -- Observed signals of the design.
    present     : in std_ulogic_vector(2 downto 0);
    delay       : in std_ulogic_vector(23 downto 0);   -- the newest byte first
    in_cobs, coded_kept, whole, too_long, ended, fits, at_code : in std_ulogic;
    run_kept, length_kept : in unsigned(7 downto 0);
    stores      : in std_ulogic;
    stored      : in byte_t;
    frame_index, write_index, free_bytes, start_index, next_index, read_index, read_now : in unsigned(3 downto 0);
    full, reads, fills, refills : in std_ulogic;
    record_in   : in std_ulogic_vector(15 downto 0);
    record_write, record_next : in unsigned(3 downto 0);  -- places of the FIFO: written next, read next
    is_full, loads : in std_ulogic
  );
end entity;

architecture properties of frame_receiver_bytes_formal is

  constant request_max  : positive := 4;
  constant payload_most : positive := request_max + 3;  -- one more than is passed on
  constant ring_bytes   : positive := 16;
  constant waiting_most : positive := 17;               -- frames that wait behind each other

  subtype index_t is unsigned(3 downto 0);

  signal begun       : std_ulogic := '0';  -- the reset of power-up is over
  signal frame_ready : std_ulogic;
  signal request     : frame_request_t;
  signal comes, ends : std_ulogic;         -- a byte comes; a frame that has bytes ends
  signal number_before : unsigned(2 downto 0);
  signal place_before  : unsigned(3 downto 0);

  -- The incoming frame: its last three bytes, and what is known of the bytes before them.
  signal last_1, last_2, last_3 : byte_t;
  signal bytes       : natural range 0 to 4 := 0;
  signal headed      : std_ulogic := '0';  -- the kind has come
  signal coded       : std_ulogic := '0';  -- and a code byte after it
  signal run         : natural range 0 to 255 := 0;
  signal no_zero     : std_ulogic := '1';  -- the block before has no zero at its end
  signal size        : natural range 0 to 255 := 0;
  signal came        : byte_t;             -- byte `number` of the payload

  -- The memories.
  signal kept        : byte_t;             -- what is at `place`
  signal looks       : byte_t;
  signal record_now  : std_ulogic_vector(15 downto 0);  -- of the frame that is passed on

  -- The frames that wait, and the followed one.
  signal waiting     : natural range 0 to waiting_most + 1 := 0;
  signal followed    : std_ulogic := '0';
  signal ahead       : natural range 0 to waiting_most := 0;
  signal slot        : unsigned(3 downto 0) := "0000";  -- its place in the FIFO
  signal newest      : std_ulogic := '0';  -- no frame has ended behind it
  signal record_kept : std_ulogic_vector(15 downto 0);
  signal at_place    : index_t;            -- where it begins in the ring
  signal has_byte    : std_ulogic;         -- it has a byte with the watched number
  signal wanted      : byte_t;             -- which is this one
  signal is_it       : std_ulogic;         -- it is the one that is passed on
  signal is_next     : std_ulogic;         -- it is the one that the FIFO reads next
  signal others_fit  : std_ulogic;         -- `record_else` is as the followed frame would be
  signal last        : natural range 0 to 2 * ring_bytes;  -- where the last frame ends, from the start

  -- What was taken of the frame that is passed on.
  signal rewound     : std_ulogic := '0';
  signal taken       : natural range 0 to 255 := 0;
  signal wait_clocks : natural range 0 to 3 := 0;  -- until the next byte is there
  signal missed      : std_ulogic := '0';  -- more was taken than there was
  signal fewer       : std_ulogic;         -- less is left than would be taken

  signal incoming_true, room_true, fifo_true, followed_true, reading_true : std_ulogic;

  function length_of(entry : std_ulogic_vector(15 downto 0)) return natural is
  begin
    return to_integer(unsigned(entry(7 downto 0)));
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.frame_receiver
    generic map (request_max => request_max, ring_bytes => ring_bytes)
    port map (
      clock => clk, reset => reset, epoch => epoch, frame_valid => frame_valid, frame_ready => frame_ready,
      frame_data => frame_data, request => request, take => take, takes_many => takes_many, take_more => take_more,
      rewind => rewind, done => done, alive => open);

  record_read <= record_now;
  looked      <= looks;

  comes <= frame_valid and frame_ready;
  ends  <= to_bit(comes = '1' and frame_data = x"00" and bytes > 0);
  is_it <= followed and request.valid and to_bit(ahead = 0);
  is_next  <= followed and not is_it and to_bit(slot = record_next);
  at_place <= place - number;
  has_byte <= to_bit(number < length_of(record_kept));
  last     <= to_integer(frame_index - start_index) + to_integer(length_kept(3 downto 0)) when fits = '1' else
              to_integer(frame_index - start_index);
  fewer <= to_bit(length_of(record_now) - taken <= to_integer(take_more));

  remember : process (clk) is
  begin
    if rising_edge(clk) then
      if reads = '1' then
        looks <= look_else;
        if read_now = place and not (stores = '1' and write_index = place) then
          looks <= kept;
        end if;
      end if;
      if stores = '1' and write_index = place then
        kept <= stored;
      end if;
      if loads = '1' then
        record_now <= record_else;
        if is_next = '1' then
          record_now <= record_kept;
        end if;
      end if;
    end if;
  end process;

  watch : process (clk) is
    variable decoded : std_ulogic;
    variable byte    : byte_t;
    variable others_waiting : natural range 0 to waiting_most + 1;
  begin
    if rising_edge(clk) then
      begun         <= '1';
      number_before <= number;
      place_before  <= place;

      -- The frame that comes.
      if comes = '1' and frame_data /= x"00" then
        last_1 <= frame_data;
        last_2 <= last_1;
        last_3 <= last_2;
        if bytes < 4 then
          bytes <= bytes + 1;
        end if;
        decoded := '0';
        byte    := x"00";
        if bytes > 2 then
          headed <= '1';
          if headed = '1' and run > 0 then
            run     <= run - 1;
            decoded := '1';
            byte    := last_3;
          elsif headed = '1' then
            coded   <= '1';
            run     <= (to_integer(unsigned(last_3)) + 255) mod 256;
            no_zero <= to_bit(last_3 = x"FF");
            decoded := not no_zero;
          end if;
        end if;
        if decoded = '1' then
          if size < 255 then
            size <= size + 1;
          end if;
          if size = number then
            came <= byte;
          end if;
        end if;
      end if;
      if (comes = '1' and frame_data = x"00") or reset = '1' then
        bytes   <= 0;
        headed  <= '0';
        coded   <= '0';
        run     <= 0;
        no_zero <= '1';
        size    <= 0;
      end if;

      -- The frames that wait, and the one that is passed on.
      others_waiting := waiting;
      if wait_clocks > 0 then
        wait_clocks <= wait_clocks - 1;
      end if;
      if done = '1' then
        others_waiting := waiting - 1;
        rewound <= '0';
        if followed = '1' and ahead = 0 then
          followed <= '0';
        elsif followed = '1' then
          ahead <= ahead - 1;
        end if;
      elsif rewind = '1' then
        rewound     <= request.valid;
        taken       <= 0;
        missed      <= '0';
        wait_clocks <= 1;
      elsif take = '1' and rewound = '1' and missed = '0' then
        missed <= fewer;
        if fewer = '0' then
          taken <= taken + to_integer(take_more) + 1;
          if takes_many = '1' then
            wait_clocks <= 2;
          end if;
        end if;
      end if;
      waiting <= others_waiting;
      if ends = '1' then
        waiting <= others_waiting + 1;
        newest  <= '0';
        if followed = '0' and mark = '1' and frame_index = at_place then
          followed    <= '1';
          newest      <= '1';
          ahead       <= others_waiting;
          slot        <= record_write;
          record_kept <= record_in;
          wanted      <= came;
        end if;
      end if;
      if reset = '1' then
        waiting  <= 0;
        followed <= '0';
        rewound  <= '0';
      end if;
    end if;
  end process;

  -- The frame that comes: where its bytes are, and the watched one, if it has come.
  know_incoming : process (all) is
    variable ok : boolean;
  begin
    ok := (bytes = 0 and present = "000") or (bytes = 1 and present = "001") or (bytes = 2 and present = "011") or
          ((bytes = 3 or bytes = 4) and present = "111");
    ok := ok and headed = to_bit(bytes = 4) and in_cobs = headed and coded_kept = coded and run_kept = run and
          at_code = to_bit(run = 0) and whole = no_zero and (ended = '0' or bytes = 0) and
          (fits = '0' or ended = '1') and (coded = '0' or headed = '1') and
          (coded = '1' or (run = 0 and size = 0 and no_zero = '1')) and
          (bytes < 1 or delay(23 downto 16) = last_1) and (bytes < 2 or delay(15 downto 8) = last_2) and
          (bytes < 3 or delay(7 downto 0) = last_3);
    ok := ok and length_kept <= payload_most and (ended = '1' or too_long = to_bit(length_kept = payload_most));
    if ended = '0' then
      ok := ok and (length_kept = size or (too_long = '1' and size > payload_most)) and
            (too_long = '1' or size <= number or frame_index + number /= place or kept = came);
    end if;
    incoming_true <= to_bit(ok);
  end process;

  -- The ring has room for the byte that comes. All frames that wait, and the one that comes, fit into it.
  know_room : process (all) is
    variable used : natural range 0 to 2 * ring_bytes;
  begin
    used := to_integer(frame_index - start_index) + to_integer(length_kept(3 downto 0));
    room_true <= to_bit(used <= ring_bytes - 2 and (full = '1' or used <= ring_bytes - 3) and
                        used <= ring_bytes - to_integer(free_bytes));
  end process;

  -- Another frame ends before the followed one begins, and the one directly before it just there. All end before the
  -- one that comes, and the last one just there. Where that other frame is followed, the properties say so of it.
  know_others : process (all) is
    variable start : index_t;  -- of the frame that is read
    variable ahead_then : natural range 0 to waiting_most;
    variable most  : natural range 0 to 2 * ring_bytes;
    variable ok    : boolean;
  begin
    start      := start_index;
    ahead_then := ahead;
    most       := last;
    if done = '1' then
      start := start_index + unsigned(record_now(3 downto 0));
      most  := last - to_integer(unsigned(record_now(3 downto 0)));
      if ahead > 0 then
        ahead_then := ahead - 1;
      end if;
    end if;
    ok := length_of(record_else) < payload_most;
    if followed = '1' and is_it = '0' then
      most := to_integer(at_place - start);
      ok   := ok and (ahead_then /= 1 or length_of(record_else) = most);
    else
      ok := ok and (record_write - record_next /= 1 or length_of(record_else) = most);  -- it is the last one
    end if;
    ok := ok and length_of(record_else) <= most;
    others_fit <= to_bit(ok);
  end process;

  -- The FIFO holds as many frames as wait. The one that is passed on ends before the followed one begins.
  know_fifo : process (all) is
    variable inside : natural range 0 to 16;               -- frames in the memory of the FIFO
    variable first  : natural range 0 to 2 * ring_bytes;   -- where the first of them begins, from the start
    variable ok     : boolean;
  begin
    inside := to_integer(record_write - record_next);
    ok     := is_full = '0' or inside = 0;
    if is_full = '1' then
      inside := 16;
    end if;
    ok := ok and waiting = inside + to_integer(unsigned'("" & request.valid));
    first := 0;
    if request.valid = '1' then
      first := to_integer(unsigned(record_now(3 downto 0)));
      ok    := ok and length_of(record_now) < payload_most;
    end if;
    fifo_true <= to_bit(ok and first <= last and (inside > 0 or first = last));
  end process;

  -- The followed frame is in its place until it is done, and so is its watched byte.
  know_followed : process (all) is
    variable first, begins, ends_at : natural range 0 to 2 * ring_bytes;  -- from the start
    variable ok : boolean;
  begin
    ok := true;
    if followed = '1' then
      first := 0;
      if request.valid = '1' then
        first := to_integer(unsigned(record_now(3 downto 0)));
      end if;
      begins  := to_integer(at_place - start_index);
      ends_at := begins + to_integer(unsigned(record_kept(3 downto 0)));
      ok := ahead < waiting and length_of(record_kept) < payload_most and ends_at <= last and
            newest = to_bit(ahead + 1 = waiting) and (newest = '0' or ends_at = last) and
            (has_byte = '0' or kept = wanted);
      if is_it = '1' then
        ok := ok and begins = 0 and record_now = record_kept;
      else
        ok := ok and slot = record_next + ahead - to_integer(unsigned'("" & request.valid)) and first <= begins and
              (ahead > 0 or begins = 0) and (ahead /= 1 or request.valid = '0' or first = begins);
      end if;
    end if;
    followed_true <= to_bit(ok);
  end process;

  -- How far the frame that is passed on was read.
  know_reading : process (all) is
    variable next_byte : unsigned(3 downto 0);
    variable ok        : boolean;

    -- What was read is right, if it was read at the watched place.
    impure function right(index : index_t; byte : byte_t) return boolean is
    begin
      return is_it = '0' or has_byte = '0' or index /= place or byte = wanted;
    end function;
  begin
    ok := (rewound = '0' or request.valid = '1') and wait_clocks < 3;
    if rewound = '1' then
      ok := ok and taken <= length_of(record_now) and (missed = '1' or taken + request.left = length_of(record_now));
    end if;
    if rewound = '1' and missed = '0' then
      next_byte := start_index + taken;
      ok := ok and next_index = next_byte and fills = to_bit(wait_clocks = 1) and refills = to_bit(wait_clocks = 2);
      case wait_clocks is
        when 0      => ok := ok and read_index = next_byte + 2 and right(next_byte + 1, looks);
        when 1      => ok := ok and read_index = next_byte + 1 and right(next_byte, looks);
        when others => ok := ok and read_index = next_byte;
      end case;
      ok := ok and (wait_clocks > 0 or right(next_byte, request.data));
    end if;
    reading_true <= to_bit(ok);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The watched byte stays the same one.
  watched_stands : assume always begun = '0' or (number = number_before and place = place_before);

  -- Only a frame that was passed on is marked as done.
  done_when_valid : assume always done = '1' -> request.valid = '1';

  -- More than one byte is taken only with `takes_many`. Another byte is taken only when it is there.
  taken_in_time : assume always take = '1' -> takes_many = '1' or (take_more = x"00" and wait_clocks = 0);

  -- Other frames than the followed one are such, too.
  others_are_such : assume always begun = '1' and loads = '1' and is_next = '0' -> others_fit = '1';

  -- What is handed out is what came in, in order: each byte of the payload is the one that has its number among the
  -- bytes that were decoded.
  data_is_right : assert always begun = '1' and is_it = '1' and has_byte = '1' and rewound = '1' and missed = '0' and
                  wait_clocks = 0 and taken = number -> request.data = wanted;

  -- No byte is taken beyond the last one.
  missing_is_right : assert always begun = '1' and request.valid = '1' and rewound = '1' and missed = '0' ->
                     request.missing = fewer;

  -- A byte of a frame that waits is never overwritten.
  not_overwritten : assert always begun = '1' and followed = '1' and has_byte = '1' and stores = '1' ->
                    write_index /= place;

  -- The invariant: the bytes of the frame that comes go behind each other, as they are decoded.
  incoming_is_true : assert always begun = '1' -> incoming_true = '1';

  -- What is not done fits into the ring, with the byte that comes.
  room_is_true : assert always begun = '1' -> room_true = '1';

  -- The FIFO holds the frames that wait, and what is passed on fits into what is not done.
  fifo_is_true : assert always begun = '1' -> fifo_true = '1';

  -- The followed frame begins where the one before ends, and is read from there. The next one begins where it ends.
  -- Its watched byte is in its place until the frame is done.
  followed_is_true : assert always begun = '1' -> followed_true = '1';

  -- What is read ahead is the next byte and the one behind it.
  reading_is_true : assert always begun = '1' -> reading_true = '1';

  -- The second byte of a payload is handed out.
  second_seen : cover {begun = '1' and is_it = '1' and rewound = '1' and missed = '0' and wait_clocks = 0 and
                       taken = 1 and number = 1 and request.data = x"A5"};

  -- The last of four bytes is handed out after many were taken.
  many_seen : cover {begun = '1' and is_it = '1' and rewound = '1' and missed = '0' and wait_clocks = 1 and
                     taken = 3 and number = 3};

end architecture;
