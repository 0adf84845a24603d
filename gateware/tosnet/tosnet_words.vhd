-- SPDX-License-Identifier: BSD-3-Clause
--
-- The words of a TosNet node for its user: registers that change with the network's cycle.
--
--   words that come --> one set, when all of it has come --> read_words        write_words --> the words to send
--
-- Reading   read_words are the words of read_addresses, all of one cycle. `exchange` is high for one clock in each
--           cycle whose words are all there and good; read_words are new in it. In all other cycles they keep their
--           values.
-- Safe      The words of safe_addresses, which are among read_addresses, have their safe_values while the ring does
--           not run, from the clock after `running` falls until the first `exchange`.
-- Missing   `missing` is high after a cycle in which a word of read_addresses did not come: no node of the ring has
--           that register. It is high from the start of the ring until the first `exchange`, too.
-- Writing   write_words are sampled three clocks after each strobe, and all the time while the ring does not run. So
--           they may change at any time. A cycle sends the words of one moment.
-- Master    It also sends the OUT words of others that are among read_addresses, so that the slaves know them. Before
--           their first `exchange` since the start of the ring, and for words that nobody reads here, it sends zero.
-- Latency   send_word one clock after send_address. read_words one clock after the strobe.
-- Reset     All words are zero, but for those with a safe value.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.protocol_pkg.all;
  use work.register_pkg.all;
  use work.tosnet_pkg.all;

entity tosnet_words is
  generic (
    read_addresses  : tosnet_address_vector_t := tosnet_no_addresses_c;
    write_addresses : tosnet_address_vector_t := tosnet_no_addresses_c;
    safe_addresses  : tosnet_address_vector_t := tosnet_no_addresses_c;
    safe_values     : word_vector_t           := tosnet_no_words_c -- one for each
  );
  port (
    clock            : in  std_ulogic;
    reset            : in  std_ulogic; -- synchronous
    running          : in  std_ulogic; -- tosnet_node
    strobe           : in  std_ulogic;
    strobe_fresh     : in  std_ulogic;
    received_valid   : in  std_ulogic;
    received_address : in  std_ulogic_vector(9 downto 0);
    received_word    : in  std_ulogic_vector(31 downto 0);
    send_address     : in  std_ulogic_vector(9 downto 0);
    send_word        : out std_ulogic_vector(31 downto 0);

    exchange    : out std_ulogic;
    missing     : out std_ulogic;
    read_words  : out word_vector_t(0 to read_addresses'length - 1);
    write_words : in  word_vector_t(0 to write_addresses'length - 1)
  );
end entity;

architecture rtl of tosnet_words is

  constant read_map   : tosnet_address_vector_t(0 to read_addresses'length - 1)  := read_addresses;
  constant write_map  : tosnet_address_vector_t(0 to write_addresses'length - 1) := write_addresses;
  constant safe_map   : tosnet_address_vector_t(0 to safe_addresses'length - 1)  := safe_addresses;
  constant safe_words : word_vector_t(0 to safe_addresses'length - 1)            := safe_values;

  signal hidden  : word_vector_t(read_map'range);  -- of the cycle that is under way
  signal came    : std_ulogic_vector(read_map'range);
  signal sending : word_vector_t(write_map'range);
  signal passed  : std_ulogic_vector(2 downto 0);  -- clocks since the strobe

  function is_place (address : std_ulogic_vector(9 downto 0); place : tosnet_address_t) return boolean is
  begin
    return unsigned(address) = place;
  end function;

begin

  read : process (clock) is
    variable all_came : std_ulogic;
  begin
    if rising_edge(clock) then
      exchange <= '0';
      for place in read_map'range loop
        if received_valid = '1' and is_place(received_address, read_map(place)) then
          hidden(place) <= received_word;
          came(place)   <= '1';
        end if;
      end loop;
      if strobe = '1' then
        all_came := and came;
        came     <= (others => '0');
        if strobe_fresh = '1' then
          missing <= not all_came;
          if all_came = '1' then
            read_words <= hidden;
            exchange   <= '1';
          end if;
        end if;
      end if;
      if running = '0' then
        missing <= '1';
        came    <= (others => '0');
      end if;
      if reset = '1' then
        read_words <= (others => (others => '0'));
        exchange   <= '0';
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
    variable word : std_ulogic_vector(31 downto 0);
  begin
    if rising_edge(clock) then
      passed <= passed(1 downto 0) & strobe;
      if passed(2) = '1' or running = '0' then
        sending <= write_words;
      end if;
      word := (others => '0');
      if reset = '0' then
        for place in write_map'range loop
          if is_place(send_address, write_map(place)) then
            word := word or sending(place);
          end if;
        end loop;
        for place in read_map'range loop
          if is_place(send_address, read_map(place)) and missing = '0' then
            word := word or read_words(place);
          end if;
        end loop;
      end if;
      send_word <= word;
      if reset = '1' then
        passed  <= "000";
        sending <= (others => (others => '0'));
      end if;
    end if;
  end process;

end architecture;
