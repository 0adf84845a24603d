-- SPDX-License-Identifier: BSD-3-Clause
--
-- A stop chain: the output `run` is high only while every contact of the chain is closed, and while the PC lives. It
-- falls without the PC.
--
--   +0  control: bit 0 enable; its rise starts, if the chain is closed; 0 stops
--   +1  status: bit 0 running, bit 1 tripped, bit 2 late: the PC was silent, bit 3 the chain is open now  (read only)
--   +2  chain: the contacts now; a closed one is 1                                                        (read only)
--   +3  opened: the contacts that were open when it tripped                                               (read only)
--   +4  feed: each write starts the time of the watchdog anew; reads 0
--
--   enable  ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾\__/‾‾‾‾
--   chain   ‾‾‾‾‾‾‾‾\_/‾\_____/‾‾‾‾‾‾‾    short openings are filtered
--   run     ____/‾‾‾‾‾‾‾‾‾\______/‾‾‾‾    closing again is not enough: enable must rise
--
-- Generics  inputs: contacts. closed_level: the level of a closed contact.
--           filter_us: the chain counts as open when some contact has been open for so long without a break. It is
--           rounded up to whole clocks.
--           watchdog_ms: the longest silence of the PC, rounded down to whole clocks; 0 for none.
-- Events    tripped: for one clock when the chain or the watchdog stops. Not when enable does.
-- Latency   2 clocks per access (register_slave). From a contact to `run` 3 clocks and the filter, for all that comes
--           from outside. From the write of control to `run` 2 clocks.
-- Errors    err for a write to +1 to +3 and for addresses from 5 on.
-- Reset     run is low, and from power-up on. enable must rise after it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity estop is
  generic (
    clock_hz     : positive                  := 50_000_000;
    inputs       : positive range 1 to 16    := 1;
    closed_level : natural range 0 to 1      := 1;
    filter_us    : natural range 0 to 10_000 := 100;
    watchdog_ms  : natural range 0 to 1000   := 0;
    data_width   : positive range 16 to 32   := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    tripped      : out std_ulogic;

    chain        : in  std_ulogic_vector(inputs - 1 downto 0); -- asynchronous
    run          : out std_ulogic
  );
end entity;

architecture rtl of estop is

  subtype chain_t is std_ulogic_vector(inputs - 1 downto 0);

  function level_of_open return std_ulogic is
  begin
    if closed_level = 1 then
      return '0';
    end if;
    return '1';
  end function;

  constant open_level      : std_ulogic := level_of_open;
  constant filter_clocks   : natural := (filter_us * ((clock_hz + 999) / 1000) + 999) / 1000;
  constant watchdog_clocks : natural := watchdog_ms * (clock_hz / 1000);

  signal read_words  : word_vector_t(0 to 4);
  signal write_words : word_vector_t(0 to 4);
  signal written     : std_ulogic_vector(0 to 4);

  signal enable, fed    : std_ulogic;
  signal levels         : chain_t;
  signal open_contacts  : chain_t;
  signal opened         : chain_t;
  signal is_open        : std_ulogic;
  signal open_clocks    : natural range 0 to filter_clocks;   -- for which the chain has been open
  signal silent_clocks  : natural range 0 to watchdog_clocks; -- since the last feed
  signal enabled_before : std_ulogic;
  signal running        : std_ulogic := '0'; -- off from power-up on
  signal has_tripped    : std_ulogic;
  signal late           : std_ulogic;

begin

  assert clock_hz >= 1000 and clock_hz <= 200_000_000
    report "estop: clock_hz must be 1 kHz to 200 MHz, got " & integer'image(clock_hz)
    severity failure;

  registers : entity work.register_slave
    generic map (writable => "10001", data_width => data_width)
    port map (
      clock => clock, reset => reset, wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m,
      read_words => read_words, write_words => write_words, written => written);

  read_words <= (
    0 => extended(write_words(0)(0 downto 0)),
    1 => (0 => running, 1 => has_tripped, 2 => late, 3 => is_open, others => '0'),
    2 => extended(not open_contacts),
    3 => extended(opened),
    4 => (others => '0'));

  contacts_synchroniser : entity work.synchroniser
    generic map (width => inputs, idle => open_level)
    port map (clock => clock, reset => reset, asynchronous => chain, levels => levels);

  enable        <= write_words(0)(0);
  fed           <= written(4);
  open_contacts <= levels xor (chain_t'range => not open_level);
  is_open       <= or open_contacts;
  run           <= running;

  process (clock) is
    variable breaks, silent : boolean;
  begin
    if rising_edge(clock) then
      breaks := is_open = '1' and open_clocks = filter_clocks;
      silent := watchdog_clocks > 0 and silent_clocks = watchdog_clocks;

      if is_open = '0' then
        open_clocks <= 0;
      elsif open_clocks /= filter_clocks then
        open_clocks <= open_clocks + 1;
      end if;

      if running = '0' or fed = '1' then
        silent_clocks <= 0;
      elsif silent_clocks /= watchdog_clocks then
        silent_clocks <= silent_clocks + 1;
      end if;

      enabled_before <= enable;
      tripped        <= '0';
      if running = '1' and (breaks or silent) then
        running     <= '0';
        has_tripped <= '1';
        tripped     <= '1';
        opened      <= open_contacts;
        if not breaks then
          late   <= '1';
          opened <= (others => '0');
        end if;
      elsif enable = '0' then
        running <= '0';
      elsif enabled_before = '0' and is_open = '0' then
        running     <= '1';
        has_tripped <= '0';
        late        <= '0';
        opened      <= (others => '0');
      end if;

      if reset = '1' then
        running        <= '0';
        has_tripped    <= '0';
        late           <= '0';
        tripped        <= '0';
        opened         <= (others => '0');
        open_clocks    <= 0;
        enabled_before <= '1';
      end if;
    end if;
  end process;

end architecture;
