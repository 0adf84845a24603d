-- SPDX-License-Identifier: BSD-3-Clause
--
-- The network cycle of TosNet, as its bus slave sees it. It decides when words are exchanged, and counts events of the
-- network.
--
-- ends      High in the clock that ends a cycle, every cycle_clocks, also while the network is offline. With
--           cycle_clocks = 0 a ring decides: ends is network_cycle.
-- exchange  The same, but only while it is online. In this clock commits take effect and words travel.
-- Counts    packets: exchanges. errors: clocks of `damaged`. resets: how often the network came back.
-- halted    More than max_skipped_writes exchanges in a row had no pending commit. It ends when the network comes back.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;

entity tosnet_cycle is
  generic (
    cycle_clocks       : natural                  := 5000; -- 0: network_cycle
    max_skipped_writes : natural range 0 to 65535 := 0 -- 0 means that it never halts
  );
  port (
    clock   : in std_ulogic;
    reset   : in std_ulogic; -- synchronous
    online  : in std_ulogic;
    damaged : in std_ulogic; -- one clock for each damaged cycle
    pending : in std_ulogic; -- with exchange: a commit is pending
    network_cycle : in std_ulogic := '0';

    ends         : out std_ulogic;
    exchange     : out std_ulogic;
    was_online   : out std_ulogic; -- one clock ago, as in the status
    packet_error : out std_ulogic; -- this cycle was damaged
    halted       : out std_ulogic;
    read_pointer : out std_ulogic; -- changes with every cycle
    packets      : out unsigned(31 downto 0);
    resets       : out unsigned(31 downto 0);
    errors       : out unsigned(31 downto 0)
  );
end entity;

architecture rtl of tosnet_cycle is

  signal passed  : natural range 0 to maximum(cycle_clocks, 1) - 1;
  signal skipped : natural range 0 to max_skipped_writes + 1;

begin

  ends     <= network_cycle when cycle_clocks = 0 else to_bit(passed = cycle_clocks - 1);
  exchange <= ends and online;

  process (clock) is
    variable idle : natural range 0 to max_skipped_writes + 1;
  begin
    if rising_edge(clock) then
      idle       := skipped;
      was_online <= online;
      if online = '1' and was_online = '0' then
        resets <= resets + 1;
        halted <= '0';
        idle   := 0;
      end if;
      if damaged = '1' then
        errors       <= errors + 1;
        packet_error <= '1';
      end if;
      if ends = '1' then
        passed       <= 0;
        read_pointer <= not read_pointer;
      elsif cycle_clocks > 0 then
        passed <= passed + 1;
      end if;
      if exchange = '1' then
        packets      <= packets + 1;
        packet_error <= '0';
        if pending = '1' then
          idle := 0;
        elsif max_skipped_writes > 0 then
          if idle >= max_skipped_writes then
            halted <= '1';
          else
            idle := idle + 1;
          end if;
        end if;
      end if;
      skipped <= idle;

      if reset = '1' then
        passed       <= 0;
        skipped      <= 0;
        was_online   <= online;
        packet_error <= '0';
        halted       <= '0';
        read_pointer <= '0';
        packets      <= (others => '0');
        resets       <= (others => '0');
        errors       <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
