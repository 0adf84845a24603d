-- SPDX-License-Identifier: BSD-3-Clause
--
-- The bytes of a TosNet packet, from the symbols of its line: K28.5, seed, scrambled bytes, checksum, K28.1.
--
-- Order     `start` is high at K28.5. Then `valid` is high once for each byte but the checksum. Then `done` is high.
--           Each is high for one clock, and two of them at once only if a packet begins inside of another: then `done`
--           belongs to the earlier one.
-- Judgement `good` is meant with `done`. A packet is good if its checksum fits and K28.1 follows it. It is not if a
--           symbol does not exist, if K28.5 comes in its middle, or if it has no byte before the checksum.
-- Use       Bytes come before they are judged. So use them for good only after a good `done`.
-- Checksum  Of check_bytes: 1 is the published one, 2 is wider (tosnet_code_pkg).
-- Latency   A byte is given when check_bytes more symbols have come, because only then it is known that it is no
--           checksum. That is check_bytes symbols and one clock.
-- Reset     Waits for K28.5.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_code_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_packet_in is
  generic (
    check_bytes : positive range 1 to 2 := 1
  );
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

  type state_t is (between, seed, bytes);
  type held_t is array (1 to check_bytes) of byte_t; -- the last bytes, or the checksum; the oldest is the last one

  signal state    : state_t;
  signal scramble : byte_t;
  signal held     : held_t := (others => x"00");
  signal count    : natural range 0 to check_bytes; -- of what is held
  signal sum      : std_ulogic_vector(8 * check_bytes - 1 downto 0);
  signal enough   : std_ulogic; -- there was a byte before the held ones

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
          good  <= not wrong and not symbol_data(7) and enough and to_bit(state = bytes and unsigned(sum) = 0);
          state <= between;
          if wrong = '0' and symbol_data(7) = '1' then -- K28.5
            start <= '1';
            state <= seed;
          end if;
        elsif state = seed then
          scramble <= symbol_data;
          sum      <= (others => '0');
          enough   <= '0';
          count    <= 0;
          state    <= bytes;
        elsif state /= between then
          scramble <= next_scramble(scramble);
          sum      <= next_sum(sum, plain);
          held(1)  <= plain;
          for place in 2 to check_bytes loop
            held(place) <= held(place - 1);
          end loop;
          data   <= held(check_bytes);
          valid  <= to_bit(count = check_bytes);
          enough <= to_bit(count = check_bytes);
          if count < check_bytes then
            count <= count + 1;
          end if;
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
