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
-- Seed      A register like the scrambler's, which advances with each K28.1.
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
  signal seed     : byte_t;
  signal scramble : byte_t;
  signal sum      : byte_t;
  signal ends     : std_ulogic;
  signal plain    : byte_t;

begin

  ends       <= not item_valid or item_data(8);
  plain      <= item_data(7 downto 0) when ends = '0' else
                sum when item_valid = '1' and item_data(0) = '0' else
                not sum;
  item_ready <= (take and to_bit(state = bytes)) or to_bit(state = drop);
  busy       <= to_bit(state /= between);

  with state select data <=
    byte_t(to_unsigned(tosnet_wire_begin_c, 8)) when begin_symbol,
    seed                                        when seed_symbol,
    scrambled(plain, scramble)                  when bytes,
    byte_t(to_unsigned(tosnet_wire_idle_c, 8))  when others;

  control <= to_bit(state = between or state = begin_symbol or state = drop);

  process (clock) is
  begin
    if rising_edge(clock) then
      if state = drop and item_valid = '1' and item_data(8) = '1' then
        state <= between;
      end if;
      if take = '1' then
        case state is
          when between =>
            seed <= next_scramble(seed);
            if item_valid = '1' and go = '1' then
              state <= begin_symbol;
            end if;
          when begin_symbol =>
            state <= seed_symbol;
          when seed_symbol =>
            scramble <= seed;
            sum      <= x"00";
            state    <= bytes;
          when bytes =>
            scramble <= next_scramble(scramble);
            sum      <= next_sum(sum, plain);
            if item_valid = '0' then
              state <= drop;
            elsif ends = '1' then
              state <= between;
            end if;
          when drop =>
            seed <= next_scramble(seed);
        end case;
      end if;
      if reset = '1' then
        state <= between;
        seed  <= byte_t(to_unsigned(tosnet_wire_first_seed_c, 8));
      end if;
    end if;
  end process;

end architecture;
