-- SPDX-License-Identifier: BSD-3-Clause
--
-- Fetches the instructions of the framed application. One is executed, and the one that follows is fetched meanwhile.
--
--   position --> | program | --> fetched --> instruction
--
-- Block RAM may need most of a clock to give a word. So nothing is decided by a word before it is in a register. That
-- costs no clock: an instruction is executed for two clocks or more, and its first clock fetches the one that follows.
--
-- Ports     act: the instruction is executed in this clock. holds: it jumps. begins: there is work. entry, operation:
--           where `begin` and `dispatch` lead. `entry` belongs to the clock before `begins`. size: see times_size.
--           rests: it waits for work, from the clock after do_begin until `begins`.
--           judges: the first clock of `instruction`, in which its condition is judged. steps: its last clock. waits:
--           in this clock it does nothing yet, because it has two clocks and is executed once. first, last: this is
--           its first or last time. late: this is one of its last two times.
-- Latency   An instruction has as many clocks as times, and two at least. With do_begin it may have one, because
--           what follows is not fetched then. A jump costs one clock, in which nothing is executed.
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
    rests       : out std_ulogic;
    judges      : out std_ulogic;
    steps       : out std_ulogic;
    waits       : out std_ulogic;
    first       : out std_ulogic;
    last        : out std_ulogic;
    late        : out std_ulogic
  );
end entity;

architecture rtl of frame_sequencer is

  constant position_bits : positive := bits_for(program'length);

  subtype position_t is unsigned(position_bits - 1 downto 0);

  signal fetched  : frame_instruction_t;
  signal now_done : frame_instruction_t := nothing_done;
  signal position, caller : position_t;
  signal turns    : unsigned(2 downto 0) := (others => '0');  -- how often it is executed after this time
  signal is_first : std_ulogic := '1';
  signal sized    : std_ulogic;                               -- `turns` is not a number, but tells which one it is
  signal is_last, turn, step, fetches, clears : std_ulogic;
  signal resting  : std_ulogic := '0';                        -- there is no work
  signal fresh    : std_ulogic := '1';                        -- this is its first clock

  function place(field : std_ulogic_vector) return position_t is
  begin
    return resize(unsigned(field), position_bits);
  end function;

begin

  instruction <= now_done;
  rests       <= resting;
  judges      <= fresh;
  steps       <= step;
  first       <= is_first;
  last        <= is_last;
  late        <= nor turns(2 downto 1);

  sized   <= and turns(2 downto 1) and to_bit(sizes);
  is_last <= nor turns;
  waits   <= fresh and ((is_last and not now_done(do_begin)) or sized);
  turn    <= act and (begins or not resting);
  step    <= turn and is_last;

  -- The position from which the next instruction is fetched. Only a jump fetches after the first clock.
  decide : process (all)
  begin
    position <= place(now_done(target_f));
    if resting = '1' then
      position <= to_unsigned(first_of_entries, position_bits) or resize(unsigned(entry), position_bits);
    elsif fresh = '1' then
      position <= place(now_done(following_f));
      if now_done(do_return) = '1' then
        position <= caller;
      elsif now_done(do_dispatch) = '1' then
        position(3 downto 0) <= unsigned(operation);
      end if;
    end if;
  end process;

  fetches <= fresh or resting or (step and holds);

  fetch : process (clock)
  begin
    if rising_edge(clock) then
      if fetches = '1' then
        fetched <= program(to_integer(position));
      end if;
      fresh <= '0';
      if step = '1' then
        fresh    <= '1';
        is_first <= '1';
        resting  <= now_done(do_begin) and not holds;
        if now_done(do_call) = '1' then
          caller <= place(now_done(target_f));
        end if;
        if holds = '1' or now_done(do_begin) = '1' then
          fresh    <= '0';
        end if;
      elsif turn = '1' then
        is_first <= '0';
      end if;
      if reset = '1' then
        resting  <= '0';
        fresh    <= '1';
      end if;
    end if;
  end process;

  -- After a reset, the next clock fetches what follows nothing_done, which is the instruction at 0. The register has an
  -- enable and a reset of its own, so no gate is between it and the block RAM. Before `turns` there is one.
  clears <= reset or (step and (holds or now_done(do_begin)));

  load : process (clock)
  begin
    if rising_edge(clock) then
      if step = '1' then
        now_done <= fetched;
      end if;
      if turn = '1' then
        turns <= turns - 1;
        if is_last = '1' then
          turns <= unsigned(fetched(times_f));
        end if;
      end if;
      if sized = '1' then
        turns(2)          <= '0';
        turns(1 downto 0) <= size(1 downto 0) - 1;
        if turns(0) = '1' then  -- times_rest
          turns(1 downto 0) <= not size(1 downto 0);
        end if;
      end if;
      if clears = '1' then
        now_done <= nothing_done;
        turns    <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
