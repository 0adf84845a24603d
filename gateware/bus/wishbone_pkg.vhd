-- SPDX-License-Identifier: BSD-3-Clause
--
-- Wishbone B4 classic cycles as two records, one for each direction.
--
-- Both records have the widest bus that the classic protocol can carry (32-bit addresses, 32-bit data). A core with a
-- narrower bus uses the low bits. The upper ones are zero, and synthesis removes them.
--
-- Addresses count words (one address for each data word), as in the protocol and in UL-spec. There is no byte address.
--
-- In a cycle, the master raises cyc and stb, with we, adr, dat and sel stable. The slave answers with ack or err for
-- one clock, at the earliest in the same clock. The master lowers stb in the clock after the answer. A slave must not
-- answer unless cyc and stb are both high.
--
-- While cyc stays high, the accesses are one indivisible block. A slave with two banks keeps the bank of the first
-- clock until cyc falls.

library ieee;
  use ieee.std_logic_1164.all;

package wishbone_pkg is

  constant wishbone_address_width : positive := 32;
  constant wishbone_data_width    : positive := 32;

  -- Master to slave.
  type wishbone_m2s_t is record
    cyc : std_ulogic;                                            -- a bus cycle is open (high during a whole block)
    stb : std_ulogic;                                            -- an access is requested
    we  : std_ulogic;                                            -- with stb: 1 write, 0 read
    adr : std_ulogic_vector(wishbone_address_width - 1 downto 0);  -- with stb: word address
    dat : std_ulogic_vector(wishbone_data_width - 1 downto 0);   -- with stb and we: word to write
    sel : std_ulogic_vector(wishbone_data_width / 8 - 1 downto 0); -- with stb: valid bytes
  end record;

  -- Slave to master.
  type wishbone_s2m_t is record
    dat : std_ulogic_vector(wishbone_data_width - 1 downto 0);   -- with ack of a read: the word
    ack : std_ulogic;                                            -- the access is done
    err : std_ulogic;                                            -- the access is refused (instead of ack)
  end record;

  constant wishbone_m2s_idle : wishbone_m2s_t := (
    cyc => '0', stb => '0', we => '0', adr => (others => '0'), dat => (others => '0'), sel => (others => '0'));

  constant wishbone_s2m_idle : wishbone_s2m_t := (dat => (others => '0'), ack => '0', err => '0');

  -- Several masters or slaves side by side.
  type wishbone_m2s_vector_t is array (natural range <>) of wishbone_m2s_t;
  type wishbone_s2m_vector_t is array (natural range <>) of wishbone_s2m_t;

end package;
