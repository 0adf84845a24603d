-- SPDX-License-Identifier: BSD-3-Clause
--
-- The memory of the recordings. Word a starts as 0x40DE0000 | (a * 257 & 0xFFFF), cut to the data width. Addresses with
-- the top byte E0 to EF answer with err, and F0 to FF do not answer. The acknowledge is registered, as in
-- wishbone_memory. It comes later by `waits` clocks, and by random ones if `stall_percent` is not 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.wishbone_pkg.all;

entity bench_memory is
  generic (
    address_width : positive;
    data_width    : positive;
    recorded      : boolean  := true;  -- false: all words are 0 and every address answers
    bad_base      : natural  := 0;       -- if not 0: four words from there answer with err, the next four not at all
    waits         : natural  := 0;
    stall_percent : natural  := 0;
    seed          : positive := 1
  );
  port (
    clock        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t
  );
end entity;

architecture bench of bench_memory is

  constant address_bytes : positive := (address_width + 7) / 8;

  type memory_t is array (0 to 2 ** minimum(address_width, 16) - 1) of std_ulogic_vector(data_width - 1 downto 0);

  signal answer : wishbone_s2m_t := wishbone_s2m_idle;

begin

  serve : process (clock)
    variable memory : memory_t;
    variable filled : boolean := false;
    variable index  : natural;
    variable top    : natural;
    variable random : random_t;
    variable left   : natural := waits;
  begin
    if not filled then
      filled := true;
      random.seed(seed);
      for a in memory'range loop
        memory(a) := (others => '0');
        if recorded then
          memory(a) := std_ulogic_vector(resize(
            unsigned'(x"40DE" & to_unsigned((a * 257) mod 65536, 16)), data_width));
        end if;
      end loop;
    end if;
    if rising_edge(clock) then
      answer <= wishbone_s2m_idle;
      if wishbone_m2s.cyc = '1' and wishbone_m2s.stb = '1' and answer.ack = '0' and answer.err = '0' then
        top   := to_integer(unsigned(wishbone_m2s.adr(8 * address_bytes - 1 downto 8 * address_bytes - 8)));
        index := to_integer(unsigned(wishbone_m2s.adr(minimum(address_width, 16) - 1 downto 0)));
        if (recorded and top >= 16#F0#) or (bad_base > 0 and index >= bad_base + 4 and index < bad_base + 8) then
          null;
        elsif left > 0 then
          left := left - 1;
        elsif random.chance(stall_percent) then
          null;
        elsif (recorded and top >= 16#E0#) or (bad_base > 0 and index >= bad_base and index < bad_base + 4) then
          answer.err <= '1';
        else
          answer.ack <= '1';
          answer.dat(data_width - 1 downto 0) <= memory(index);
          if wishbone_m2s.we = '1' then
            memory(index) := wishbone_m2s.dat(data_width - 1 downto 0);
          end if;
        end if;
      else
        left := waits;
      end if;
    end if;
  end process;

  wishbone_s2m <= answer;

end architecture;
