-- SPDX-License-Identifier: BSD-3-Clause
--
-- Property of the sequencer: the current instruction is the one at the decided position, after any step, jump or reset.
-- The proof of frame_application uses this to take its instructions from the position, which has 8 bits instead of 80.

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

  signal begun        : std_ulogic := '0';  -- the reset of power-up is over
  signal instruction  : frame_instruction_t;
  signal position_now : unsigned(7 downto 0);
  signal jump, first, last : std_ulogic;

begin

  default clock is rising_edge(clk);

  dut : entity work.frame_sequencer
    generic map (program => program, sizes => true)
    port map (
      clock => clk, reset => reset, act => act, holds => holds, begins => begins, entry => entry,
      operation => operation, size => size, instruction => instruction, jump => jump, first => first, last => last);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if steps = '1' or reset = '1' then
        position_now <= position;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The instruction is the one at the last decided position.
  instruction_is_there : assert always begun = '1' -> instruction = program(to_integer(position_now));

  -- After a reset it starts at position 0.
  starts_at_zero : assert always reset = '1' -> next (position_now = 0);

  -- It goes to the next instruction only when all parts of the current one are done.
  steps_when_done : assert always begun = '1' and steps = '1' -> act = '1' and (last = '1' or jump = '1');

  -- It reaches the second half of the program.
  goes_on : cover {begun = '1' and reset = '0' and steps = '1' and position_now > 128};

end architecture;
