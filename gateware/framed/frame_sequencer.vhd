-- SPDX-License-Identifier: BSD-3-Clause
--
-- Fetches the instructions of the framed application, one per clock.
--
-- Ports     act: the instruction is executed in this clock. holds: its condition holds. entry, operation: where `begin`
--           and `dispatch` lead. begins: there is work. size: see times_size.
--           jump: the next instruction is the target. last: this is its last time. Both are for the current clock.
-- Latency   None between instructions.
-- Errors    None.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

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
    jump        : out std_ulogic;
    first       : out std_ulogic;
    last        : out std_ulogic
  );
end entity;

architecture rtl of frame_sequencer is

  constant position_bits : positive := bits_for(program'length);

  subtype position_t is unsigned(position_bits - 1 downto 0);

  signal now_done : frame_instruction_t;
  signal following, position, caller : position_t;
  signal turns    : unsigned(2 downto 0) := (others => '0');  -- how often it was executed
  signal final    : unsigned(2 downto 0);                     -- how often before the last time
  signal is_last, jumps, step : std_ulogic;

begin

  instruction <= to_stdulogicvector(to_bitvector(now_done));  -- known before the first clock, too
  jump        <= jumps;
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
  jumps   <= holds and (is_last or now_done(if_any_time));
  step    <= act and (is_last or jumps) and (begins or not now_done(do_begin));

  decide : process (all)
  begin
    following <= unsigned(now_done(following_f'right + position_bits - 1 downto following_f'right));
    if now_done(do_begin) = '1' then
      following(4 downto 0) <= unsigned(entry);
    elsif now_done(do_dispatch) = '1' then
      following(3 downto 0) <= unsigned(operation);
    elsif now_done(do_return) = '1' then
      following <= caller;
    end if;
    position <= following;
    if jumps = '1' then
      position <= unsigned(now_done(target_f'right + position_bits - 1 downto target_f'right));
    end if;
    if reset = '1' then
      position <= (others => '0');
    end if;
  end process;

  fetch : process (clock)
  begin
    if rising_edge(clock) then
      if step = '1' or reset = '1' then
        now_done <= program(to_integer(position));
        turns    <= (others => '0');
      elsif act = '1' and is_last = '0' then
        turns <= turns + 1;
      end if;
      if step = '1' and now_done(do_call) = '1' then
        caller <= following;
      end if;
    end if;
  end process;

end architecture;
