-- SPDX-License-Identifier: BSD-3-Clause
--
-- Sends TosNet packets: K28.5, seed, scrambled bytes, checksum, K28.1.
--
-- Items     item_data(8) is low for a byte. It is high for the end of a packet: then bit 0 says that the packet is
--           poisoned, so the checksum is inverted and no node takes the packet for good.
-- Start     While `go` is high and an item is there, a packet begins with the next symbol. One K28.1 at least stands
--           between two packets.
-- Pressure  An item is taken for each symbol. If none is there in the middle of a packet, the packet ends, poisoned,
--           and the items up to its end are dropped.
-- Seed      The scrambler's register, which advances with each byte and with each K28.1.
-- Reset     Sends K28.1.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_code_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_packet_out is
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic; -- synchronous
    go         : in  std_ulogic := '1';
    item_valid : in  std_ulogic;
    item_ready : out std_ulogic;
    item_data  : in  std_ulogic_vector(8 downto 0);
    busy       : out std_ulogic; -- a packet is on the line

    take    : in  std_ulogic;    -- of tosnet_line_out
    data    : out byte_t;
    control : out std_ulogic
  );
end entity;

architecture rtl of tosnet_packet_out is

  type state_t is (between, begin_symbol, seed_symbol, bytes, drop);

  signal state    : state_t;
  signal scramble : byte_t;
  signal sum      : byte_t;
  signal ends     : std_ulogic;
  signal plain    : byte_t;

begin

  -- The seed is the scrambler's register xor the sum of no bytes.
  ends       <= not item_valid or item_data(8) or to_bit(state = seed_symbol);
  plain      <= item_data(7 downto 0) when ends = '0' else
                not sum when state = bytes and (item_valid = '0' or item_data(0) = '1') else
                sum;
  item_ready <= (take and to_bit(state = bytes)) or to_bit(state = drop);
  busy       <= to_bit(state /= between);

  control <= to_bit(state /= seed_symbol and state /= bytes);
  data    <= scrambled(plain, scramble) when control = '0' else
             byte_t(to_unsigned(tosnet_wire_begin_c, 8)) when state = begin_symbol else
             byte_t(to_unsigned(tosnet_wire_idle_c, 8));

  process (clock) is
  begin
    if rising_edge(clock) then
      if state = drop and item_valid = '1' and item_data(8) = '1' then
        state <= between;
      end if;
      if take = '1' then
        case state is
          when between =>
            if item_valid = '1' and go = '1' then
              state <= begin_symbol;
            end if;
          when begin_symbol =>
            state <= seed_symbol;
            sum   <= x"00";
          when seed_symbol =>
            state <= bytes;
          when bytes =>
            sum <= next_sum(sum, plain);
            if item_valid = '0' then
              state <= drop;
            elsif ends = '1' then
              state <= between;
            end if;
          when drop =>
            null;
        end case;
        if state = between or state = drop or state = bytes then
          scramble <= next_scramble(scramble);
        end if;
      end if;
      if reset = '1' then
        state    <= between;
        scramble <= byte_t(to_unsigned(tosnet_wire_first_seed_c, 8));
      end if;
    end if;
  end process;

end architecture;
