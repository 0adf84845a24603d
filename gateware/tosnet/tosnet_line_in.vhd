-- SPDX-License-Identifier: BSD-3-Clause
--
-- The receiver of a TosNet line: samples to symbols, and symbols to bytes.
--
--   samples --> bits, at the middle between edges --> ten of them, aligned by K28.5 --> symbol_valid/data/control/wrong
--
-- Samples   `samples` are bits of the line that are already of `clock`, the oldest in bit 0. One per clock comes from a
--           `synchroniser`. More come from the DDR or SERDES input of an FPGA, so that a line may be as fast as
--           the clock. A bit is at least three samples long: clocks_per_bit * samples_per_clock.
-- Bits      Every edge sets the middle of the next bit anew. Between two edges there are at most five bits, so the two
--           clocks may be 1 % apart.
-- Alignment Every K28.5 begins a symbol, wherever it comes. Until the first one, no symbol is valid. After a symbol
--           that does not exist, none is valid until the next K28.5.
-- Loss      `lost` is high after 32 bits without an edge, and until the next K28.5.
-- Latency   symbol_valid is high for one clock, three clocks after the sample in the middle of the symbol's last bit.
-- Reset     The line is lost.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_code_pkg.all;

entity tosnet_line_in is
  generic (
    clocks_per_bit    : positive := 4;
    samples_per_clock : positive := 1
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    samples      : in  std_ulogic_vector(samples_per_clock - 1 downto 0);
    symbol_valid : out std_ulogic;
    data         : out byte_t;
    control      : out std_ulogic; -- the symbol is K28.1 or K28.5
    wrong        : out std_ulogic; -- the symbol does not exist
    lost         : out std_ulogic
  );
end entity;

architecture rtl of tosnet_line_in is

  -- What each of the 1024 symbols means: data, control, wrong. This becomes block RAM.
  subtype meaning_t is std_ulogic_vector(9 downto 0);
  type meanings_t is array (0 to 1023) of meaning_t;

  function all_meanings return meanings_t is
    variable decoded  : decoded_t;
    variable meanings : meanings_t;
  begin
    for number in meanings'range loop
      decoded := decode(symbol_t(to_unsigned(number, 10)));
      meanings(number) := decoded.data & decoded.control & decoded.wrong;
    end loop;
    return meanings;
  end function;

  constant meanings : meanings_t := all_meanings;

  constant samples_per_bit : positive := clocks_per_bit * samples_per_clock;
  constant middle          : natural  := (samples_per_bit - 1) / 2;
  constant quiet_bits      : positive := 32;

  signal level   : std_ulogic; -- the last sample
  signal passed  : natural range 0 to samples_per_bit - 1; -- samples since the last edge, or since the last bit began
  signal shift   : symbol_t;
  signal place   : natural range 0 to 9; -- bits of the symbol that have come
  signal aligned : std_ulogic;
  signal quiet   : natural range 0 to quiet_bits;

  signal whole   : std_ulogic; -- the symbol whose meaning is here is one
  signal meaning : meaning_t;

begin

  assert samples_per_bit >= 3
    report "tosnet_line_in: a bit of " & integer'image(samples_per_bit) & " samples is too short; three are needed"
    severity failure;

  -- Block RAM is slow, and what follows has long paths.
  outputs : process (clock) is
  begin
    if rising_edge(clock) then
      symbol_valid <= whole and not reset;
      data         <= meaning(9 downto 2);
      control      <= meaning(1);
      wrong        <= meaning(0);
    end if;
  end process;

  bits : process (clock) is
    variable old   : std_ulogic;
    variable count : natural range 0 to samples_per_bit - 1;
    variable now   : symbol_t;
    variable has   : natural range 0 to 9;
    variable still : natural range 0 to quiet_bits;
    variable lines_up : std_ulogic;
    variable symbol   : symbol_t;
    variable ends     : boolean; -- a symbol ends
  begin
    if rising_edge(clock) then
      old   := level;
      count := passed;
      now   := shift;
      has   := place;
      still := quiet;
      lines_up := aligned;
      symbol   := now;
      ends     := false;
      whole <= '0';
      if whole = '1' and meaning(0) = '1' then
        lines_up := '0';
      end if;
      for index in 0 to samples_per_clock - 1 loop
        if samples(index) /= old then
          count := 0;
          still := 0;
        elsif count = samples_per_bit - 1 then
          count := 0;
        else
          count := count + 1;
        end if;
        old := samples(index);
        if count = middle then
          now := samples(index) & now(9 downto 1);
          if still < quiet_bits then
            still := still + 1;
          end if;
          if is_comma(now) then
            lines_up := '1';
            has      := 0;
            symbol   := now;
            ends     := true;
            whole    <= '1';
            lost     <= '0';
          elsif has = 9 then
            has      := 0;
            symbol   := now;
            ends     := true;
            whole    <= lines_up;
          else
            has := has + 1;
          end if;
        end if;
      end loop;
      if still = quiet_bits then
        lost <= '1';
      end if;
      if ends then
        meaning <= meanings(to_integer(unsigned(symbol)));
      end if;
      level   <= old;
      passed  <= count;
      shift   <= now;
      place   <= has;
      quiet   <= still;
      aligned <= lines_up;
      if reset = '1' then
        aligned <= '0';
        whole   <= '0';
        lost    <= '1';
        quiet   <= 0;
        passed  <= 0;
        place   <= 0;
        level   <= '0';
      end if;
    end if;
  end process;

end architecture;
