-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the sequencer: the instruction is the one at the decided position, and so is the one that was fetched,
-- after any step, jump, rest or reset. The proof of frame_application uses this to take its instructions from the
-- positions, which have 8 bits instead of 80.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_assembler_pkg.all;
use work.frame_instruction_pkg.all;
use work.frame_pkg.all;

entity frame_sequencer_formal is
  port (
    clk       : in std_ulogic;
    reset     : in std_ulogic;
    act       : in std_ulogic;
    holds     : in std_ulogic;
    begins    : in std_ulogic;
    entry     : in entry_t;
    operation : in std_ulogic_vector(3 downto 0);
    size      : in unsigned(2 downto 0);
    -- Observed signals of the design.
    steps     : in std_ulogic;
    fetches   : in std_ulogic;
    fetched   : in frame_instruction_t;
    position  : in unsigned(7 downto 0)
  );
end entity;

architecture properties of frame_sequencer_formal is

  -- A program in which each instruction differs from all others, and each field is used somewhere.
  function numbered return frame_program_t is
    variable program : frame_program_t(0 to 255);
  begin
    for place in program'range loop
      program(place) := std_ulogic_vector(to_unsigned(place, 8)) &
                        std_ulogic_vector(to_unsigned(2 ** 16 - 1 - 257 * place, 16)) &
                        (55 downto 0 => '0') or std_ulogic_vector(resize(to_unsigned(place * 4099 + 70077, 31), 80));
    end loop;
    return program;
  end function;

  constant program : frame_program_t := numbered;

  signal begun           : std_ulogic := '0';  -- the reset of power-up is over
  signal instruction     : frame_instruction_t;
  signal position_ahead, position_now : unsigned(7 downto 0) := (others => '0');
  signal idle            : std_ulogic := '1';  -- nothing is executed
  signal jumped          : std_ulogic := '0';
  signal target          : unsigned(7 downto 0) := (others => '0');
  signal rests, judges, waits, first, last, steps_now : std_ulogic;
  signal rested          : std_ulogic := '0';
  signal started         : std_ulogic := '0';  -- the clock before was the last one of a reset
  signal entry_before    : entry_t := (others => '0');

begin

  default clock is rising_edge(clk);

  dut : entity work.frame_sequencer
    generic map (program => program, sizes => true)
    port map (
      clock => clk, reset => reset, act => act, holds => holds, begins => begins, entry => entry,
      operation => operation, size => size, instruction => instruction, rests => rests, judges => judges,
      steps => steps_now, waits => waits, first => first, last => last);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun  <= '1';
      jumped <= steps and holds and not reset;
      rested       <= rests and not reset;
      entry_before <= entry;
      started      <= reset;
      target <= unsigned(instruction(target_f'right + 7 downto target_f'right));
      if fetches = '1' then
        position_ahead <= position;
      end if;
      if steps = '1' then
        position_now <= position_ahead;
        idle         <= holds or instruction(do_begin);
      end if;
      if reset = '1' then
        idle <= '1';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- frame_judge: nothing holds in the first clock of an instruction, nor without one, but for the clock after a reset.
  holds_later : assume always started = '0' and (judges = '1' or rests = '1') -> holds = '0';

  -- frame_application: an instruction that waits is not executed.
  waits_first : assume always waits = '1' -> act = '0';

  -- frame_dispatcher: what begins was chosen in the clock before.
  begins_later : assume always begins = '1' -> rested = '1' and rests = '1';

  -- What was fetched is the instruction at the last decided position.
  fetched_is_there : assert always begun = '1' and judges = '0' ->
                     fetched = program(to_integer(position_ahead));

  -- The instruction is the one that was fetched, or none after a jump, at rest or after a reset.
  instruction_is_there : assert always begun = '1' ->
                         (idle = '1' or instruction = program(to_integer(position_now))) and
                         (idle = '0' or instruction = nothing_done);

  -- After a reset, the first instruction is fetched.
  fetches_first : assert always begun = '1' and started = '1' -> judges = '1' and idle = '1' and rests = '0';

  -- After a reset it starts at position 0.
  starts_at_zero : assert always started = '1' and reset = '0' -> next (position_ahead = 0 and idle = '1');

  -- Work begins at the entry that was chosen.
  begins_at_entry : assert always begins = '1' ->
                    position_ahead = first_of_entries + resize(unsigned(entry_before), 8);

  -- An instruction has two clocks, unless the work ends with it.
  two_clocks : assert always begun = '1' and judges = '1' and steps = '1' -> instruction(do_begin) = '1';

  -- A jump leads to its target.
  jumps_to_target : assert always begun = '1' and jumped = '1' -> position_ahead = target and idle = '1';

  -- It goes to the next instruction only when all parts of the current one are done.
  steps_when_done : assert always begun = '1' and steps = '1' -> act = '1' and last = '1';

  -- It reaches the second half of the program.
  goes_on : cover {begun = '1' and reset = '0' and steps = '1' and idle = '0' and position_now > 128};

end architecture;
