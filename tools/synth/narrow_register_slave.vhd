-- SPDX-License-Identifier: BSD-3-Clause
-- register_slave with as many pins as a chip has: a word from the PC and a word to it, and addresses of 8 bits.

library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
  use unitylink.register_pkg.all;
  use unitylink.wishbone_pkg.all;

entity narrow_register_slave is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    cyc, stb, we : in  std_ulogic;
    adr          : in  std_ulogic_vector(7 downto 0);
    dat          : in  std_ulogic_vector(31 downto 0);
    wishbone_s2m : out wishbone_s2m_t;
    to_pc        : in  word_t;
    from_pc      : out word_t;
    written      : out std_ulogic
  );
end entity;

architecture rtl of narrow_register_slave is
  signal wide                    : wishbone_m2s_t;
  signal read_words, write_words : word_vector_t(0 to 1);
  signal all_written             : std_ulogic_vector(0 to 1);
begin
  wide       <= (cyc => cyc, stb => stb, we => we, adr => x"000000" & adr, dat => dat, sel => "1111");
  read_words <= (write_words(0), to_pc);
  from_pc    <= write_words(0);
  written    <= all_written(0);

  whole : entity unitylink.register_slave
    generic map (writable => "10")
    port map (
      clock => clock, reset => reset, wishbone_m2s => wide, wishbone_s2m => wishbone_s2m, read_words => read_words,
      write_words => write_words, written => all_written, was_read => open);
end architecture;
