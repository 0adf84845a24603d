-- SPDX-License-Identifier: BSD-3-Clause
--
-- When things happen in a running TosNet ring: the strobe, the master's next packet, and the watchdogs.
--
-- Strobe    High for one clock, in all nodes at the same time, after each DATA packet: a slave waits a hop for each
--           node that is still to come, the master not at all. With it, strobe_fresh says that the packet was fresh.
-- Send      The master sends its first packet pause_clocks after `begins`, and each further one pause_clocks after its
--           strobe.
-- Step      While `hold` is high, a packet that is to be sent waits, and `due` is high. `give_up`: a packet that has
--           not come back is lost now. So the master of two rings sends into both at once (tosnet_rings).
-- Lost      A packet of the master that has not come back (nodes + 6) hops after it was sent is lost. The master has a
--           strobe that is not fresh, and goes on. The slaves have none.
-- Way       The time from the master's packet to its return is the same in each cycle, but for a symbol a hop. If it
--           differs from the one before by half a hop, a node has gone or come without a gap on the line. Then the
--           strobe is not fresh, and `way_changed` is high for one clock.
-- Silence   `silence` is high for one clock when no good packet has come for watchdog_clocks.
-- Reset     Nothing runs. The watchdog starts.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.width_pkg.all;

entity tosnet_timing is
  generic (
    hop_clocks      : positive := 300;
    pause_clocks    : positive := 192; -- at most hop_clocks
    watchdog_clocks : positive := 655360 -- at least 2
  );
  port (
    clock       : in std_ulogic;
    reset       : in std_ulogic; -- synchronous
    running     : in std_ulogic;
    begins      : in std_ulogic;
    is_master   : in std_ulogic;
    own_address : in unsigned(3 downto 0);
    nodes       : in unsigned(3 downto 0);
    good_packet : in std_ulogic; -- any packet
    packet_done : in std_ulogic; -- a DATA packet
    fresh       : in std_ulogic;
    sent        : in std_ulogic;
    hold        : in std_ulogic := '0';
    give_up     : in std_ulogic := '0';

    strobe       : out std_ulogic;
    strobe_fresh : out std_ulogic;
    send         : out std_ulogic;
    due          : out std_ulogic := '0';
    lost         : out std_ulogic;
    way_changed  : out std_ulogic;
    silence      : out std_ulogic
  );
end entity;

architecture rtl of tosnet_timing is

  constant patience : positive := 6;

  type state_t is (quiet, to_strobe, to_send, to_return);

  signal state  : state_t;
  signal hops   : natural range 0 to 15 + patience;
  signal clocks : natural range 0 to hop_clocks - 1;
  -- In steps of an eighth of a hop.
  constant step_clocks : positive := maximum(hop_clocks / 8, 1);
  signal step_passed   : natural range 0 to step_clocks - 1;
  signal way           : natural range 0 to 255;
  signal last_way      : natural range 0 to 255;
  signal way_known     : std_ulogic;

  -- Clocks that are left, less one. The first bit is high at the end.
  signal calm   : signed(bits_for(watchdog_clocks) downto 0);

begin

  process (clock) is
    variable next_state : state_t;
    variable next_hops  : natural range 0 to 15 + patience;
    variable ends       : boolean; -- a wait ends
  begin
    if rising_edge(clock) then
      strobe     <= '0';
      send       <= '0';
      lost       <= '0';
      way_changed <= '0';
      if step_passed < step_clocks - 1 then
        step_passed <= step_passed + 1;
      else
        step_passed <= 0;
        way         <= minimum(way, 254) + 1;
      end if;
      next_state := state;
      next_hops  := hops;
      ends       := false;
      if clocks < hop_clocks - 1 then
        clocks <= clocks + 1;
      else
        clocks    <= 0;
        ends      := hops <= 1 and state /= quiet;
        next_hops := maximum(hops, 1) - 1;
      end if;

      if packet_done = '1' and is_master = '0' then
        strobe_fresh <= fresh;
        next_state   := to_strobe;
        next_hops    := to_integer(nodes - own_address);
        clocks       <= 0;
      elsif (packet_done = '1' and state = to_return) or begins = '1' then
        strobe_fresh <= fresh;
        strobe       <= packet_done;
        last_way     <= way;
        way_known    <= packet_done;
        if packet_done = '1' and way_known = '1' and (way > last_way + 4 or way + 4 < last_way) then
          strobe_fresh <= '0';
          way_changed  <= '1';
        end if;
        next_state   := to_send when is_master = '1' else quiet;
        next_hops    := 1;
        clocks       <= hop_clocks - pause_clocks;
      elsif sent = '1' then
        next_state := to_return;
        next_hops  := to_integer(nodes) + patience;
        clocks     <= 0;
        way         <= 0;
        step_passed <= 0;
      elsif ends and state = to_strobe then
        strobe     <= '1';
        next_state := quiet;
      elsif ends and state = to_send then
        send       <= not hold;
        due        <= hold;
        next_state := quiet;
      elsif (due and not hold) = '1' then
        send <= '1';
        due  <= '0';
      elsif (ends or give_up = '1') and state = to_return then
        lost         <= '1';
        strobe       <= '1';
        strobe_fresh <= '0';
        next_state   := to_send;
        next_hops    := 1;
        clocks       <= 0;
      end if;
      if running = '0' and begins = '0' then
        next_state := quiet;
        strobe     <= '0';
        send       <= '0';
        due        <= '0';
      end if;
      state <= next_state;
      hops  <= next_hops;

      silence <= calm(calm'high) and not good_packet;
      calm    <= calm - 1;
      if (good_packet or calm(calm'high)) = '1' then
        calm <= to_signed(watchdog_clocks - 2, calm'length);
      end if;

      if reset = '1' then
        state   <= quiet;
        hops    <= 0;
        clocks  <= 0;
        strobe  <= '0';
        send    <= '0';
        due     <= '0';
        lost    <= '0';
        way_changed <= '0';
        way     <= 0;
        last_way <= 0;
        way_known <= '0';
        step_passed <= 0;
        calm    <= to_signed(watchdog_clocks - 2, calm'length);
        silence <= '0';
      end if;
    end if;
  end process;

end architecture;
