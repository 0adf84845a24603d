-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pins of hx711, for benches: the chip. It checks the times of sck, and that each conversion is
-- read whole. Behind a reset and another input its conversions are wrong until it has settled.
--
--   values   of the inputs 0 to 2
--   fault    0 none, 1 dout stays high, 2 it stays low
--   spike    dout is low for a moment, at its rise
--   done     the bench has ended
--   input    that of the last conversion that was ready

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity hx711_chip_model is
  generic (
    conversion_time : time    := 12.5 ms;
    settle          : natural := 4 -- conversions that are wrong
  );
  port (
    sck      : in  std_ulogic;
    dout     : out std_ulogic;

    value_0, value_1, value_2 : in signed(23 downto 0);
    fault    : in  natural;
    spike    : in  std_ulogic;
    done     : in  boolean;
    resets   : out natural := 0;
    input    : out natural := 0
  );
end entity;

architecture behaviour of hx711_chip_model is

  signal answer, spiked : std_ulogic := '1';

begin

  spiked <= '0', '1' after 900 ns when rising_edge(spike) else unaffected;
  dout   <= (answer and spiked) when fault = 0 else '1' when fault = 1 else '0';

  convert : process is
    variable next_ready : time := 0 ns;
    variable rose       : time := 0 ns;
    variable pulses     : natural := 0;
    variable wrong      : natural := 0;
    variable channel    : natural := 0;
    variable word       : signed(23 downto 0);

    procedure reset_chip is
    begin
      answer     <= '1';
      pulses     := 25;
      channel    := 0;
      wrong      := settle;
      next_ready := now + conversion_time;
      resets     <= resets + 1;
    end procedure;

  begin
    reset_chip;
    loop
      wait until sck'event or done for next_ready - now;
      exit when done;
      if sck'event and sck = '1' then
        check(now - rose >= 400 ns or rose = 0 ns, "sck rises too soon");
        rose   := now;
        pulses := pulses + 1;
        check(pulses <= 27 or fault /= 0 or answer = '1', "a conversion has at most 27 pulses");
        if pulses <= 24 then
          answer <= word(24 - pulses) after 100 ns;
        else
          answer <= '1' after 100 ns;
        end if;
      elsif sck'event then
        check(now - rose >= 200 ns, "sck is high for 200 ns or longer");
        if now - rose > 60 us then
          reset_chip;
        else
          check(now - rose <= 50 us, "sck is high for 50 us or shorter, or for 60 us or longer");
        end if;
      elsif sck = '0' then
        next_ready := now + conversion_time;
        if pulses >= 25 then -- the last one was read, and said what is next
          if pulses - 25 /= channel then
            channel := pulses - 25;
            wrong   := settle;
          end if;
          word := value_0 when channel = 0 else value_1 when channel = 1 else value_2;
          if wrong > 0 then
            word  := not word;
            wrong := wrong - 1;
          end if;
          input  <= channel;
          pulses := 0;
          answer <= '0';
        else
          check(pulses = 0, "a conversion is read whole");
        end if;
      else
        next_ready := now + conversion_time;
      end if;
    end loop;
    wait;
  end process;

end architecture;
