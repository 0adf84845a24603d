-- SPDX-License-Identifier: BSD-3-Clause
--
-- Turns bytes into checked frames: the verify buffer of the framed protocol. A frame is passed on only after its
-- closing 00 has come and its check was right. Then its payload is decoded. It can be read, read again and dropped.
--
--   frame --> delay of 3 --> CRC, COBS --> | payloads, a ring |  --> request.data
--   (the check)    00 --> verdict -------> | frames, a FIFO   |  --> request
--
-- Ports     frame: valid/ready bytes of frames, each from its kind to its closing 00.
--           request: see frame_pkg. `rewind` must come first, and makes the first byte of the payload the next one.
--           `take` moves on by one byte, or with `takes_many` by one and take_more. It takes nothing if fewer are left
--           (request.missing). `done` moves to the next frame.
-- Latency   A frame is passed on two clocks after its 00. One byte per clock, in and out. The first byte
--           comes in the second clock after `rewind`, and the next byte in the third one after `takes_many`. Until then
--           nothing is taken, but `takes_many` may be repeated.
-- Errors    A dropped frame is passed on in the order of arrival too, as an entry that gives the reason, without
--           payload. A wrong byte costs only its own frame.
-- Pressure  frame_ready is low while the ring or the FIFO of 16 frames is full. It is also low from an OPEN or CLOSE to
--           its `done`, because the epoch changes then, and the next frame is checked with the new epoch.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;
use work.width_pkg.all;

entity frame_receiver is
  generic (
    request_max : positive range 2 to 250 := 250;  -- longest payload of a request
    ring_bytes  : positive := 512;                  -- a power of two: bytes of all payloads that are not done
    many        : boolean  := true                  -- there is takes_many; otherwise one byte is taken at a time
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    epoch       : in  crc16_t;     -- FFFF means that no session is open
    frame_valid : in  std_ulogic;
    frame_ready : out std_ulogic;
    frame_data  : in  byte_t;
    request     : out frame_request_t;
    take        : in  std_ulogic;
    takes_many  : in  std_ulogic := '0';
    take_more   : in  unsigned(7 downto 0) := x"00";
    rewind      : in  std_ulogic;
    done        : in  std_ulogic;
    alive       : out std_ulogic   -- for one clock: a frame of the session passed its check
  );
end entity;

architecture rtl of frame_receiver is

  constant index_bits : positive := bits_for(ring_bytes);
  -- The longest piece that a payload of request_max with the longer check can have, without the shorter check.
  constant payload_most : positive := request_max + 2;

  -- HELLO and OPEN, which differ in their lowest bit.
  constant outside_kinds : std_ulogic_vector(6 downto 0) := std_ulogic_vector(to_unsigned(request_kind_hello_c / 2, 7));

  subtype index_t is unsigned(index_bits - 1 downto 0);
  type ring_t is array (0 to ring_bytes - 1) of byte_t;

  signal ring : ring_t;

  -- The incoming frame.
  type bytes_t is array (0 to 2) of byte_t;
  signal delay    : bytes_t := (others => (others => '0'));  -- the last bytes, 0 the newest
  signal present  : std_ulogic_vector(2 downto 0) := "000"; -- which of them are valid
  signal kind     : byte_t := (others => '0');
  signal outside  : std_ulogic := '0';  -- it is HELLO or OPEN, which belong to no session
  signal in_cobs  : std_ulogic := '0';  -- the kind has left the delay
  signal coded    : std_ulogic := '0';  -- and so has the first code byte
  signal crc      : crc16_t := (others => '0');
  signal run      : unsigned(7 downto 0) := (others => '0');  -- bytes left in the block
  signal at_code  : std_ulogic := '1';  -- no byte is left: the one that leaves the delay is a code byte
  signal whole    : std_ulogic := '1';  -- the block before has no zero at its end
  signal length   : unsigned(7 downto 0) := (others => '0');
  signal beyond   : std_ulogic := '0';  -- the payload is longer than that of a request
  signal too_long : std_ulogic := '0';  -- or than any

  signal closed   : std_ulogic := '0';  -- a frame has ended in the clock before
  signal fits     : std_ulogic := '0';  -- and is passed on with its payload

  signal frame_index : index_t := (others => '0');  -- first byte of the frame
  signal write_index : index_t;                     -- place of the next byte
  signal accepts, border, stores, outside_now : std_ulogic;
  signal free_bytes : index_t := (others => '1');   -- of the ring, a clock ago
  signal stored                   : byte_t;
  signal full                     : std_ulogic := '0';
  signal paused                   : std_ulogic := '0';

  signal planned      : entry_t := (others => '0');      -- the entry of `kind`, a clock after it
  signal judged       : std_ulogic;                      -- a frame ends
  signal wrong        : std_ulogic;                      -- its check or its COBS is wrong
  signal shut         : std_ulogic;                      -- it belongs to a session, and none is open
  signal verdict      : entry_t;
  signal pauses       : std_ulogic;
  signal kept         : std_ulogic;
  signal record_in    : std_ulogic_vector(15 downto 0);
  signal record_read, record_out : std_ulogic_vector(15 downto 0);
  signal record_room, record_valid : std_ulogic;

  -- The frame that is being read.
  signal start_index : index_t := (others => '0');  -- its first byte
  signal next_index  : index_t := (others => '0');  -- the place of its next byte, if there is takes_many
  signal read_index  : index_t := (others => '0');  -- the place of the byte that is looked at next
  signal read_now    : index_t;
  signal looked      : byte_t;                      -- the byte behind the next one
  signal next_byte   : byte_t;
  signal fills       : std_ulogic := '0';           -- `looked` is the next byte itself
  signal refills     : std_ulogic := '0';           -- it is being looked at
  signal moves, reads : std_ulogic;
  signal more        : unsigned(7 downto 0);        -- how many are taken at a time, less one
  signal length_out  : unsigned(7 downto 0);
  signal left        : unsigned(7 downto 0) := (others => '0');
  signal missing, few : std_ulogic;
  signal none        : std_ulogic := '1';           -- none is left

begin

  assert ring_bytes = 2 ** index_bits and ring_bytes >= request_max + 7
    report "frame_receiver: ring_bytes must be a power of two, and hold a request" severity failure;
  assert request_kind_open_c = request_kind_hello_c + 1 and request_kind_hello_c mod 2 = 0
    report "frame_receiver: HELLO and OPEN are one bit apart" severity failure;

  frame_ready <= record_room and not full and not paused;
  accepts     <= frame_valid and record_room and not full and not paused;
  border      <= nor frame_data;
  outside_now <= '1' when frame_data(7 downto 1) = outside_kinds else '0';

  write_index <= frame_index + resize(length, index_bits);

  stored  <= delay(2) when at_code = '0' else (others => '0');
  stores  <= accepts and not border and present(2) and in_cobs and not too_long and not (at_code and whole);

  -- What depends on the kind alone is decided before the end of the frame. It comes a clock after the kind. A frame
  -- that ends sooner has no code byte. So it is wrong, whatever `planned` says.
  plan : process (clock)
    variable entry : natural range 0 to 31;
  begin
    if rising_edge(clock) then
      entry := to_integer(unsigned(kind(3 downto 0)));
      if kind(6) = '1' or ((entry = 4 or entry = 6) and kind(5 downto 4) /= "00") then
        entry := entry_kind;  -- a post has no such bits
      elsif entry = 0 or entry = 1 or entry = 15 then
        entry := entry_unknown;
      end if;
      if outside = '1' then
        entry := entry_hello;
        if kind(0) = '1' then
          entry := entry_open;
        end if;
      end if;
      planned <= std_ulogic_vector(to_unsigned(entry, 5));
    end if;
  end process;

  judged <= accepts and border and present(0);
  wrong  <= not coded or not at_code or to_bit(delay(2) /= check_byte(crc, 0)) or
            to_bit(delay(1) /= check_byte(crc, 1)) or to_bit(delay(0) /= check_byte(crc, 2));
  shut   <= not outside and and epoch(15 downto 8);

  -- `wrong` comes late in the clock. So all else is decided beside it, and it only chooses.
  judge : process (all)
    variable entry : entry_t;
    variable keeps : std_ulogic;  -- the frame keeps its payload, unless it is wrong
  begin
    entry := planned;
    if outside = '0' and beyond = '1' then
      entry := std_ulogic_vector(to_unsigned(entry_long, 5));
    end if;
    keeps := not too_long and not shut and (not entry(4) or nor entry(3 downto 1));

    verdict <= entry;
    if too_long = '1' then
      verdict <= std_ulogic_vector(to_unsigned(entry_long, 5));
    elsif shut = '1' then
      verdict <= std_ulogic_vector(to_unsigned(entry_session, 5));
    elsif wrong = '1' then
      verdict <= std_ulogic_vector(to_unsigned(entry_check, 5));
    end if;
    kept   <= keeps and not wrong;
    pauses <= keeps and not wrong and to_bit(unsigned(entry) = entry_open or
                                             unsigned(entry) = request_kind_close_c mod 16);
    alive  <= judged and keeps and not wrong and not entry(4);
  end process;

  -- A dropped frame has no payload.
  record_in <= pauses & verdict & kind(5 downto 4) & (std_ulogic_vector(length) and (7 downto 0 => kept));

  receive : process (clock)
    variable rest : unsigned(7 downto 0);  -- of the block, with the byte that leaves the delay
  begin
    if rising_edge(clock) then
      rest := unsigned(delay(2)) when at_code = '1' else run;
      if accepts = '1' and border = '0' then
        delay <= frame_data & delay(0 to 1);
        present <= present(1 downto 0) & '1';
        if present(0) = '0' then
          kind    <= frame_data;
          outside <= outside_now;
          crc     <= epoch or (crc16_t'range => outside_now);
        end if;
        if present(2) = '1' then
          crc     <= next_crc16(crc, delay(2));
          in_cobs <= '1';
          if in_cobs = '1' then
            coded   <= '1';
            run     <= rest - 1;
            at_code <= to_bit(rest = 1);
            if at_code = '1' then
              whole <= and delay(2);
            end if;
          end if;
        end if;
        if stores = '1' then
          length <= length + 1;
          if length = request_max then
            beyond <= '1';
          end if;
          if length = payload_most then
            too_long <= '1';
          end if;
        end if;
      end if;
      if (accepts and border) = '1' or reset = '1' then
        present <= "000";
        in_cobs <= '0';
        coded   <= '0';
        run     <= (others => '0');
        at_code <= '1';
        whole   <= '1';
      end if;
      -- A clock later, which is long before the next frame has a byte to store.
      closed <= accepts and border;
      fits   <= judged and kept;
      if fits = '1' then
        frame_index <= write_index;
      end if;
      if closed = '1' or reset = '1' then
        length   <= (others => '0');
        beyond   <= '0';
        too_long <= '0';
      end if;
      if reset = '1' then
        frame_index <= (others => '0');
      end if;
    end if;
  end process;

  records : entity work.fifo
    generic map (width => 16, depth => 16)
    port map (
      clock => clock, reset => reset,
      write_valid => judged, write_ready => record_room, write_data => record_in,
      read_valid => record_valid, read_ready => done, read_data => record_read);

  record_out <= to_stdulogicvector(to_bitvector(record_read));  -- known before the first frame, too

  pause : process (clock)
  begin
    if rising_edge(clock) then
      if judged = '1' and pauses = '1' then
        paused <= '1';
      elsif done = '1' and record_out(15) = '1' then
        paused <= '0';
      end if;
      -- It is set a few bytes early, because it comes two clocks late.
      free_bytes <= start_index - write_index - 1;
      full       <= nor free_bytes(free_bytes'left downto 2);
      if reset = '1' then
        paused     <= '0';
        free_bytes <= (others => '1');
        full       <= '0';
      end if;
    end if;
  end process;

  memory : process (clock)
  begin
    if rising_edge(clock) then
      if stores = '1' then
        ring(to_integer(write_index)) <= stored;
      end if;
    end if;
  end process;

  memory_read : process (clock)
  begin
    if rising_edge(clock) then
      if reads = '1' then
        looked <= ring(to_integer(read_now));
        if stores = '1' and write_index = read_now then
          looked <= (others => '-');  -- not part of a frame that was passed on
        end if;
      end if;
      if fills = '1' or take = '1' then
        next_byte <= looked;  -- a register of its own, because a block RAM may be slow
      end if;
    end if;
  end process;

  request.valid   <= record_valid;
  request.entry   <= record_out(14 downto 10);
  request.barrier <= record_out(9);
  request.chained <= record_out(8);
  request.length  <= length_out;
  request.left    <= left;
  request.missing <= missing;
  request.data    <= next_byte;

  length_out <= unsigned(record_out(7 downto 0));
  more       <= take_more when many else x"00";
  few        <= '1' when left <= more else '0';
  missing    <= few when many else none;
  moves      <= take and not missing;

  -- The address comes from a register, because `take` comes late in the clock. It may move beyond the last byte: then
  -- nobody needs the next byte until `rewind`.
  read_now <= start_index when rewind = '1' else read_index;
  reads    <= rewind or refills or fills or take;

  follow : process (clock)
    variable left_then : unsigned(7 downto 0);
    variable index_then : index_t;
  begin
    if rising_edge(clock) then
      if reads = '1' then
        read_index <= read_now + 1;
      end if;
      fills   <= rewind or refills;
      refills <= '0';
      if many then
        index_then := next_index + resize(more, index_bits) + 1;
        if rewind = '1' then
          next_index <= start_index;
        elsif moves = '1' then
          next_index <= index_then;
          if takes_many = '1' then
            read_index <= index_then;
            refills    <= '1';
            fills      <= '0';
          end if;
        end if;
      end if;
      left_then := left + not more;
      if rewind = '1' then
        left <= length_out;
        none <= nor length_out;
      elsif moves = '1' then
        left <= left_then;
        none <= nor left_then;
      end if;
      if done = '1' then
        start_index <= start_index + resize(length_out, index_bits);
      end if;
      if reset = '1' then
        start_index <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
