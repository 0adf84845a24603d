-- SPDX-License-Identifier: BSD-3-Clause
--
-- Sends TosNet packets: K28.5, seed, scrambled bytes, checksum, K28.1.
--
-- Items     item_data(8) is low for a byte. It is high for the end of a packet: then bit 0 says that the packet is
--           poisoned, so the checksum is inverted and no node takes the packet for good.
-- Start     While `go` is high and an item is there, a packet begins with the next symbol. One K28.1 at least stands
--           between two packets. With exact_start it begins at once, and `cut` is high for one clock: the K28.1 that is
--           on the line ends early (tosnet_line_out). Only if another packet has just ended, it begins later.
-- Checksum  Of check_bytes: 1 is the published one, 2 is wider (tosnet_code_pkg).
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
  generic (
    check_bytes : positive range 1 to 2 := 1;
    exact_start : boolean               := false
  );
  port (
    clock      : in  std_ulogic;
    reset      : in  std_ulogic; -- synchronous
    go         : in  std_ulogic := '1';
    item_valid : in  std_ulogic;
    item_ready : out std_ulogic;
    item_data  : in  std_ulogic_vector(8 downto 0);
    busy       : out std_ulogic; -- a packet is on the line

    take    : in  std_ulogic;    -- of tosnet_line_out
    cut     : out std_ulogic;    -- to it: data and control are those of a symbol that begins now
    data    : out byte_t;
    control : out std_ulogic
  );
end entity;

architecture rtl of tosnet_packet_out is

  type state_t is (between, begin_symbol, seed_symbol, bytes, check, drop);

  -- Symbols that are taken from the end of a packet until its K28.1 has been on the line.
  constant rest_symbols : positive := 3;

  signal state    : state_t;
  signal scramble : byte_t;
  signal sum      : std_ulogic_vector(8 * check_bytes - 1 downto 0);
  signal low_sum  : byte_t; -- the second byte of the checksum
  signal ends     : std_ulogic;
  signal poison   : std_ulogic;
  signal plain    : byte_t;
  signal dropped  : std_ulogic; -- the packet ran dry: its items up to the end are dropped
  signal rested   : natural range 0 to rest_symbols;

begin

  -- The seed is the scrambler's register xor the sum of no bytes.
  ends       <= not item_valid or item_data(8) or to_bit(state = seed_symbol);
  poison     <= to_bit(state = bytes) and (not item_valid or item_data(0));
  plain      <= low_sum when state = check else
                item_data(7 downto 0) when ends = '0' else
                sum(sum'high downto sum'high - 7) xor (7 downto 0 => poison);
  item_ready <= (take and to_bit(state = bytes)) or to_bit(state = drop);
  busy       <= to_bit(state /= between);

  cut <= to_bit(exact_start and state = between and rested = rest_symbols) and item_valid and go;

  control <= to_bit(state /= seed_symbol and state /= bytes and state /= check);
  data    <= scrambled(plain, scramble) when control = '0' else
             byte_t(to_unsigned(tosnet_wire_begin_c, 8)) when state = begin_symbol or cut = '1' else
             byte_t(to_unsigned(tosnet_wire_idle_c, 8));

  process (clock) is
  begin
    if rising_edge(clock) then
      if state = drop and item_valid = '1' and item_data(8) = '1' then
        state <= between;
      end if;
      if take = '1' then
        if rested < rest_symbols then
          rested <= rested + 1;
        end if;
        case state is
          when between =>
            if not exact_start and item_valid = '1' and go = '1' then
              state <= begin_symbol;
            end if;
          when begin_symbol =>
            state <= seed_symbol;
            sum   <= (others => '0');
          when seed_symbol =>
            state <= bytes;
          when bytes =>
            sum     <= next_sum(sum, plain);
            low_sum <= sum(7 downto 0) xor (7 downto 0 => poison);
            rested  <= 0;
            dropped <= not item_valid;
            if ends = '1' and check_bytes = 2 then
              state <= check;
            elsif item_valid = '0' then
              state <= drop;
            elsif ends = '1' then
              state <= between;
            end if;
          when check =>
            state  <= drop when dropped = '1' else between;
            rested <= 0;
          when drop =>
            null;
        end case;
        if state /= begin_symbol and state /= seed_symbol and cut = '0' then
          scramble <= next_scramble(scramble);
        end if;
      end if;
      if cut = '1' then
        state <= seed_symbol;
        sum   <= (others => '0');
      end if;
      if reset = '1' then
        state    <= between;
        rested   <= 0;
        scramble <= byte_t(to_unsigned(tosnet_wire_first_seed_c, 8));
      end if;
    end if;
  end process;

end architecture;
