-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of a TosNet node for its user: registers that change with the network's cycle.
--
--   words that come --> one set, when all of it has come --> read_words        write_words --> the words to send
--
-- Reading   read_words are the words of read_addresses, all of one cycle. `exchange` is high for one clock in each
--           cycle whose words are all there and good; read_words are new in it. In all other cycles they keep their
--           values.
-- Rings     With two rings, a cycle's words come twice, and the first set that is whole is taken. The other one of the
--           same cycle, within apart_clocks, is left. The rings must be in step (tosnet_rings).
-- Safe      The words of safe_addresses, which are among read_addresses, have their safe_values while no ring runs,
--           from the clock after `running` falls until the first `exchange`.
-- Missing   `missing` is high after a cycle in which a word of read_addresses did not come: no node of the ring has
--           that register. It is high from the start of the ring until the first `exchange`, too. With two rings, one
--           that has all words is enough.
-- Writing   A slave samples write_words three clocks after each strobe, the master when it sends, and both all the time
--           while no ring runs. So they may change at any time. A cycle sends the words of one moment.
-- Master    It also sends the OUT words of others that are among read_addresses, so that the slaves know them. Before
--           their first `exchange` since the start of the ring, and for words that nobody reads here, it sends zero.
-- Latency   A word to send is there one clock after send_address, read_words one clock after the strobe.
-- Reset     All words are zero, but for those with a safe value.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_words is
  generic (
    read_addresses  : tosnet_address_vector_t := tosnet_no_addresses_c;
    write_addresses : tosnet_address_vector_t := tosnet_no_addresses_c;
    safe_addresses  : tosnet_address_vector_t := tosnet_no_addresses_c;
    safe_values     : word_vector_t           := tosnet_no_words_c; -- one for each
    rings           : positive range 1 to 2   := 1;
    apart_clocks    : positive                := 600 -- of the strobes of two rings, at most; less than a cycle
  );
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic; -- synchronous
    from_nodes : in  from_node_vector_t(0 to rings - 1);
    send_words : out word_vector_t(0 to rings - 1);

    exchange    : out std_ulogic;
    missing     : out std_ulogic;
    lacks       : out std_ulogic_vector(0 to rings - 1) := (others => '1'); -- … of each ring
    read_words  : out word_vector_t(0 to read_addresses'length - 1);
    write_words : in  word_vector_t(0 to write_addresses'length - 1)
  );
end entity;

architecture rtl of tosnet_words is

  constant read_map   : tosnet_address_vector_t(0 to read_addresses'length - 1)  := read_addresses;
  constant write_map  : tosnet_address_vector_t(0 to write_addresses'length - 1) := write_addresses;
  constant safe_map   : tosnet_address_vector_t(0 to safe_addresses'length - 1)  := safe_addresses;
  constant safe_words : word_vector_t(0 to safe_addresses'length - 1)            := safe_values;

  type sets_t is array (0 to rings - 1) of word_vector_t(read_map'range);
  type flags_t is array (0 to rings - 1) of std_ulogic_vector(read_map'range);

  signal hidden  : sets_t;  -- of the cycle that is under way
  signal came    : flags_t;
  signal since   : natural range 0 to apart_clocks := 0; -- clocks in which the other ring's set may come
  signal sending : word_vector_t(write_map'range);
  signal passed  : std_ulogic_vector(2 downto 0);  -- clocks since the strobe
  signal running : std_ulogic;

  function is_place (address : std_ulogic_vector(9 downto 0); place : tosnet_address_t) return boolean is
  begin
    return unsigned(address) = place;
  end function;

begin

  missing <= and lacks;

  any_runs : process (all) is
    variable any : std_ulogic;
  begin
    any := '0';
    for ring in from_nodes'range loop
      any := any or from_nodes(ring).running;
    end loop;
    running <= any;
  end process;

  read : process (clock) is
    variable all_came : std_ulogic;
    variable taken    : boolean; -- this cycle has its set
  begin
    if rising_edge(clock) then
      exchange <= '0';
      taken    := since > 0;
      if since > 0 then
        since <= since - 1;
      end if;
      for ring in from_nodes'range loop
        for place in read_map'range loop
          if from_nodes(ring).received_valid = '1' and is_place(from_nodes(ring).received_address, read_map(place)) then
            hidden(ring)(place) <= from_nodes(ring).received_word;
            came(ring)(place)   <= '1';
          end if;
        end loop;
        if (from_nodes(ring).strobe and from_nodes(ring).running) = '1' then
          all_came   := and came(ring);
          came(ring) <= (others => '0');
          if from_nodes(ring).strobe_fresh = '1' then
            lacks(ring) <= not all_came;
            if all_came = '1' and not taken then
              read_words <= hidden(ring);
              exchange   <= '1';
              taken      := true;
              if rings = 2 then
                since <= apart_clocks;
              end if;
            end if;
          end if;
        end if;
        if from_nodes(ring).running = '0' then
          lacks(ring) <= '1';
          came(ring)  <= (others => '0');
        end if;
      end loop;
      if reset = '1' then
        read_words <= (others => (others => '0'));
        exchange   <= '0';
        since      <= 0;
      end if;
      if reset = '1' or running = '0' then
        for place in read_map'range loop
          for safe in safe_map'range loop
            if safe_map(safe) = read_map(place) then
              read_words(place) <= safe_words(safe);
            end if;
          end loop;
        end loop;
      end if;
    end if;
  end process;

  write : process (clock) is
    variable word    : std_ulogic_vector(31 downto 0);
    variable strobes : std_ulogic; -- of a slave, in any ring
    variable sends   : std_ulogic; -- the master, into any ring
  begin
    if rising_edge(clock) then
      strobes := '0';
      sends   := '0';
      for ring in from_nodes'range loop
        strobes := strobes or (from_nodes(ring).strobe and not from_nodes(ring).is_master);
        sends   := sends or from_nodes(ring).sends;
      end loop;
      passed <= passed(1 downto 0) & strobes;
      if passed(2) = '1' or sends = '1' or running = '0' then
        sending <= write_words;
      end if;
      for ring in from_nodes'range loop
        word := (others => '0');
        if reset = '0' then
          for place in write_map'range loop
            if is_place(from_nodes(ring).send_address, write_map(place)) then
              word := word or sending(place);
            end if;
          end loop;
          for place in read_map'range loop
            if is_place(from_nodes(ring).send_address, read_map(place)) and missing = '0' then
              word := word or read_words(place);
            end if;
          end loop;
        end if;
        send_words(ring) <= word;
      end loop;
      if reset = '1' then
        passed  <= "000";
        sending <= (others => (others => '0'));
      end if;
    end if;
  end process;

end architecture;
