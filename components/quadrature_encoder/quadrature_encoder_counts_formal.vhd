-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the words of one encoder, of 8 bits, with its index. A reference counts the steps at once, without
-- memories and turns. It knows only at which clock of a round a word is taken, and when it is shown. `in_place` says
-- how the registers and memories of the design belong to it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wishbone_pkg.all;

entity quadrature_encoder_counts_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s   : in wishbone_m2s_t;
    a     : in std_ulogic;
    b     : in std_ulogic;
    index : in std_ulogic;
    clocks      : in unsigned(3 downto 0); -- shows the clock in a round, as all of these show signals of the design
    begins      : in std_ulogic;           -- the first round
    shut        : in std_ulogic;           -- the bus must wait
    old         : in unsigned(1 downto 0); -- the bank of the last whole round
    bank        : in unsigned(1 downto 0); -- of this round
    for_bus     : in unsigned(1 downto 0);
    now         : in unsigned(2 downto 0); -- the word that is written
    sum         : in unsigned(7 downto 0); -- that is written
    steps       : in signed(5 downto 0);
    index_steps : in signed(5 downto 0);
    is_due, indexes, fails : in std_ulogic;
    a_was, b_was, index_was : in std_ulogic;
    reads       : in std_ulogic;
    puts        : in std_ulogic;           -- a write was taken, and is not acknowledged
    thaws       : in std_ulogic;
    acks, errs  : in std_ulogic
  );
end entity;

architecture properties of quadrature_encoder_counts_formal is

  subtype byte_t is unsigned(7 downto 0);
  type words_t is array (0 to 7) of byte_t;
  type memory_t is array (0 to 31) of byte_t;

  signal s2m             : wishbone_s2m_t;
  signal indexed, failed : std_ulogic;
  signal begun           : std_ulogic := '0';
  signal asked           : std_ulogic := '0';
  signal count           : unsigned(3 downto 0) := (others => '0');
  signal starting        : std_ulogic := '1';
  signal closed          : std_ulogic := '1';
  signal live            : words_t := (others => (others => '0'));
  signal whole           : words_t := (others => (others => '0'));
  signal shown           : words_t := (others => (others => '0'));
  signal window          : byte_t := (others => '0'); -- steps since the position was taken
  signal index_window    : byte_t := (others => '0'); -- those until the index
  signal has_index, due  : std_ulogic := '0';
  signal has_failed      : std_ulogic := '0';
  signal a_before, b_before, index_before : std_ulogic := '0';
  signal taken           : std_ulogic := '0';                    -- a write was, and its round has not ended
  signal takes_0         : std_ulogic := '0';                    -- the position was written in this round, with …
  signal given_0         : byte_t := (others => '0');
  signal thawed          : std_ulogic := '0';
  signal expected        : byte_t := (others => '0'); -- of a read that is answered now
  signal copy, bus_copy  : memory_t := (others => (others => '0')); -- the memories once more
  signal in_place        : std_ulogic;                -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.quadrature_encoder_counts
    generic map (with_index => 1, data_width => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m,
      indexed => indexed, failed => failed, a(0) => a, b(0) => b, index(0) => index);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  follow : process (clk) is
    variable gives : std_ulogic; -- the bus has a word for a register
    variable given, base, by, total : byte_t;
  begin
    if rising_edge(clk) then
      begun  <= '1';
      asked  <= m2s.stb and not s2m.ack and not s2m.err and not reset;
      a_before     <= a;
      b_before     <= b;
      index_before <= index;
      count        <= count + 1;
      expected     <= shown(to_integer(unsigned(m2s.adr(2 downto 0))));

      gives := m2s.cyc and m2s.stb and m2s.we and (and m2s.sel) and not s2m.ack and not s2m.err and not closed and
               nor m2s.adr(31 downto 3);
      given := unsigned(m2s.dat(byte_t'range));

      by := (others => '0');
      if ((a xor a_before) xor (b xor b_before)) = '1' then
        by := to_unsigned(255, 8);
        if a /= b_before then
          by := to_unsigned(1, 8);
        end if;
      end if;

      total := window + by;
      if count = 0 then
        base    := live(0);
        takes_0 <= '0';
        if gives = '1' and unsigned(m2s.adr(2 downto 0)) = 0 then
          base    := given;
          takes_0 <= '1';
          given_0 <= given;
        end if;
        live(0) <= base + window;
        total   := by;
        due     <= has_index;
        if has_index = '1' then
          live(1) <= base + index_window;
          live(2) <= live(2) + 1;
        end if;
      end if;
      window <= total;

      if count = 6 then
        base := live(3);
        if gives = '1' and unsigned(m2s.adr(2 downto 0)) = 3 then
          base := given;
        end if;
        live(3)    <= base + unsigned'("0000000" & has_failed);
        has_failed <= '0';
      end if;
      if a /= a_before and b /= b_before then
        has_failed <= '1';
      end if;

      -- An index is served within a round. Until then another one does not count.
      if count = 10 and due = '1' then
        has_index <= '0';
      end if;
      if index = '1' and index_before = '0' and has_index = '0' then
        has_index    <= '1';
        index_window <= total;
      end if;

      if count = 15 then
        whole    <= live;
        starting <= '0';
      end if;

      -- A write thaws the words from its answer on, which comes at the end of its round, until cyc falls.
      if gives = '1' and ((count = 0 and unsigned(m2s.adr(2 downto 0)) = 0) or
                          (count = 6 and unsigned(m2s.adr(2 downto 0)) = 3)) then
        taken <= '1';
      end if;
      if count = 15 then
        taken <= '0';
      end if;
      thawed <= m2s.cyc and (thawed or (taken and to_bit(count = 15)));

      closed <= starting;
      if m2s.cyc = '0' or thawed = '1' or closed = '1' then
        shown <= whole;
      end if;

      if starting = '1' or reset = '1' then
        live       <= (others => (others => '0'));
        window     <= (others => '0');
        has_failed <= '0';
        has_index  <= '0';
        due        <= '0';
      end if;

      for number in copy'range loop
        if clocks(0) = '1' and bank & now = number then
          copy(number) <= sum;
        end if;
        if reads = '0' and bank & now = number then
          bus_copy(number) <= sum;
        end if;
      end loop;
      if reset = '1' then
        count      <= (others => '0');
        starting   <= '1';
        closed     <= '1';
        whole      <= (others => (others => '0'));
        shown      <= (others => (others => '0'));
        taken      <= '0';
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits : boolean;
    variable here : natural range 0 to 16; -- clocks since the position was taken

    impure function has(of_bank : unsigned(1 downto 0); word : natural; value : byte_t) return boolean is
    begin
      return copy(to_integer(of_bank & to_unsigned(word, 3))) = value;
    end function;

    impure function bus_has(of_bank : unsigned(1 downto 0); word : natural; value : byte_t) return boolean is
    begin
      return bus_copy(to_integer(of_bank & to_unsigned(word, 3))) = value;
    end function;

  begin
    here := to_integer(count);
    if here = 0 then
      here := 16;
    end if;

    -- The rounds and the banks.
    fits := clocks = count and begins = starting and shut = closed and (closed = '1' or starting = '0') and
            bank /= 0 and old /= 0 and for_bus /= 0 and bank /= for_bus and (count = 0 or bank /= old) and
            (count /= 0 or starting = '1' or bank = old) and
            (count(0) = '0' or now = count(3 downto 1)) and
            (count(0) = '1' or count = 0 or now = count(3 downto 1) - 1);

    -- What is collected.
    fits := fits and a_was = a_before and b_was = b_before and index_was = index_before and
            unsigned(resize(steps, 8)) = window and steps <= here and steps >= -here and
            indexes = has_index and (has_index = '0' or unsigned(resize(index_steps, 8)) = index_window) and
            fails = has_failed and (count = 0 or is_due = due) and
            (count = 0 or count > 10 or due = '0' or has_index = '1') and
            (starting = '0' or (window = 0 and has_index = '0' and has_failed = '0' and (count = 0 or due = '0')));

    -- The bus.
    fits := fits and thaws = thawed and puts = taken and
            (closed = '0' or (taken = '0' and acks = '0' and errs = '0')) and
            (taken = '0' or (asked = '1' and acks = '0' and errs = '0' and m2s.we = '1' and (and m2s.sel) = '1' and
                             unsigned(m2s.adr(31 downto 3)) = 0 and
                             ((unsigned(m2s.adr(2 downto 0)) = 0 and count /= 0 and takes_0 = '1') or
                              (unsigned(m2s.adr(2 downto 0)) = 3 and count > 6)))) and
            (count = 0 or takes_0 = '0' or (taken = '1' and unsigned(m2s.adr(2 downto 0)) = 0 and
                                            unsigned(m2s.dat(7 downto 0)) = given_0));

    -- The word that is written, in both clocks.
    if count /= 0 and now < 4 then
      fits := fits and sum = live(to_integer(now));
    end if;
    fits := fits and ((now /= 4 and now /= 5) or sum = 0);

    -- What this round does with the words of the one before.
    if count = 0 then
      for word in 0 to 3 loop
        fits := fits and (starting = '1' or live(word) = whole(word));
      end loop;
    elsif starting = '0' then
      fits := fits and (due = '1' or live(1) = whole(1)) and
              (due = '0' or count > 4 or (takes_0 = '1' and live(1) = given_0 + index_window) or
               (takes_0 = '0' and live(1) = whole(0) + index_window)) and
              live(2) = whole(2) + unsigned'("" & due) and (count > 6 or live(3) = whole(3));
    end if;

    for word in 0 to 3 loop
      fits := fits and (starting = '0' or (live(word) = 0 and whole(word) = 0)) and
              (starting = '1' or (has(old, word, whole(word)) and bus_has(old, word, whole(word)))) and
              (closed = '1' or bus_has(for_bus, word, shown(word))) and
              (count < 2 * word + 2 or has(bank, word, live(word))) and
              (count < 2 * word + 2 or bus_has(bank, word, live(word)) or
               (count = 2 * word + 2 and (acks = '1' or errs = '1')));
    end loop;
    for number in 0 to 3 loop
      for word in 4 to 5 loop
        fits := fits and copy(8 * number + word) = 0 and bus_copy(8 * number + word) = 0;
      end loop;
    end loop;
    for word in 4 to 7 loop
      fits := fits and live(word) = 0 and whole(word) = 0 and shown(word) = 0;
    end loop;
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always asked = '1' -> m2s.cyc = '1';

  -- At every clock, the design and its memories are where these say.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- A read gives what the reference shows: no step is lost or doubled, also when a preset, an index, or both come with
  -- it. All words are of one moment.
  read_is_right : assert always begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' ->
                  unsigned(s2m.dat(byte_t'range)) = expected;

  -- A write that is answered has thawed the words.
  write_thaws : assert always begun = '1' and s2m.ack = '1' and m2s.we = '1' -> thawed = '1';

  -- A preset was written and is read back, while the lines move.
  preset_seen : cover {begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and expected = 90 and
                       unsigned(m2s.adr(2 downto 0)) = 0 and window /= 0};

  -- An index has latched a position.
  index_seen : cover {begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and expected = 3 and
                      unsigned(m2s.adr(2 downto 0)) = 1};

end architecture;
