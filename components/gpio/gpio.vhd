-- SPDX-License-Identifier: BSD-3-Clause
--
-- General-purpose pins on the Wishbone bus. Each is an input or an output, and a change of a watched pin is an event.
--
--   +0  read: the state of the pins (outputs too)     +3  write: set the outputs whose bit is 1       read: outputs
--   +1  outputs                                       +4  write: clear the outputs whose bit is 1     read: outputs
--   +2  direction: 1 drives the pin                   +5  watch: 1 makes a change of this pin an event
--
-- +3 and +4 change some pins without a read first. So two programs, or a lost reply, cannot undo each other's changes.
-- Bits above `pins` read as zero and are not stored.
--
-- Event     changed is high for one clock when a watched pin has changed. Connect it to an edge event input of a
--           subscription group.
-- Latency   2 clocks per access (register_slave). A write reaches the pins 2 clocks after its strobe. A pin can be read
--           2 + stable_clocks clocks after it changed. Reads give the pins of the moment when cyc rose.
-- Errors    err for a write to +0 and for addresses from 6 on.
-- Reset     All pins are inputs, all outputs are zero, and no pin is watched.

library ieee;
  use ieee.std_logic_1164.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity gpio is
  generic (
    pins          : positive range 1 to 32 := 8;
    data_width    : positive range 8 to 32 := 32;
    stable_clocks : positive               := 1 -- clocks for which an input must be stable
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    changed      : out std_ulogic;

    -- At the top level: pin(i) <= pin_out(i) when pin_drive(i) = '1' else 'Z'; pin_in <= pin;
    pin_in    : in  std_ulogic_vector(pins - 1 downto 0); -- asynchronous
    pin_out   : out std_ulogic_vector(pins - 1 downto 0);
    pin_drive : out std_ulogic_vector(pins - 1 downto 0)
  );
end entity;

architecture rtl of gpio is

  subtype pins_t is std_ulogic_vector(pins - 1 downto 0);

  signal levels, before : pins_t;
  signal read_words     : word_vector_t(0 to 5);
  signal write_words    : word_vector_t(0 to 5);
  signal written        : std_ulogic_vector(0 to 5);

begin

  assert pins <= data_width
    report "gpio: " & integer'image(pins) & " pins do not fit a word of " & integer'image(data_width) & " bits"
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "011111", data_width => data_width, snapshot => true)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  inputs : entity work.input_filter
    generic map (width => pins, stable_clocks => stable_clocks)
    port map (clock => clock, reset => reset, pins => pin_in, levels => levels);

  read_words <= (
    0 => extended(levels),
    2 => extended(write_words(2)(pins_t'range)),
    5 => extended(write_words(5)(pins_t'range)),
    others => extended(pin_out));

  pin_drive <= write_words(2)(pins_t'range);

  process (clock) is
  begin
    if rising_edge(clock) then
      if written(1) = '1' then
        pin_out <= write_words(1)(pins_t'range);
      elsif written(3) = '1' then
        pin_out <= pin_out or write_words(3)(pins_t'range);
      elsif written(4) = '1' then
        pin_out <= pin_out and not write_words(4)(pins_t'range);
      end if;

      before  <= levels;
      changed <= or ((levels xor before) and write_words(5)(pins_t'range));

      if reset = '1' then
        pin_out <= (others => '0');
        changed <= '0';
      end if;
    end if;
  end process;

end architecture;
