-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of estop. The bus may do anything at any clock, and so may the contacts. There are two contacts. The
-- filter is 3 clocks, and the watchdog 8.

library ieee;
  use ieee.std_logic_1164.all;

use work.wishbone_pkg.all;

entity estop_formal is
  port (
    clk    : in std_ulogic;
    reset  : in std_ulogic;
    m2s    : in wishbone_m2s_t;
    chain  : in std_ulogic_vector(1 downto 0);
    enable : in std_ulogic; -- shows the bit of the design
    fed    : in std_ulogic  -- shows that the PC has written `feed`
  );
end entity;

architecture properties of estop_formal is

  constant filter_clocks   : positive := 3;
  constant watchdog_clocks : positive := 8;
  constant synchronised    : positive := 2; -- clocks that the contacts take to come in
  constant decided         : positive := synchronised + 1;

  signal s2m             : wishbone_s2m_t;
  signal tripped, run    : std_ulogic;
  signal begun           : std_ulogic := '0';
  signal run_1           : std_ulogic := '0';
  signal tripped_1       : std_ulogic := '0';
  signal reset_1         : std_ulogic := '1';
  signal broken          : natural range 0 to filter_clocks + decided := 0; -- clocks with an open contact
  signal silent          : natural range 0 to watchdog_clocks + 1 := 0;   -- clocks of `run` without a feed
  signal closed          : std_ulogic_vector(1 to decided) := "000"; -- all were, so many clocks ago
  signal off_1           : std_ulogic := '0';                             -- enable was 0 a clock ago
  signal risen           : std_ulogic := '0';                             -- enable has risen a clock ago

begin

  default clock is rising_edge(clk);

  dut : entity work.estop
    generic map (clock_hz => 8_000, inputs => 2, filter_us => 375, watchdog_ms => 1, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, tripped => tripped, chain => chain,
      run => run);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun     <= '1';
      run_1     <= run;
      tripped_1 <= tripped;
      reset_1   <= reset;
      closed    <= (and chain) & closed(1 to synchronised);
      off_1     <= not enable;
      risen      <= enable and off_1;

      broken <= 0;
      if (and chain) = '0' then
        broken <= minimum(broken + 1, filter_clocks + decided);
      end if;

      silent <= 0;
      if run = '1' and fed = '0' then
        silent <= minimum(silent + 1, watchdog_clocks + 1);
      end if;

      if reset = '1' then
        closed <= "000";
        broken <= 0;
        off_1  <= '0';
        risen   <= '0';
        silent <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A chain that has been open for the filter stops, 3 clocks after it was over.
  open_stops : assert always begun = '1' and broken = filter_clocks + decided -> run = '0';

  -- A silent PC stops: run is never high for longer than the watchdog without a feed.
  silence_stops : assert always begun = '1' and silent = watchdog_clocks + 1 -> run = '0';

  -- Without enable it stops a clock later.
  disable_stops : assert always begun = '1' and off_1 = '1' -> run = '0';

  -- It starts only when enable rises, and when all contacts were closed as the chain came in.
  start_is_asked : assert always begun = '1' and run = '1' and run_1 = '0' -> risen = '1' and closed(decided) = '1';

  -- The event is there when it stops though enable is on.
  stop_is_told : assert always begun = '1' and reset_1 = '0' and run = '0' and run_1 = '1' and off_1 = '0' ->
                          tripped = '1';

  -- The event lasts a clock.
  told_once : assert always begun = '1' and tripped_1 = '1' -> tripped = '0';

  -- It comes when run falls, and at no other time.
  nothing_else_is_told : assert always begun = '1' and tripped = '1' -> run = '0' and run_1 = '1';

  -- It runs longer than the watchdog, because it is fed.
  fed_seen : cover {begun = '1' and risen = '1' and run = '1'; (run = '1')[*12]};

  -- The chain stops it.
  open_seen : cover {begun = '1' and run = '1' and silent < 3; tripped = '1'};

end architecture;
