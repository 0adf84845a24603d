-- SPDX-License-Identifier: BSD-3-Clause
--
-- A processor of eight bits for framed_small: accumulator, carry, a pointer X, and a return stack of two places.
--
--   clock 1  operand:  the instruction is known. The memory reads its operand. A jump changes the program counter.
--   clock 2  execute:  the operand is known. The instruction does its work, and the next one is fetched.
--
-- Program   Of 1024 instructions, or of 2048. With 2048, X has ten bits and so reaches 1024 bytes.
-- Ports     executing: high in the second clock. address: of the operand in the first clock, of a store in the second.
--           operand: what the memory read. given: what is stored or put, or what an action takes. It is the operand
--           of a `put`, of `get` and `give`, and of an action with X, and otherwise the accumulator.
--           store, put, acts, tells, notes: high in the second clock only. docs/gateware/framed_small.md explains the
--           instructions.
--           port_number, port_data: what `in` reads. conditions: what a jump can ask of the hardware.
-- Latency   Two clocks for each instruction, jumps included.
-- Errors    None. A third call within two forgets the oldest return address.
-- Reset     The program starts at 0. The accumulator, the carry and X keep what they have.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.protocol_pkg.all;
use work.small_instruction_pkg.all;
use work.width_pkg.all;

entity byte_processor is
  generic (
    program : small_program_t  -- 1024 or 2048 instructions
  );
  port (
    clock       : in  std_ulogic;
    reset       : in  std_ulogic;
    executing   : out std_ulogic;
    address     : out unsigned(9 downto 0);
    operand     : in  byte_t;
    accumulator : out byte_t;
    given       : out byte_t;
    pointer     : out unsigned(9 downto 0);
    store       : out std_ulogic := '0';
    put         : out std_ulogic := '0';
    acts        : out small_actions_t := (others => '0');
    tells       : out small_actions_t := (others => '0');
    notes       : out small_actions_t := (others => '0');
    port_number : out small_port_t;
    port_data   : in  byte_t;
    conditions  : in  small_conditions_t
  );
end entity;

architecture rtl of byte_processor is

  constant position_bits : positive := bits_for(program'length);

  subtype position_t is unsigned(position_bits - 1 downto 0);

  signal fetched     : small_instruction_t;
  signal instruction : small_instruction_t;
  signal execute     : std_ulogic := '1';
  -- What is done in the second clock.
  signal loads, loads_carry, points, goes_on : std_ulogic := '0';
  signal moves, follows                      : std_ulogic := '0';
  signal gives_operand, gives_constant       : std_ulogic := '0';
  signal position, caller, caller_before : position_t := (others => '0');
  signal called, returns, jumps : std_ulogic;

  signal a           : byte_t := (others => '0');
  signal carry       : std_ulogic := '0';
  signal x           : unsigned(position_bits - 2 downto 0) := (others => '0');

  signal operation   : std_ulogic_vector(3 downto 0);
  signal immediate, indexed, arithmetic : std_ulogic;
  signal moving      : std_ulogic;            -- of do_in: it is get or give
  signal by_x        : std_ulogic;            -- the address is X
  signal chosen, value : byte_t;              -- the operand; the same, inverted for a subtraction
  signal carry_in    : std_ulogic;
  signal sum         : unsigned(8 downto 0);
  signal combined, result : byte_t;

begin

  assert program'length = 1024 or program'length = 2048
    report "byte_processor: a program has 1024 or 2048 instructions" severity failure;

  -- The program.

  instruction <= to_stdulogicvector(to_bitvector(fetched));  -- known before the first clock, too

  fetch : process (clock)
  begin
    if rising_edge(clock) then
      if execute = '1' then
        fetched <= program(to_integer(position));
      end if;
    end if;
  end process;

  called <= and instruction(condition_f);

  decide : process (all)
    variable holds : std_ulogic;
  begin
    case instruction(condition_f) is
      when if_always    => holds := '1';
      when if_zero      => holds := nor a;
      when if_carry     => holds := carry;
      when if_piece     => holds := conditions.piece;
      when if_sending   => holds := conditions.sending;
      when if_accessing => holds := conditions.accessing;
      when others       => holds := conditions.alert;
    end case;
    jumps   <= instruction(is_jump) and ((holds xor instruction(is_inverted)) or called);
    returns <= '0';
    if instruction(condition_f) = if_always then
      returns <= instruction(is_jump) and instruction(is_inverted);
    end if;
  end process;

  step : process (clock)
  begin
    if rising_edge(clock) then
      execute <= not execute;
      if execute = '1' then
        position <= position + 1;
      elsif returns = '1' then
        position      <= caller;
        caller        <= caller_before;
      elsif jumps = '1' then
        position <= unsigned(instruction(position_bits - 1 downto 0));
        if called = '1' then
          caller        <= position;
          caller_before <= caller;
        end if;
      end if;
      if reset = '1' then
        execute  <= '1';
        position <= (others => '0');
      end if;
    end if;
  end process;

  -- The operand.

  executing <= execute;
  operation <= instruction(operation_f);
  immediate <= instruction(mode_f'right) and not instruction(mode_f'left);
  indexed   <= instruction(mode_f'left);
  moving    <= instruction(mode_f'right);
  by_x      <= indexed xor moves;  -- get and give read at one of two addresses, and write at the other one
  address   <= resize(x, 10) when by_x = '1' else '0' & unsigned(instruction(address_f));
  pointer   <= resize(x, 10);

  -- The result. A subtraction adds the inverted operand.

  arithmetic <= operation(2);
  chosen     <= instruction(value_f) when immediate = '1' else operand;
  value      <= chosen xor (7 downto 0 => arithmetic and operation(1));
  carry_in   <= carry when operation(0) = '1' else operation(1);
  sum        <= ('0' & unsigned(a)) + ('0' & unsigned(value)) + unsigned'("" & carry_in);

  combine : process (all)
  begin
    case operation(1 downto 0) is
      when "00"   => combined <= value;
      when "01"   => combined <= a and value;
      when "10"   => combined <= a or value;
      when others => combined <= a xor value;
    end case;
    result <= combined;
    if operation(3) = '1' and moving = '0' then
      result <= port_data;
    elsif arithmetic = '1' then
      result <= byte_t(sum(7 downto 0));
    end if;
  end process;

  -- What the instruction does in the second clock is decided in the first one, so that the clock can be fast.
  prepare : process (clock)
    variable works : std_ulogic;
  begin
    if rising_edge(clock) then
      works      := not execute and not instruction(is_jump) and not reset;
      loads      <= '0';
      loads_carry <= works and not operation(3) and arithmetic;
      points     <= '0';
      goes_on    <= works and and instruction(mode_f);
      moves      <= '0';
      follows    <= '0';
      store      <= '0';
      put        <= '0';
      acts       <= (others => '0');
      tells      <= (others => '0');
      notes      <= (others => '0');
      if works = '1' then
        case operation is
          when do_in =>
            loads   <= indexed or not moving;
            moves   <= moving;
            store   <= moving;
            goes_on <= moving;
            tells(tell_check_next) <= instruction(in_check_next) and not moving;
            acts(out_shift_data)   <= instruction(in_data_next) and not moving;
          when do_point            => points <= '1';
          when do_store            => store  <= '1';
          when do_clear =>
            store   <= not immediate;
            follows <= immediate;
          when do_put              => put    <= '1';
          when do_out              => acts   <= instruction(address_f);
          when do_tell             => tells  <= instruction(address_f);
          when do_note             => notes  <= instruction(address_f);
          when others              => loads  <= '1';
        end case;
      end if;
      gives_operand  <= indexed;
      gives_constant <= '0';
      case operation is
        when do_in    => gives_operand <= '1';
        when do_put   => gives_operand <= not immediate;
        when do_store =>
          gives_operand  <= immediate;  -- with gives_constant: FF
          gives_constant <= immediate;
        when do_clear =>
          gives_operand  <= '0';
          gives_constant <= '1';
        when others   => null;
      end case;
    end if;
  end process;

  registers : process (clock)
  begin
    if rising_edge(clock) then
      if loads = '1' then
        a <= result;
      end if;
      if loads_carry = '1' then
        carry <= sum(8);
      end if;
      if points = '1' then
        x <= resize(instruction(mode_f'left) & instruction(8) & unsigned(a), x'length);
        if instruction(mode_f'right) = '1' then
          x <= resize(instruction(mode_f'left) & unsigned(instruction(address_f)), x'length);
        end if;
      elsif follows = '1' then
        x <= resize("01" & unsigned(operand), x'length);
      elsif goes_on = '1' then
        x(6 downto 0) <= x(6 downto 0) + 1;
      end if;
    end if;
  end process;

  -- What it does outside.

  accumulator <= a;
  given       <= (others => gives_operand) when gives_constant = '1' else operand when gives_operand = '1' else a;
  port_number <= instruction(2 downto 0);

end architecture;
