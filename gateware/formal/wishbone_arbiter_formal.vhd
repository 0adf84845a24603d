-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the arbiter with three masters that do anything a master may, and a slave that does anything a slave
-- may. The lowest bits of an address say here whose it is.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity wishbone_arbiter_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s_0 : in wishbone_m2s_t;
    m2s_1 : in wishbone_m2s_t;
    m2s_2 : in wishbone_m2s_t;
    s2m   : in wishbone_s2m_t
  );
end entity;

architecture properties of wishbone_arbiter_formal is

  signal begun       : std_ulogic := '0';
  signal masters_m2s : wishbone_m2s_vector_t(0 to 2);
  signal masters_s2m : wishbone_s2m_vector_t(0 to 2);
  signal slave_m2s   : wishbone_m2s_t;

  signal owner   : natural range 0 to 3;                             -- by the address on the bus
  signal holder  : natural range 0 to 3 := 3;                        -- the one of the clock before; 3: none
  signal cycles  : std_ulogic_vector(0 to 2);
  signal answers : std_ulogic_vector(0 to 2);
  signal right   : boolean;                                          -- the bus has what its owner says
  signal back    : boolean;                                          -- its owner has what the slave answers
  signal stays   : boolean;                                          -- the cycle of the clock before is still open

  type turns_t is array (0 to 2) of natural range 0 to 3;
  signal turns : turns_t := (others => 0);                           -- of others, that began while a master waited

begin

  default clock is rising_edge(clk);

  masters_m2s <= (m2s_0, m2s_1, m2s_2);

  dut : entity work.wishbone_arbiter
    generic map (masters => 3)
    port map (
      clock => clk, reset => reset, masters_m2s => masters_m2s, masters_s2m => masters_s2m,
      slave_m2s => slave_m2s, slave_s2m => s2m);

  slave : entity work.wishbone_master_view port map (clk => clk, reset => reset, m2s => slave_m2s, s2m => s2m);
  masters : for master in 0 to 2 generate
    each : entity work.wishbone_slave_view
      port map (clk => clk, reset => reset, m2s => masters_m2s(master), s2m => masters_s2m(master));
    cycles(master)  <= masters_m2s(master).cyc;
    answers(master) <= masters_s2m(master).ack or masters_s2m(master).err;
  end generate;

  owner <= to_integer(unsigned(slave_m2s.adr(1 downto 0)));
  right <= slave_m2s = masters_m2s(owner) when owner < 3 else false;
  back  <= masters_s2m(owner) = s2m when owner < 3 else false;
  stays <= cycles(holder) = '1' when holder < 3 else false;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun  <= '1';
      holder <= 3;
      if slave_m2s.cyc = '1' then
        holder <= owner;
      end if;
      for master in 0 to 2 loop
        if cycles(master) = '0' or owner = master then
          turns(master) <= 0;
        elsif slave_m2s.cyc = '1' and not stays and turns(master) < 3 then
          turns(master) <= turns(master) + 1;
        end if;
      end loop;
      if reset = '1' then
        holder <= 3;
        turns  <= (others => 0);
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- Master 0 has addresses of its own.
  marked_0 : assume always m2s_0.adr(1 downto 0) = "00";

  -- Master 1 has addresses of its own.
  marked_1 : assume always m2s_1.adr(1 downto 0) = "01";

  -- Master 2 has addresses of its own.
  marked_2 : assume always m2s_2.adr(1 downto 0) = "10";

  -- The bus has all that one of the masters says, and nothing else.
  is_one_of_them : assert always right;

  -- While a master wants the bus, it is free for one clock between two turns only.
  never_idle : assert always begun = '0' or cycles = "000" or slave_m2s.cyc = '1' or holder /= 3;

  -- Between the turns of two masters it is free.
  free_between : assert always begun = '1' and holder /= 3 and slave_m2s.cyc = '1' -> owner = holder;

  -- The owner gets the answer of the slave in the same clock.
  answer_comes_back : assert always back;

  -- No other master gets an answer.
  no_other_answer : assert always (answers = "000" or slave_m2s.cyc = '1') and
                    (answers(0) = '0' or owner = 0) and (answers(1) = '0' or owner = 1) and
                    (answers(2) = '0' or owner = 2);

  -- A master keeps the bus until its cyc falls.
  locked : assert always begun = '1' and stays -> owner = holder;

  -- A master waits for at most one turn of each other.
  fair : assert always turns(0) <= 2 and turns(1) <= 2 and turns(2) <= 2;

  -- A master waits for both others.
  both_waited_for : cover {begun = '1' and turns(0) = 2};

end architecture;
