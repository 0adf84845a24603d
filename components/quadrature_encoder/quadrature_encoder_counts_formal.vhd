-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the words of one encoder, of 8 bits, with its index. A reference counts the steps at once, without
-- memories and turns. It knows only at which clock of a round a word is taken, and when it is shown.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.wishbone_pkg.all;

entity quadrature_encoder_counts_formal is
  port (
    clk   : in std_ulogic;
    reset : in std_ulogic;
    m2s   : in wishbone_m2s_t;
    a     : in std_ulogic;
    b     : in std_ulogic;
    index : in std_ulogic
  );
end entity;

architecture properties of quadrature_encoder_counts_formal is

  subtype byte_t is unsigned(7 downto 0);
  type words_t is array (0 to 7) of byte_t;

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
  signal thawed, was_thawed : std_ulogic := '0';
  signal expected        : byte_t := (others => '0'); -- of a read that is answered now

begin

  default clock is rising_edge(clk);

  dut : entity work.quadrature_encoder_counts
    generic map (with_index => 1, data_width => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m,
      indexed => indexed, failed => failed, a(0) => a, b(0) => b, index(0) => index);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  thawed <= was_thawed or (s2m.ack and m2s.we);

  follow : process (clk) is
    variable gives : std_ulogic; -- the bus has a word for a register
    variable given, base, by, sum : byte_t;
  begin
    if rising_edge(clk) then
      begun  <= '1';
      asked  <= m2s.stb and not s2m.ack and not s2m.err and not reset;
      a_before     <= a;
      b_before     <= b;
      index_before <= index;
      count        <= count + 1;
      was_thawed   <= m2s.cyc and thawed;
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

      sum := window + by;
      if count = 0 then
        base := live(0);
        if gives = '1' and unsigned(m2s.adr(2 downto 0)) = 0 then
          base := given;
        end if;
        live(0) <= base + window;
        sum     := by;
        due     <= has_index;
        if has_index = '1' then
          live(1) <= base + index_window;
          live(2) <= live(2) + 1;
        end if;
      end if;
      window <= sum;

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
        index_window <= sum;
      end if;

      if count = 15 then
        whole    <= live;
        starting <= '0';
      end if;
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
      if reset = '1' then
        count      <= (others => '0');
        starting   <= '1';
        closed     <= '1';
        whole      <= (others => (others => '0'));
        shown      <= (others => (others => '0'));
        was_thawed <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The master waits for the answer to each access.
  patient : assume always asked = '1' -> m2s.cyc = '1';

  -- A read gives what the reference shows: no step is lost or doubled, also when a preset, an index, or both come with
  -- it. All words are of one moment.
  read_is_right : assert always begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' ->
                  unsigned(s2m.dat(byte_t'range)) = expected;

  -- A preset was written and is read back, while the lines move.
  preset_seen : cover {begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and expected = 90 and
                       unsigned(m2s.adr(2 downto 0)) = 0 and window /= 0};

  -- An index has latched a position.
  index_seen : cover {begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and expected = 3 and
                      unsigned(m2s.adr(2 downto 0)) = 1};

end architecture;
