-- SPDX-License-Identifier: BSD-3-Clause
--
-- A Wishbone between two clocks: a master on one clock reaches slaves on another, of any ratio and phase.
--
--   master_clock                                              slave_clock
--   master_m2s --> | access, stands still | -- toggle --> | asks the slave | --> slave_m2s
--   master_s2m <-- | answer               | <-- toggle -- | stands still   | <-- slave_s2m
--
-- Block      cyc of the slaves follows that of the master: it rises with the first access, and falls when the master's
--            has fallen. It is low between two blocks, so slaves that keep one moment keep it for the same accesses.
-- Latency    About 4 clocks of the slaves, their own clocks, and about 4 of the master. The end of a block takes the
--            same, while the next block waits.
-- Errors     err is passed on. After `timeout_clocks` of the slaves without an answer the access ends with err, and cyc
--            falls. A master that gives up early (cyc falls) gets no answer to that access later.
-- Pressure   The master waits. Give it a longer timeout than this one, counted in its own clocks.
-- Reset      Each is synchronous to its clock, and may come alone. No access is repeated. master_reset drops the one in
--            hand: the slave may still do it, and the next access waits for that. slave_reset ends it with err.

library ieee;
  use ieee.std_logic_1164.all;
  use work.protocol_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_crossing is
  generic (
    timeout_clocks : positive := limits_bus_timeout_clocks_c
  );
  port (
    master_clock : in  std_ulogic;
    master_reset : in  std_ulogic;
    master_m2s   : in  wishbone_m2s_t;
    master_s2m   : out wishbone_s2m_t;

    slave_clock  : in  std_ulogic;
    slave_reset  : in  std_ulogic;
    slave_m2s    : out wishbone_m2s_t;
    slave_s2m    : in  wishbone_s2m_t
  );
end entity;

architecture rtl of wishbone_crossing is

  subtype access_t is std_ulogic_vector(69 downto 0); -- 1: an access, 0: the end of a block; we, sel, adr, dat
  subtype answer_t is std_ulogic_vector(32 downto 0); -- refused, dat

  -- Of the master.
  signal access_held    : access_t   := (others => '0');
  signal asked          : std_ulogic := '0'; -- toggles with it
  signal done_seen      : std_ulogic;
  signal waiting        : std_ulogic := '0'; -- for the slave's side
  signal wanted         : std_ulogic := '0'; -- the master still waits for this answer
  signal is_open        : std_ulogic := '0'; -- the slaves see a block
  signal is_over        : std_ulogic := '0'; -- … which the master has ended
  signal answer_crossed : answer_t   := (others => '0');
  signal answered       : std_ulogic := '0';

  -- Of the slaves.
  type state_t is (idle, looking, asking);
  signal state          : state_t    := idle;
  signal asked_seen     : std_ulogic;
  signal access_crossed : access_t   := (others => '0');
  signal answer_held    : answer_t   := (others => '0');
  signal done           : std_ulogic := '0'; -- becomes `asked` when that is done
  signal cycle          : std_ulogic := '0';
  signal waited         : natural range 0 to timeout_clocks - 1 := 0;

begin

  asked_synchroniser : entity work.synchroniser
    port map (clock => slave_clock, asynchronous(0) => asked, levels(0) => asked_seen);

  done_synchroniser : entity work.synchroniser
    port map (clock => master_clock, asynchronous(0) => done, levels(0) => done_seen);

  respond : process (all) is
    variable asks : std_ulogic;
  begin
    asks           := answered and master_m2s.cyc and master_m2s.stb;
    master_s2m     <= wishbone_s2m_idle;
    master_s2m.ack <= asks and not answer_crossed(32);
    master_s2m.err <= asks and answer_crossed(32);
    master_s2m.dat <= answer_crossed(31 downto 0);
  end process;

  master_side : process (master_clock) is
  begin
    if rising_edge(master_clock) then
      answered <= '0';
      is_over  <= is_over or (is_open and not master_m2s.cyc);
      wanted   <= wanted and master_m2s.cyc and master_m2s.stb;
      if waiting = '1' then
        if done_seen = asked then
          waiting        <= '0';
          answer_crossed <= answer_held;
          answered       <= wanted and master_m2s.cyc and master_m2s.stb;
        end if;
      elsif is_over = '1' then
        access_held(69) <= '0';
        asked           <= not asked;
        waiting         <= '1';
        wanted          <= '0';
        is_open         <= '0';
        is_over         <= '0';
      elsif master_m2s.cyc = '1' and master_m2s.stb = '1' and answered = '0' then
        access_held <= '1' & master_m2s.we & master_m2s.sel & master_m2s.adr & master_m2s.dat;
        asked       <= not asked;
        waiting     <= '1';
        wanted      <= '1';
        is_open     <= '1';
      end if;

      if master_reset = '1' then -- what is asked stays asked, because the slave's side may not be in reset
        asked    <= asked;
        waiting  <= '1';
        wanted   <= '0';
        is_open  <= is_open;
        is_over  <= is_open;
        answered <= '0';
      end if;
    end if;
  end process;

  ask : process (all) is
  begin
    slave_m2s     <= wishbone_m2s_idle;
    slave_m2s.cyc <= cycle;
    slave_m2s.we  <= access_crossed(68);
    slave_m2s.sel <= access_crossed(67 downto 64);
    slave_m2s.adr <= access_crossed(63 downto 32);
    slave_m2s.dat <= access_crossed(31 downto 0);
    if state = asking then
      slave_m2s.stb <= '1';
    end if;
  end process;

  slave_side : process (slave_clock) is
  begin
    if rising_edge(slave_clock) then
      case state is
        when idle =>
          if asked_seen /= done then
            access_crossed <= access_held;
            state          <= looking;
          end if;

        when looking =>
          cycle  <= access_crossed(69);
          waited <= 0;
          if access_crossed(69) = '1' then
            state <= asking;
          else
            done  <= asked_seen;
            state <= idle;
          end if;

        when asking =>
          if slave_s2m.ack = '1' or slave_s2m.err = '1' or waited = timeout_clocks - 1 then
            answer_held <= not slave_s2m.ack & slave_s2m.dat;
            cycle       <= slave_s2m.ack or slave_s2m.err;
            done        <= asked_seen;
            state       <= idle;
          else
            waited <= waited + 1;
          end if;
      end case;

      if slave_reset = '1' then -- what is asked now is refused
        state <= idle;
        done  <= asked_seen;
        cycle <= '0';
        if done /= asked_seen then
          answer_held(32) <= '1';
        end if;
      end if;
    end if;
  end process;

end architecture;
