-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the carrier with a constant, two words of the ring and two registers to read, on a bus whose slaves
-- answer in the second clock of an access. Each word is 32 times one bit, which changes at any exchange.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_carrier_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    running  : in std_ulogic;
    exchange : in std_ulogic;
    bits     : in std_ulogic_vector(0 to 2); -- the words
    which    : in natural range 0 to 2;      -- the word that is looked at
    s2m      : in wishbone_s2m_t
  );
end entity;

architecture properties of tosnet_carrier_formal is

  constant constants : natural  := 1;
  constant writes    : positive := 3;
  constant reads     : positive := 2;
  constant latest    : positive := 2 * (reads + writes); -- clocks from there until it is written

  signal begun    : std_ulogic := '0';
  signal m2s      : wishbone_m2s_t;
  signal given    : word_vector_t(0 to writes - 1);
  signal taken    : word_vector_t(0 to reads - 1);
  signal answered : std_ulogic;
  signal waits    : std_ulogic := '0'; -- an access was asked for in the clock before
  signal ran      : std_ulogic := '0';
  signal is_due   : std_ulogic := '0'; -- the word may be new, and is not written since then
  signal age      : natural range 0 to latest + 1 := 0;
  signal chosen   : natural range 0 to 2 := 0;
  signal old_bits : std_ulogic_vector(0 to 2) := "000";
  signal place    : unsigned(31 downto 0);
  signal is_word  : std_ulogic; -- this clock writes the word as it is now
  signal at_first : std_ulogic; -- this clock reads the first register

begin

  default clock is rising_edge(clk);

  each : for word in given'range generate
    given(word) <= (others => bits(word));
  end generate;

  dut : entity work.tosnet_carrier
    generic map (write_addresses => (1, 2, 3), read_addresses => (8, 9), constants => constants)
    port map (
      clock => clk, reset => reset, running => running, exchange => exchange, write_words => given,
      read_words => taken, wishbone_m2s => m2s, wishbone_s2m => s2m);

  bus_rules : entity work.wishbone_master_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  place    <= unsigned(m2s.adr);
  answered <= s2m.ack or s2m.err;
  is_word  <= answered and m2s.we and to_bit(place = which + 1) and to_bit(m2s.dat(0) = bits(which));
  at_first <= answered and not m2s.we and to_bit(place = 8);

  follow : process (clk) is
    variable changes : std_ulogic;
  begin
    if rising_edge(clk) then
      begun  <= '1';
      chosen <= which;
      old_bits <= bits;
      ran    <= running;
      waits  <= m2s.stb and not answered;
      changes := (running xor ran) or (exchange and to_bit(which >= constants));
      if changes = '1' then
        is_due <= '1';
        age    <= 0;
      elsif is_word = '1' then
        is_due <= '0';
        age    <= 0;
      elsif is_due = '1' and age <= latest then
        age <= age + 1;
      end if;
      if reset = '1' then
        is_due <= '1';
        age    <= 0;
        ran    <= '0';
        waits  <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The word that is looked at stays the same.
  one_word : assume always begun = '0' or which = chosen;

  -- There are three words.
  three_words : assume always which <= 2;

  -- A slave answers in the second clock of an access.
  answers : assume always answered = (waits and m2s.stb);

  -- Words change with an exchange; the constant changes with `running`.
  words_change : assume always begun = '0' or (bits(1 to 2) = old_bits(1 to 2) or exchange = '1');

  -- The constant changes with `running`.
  constant_changes : assume always begun = '0' or bits(0) = old_bits(0) or running /= ran;

  -- A new word is in its register in time.
  in_time : assert always age <= latest;

  -- Nothing but the words goes to the registers, each to its own.
  own_word : assert always m2s.stb = '0' or m2s.we = '0' or (place >= 1 and place <= writes);

  -- Only the registers to read are read.
  own_read : assert always m2s.stb = '0' or m2s.we = '1' or place = 8 or place = 9;

  -- A block of reads is not left before its end.
  one_block : assert always at_first = '1' and reset = '0' -> next (m2s.cyc = '1' and place = 9);

  -- A word may be due.
  can_be_due : cover {is_due = '1' and age = 5};

  -- A block of reads comes to its end.
  can_read : cover {answered = '1' and place = 9};

end architecture;
