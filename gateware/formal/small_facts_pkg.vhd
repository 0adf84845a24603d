-- SPDX-License-Identifier: BSD-3-Clause
--
-- The table of facts that the proof of small_engine checks, and the variables that it knows. The table is a text, made
-- by tools/formal/small_facts.py: for each place of the program 24 hexadecimal digits.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

package small_facts_pkg is

  constant window : positive := 8;  -- places

  subtype number_t is unsigned(7 downto 0);
  subtype word16_t is unsigned(15 downto 0);

  type names_t is (
    n_kind, n_id_h, n_id_l, n_record, n_status, n_count, n_repeated, n_scratch, n_found, n_low, n_high, n_head,
    n_look, n_after, n_outside, n_posts_h, n_posts_l);
  type numbers_t is array (names_t) of natural;
  type bytes_t is array (names_t) of number_t;
  -- The facts, as in tools/formal/small_facts.py.
  type fact_t is (
    none, begun_frame, not_post, is_post, older, recorded, fresh, remembered, settled, renewed, next_post, out_known,
    a_high, a_low, a_counter, x_low, x_counter, x_high, x_ring, look_high, after_high, x_clear, kind_legal,
    kind_small, post_or_older, post_or_recorded, head_high);

  constant facts_left : natural := 27;  -- of the bits for facts

  subtype facts_t is std_ulogic_vector(facts_left downto 0);
  subtype row_t is std_ulogic_vector(95 downto 0);
  type table_t is array (0 to 1023) of row_t;

  subtype true_f is natural range 95 downto 68;     -- facts that are true at this place
  subtype kept_f is natural range 67 downto 40;     -- if a call returns here: facts that it keeps
  subtype group_f is natural range 39 downto 32;    -- if this is in a routine: its group
  subtype groups_f is natural range 31 downto 0;    -- groups that may return here

  function table_of(text : string) return table_t;

  function joined(high_byte : number_t; low_byte : number_t) return word16_t;

  -- The address of the place of an id, if the places begin at `first`.
  function place_of(first : natural; id_low : number_t) return number_t;

end package;

package body small_facts_pkg is

  function value_of_digit(letter : character) return natural is
  begin
    case letter is
      when '0' to '9' => return character'pos(letter) - character'pos('0');
      when 'A' to 'F' => return character'pos(letter) - character'pos('A') + 10;
      when others     => return 0;
    end case;
  end function;

  function table_of(text : string) return table_t is
    variable rows : table_t := (others => (others => '0'));
  begin
    for number in 0 to text'length / 24 - 1 loop
      for place in 0 to 23 loop
        rows(number)(95 - 4 * place downto 92 - 4 * place) := std_ulogic_vector(
          to_unsigned(value_of_digit(text(text'low + 24 * number + place)), 4));
      end loop;
    end loop;
    return rows;
  end function;

  function joined(high_byte : number_t; low_byte : number_t) return word16_t is
  begin
    return high_byte & low_byte;
  end function;

  function place_of(first : natural; id_low : number_t) return number_t is
  begin
    return to_unsigned(first, 8) or shift_left(id_low and to_unsigned(window - 1, 8), 2);
  end function;

end package body;
