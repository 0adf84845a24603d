-- SPDX-License-Identifier: BSD-3-Clause
--
-- How a sensor does, in one word: whether its value may be used, and what went wrong. Each try to read it ends well or
-- badly, and is told here.
--
--   ended  ___/‾‾‾‾‾‾‾‾‾‾\____    a try has ended, with its reason: 0 is a sample
--   hold   ‾‾‾‾‾‾‾‾‾‾‾\_______    a block of accesses is open: nothing changes in it
--   accept ___________/‾\_____    the value is taken in this clock, with the word
--
--   word   bits 7:0   failures: tries that ended badly; it wraps
--          bits 11:8  failures in a row, at most 15; 0: the value is that of the last try
--          bits 14:12 the reason of the last one, or 0
--          bit 15     valid: there was a sample, and no failures_most failures in a row since then
--
-- Void      While `void` is high, the value counts no more: valid is 0 until the next sample behind it.
-- Latency   word and valid follow accept by one clock. sampled and failed are high for this clock.
-- Reset     All bits of the word are 0.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity sample_state is
  generic (
    failures_most : positive range 1 to 15 := 3
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic; -- synchronous
    ended   : in  std_ulogic; -- until accept
    reason  : in  std_ulogic_vector(2 downto 0);
    hold    : in  std_ulogic;
    void    : in  std_ulogic;
    accept  : out std_ulogic;
    sampled : out std_ulogic := '0';
    failed  : out std_ulogic := '0';
    valid   : out std_ulogic;
    word    : out std_ulogic_vector(15 downto 0)
  );
end entity;

architecture rtl of sample_state is

  signal takes    : std_ulogic;
  signal good     : std_ulogic;
  signal is_valid : std_ulogic := '0';
  signal last     : std_ulogic_vector(2 downto 0) := "000";
  signal in_a_row : unsigned(3 downto 0) := (others => '0');
  signal failures : unsigned(7 downto 0) := (others => '0');

begin

  takes  <= ended and not hold;
  good   <= nor reason;
  accept <= takes;
  valid  <= is_valid;
  word   <= is_valid & last & std_ulogic_vector(in_a_row) & std_ulogic_vector(failures);

  process (clock) is
  begin
    if rising_edge(clock) then
      sampled <= takes and good;
      failed  <= takes and not good;
      if takes = '1' then
        last <= reason;
        if good = '1' then
          in_a_row <= (others => '0');
          is_valid <= '1';
        else
          failures <= failures + 1;
          if in_a_row /= 15 then
            in_a_row <= in_a_row + 1;
          end if;
          if in_a_row = failures_most - 1 then
            is_valid <= '0';
          end if;
        end if;
      end if;
      if void = '1' then
        is_valid <= '0';
      end if;
      if reset = '1' then
        sampled  <= '0';
        failed   <= '0';
        is_valid <= '0';
        last     <= "000";
        in_a_row <= (others => '0');
        failures <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
