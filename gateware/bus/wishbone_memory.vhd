-- SPDX-License-Identifier: BSD-3-Clause
--
-- Plain memory on the Wishbone bus: `words` words from address 0 on.
--
-- Latency   ack one clock after strobe (registered), so 2 clocks per access.
-- Errors    An address beyond the memory is answered with err. Nothing is read or written then.
-- Contents  Zero at power-up (initial value of block RAM). A reset keeps them.
-- The upper address bits are used, too. So put an interconnect in front that subtracts the slave's base.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.width_pkg.all;
use work.wishbone_pkg.all;

entity wishbone_memory is
  generic (
    words      : positive := 256;
    data_width : positive range 8 to 32 := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t
  );
end entity;

architecture rtl of wishbone_memory is

  constant index_bits : positive := bits_for(words);

  type memory_t is array (0 to words - 1) of std_ulogic_vector(data_width - 1 downto 0);

  signal memory   : memory_t := (others => (others => '0'));
  signal word     : std_ulogic_vector(data_width - 1 downto 0) := (others => '0');
  signal ack, err : std_ulogic := '0';
  signal asked    : std_ulogic;
  signal inside   : std_ulogic;

begin

  assert index_bits < 31
    report "wishbone_memory: more words than an address range of 2**30" severity failure;

  asked  <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  inside <= '1' when unsigned(wishbone_m2s.adr) < words else '0';

  store : process (clock)
  begin
    if rising_edge(clock) then
      if asked = '1' and inside = '1' then
        if wishbone_m2s.we = '1' then
          memory(to_integer(unsigned(wishbone_m2s.adr(index_bits - 1 downto 0)))) <=
            wishbone_m2s.dat(data_width - 1 downto 0);
        end if;
        word <= memory(to_integer(unsigned(wishbone_m2s.adr(index_bits - 1 downto 0))));
      end if;
    end if;
  end process;

  answer : process (clock)
  begin
    if rising_edge(clock) then
      ack <= asked and inside and not reset;
      err <= asked and not inside and not reset;
    end if;
  end process;

  reply : process (all)
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.dat(data_width - 1 downto 0) <= word;
  end process;

end architecture;
