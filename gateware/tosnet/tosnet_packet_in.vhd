-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bytes of a TosNet packet, from the symbols of its line: K28.5, seed, scrambled bytes, checksum, K28.1.
--
-- Order     `start` is high at K28.5. Then `valid` is high once for each byte but the checksum. Then `done` is high.
--           Each is high for one clock, and two of them at once only if a packet begins inside of another: then `done`
--           belongs to the earlier one.
-- Judgement `good` is meant with `done`. A packet is good if its checksum fits and K28.1 follows it. It is not if a
--           symbol does not exist, if K28.5 comes in its middle, or if it is shorter than two bytes.
-- Use       Bytes come before they are judged. So use them for good only after a good `done`.
-- Latency   A byte is given when the next symbol has come, because only then it is known that it is no checksum:
--           one symbol and one clock.
-- Reset     Waits for K28.5.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_code_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_packet_in is
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    symbol_valid : in  std_ulogic;
    symbol_data  : in  byte_t;
    control      : in  std_ulogic;
    wrong        : in  std_ulogic;
    start        : out std_ulogic;
    valid        : out std_ulogic;
    data         : out byte_t := x"00";
    done         : out std_ulogic;
    good         : out std_ulogic
  );
end entity;

architecture rtl of tosnet_packet_in is

  type state_t is (between, seed, first, more);

  signal state    : state_t;
  signal scramble : byte_t;
  signal held     : byte_t := x"00"; -- a byte, or the checksum
  signal sum      : byte_t;
  signal enough   : std_ulogic; -- there was a byte before the held one

begin

  process (clock) is
    variable plain : byte_t;
  begin
    if rising_edge(clock) then
      start <= '0';
      valid <= '0';
      done  <= '0';
      plain := scrambled(symbol_data, scramble);
      if symbol_valid = '1' then
        if wrong = '1' or control = '1' then
          done  <= to_bit(state /= between);
          good  <= not wrong and not symbol_data(7) and enough and to_bit(state = more and sum = x"00");
          state <= between;
          if wrong = '0' and symbol_data(7) = '1' then -- K28.5
            start <= '1';
            state <= seed;
          end if;
        elsif state = seed then
          scramble <= symbol_data;
          sum      <= x"00";
          enough   <= '0';
          state    <= first;
        elsif state /= between then
          scramble <= next_scramble(scramble);
          sum      <= next_sum(sum, plain);
          held     <= plain;
          data     <= held;
          valid    <= to_bit(state = more);
          enough   <= to_bit(state = more);
          state    <= more;
        end if;
      end if;
      if reset = '1' then
        state <= between;
        start <= '0';
        valid <= '0';
        done  <= '0';
      end if;
    end if;
  end process;

end architecture;
