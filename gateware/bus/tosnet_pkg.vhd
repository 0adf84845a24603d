-- SPDX-License-Identifier: BSD-3-Clause
--
-- TosNet as its bus slave sees it: the nodes of the ring, and which words of the shared memory are in use.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;

package tosnet_pkg is

  -- A node other than the PC's own. Bit r of `registers` enables register r.
  type tosnet_node_t is record
    id        : natural range 0 to 15;
    registers : std_ulogic_vector(7 downto 0);
  end record;

  type tosnet_node_vector_t is array (natural range <>) of tosnet_node_t; -- in the order of the ring
  constant tosnet_no_nodes_c : tosnet_node_vector_t(1 to 0) := (others => (id => 0, registers => x"00"));

  -- Words of the shared memory: node * 64 + register * 8 + 4 if IN + word.
  subtype tosnet_address_t is natural range 0 to tosnet_memory_words_c - 1;
  type tosnet_address_vector_t is array (natural range <>) of tosnet_address_t;
  constant tosnet_no_addresses_c : tosnet_address_vector_t(1 to 0) := (others => 0);
  constant tosnet_no_words_c     : word_vector_t(1 to 0)           := (others => (others => '0'));

  -- The PC's own node may write its IN and OUT words, and the IN words of all others.
  function is_writable (address : tosnet_address_t; master_id : natural) return boolean;

  -- The network registers: the nodes of the ring, from its master on. They are zero if they are not `known`.
  function network_registers (
    master_id        : natural;
    master_registers : std_ulogic_vector(7 downto 0);
    nodes            : tosnet_node_vector_t;
    known            : boolean
  ) return word_vector_t;

  -- Finds a wrong address in `some`: one that occurs twice, one that the PC may not write if `writable` is true, or one
  -- that it may write if `writable` is false. The result is 1 + the index of the first such address, or 0.
  function misfit (some : tosnet_address_vector_t; master_id : natural; writable : boolean) return natural;

end package;

package body tosnet_pkg is

  function is_writable (address : tosnet_address_t; master_id : natural) return boolean is
  begin
    return (address / 2 ** tosnet_in_bit_c) mod 2 = 1 or address / 2 ** tosnet_node_shift_c = master_id;
  end function;

  function network_register (
    index     : natural;
    id        : natural;
    registers : std_ulogic_vector(7 downto 0)
  ) return word_t is
  begin
    return x"00" & registers & registers & std_ulogic_vector(to_unsigned(index, 4) & to_unsigned(id, 4));
  end function;

  function network_registers (
    master_id        : natural;
    master_registers : std_ulogic_vector(7 downto 0);
    nodes            : tosnet_node_vector_t;
    known            : boolean
  ) return word_vector_t is
    variable result : word_vector_t(0 to 15) := (others => (others => '0'));
    variable index  : natural range 0 to 16  := 1;
  begin
    if not known then
      return result;
    end if;
    result(0) := network_register(0, master_id, master_registers);
    for place in nodes'range loop
      if index < 16 then
        result(index) := network_register(index, nodes(place).id, nodes(place).registers);
        index         := index + 1;
      end if;
    end loop;
    return result;
  end function;

  function misfit (some : tosnet_address_vector_t; master_id : natural; writable : boolean) return natural is
    variable count : natural := 0;
  begin
    for index in some'range loop
      count := count + 1;
      if is_writable(some(index), master_id) /= writable then
        return count;
      end if;
      for other in some'range loop
        if other < index and some(other) = some(index) then
          return count;
        end if;
      end loop;
    end loop;
    return 0;
  end function;

end package body;
