-- SPDX-License-Identifier: BSD-3-Clause
--
-- Fetches the instructions of the framed application. One is executed, and the one that follows is fetched meanwhile.
--
--   position --> | program | --> ahead --> instruction
--
-- Ports     act: the instruction is executed in this clock. holds: it jumps. begins: there is work. entry, operation:
--           where `begin` and `dispatch` lead. `entry` belongs to the clock before `begins`. size: see times_size.
--           ahead: the instruction that follows. judges: its condition is judged now. idles: nothing is executed, so
--           nothing jumps. first, last: this is the first or last time of `instruction`.
-- Latency   None between instructions. A jump costs one clock, and so does an instruction that waits (times_wait). In
--           that clock nothing is executed.
-- Errors    None.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_pkg.all;
use work.width_pkg.all;

entity frame_sequencer is
  generic (
    program : frame_program_t;  -- its length is a power of two
    sizes   : boolean           -- some instructions are executed `size` times
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    act         : in  std_ulogic;
    holds       : in  std_ulogic;
    begins      : in  std_ulogic;
    entry       : in  entry_t;
    operation   : in  std_ulogic_vector(3 downto 0);
    size        : in  unsigned(2 downto 0);
    instruction : out frame_instruction_t;
    ahead       : out frame_instruction_t;
    judges      : out std_ulogic;
    idles       : out std_ulogic;
    first       : out std_ulogic;
    last        : out std_ulogic
  );
end entity;

architecture rtl of frame_sequencer is

  constant position_bits : positive := bits_for(program'length);

  subtype position_t is unsigned(position_bits - 1 downto 0);

  signal fetched  : frame_instruction_t;
  signal following : frame_instruction_t;
  signal now_done : frame_instruction_t := nothing_done;
  signal position, caller : position_t;
  signal turns    : unsigned(2 downto 0) := (others => '0');  -- how often it was executed
  signal final    : unsigned(2 downto 0);                     -- how often before the last time
  signal is_last, step, waits, fetches : std_ulogic;
  signal skips    : std_ulogic;                               -- the next clock executes nothing
  signal waited   : std_ulogic := '1';                        -- nothing is executed

  function place(field : std_ulogic_vector) return position_t is
  begin
    return resize(unsigned(field), position_bits);
  end function;

begin

  following   <= to_stdulogicvector(to_bitvector(fetched));  -- known before the first clock, too
  ahead       <= following;
  instruction <= now_done;
  first       <= nor turns;
  last        <= is_last;

  count_turns : process (all)
  begin
    final <= '0' & unsigned(now_done(times_f'right + 1 downto times_f'right));
    if sizes and now_done(times_f) = times_size then
      final <= size - 1;
    elsif sizes and now_done(times_f) = times_rest then
      final <= 7 - size;
    end if;
  end process;

  is_last <= '1' when turns = final else '0';
  step    <= act and is_last and (begins or not now_done(do_begin));
  judges  <= step;
  idles   <= waited;
  waits   <= to_bit(following(times_f) = times_wait) and not waited;

  -- The position from which the instruction after `ahead` is fetched.
  decide : process (all)
  begin
    position <= place(following(following_f));
    if following(do_return) = '1' then
      position <= caller;
    elsif following(do_dispatch) = '1' then
      position(3 downto 0) <= unsigned(operation);
    end if;
    if now_done(do_begin) = '1' and begins = '0' then
      position <= to_unsigned(first_of_entries, position_bits) or resize(unsigned(entry), position_bits);
    elsif holds = '1' then
      position <= place(now_done(target_f));
    end if;
    if reset = '1' then
      position <= (others => '0');
    end if;
  end process;

  skips   <= holds or waits;
  fetches <= (step and (holds or not waits)) or now_done(do_begin) or reset;

  fetch : process (clock)
  begin
    if rising_edge(clock) then
      if fetches = '1' then
        fetched <= program(to_integer(position));
      end if;
      if step = '1' then
        now_done <= loaded(following, skips);
        turns    <= (others => '0');
        waited   <= skips;
        if now_done(do_call) = '1' then
          caller <= place(now_done(target_f));
        end if;
      elsif act = '1' and is_last = '0' then
        turns <= turns + 1;
      end if;
      if reset = '1' then
        now_done <= nothing_done;
        waited   <= '1';
        turns    <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
