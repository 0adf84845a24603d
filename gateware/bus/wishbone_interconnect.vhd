-- SPDX-License-Identifier: BSD-3-Clause
--
-- One Wishbone master and many slaves: the address selects the slave.
--
--                        +--> slaves_m2s(0)   address_map(0): base x"00000000", 256 words
--   master_m2s --decode--+--> slaves_m2s(1)   address_map(1): base x"00000400", 3 words
--                        +--> err             everywhere else
--
-- Addresses  A slave gets addresses of its own, from 0 on: the base is subtracted. Any base and size are possible. A
--            size that is a power of two, with a base that is a multiple of it, needs no adder. Ranges that overlap or
--            pass the end stop elaboration.
-- cyc        goes to every slave, and stb to one. So all slaves that keep one moment (double buffers, snapshots) keep
--            the same moment.
-- Latency    None: decode, strobe and answer are in the same clock.
-- Errors     An access outside all ranges is answered with err in its first clock. The master's timeout ends an access
--            whose slave never answers.
-- Pressure   A slave may take any number of clocks. The master waits.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.address_map_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_interconnect is
  generic (
    address_map : address_map_t := (0 => (base => x"00000000", words => 256))
  );
  port (
    master_m2s : in  wishbone_m2s_t;
    master_s2m : out wishbone_s2m_t;
    slaves_m2s : out wishbone_m2s_vector_t(0 to address_map'length - 1);
    slaves_s2m : in  wishbone_s2m_vector_t(0 to address_map'length - 1)
  );
end entity;

architecture rtl of wishbone_interconnect is

  constant slaves : positive                       := address_map'length;
  constant map_c  : address_map_t(0 to slaves - 1) := address_map;

  signal hit : std_ulogic_vector(0 to slaves - 1); -- at most one

begin

  decode : for slave in 0 to slaves - 1 generate

    constant span : address_range_t       := map_c(slave);
    constant last : unsigned(31 downto 0) := last_address(map_c(slave));

    signal inner : std_ulogic_vector(31 downto 0); -- the address within the slave's range

  begin

    assert last >= span.base
      report "wishbone_interconnect: slave " & integer'image(slave) & " passes the last address"
      severity failure;

    distinct : for other in 0 to slave - 1 generate
      assert not overlaps(span, map_c(other))
        report "wishbone_interconnect: slaves " & integer'image(other) & " and " & integer'image(slave) & " overlap"
        severity failure;
    end generate;

    aligned : if is_aligned(span) generate
      hit(slave) <= '1' when (unsigned(master_m2s.adr) and not to_unsigned(span.words - 1, 32)) = span.base else '0';
      inner      <= master_m2s.adr and std_ulogic_vector(to_unsigned(span.words - 1, 32));
    end generate;

    anywhere : if not is_aligned(span) generate
      hit(slave) <= '1' when unsigned(master_m2s.adr) >= span.base and unsigned(master_m2s.adr) <= last else '0';
      inner      <= std_ulogic_vector(unsigned(master_m2s.adr) - span.base);
    end generate;

    process (all) is
    begin
      slaves_m2s(slave)     <= master_m2s;
      slaves_m2s(slave).adr <= inner;
      slaves_m2s(slave).stb <= master_m2s.stb and hit(slave);
    end process;

  end generate;

  process (all) is
    variable answer : wishbone_s2m_t;
  begin
    answer     := wishbone_s2m_idle;
    answer.err := master_m2s.cyc and master_m2s.stb and not (or hit);
    for slave in 0 to slaves - 1 loop
      if hit(slave) = '1' then
        answer.dat := slaves_s2m(slave).dat;
        answer.ack := slaves_s2m(slave).ack;
        answer.err := slaves_s2m(slave).err;
      end if;
    end loop;
    master_s2m <= answer;
  end process;

end architecture;
