-- SPDX-License-Identifier: BSD-3-Clause
--
-- A clock that all nodes of a TosNet ring share. Its unit is a bit of the line, 80 ns at 12.5 Mbit/s.
--
--   master: own clock at a strobe + a cycle --> OUT word at `address` --> slaves: own clock at the next strobe
--
-- Use       In each node beside tosnet_node with exact_hops, whose strobes are at the same moment everywhere. The
--           master gives `word` for send_address = `address`, an OUT word of its own. The slaves take it from what
--           they receive.
-- Master    Its clock runs freely. After each strobe, the word is the time at which the next one is due: the cycle is
--           as long as the last one that was fresh. It is zero until the first two fresh strobes.
-- Slave     With each fresh strobe it compares its clock with the word that came in this cycle. If it is behind, the
--           clock is set. If it is up to hold_bits ahead, the clock stands still for so long: it never runs backwards
--           while `valid` is high. If it is farther off, it is set, and `valid` is low until the next strobe.
-- Valid     In a slave, from the first comparison that fits until the ring stops. In a master, always while it runs.
-- Exact     Between two nodes: what their strobes differ, one bit, and what their crystals drift in a cycle.
-- Reset     `now_bits` is zero, and not valid.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;

entity tosnet_clock is
  generic (
    address        : natural range 0 to 1023; -- of the OUT word in the shared memory
    clocks_per_bit : positive := 4;
    hold_bits      : positive := 16
  );
  port (
    clock            : in  std_ulogic;
    reset            : in  std_ulogic; -- synchronous
    running          : in  std_ulogic; -- all of these from tosnet_node
    is_master        : in  std_ulogic;
    strobe           : in  std_ulogic;
    strobe_fresh     : in  std_ulogic;
    received_valid   : in  std_ulogic;
    received_address : in  std_ulogic_vector(9 downto 0);
    received_word    : in  std_ulogic_vector(31 downto 0);
    word             : out std_ulogic_vector(31 downto 0);

    valid    : out std_ulogic;
    now_bits : out unsigned(31 downto 0)
  );
end entity;

architecture rtl of tosnet_clock is

  signal passed   : natural range 0 to clocks_per_bit - 1 := 0; -- clocks of the bit
  signal time_now : unsigned(31 downto 0) := (others => '0');
  signal held     : natural range 0 to hold_bits := 0; -- bits for which the clock stands still
  signal due      : unsigned(31 downto 0) := (others => '0'); -- at the master: what it sends
  signal last     : unsigned(31 downto 0) := (others => '0'); -- … its last strobe
  signal known    : std_ulogic := '0';                        -- … that was fresh
  signal cycle    : unsigned(31 downto 0) := (others => '0'); -- … its last fresh cycle; zero: none yet
  signal came     : unsigned(31 downto 0) := (others => '0'); -- at a slave: the word of this cycle
  signal fits     : std_ulogic := '0';

begin

  word     <= std_ulogic_vector(due);
  now_bits <= time_now;
  valid    <= running and (is_master or fits);

  process (clock) is
    variable behind : signed(31 downto 0);
  begin
    if rising_edge(clock) then
      if passed < clocks_per_bit - 1 then
        passed <= passed + 1;
      else
        passed <= 0;
        if held > 0 then
          held <= held - 1;
        else
          time_now <= time_now + 1;
        end if;
      end if;

      if received_valid = '1' and unsigned(received_address) = address then
        came <= unsigned(received_word);
      end if;

      behind := signed(came - time_now);
      if strobe = '1' and is_master = '1' then
        last  <= time_now;
        known <= strobe_fresh;
        if (strobe_fresh and known) = '1' then
          cycle <= time_now - last;
          due   <= time_now + (time_now - last);
        elsif cycle /= 0 then
          due <= time_now + cycle;
        end if;
      elsif strobe = '1' and strobe_fresh = '1' and came /= 0 then
        fits <= '1';
        held <= 0;
        came <= (others => '0');
        if behind < 0 and behind >= -hold_bits then
          held <= to_integer(-behind);
        elsif behind /= 0 then
          time_now <= came;
          passed   <= 0;
          fits     <= to_bit(behind > 0 and behind <= hold_bits);
        end if;
      end if;

      if running = '0' then
        known <= '0';
        fits  <= '0';
        held  <= 0;
        due   <= (others => '0');
        came  <= (others => '0');
        cycle <= (others => '0');
      end if;
      if reset = '1' then
        time_now <= (others => '0');
        passed   <= 0;
        fits     <= '0';
      end if;
    end if;
  end process;

end architecture;
