-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pin of ws2812, for benches: the strip. It checks the times of each bit. Each LED keeps its
-- bits and hands on the next ones. It shows them when the line has been low for a pause.
--
--   shown    colours that the LEDs show, the first one leftmost
--   frames   pauses so far; a frame with too few or too many bits fails the bench
--   cut      a reset cuts this frame: it may have too few bits, and the last one may be too short

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;

entity ws2812_strip_model is
  generic (
    bits       : positive; -- of all LEDs
    pause_time : time := 280 us
  );
  port (
    data   : in  std_ulogic;
    done   : in  boolean;
    cut    : in  boolean := false;
    shown  : out std_ulogic_vector(bits - 1 downto 0) := (others => '1');
    frames : out natural := 0
  );
end entity;

architecture behaviour of ws2812_strip_model is
begin

  follow : process is
    variable got   : std_ulogic_vector(bits - 1 downto 0);
    variable count : natural := 0;
    variable rose  : time;
    variable fell  : time := 0 ns;
    variable high  : time;
    variable ended : natural := 0;
  begin
    loop
      wait until rising_edge(data) or done for pause_time;
      if not (data'event and data = '1') then
        exit when done;
        if count > 0 then
          if cut then
            shown(bits - 1 downto bits - count) <= got(count - 1 downto 0);
          else
            check_equal(count, bits, "the bits of a frame");
            shown <= got;
          end if;
          ended  := ended + 1;
          frames <= ended;
          count  := 0;
        end if;
      else
        if count > 0 then
          -- What WS2812B, SK6812 and WS2812B-V5 have in common.
          check(now - fell >= 450 ns and (high < 500 ns or now - fell <= 750 ns) and now - fell <= 1080 ns,
                "the low end of a bit is " & time'image(now - fell));
          check(now - rose >= 1150 ns and now - rose <= 1350 ns, "a bit is " & time'image(now - rose));
        end if;
        rose := now;
        wait until falling_edge(data) for 2 us;
        fell := now;
        high := fell - rose;
        check(cut or (high >= 220 ns and high <= 380 ns) or (high >= 620 ns and high <= 780 ns), "a 0 or a 1 is "
              & time'image(high));
        got   := got(bits - 2 downto 0) & to_bit(high > 500 ns);
        count := count + 1;
        check(count <= bits, "a frame has no more bits than its LEDs");
      end if;
    end loop;
    wait;
  end process;

end architecture;
