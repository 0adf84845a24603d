-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of wishbone_crossing, between two clocks with any timing that z3 chooses. The master does not give up, and
-- the slave answers when it likes.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity wishbone_crossing_formal is
  port (
    master_clk : in std_ulogic;
    slave_clk  : in std_ulogic;
    ask        : in std_ulogic; -- the master begins an access, if it has none
    let_go     : in std_ulogic; -- … or ends its block
    we         : in std_ulogic;
    adr        : in std_ulogic_vector(1 downto 0);
    dat        : in std_ulogic_vector(1 downto 0);
    ack        : in std_ulogic;
    err        : in std_ulogic;
    word       : in std_ulogic_vector(1 downto 0)
  );
end entity;

architecture properties of wishbone_crossing_formal is

  subtype number_t is unsigned(1 downto 0); -- of an access modulo 4; at most one is on its way

  -- A master that keeps its access until the answer.
  signal cyc, stb, wr   : std_ulogic := '0';
  signal where, what    : std_ulogic_vector(1 downto 0) := "00";
  signal m2s, slave_m2s : wishbone_m2s_t;
  signal s2m, slave_s2m : wishbone_s2m_t;
  signal answers        : std_ulogic;
  signal begun, ended   : number_t := "00"; -- accesses of the master

  -- What the slave has done last.
  signal did         : number_t := "00";
  signal did_refuse  : std_ulogic := '0';
  signal did_word    : std_ulogic_vector(1 downto 0) := "00";
  signal fits        : boolean;           -- the slave is asked what the master asks
  signal passes_back : boolean;           -- the master has what the slave has answered

begin

  default clock is rising_edge(slave_clk);

  dut : entity work.wishbone_crossing
    generic map (timeout_clocks => 8)
    port map (
      master_clock => master_clk, master_reset => '0', master_m2s => m2s, master_s2m => s2m,
      slave_clock => slave_clk, slave_reset => '0', slave_m2s => slave_m2s, slave_s2m => slave_s2m);

  answers <= s2m.ack or s2m.err;

  say : process (all) is
  begin
    m2s     <= wishbone_m2s_idle;
    m2s.cyc <= cyc;
    m2s.stb <= stb;
    m2s.we  <= wr;
    m2s.adr(1 downto 0) <= where;
    m2s.dat(1 downto 0) <= what;
  end process;

  serve : process (all) is
  begin
    slave_s2m     <= wishbone_s2m_idle;
    slave_s2m.ack <= ack and slave_m2s.stb;
    slave_s2m.err <= err and not ack and slave_m2s.stb;
    slave_s2m.dat(1 downto 0) <= word;
  end process;

  master : process (master_clk) is
  begin
    if rising_edge(master_clk) then
      if stb = '0' then
        if ask = '1' then
          cyc   <= '1';
          stb   <= '1';
          wr    <= we;
          where <= adr;
          what  <= dat;
          begun <= begun + 1;
        elsif let_go = '1' then
          cyc <= '0';
        end if;
      elsif answers = '1' then
        stb   <= '0';
        ended <= ended + 1;
      end if;
    end if;
  end process;

  fits <= m2s.stb = '1' and slave_m2s.we = m2s.we and slave_m2s.adr = m2s.adr and slave_m2s.dat = m2s.dat;

  slave : process (slave_clk) is
  begin
    if rising_edge(slave_clk) then
      if slave_m2s.stb = '1' and (slave_s2m.ack = '1' or slave_s2m.err = '1') then
        did        <= did + 1;
        did_refuse <= slave_s2m.err;
        did_word   <= word;
      end if;
    end if;
  end process;

  passes_back <= did = begun and s2m.err = did_refuse and s2m.dat(1 downto 0) = did_word;

  -- The slave is asked what the master asks, while it asks, and once.
  asks_what_was_asked : assert always slave_m2s.stb = '1' -> fits and did = ended;

  -- The slave is asked within a cycle.
  strobe_in_cycle : assert always slave_m2s.stb = '1' -> slave_m2s.cyc = '1';

  -- The master has an answer only when the slave has given it, and it is the same one.
  answer_is_the_slaves : assert always answers = '1' -> passes_back;

  -- A read comes back.
  answered_seen : cover {answers = '1'};

end architecture;
