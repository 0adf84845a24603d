-- SPDX-License-Identifier: BSD-3-Clause
--
-- Remembers which requests were executed, so that none is executed twice. There is one place for each id mod `window`.
-- It holds the last id executed there, its status, and its reply if that was short.
--
-- Ports     id: the id to look up. Two clocks after it these outputs are about it:
--           new_id: it is later than the id of its place. repeated: it is the id of its place.
--           order, with `before`: neither the id before it nor a later one of that place was executed.
--           status, kept: of the cached reply. too_long: the reply was not kept.
--           remember: the id takes its place, with status_in and the bytes given since `start`. forget: place number
--           forget_index gets an id from before the session. keep: data_in is the next byte of a reply. recall:
--           data_out is taken, and the next byte comes three clocks later.
-- Latency   Two clocks from the id to the outputs about it.
-- Errors    Bytes beyond the size of a place are counted, not kept.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_layout_pkg.all;
use work.protocol_pkg.all;
use work.width_pkg.all;

entity reply_cache is
  generic (
    window : positive range 2 to 128 := frame_window_default_c  -- number of places, a power of two
  );
  port (
    clock        : in  std_ulogic;
    id           : in  std_ulogic_vector(15 downto 0);
    before       : in  std_ulogic;
    new_id       : out std_ulogic;
    repeated     : out std_ulogic;
    order        : out std_ulogic;
    status       : out std_ulogic_vector(3 downto 0);
    kept         : out unsigned(4 downto 0);
    too_long     : out std_ulogic;
    remember     : in  std_ulogic;
    status_in    : in  std_ulogic_vector(3 downto 0);
    forget       : in  std_ulogic;
    forget_index : in  unsigned(6 downto 0);
    start        : in  std_ulogic;
    keep         : in  std_ulogic;
    data_in      : in  byte_t;
    recall       : in  std_ulogic;
    data_out     : out byte_t
  );
end entity;

architecture rtl of reply_cache is

  constant place_bits : positive := bits_for(window);
  constant entry_bits : positive := 16 - place_bits + 4 + 5;

  subtype place_t is unsigned(place_bits - 1 downto 0);
  subtype turn_t is unsigned(15 downto place_bits);  -- the part of an id that says how often its place was used

  type places_t is array (0 to 2 ** place_bits - 1) of std_ulogic_vector(entry_bits - 1 downto 0);
  type cache_t is array (0 to frame_cache_bytes_default_c * 2 ** place_bits - 1) of byte_t;

  signal places : places_t;
  signal cache  : cache_t;

  signal place, place_read : place_t;
  signal entry             : std_ulogic_vector(entry_bits - 1 downto 0);
  signal borrow            : std_ulogic := '0';  -- `entry` belongs to the turn before: `before`, at place 0
  signal byte              : byte_t;
  signal ahead             : turn_t;  -- how far the id is ahead of the id of its place
  signal same              : std_ulogic;  -- if the id itself is looked up
  signal count             : unsigned(4 downto 0) := (others => '0');  -- bytes of the reply; 17 means too many
  signal index             : unsigned(place_bits + 3 downto 0);

begin

  assert window = 2 ** place_bits and frame_cache_bytes_default_c = 16
    report "reply_cache: window must be a power of two" severity failure;

  place      <= unsigned(id(place_t'range));
  place_read <= place - unsigned'("" & before);
  -- A place holds the complement of its turn, because this sum needs fewer gates than the difference.
  ahead      <= turn_t(id(turn_t'range)) + turn_t(entry(entry_bits - 1 downto 9)) + unsigned'("" & not borrow);
  same       <= and (id(turn_t'range) xor entry(entry_bits - 1 downto 9));

  status   <= entry(8 downto 5);
  kept     <= unsigned(entry(4 downto 0));

  say : process (clock)
  begin
    if rising_edge(clock) then
      too_long <= entry(4) and or entry(3 downto 0);
      new_id   <= not ahead(15) and not same;
      repeated <= same and nand entry(8 downto 5);  -- no_status means that nothing was executed
      order    <= ahead(15) xor or ahead(14 downto place_bits);  -- later, or half way around
    end if;
  end process;

  remember_place : process (clock)
    variable where : place_t;
    variable turn  : turn_t;
  begin
    if rising_edge(clock) then
      where := place;
      turn  := turn_t(id(turn_t'range));
      if forget = '1' then
        where := forget_index(place_t'range);
        turn  := (others => '1');
      end if;
      if remember = '1' or forget = '1' then
        places(to_integer(where)) <= std_ulogic_vector(not turn) & status_in & std_ulogic_vector(count);
      end if;
      entry <= places(to_integer(place_read));
      if (remember = '1' or forget = '1') and where = place_read then
        entry <= (others => '-');  -- block RAMs differ in what such a read gives
      end if;
      borrow <= before and nor place;
    end if;
  end process;

  index <= place & count(3 downto 0);

  keep_reply : process (clock)
  begin
    if rising_edge(clock) then
      byte <= cache(to_integer(index));
      if keep = '1' and count(4) = '0' then
        cache(to_integer(index)) <= data_in;
        byte <= (others => '-');  -- block RAMs differ in what such a read gives
      end if;
      data_out <= byte;  -- a register of its own, because a block RAM may be slow
      if start = '1' then
        count <= (others => '0');
      elsif (keep = '1' or recall = '1') and (count(4) and count(0)) = '0' then
        count <= count + 1;
      end if;
    end if;
  end process;

end architecture;
