-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of two pins without a filter. A reference follows the pins, and the writes that were acknowledged.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity gpio_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    m2s    : in wishbone_m2s_t;
    pin_in : in std_ulogic_vector(1 downto 0)
  );
end entity;

architecture properties of gpio_formal is

  subtype pins_t is std_ulogic_vector(1 downto 0);
  type history_t is array (1 to 5) of pins_t;

  signal s2m       : wishbone_s2m_t;
  signal changed   : std_ulogic;
  signal pin_out   : pins_t;
  signal pin_drive : pins_t;
  signal begun     : std_ulogic := '0';
  signal clocks    : natural range 0 to 6 := 0;        -- since power-up
  signal asked     : std_ulogic := '0';
  signal answered  : std_ulogic;
  signal whole     : std_ulogic;                       -- a write, if it is one, is of a whole word
  signal write     : std_ulogic;                       -- a write ends in this clock
  signal bits      : pins_t;
  signal history   : history_t := (others => "00");    -- the pins, so many clocks ago
  signal frozen    : pins_t := "00";                   -- the level for reads in this block
  signal outputs   : pins_t := "00";
  signal direction : pins_t;
  signal was_direction : pins_t := "00";
  signal watch     : pins_t;
  signal was_watch : pins_t := "00";
  signal due       : std_ulogic := '0';                -- the event of this clock

begin

  default clock is rising_edge(clk);

  dut : entity work.gpio
    generic map (pins => 2)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, changed => changed,
      pin_in => pin_in, pin_out => pin_out, pin_drive => pin_drive);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  answered  <= s2m.ack or s2m.err;
  whole     <= '1' when m2s.we = '0' or m2s.sel = "1111" else '0';
  write     <= s2m.ack and m2s.we;
  bits      <= m2s.dat(1 downto 0);
  direction <= bits when write = '1' and unsigned(m2s.adr) = 2 else was_direction;
  watch     <= bits when write = '1' and unsigned(m2s.adr) = 5 else was_watch;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      asked <= m2s.stb and not answered and not reset;
      if clocks < 6 then
        clocks <= clocks + 1;
      end if;
      history <= pin_in & history(1 to 4);
      if m2s.cyc = '0' then
        frozen <= history(3);
      end if;
      if write = '1' and unsigned(m2s.adr) = 1 then
        outputs <= bits;
      elsif write = '1' and unsigned(m2s.adr) = 3 then
        outputs <= outputs or bits;
      elsif write = '1' and unsigned(m2s.adr) = 4 then
        outputs <= outputs and not bits;
      end if;
      was_direction <= direction;
      was_watch     <= watch;
      due           <= or ((history(3) xor history(4)) and watch);
      if reset = '1' then
        outputs       <= "00";
        was_direction <= "00";
        was_watch     <= "00";
        due           <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no block during power-up.
  quiet_first : assume always clocks >= 6 or (m2s.cyc = '0' and m2s.stb = '0');

  -- The master waits for the answer to each access.
  patient : assume always m2s.stb = '1' and answered = '0' and reset = '0' -> next (m2s.stb = '1');

  -- Each output is as the writes to +1, +3 and +4 made it, one after the other.
  outputs_follow : assert always begun = '0' or pin_out = outputs;

  -- A pin is driven exactly if its bit was written to +2.
  driven_as_written : assert always begun = '0' or pin_drive = direction;

  -- A read of +0 gives the pins three clocks before the block of accesses began.
  levels_read : assert always clocks < 6 or s2m.ack = '0' or m2s.we = '1' or unsigned(m2s.adr) /= 0 or
                s2m.dat = 30x"0" & frozen;

  -- The event comes exactly if a watched pin has changed, five clocks after the change.
  event_of_change : assert always clocks < 6 or changed = due;

  -- Words beyond +5, writes to +0, and writes of a part of a word are refused.
  refused : assert always s2m.ack = '1' -> unsigned(m2s.adr) < 6 and whole = '1' and
            (m2s.we = '0' or unsigned(m2s.adr) /= 0);

  -- Nothing else is refused.
  only_these_refused : assert always s2m.err = '1' -> unsigned(m2s.adr) >= 6 or whole = '0' or
                       (m2s.we = '1' and unsigned(m2s.adr) = 0);

  -- An access takes two clocks.
  two_clocks : assert always asked = '0' or m2s.stb = '0' or answered = '1';

  -- One pin is set while another one stays.
  one_set : cover {write = '1' and unsigned(m2s.adr) = 3 and outputs = "01" and bits = "10"};

end architecture;
