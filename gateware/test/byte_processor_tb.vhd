-- SPDX-License-Identifier: BSD-3-Clause
--
-- byte_processor on a program with every operation, mode and condition. The program stores what it found, and the bench
-- compares it with what a person computes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.protocol_pkg.all;
use work.small_instruction_pkg.all;

entity byte_processor_tb is
  generic (
    length : positive := 1024
  );
end entity;

architecture bench of byte_processor_tb is

  -- How the bench writes instructions.
  type mode_t is (direct, immediate, indexed, indexed_next);

  function operation (code : natural; mode : mode_t := direct; value : natural := 0) return small_instruction_t is
  begin
    return '0' & std_ulogic_vector(to_unsigned(code, 4)) & std_ulogic_vector(to_unsigned(mode_t'pos(mode), 2)) &
           std_ulogic_vector(to_unsigned(value, 9));
  end function;

  function jump (
    condition : std_ulogic_vector(2 downto 0); target : natural; inverted : std_ulogic := '0'
  ) return small_instruction_t is
  begin
    return '1' & condition & inverted & std_ulogic_vector(to_unsigned(target, 11));
  end function;

  constant load         : natural := 0;
  constant both         : natural := 1;
  constant either       : natural := 2;
  constant differ       : natural := 3;
  constant add          : natural := 4;
  constant add_carry    : natural := 5;
  constant subtract     : natural := 6;
  constant subtract_carry : natural := 7;
  constant enter        : natural := 8;
  constant store_it     : natural := 9;
  constant point        : natural := 10;
  constant put_it       : natural := 11;
  constant act          : natural := 12;
  constant tell         : natural := 13;
  constant clear        : natural := 14;
  constant note         : natural := 15;

  constant back : small_instruction_t := jump(if_always, 0, '1');

  constant steps : small_program_t(0 to 90) := (
    operation(act),
    operation(load, immediate, 16#5A#), operation(both, immediate, 16#0F#), operation(store_it, direct, 0),  -- 0A
    operation(either, immediate, 16#35#), operation(store_it, direct, 1),  -- 3F
    operation(differ, immediate, 16#FF#), operation(store_it, direct, 2),  -- C0
    operation(add, immediate, 16#41#), operation(store_it, direct, 3),  -- 01, carry
    operation(add_carry, immediate, 16#FE#), operation(store_it, direct, 4),  -- 00, carry
    operation(load, immediate, 7), operation(subtract, immediate, 9), operation(store_it, direct, 5),  -- FE, borrow
    operation(subtract_carry, immediate, 1), operation(store_it, direct, 6),  -- FC
    operation(subtract, direct, 0), operation(store_it, direct, 7),  -- F2
    -- 19: by X, across the end of 128 bytes
    operation(point, immediate, 16#17F#), operation(load, immediate, 16#77#), operation(store_it, indexed_next),
    operation(load, immediate, 16#78#), operation(store_it, indexed), operation(load, indexed_next),
    operation(store_it, direct, 8), operation(enter, direct, 3), operation(store_it, direct, 9),  -- 78, 01
    operation(load, immediate, 16#20#), operation(point, direct, 0), operation(store_it, indexed),  -- at 020
    -- 31: jumps that are made, over a store of a wrong byte
    operation(load, immediate, 0), jump(if_zero, 34), operation(store_it, direct, 0),
    operation(load, immediate, 1), jump(if_zero, 37, '1'), operation(store_it, direct, 0),
    operation(add, immediate, 16#FF#), jump(if_carry, 40), operation(store_it, direct, 0),
    jump(if_piece, 42), operation(store_it, direct, 0), jump(if_sending, 44, '1'), operation(store_it, direct, 0),
    jump(if_accessing, 46), operation(store_it, direct, 0), jump(if_alert, 48, '1'), operation(store_it, direct, 0),
    -- 48: jumps that are not made
    operation(load, immediate, 16#11#), jump(if_zero, 60), jump(if_carry, 60, '1'), jump(if_piece, 60, '1'),
    jump(if_sending, 60), jump(if_accessing, 60, '1'), jump(if_alert, 60), operation(store_it, direct, 10),  -- 11
    -- 56: two calls
    jump(if_called, 65), operation(store_it, direct, 11), operation(put_it, immediate), jump(if_always, 61),
    operation(store_it, direct, 0),
    -- 61: actions
    operation(act, direct, 16#105#), operation(tell, direct, 16#0A0#), jump(if_always, 75), jump(if_always, 64),
    -- 65
    operation(load, immediate, 16#30#), jump(if_called, 70), operation(add, immediate, 1), back,
    operation(store_it, direct, 0),
    -- 70
    operation(add, immediate, 2), back, operation(store_it, direct, 0), back, back,
    -- 75: a byte by X that goes to an action, zero to a byte
    operation(point, immediate, 16#100#), operation(act, indexed, 16#010#), operation(clear, indexed),
    operation(note, direct, 16#041#),
    -- 79: give and get, set, follow, put by a name, a port that goes on
    operation(point, immediate, 16#110#), operation(enter, immediate, 1), operation(point, immediate, 16#110#),
    operation(enter, indexed_next, 12), operation(store_it, direct, 13), operation(store_it, immediate, 14),  -- 3F, FF
    operation(clear, immediate, 3), operation(enter, direct, 16#183#), operation(store_it, direct, 15),  -- 01
    operation(put_it, direct, 2), operation(act, direct, 16#080#), jump(if_always, 90));

  function whole (code : small_program_t) return small_program_t is
    variable program : small_program_t(0 to length - 1) := (others => (others => '0'));
  begin
    program(code'range) := code;
    if length > 1024 then  -- a place and bytes that the shorter program does not reach
      program(code'right - 1) := jump(if_always, 1500);
      program(1500 to 1507) := (
        operation(point, indexed_next, 16#080#), operation(load, immediate, 16#66#), operation(store_it, indexed),
        operation(load, immediate, 16#21#), operation(point, indexed, 16#100#), operation(store_it, indexed),
        operation(act, direct, 16#080#), jump(if_always, 1507));
    end if;
    return program;
  end function;

  constant program : small_program_t := whole(steps);

  type memory_t is array (0 to 1023) of byte_t;
  type bytes_t is array (natural range <>) of byte_t;

  constant expected : bytes_t := (
    x"0A", x"3F", x"C0", x"01", x"00", x"FE", x"FC", x"F2", x"78", x"01", x"11", x"33", x"3F", x"3F", x"FF", x"01");

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;

  signal executing, store, put : std_ulogic;
  signal address, pointer      : unsigned(9 downto 0);
  signal operand               : byte_t := (others => '0');
  signal accumulator, given    : byte_t;
  signal acts, tells, notes    : small_actions_t;
  signal port_number           : small_port_t;
  signal memory                : memory_t := (others => (others => '0'));
  signal acted, told, noted    : small_actions_t := (others => '0');
  signal was_put, put_before, went : byte_t := (others => '0');

begin

  clock <= not clock after 5 ns when not ended;

  processor : entity work.byte_processor
    generic map (program => program)
    port map (
      clock => clock, reset => reset, executing => executing, address => address, operand => operand,
      accumulator => accumulator, given => given, pointer => pointer, store => store, put => put,
      acts => acts, tells => tells, notes => notes,
      port_number => port_number, port_data => byte_t(pointer(7 downto 0)),
      conditions => (piece => '1', sending => '0', accessing => '1', alert => '0'));

  serve : process (clock)
  begin
    if rising_edge(clock) then
      operand <= memory(to_integer(address));
      check(executing = '1' or (store or put or (or acts) or (or tells) or (or notes)) = '0',
        "it acts in the second clock only");
      if store = '1' then
        memory(to_integer(address)) <= given;
      end if;
      if put = '1' then
        put_before <= was_put;
        was_put    <= given;
      end if;
      if acts(4) = '1' then
        went <= given;
      end if;
      acted <= acted or acts;
      told  <= told or tells;
      noted <= noted or notes;
    end if;
  end process;

  judge : process
  begin
    wait_clocks(clock, 3);
    reset <= '0';
    wait until acted(7) = '1';
    for place in expected'range loop
      check_equal(memory(place), expected(place), "byte " & integer'image(place));
    end loop;
    check_equal(went, x"78", "X goes round within 128 bytes, and a byte there goes to an action");
    check_equal(memory(16#100#), x"00", "clear");
    check_equal(noted, 9x"041", "noted");
    check_equal(memory(16#17F#), x"77", "the last of the 128 bytes");
    check_equal(memory(16#020#), x"20", "X from the accumulator");
    check_equal(put_before, x"33", "put");
    check_equal(was_put, x"C0", "put by a name");
    check_equal(memory(16#110#), x"3F", "give");
    check_equal(acted, 9x"195", "actions");
    check_equal(told, 9x"1A0", "told, and the port that goes on");
    check_equal(port_number, "000", "the port of the last instruction");
    if length > 1024 then
      check_equal(memory(16#280#), x"66", "X becomes an address of ten bits");
      check_equal(memory(16#321#), x"21", "X from the accumulator, with two bits above it");
    end if;
    report_passed("byte_processor_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "byte_processor_tb");

end architecture;
