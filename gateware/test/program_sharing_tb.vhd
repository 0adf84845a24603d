-- SPDX-License-Identifier: BSD-3-Clause
--
-- program_sharing_pkg: a program whose equal instructions share places does what it did before. The bench goes from
-- each fixed place to all that can follow, in both programs at once. The programs are random ones, with many equal
-- instructions, and those of the application that fit without sharing.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.instruction_pkg.all;
use work.program_pkg.all;
use work.program_sharing_pkg.all;

entity program_sharing_tb is
  generic (
    seed : positive := 1
  );
end entity;

architecture bench of program_sharing_tb is

  constant fixed : positions_t(0 to 511) := (0 to 3 | 32 to 63 => true, others => false);

  type places_t is array (natural range <>) of natural;
  type pairs_t is array (natural range <>, natural range <>) of boolean;

  function place_of(field : std_ulogic_vector) return natural is
  begin
    return to_integer(unsigned(field));
  end function;

  function size_of(program : program_t) return natural is
  begin
    return program'length;
  end function;

  function jumps(i : instruction_t) return boolean is
  begin
    return i(condition_f) /= (condition_f => '0');
  end function;

  -- Every field but the places.
  function deed_of(i : instruction_t) return instruction_t is
    variable deed : instruction_t := i;
  begin
    if i(do_begin) = '0' then
      deed(following_f) := (others => '0');
    end if;
    if jumps(i) then
      deed(target_f) := (others => '0');
    end if;
    return deed;
  end function;

  -- Whether `fewer` does all that `whole` does.
  procedure compare(whole, fewer : program_t) is
    variable are_twins : pairs_t(whole'range, fewer'range) := (others => (others => false));
    variable ones, others_of : places_t(0 to whole'length * fewer'length);  -- twins whose followers are to be looked at
    variable count : natural := 0;

    procedure meet(one, other : natural) is
    begin
      if not are_twins(one, other) then
        check(deed_of(whole(one)) = deed_of(fewer(other)), "the twin of a place does the same");
        are_twins(one, other) := true;
        ones(count)           := one;
        others_of(count)      := other;
        count                 := count + 1;
      end if;
    end procedure;

    variable i, j : instruction_t;
  begin
    for one in whole'range loop
      if fixed(one) then
        meet(one, one);
      end if;
    end loop;
    while count > 0 loop
      count := count - 1;
      i     := whole(ones(count));
      j     := fewer(others_of(count));
      if i(do_begin) = '0' then
        meet(place_of(i(following_f)), place_of(j(following_f)));
      end if;
      if jumps(i) then
        meet(place_of(i(target_f)), place_of(j(target_f)));
      end if;
    end loop;
  end procedure;

begin

  play : process
    variable random : random_t;

    -- Its instructions are of a few kinds, and most of them lead to a later place.
    impure function random_program return program_t is
      variable code : program_t(0 to random.integer_between(80, 400));
      variable next_place : natural;
    begin
      for place in code'range loop
        code(place) := number(random.integer_between(0, 2)) or act(random.integer_between(do_say, do_take));
        next_place  := random.integer_between(0, code'high);
        if random.chance(80) then
          next_place := minimum(place + random.integer_between(1, 2), code'high);
        end if;
        code(place)(following_f) := std_ulogic_vector(to_unsigned(next_place, 9));
        if random.chance(20) then
          code(place)(if_some_left) := '1';
          code(place)(target_f)     := std_ulogic_vector(to_unsigned(random.integer_between(0, code'high), 9));
        end if;
      end loop;
      code(0) := act(do_begin);
      code(0)(following_f) := std_ulogic_vector(to_unsigned(first_of_commands, 9));
      return code;
    end function;

    procedure try(whole : program_t; least : natural) is
      constant fewer : program_t := with_shared_places(whole, fixed(whole'range));
    begin
      compare(whole, fewer);
      check(fewer'length + least <= whole'length, "a program has equal instructions");
      check_equal(size_of(with_shared_places(fewer, fixed(fewer'range))), fewer'length, "places after a second time");
    end procedure;
  begin
    random.seed(seed);
    for turn in 1 to 20 loop
      try(random_program, 0);
    end loop;
    for publish_mode in 0 to 2 loop
      try(program_for(1, 4, 255, publish_mode, 1000, 16, 32, 2, 2, true), 10);
    end loop;
    check_equal(size_of(program_for(2, 4, 255, 2, 1000, 16, 32, 2, 2, true)), 256, "places at two address bytes");
    check_equal(size_of(program_for(4, 4, 255, 2, 1000, 16, 32, 4, 2, true)), 512, "places at four address bytes");
    report_passed("program_sharing_tb");
    wait;
  end process;

end architecture;
