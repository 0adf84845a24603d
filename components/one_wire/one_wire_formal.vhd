-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of a try of one_wire, with failures_most 2. A place of a slot may come at any clock, and a period may end
-- at any clock, so only the order of the places counts: their times are proven in one_wire_line. The line and the bus
-- may do anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wishbone_pkg.all;

entity one_wire_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    line_in : in std_ulogic;
    enable  : in std_ulogic;                     -- shows the bit of the design, as all of these show its signals
    turns   : in std_ulogic;                     -- the place of this clock counts
    place   : in unsigned(6 downto 0);
    due     : in std_ulogic;
    step    : in unsigned(3 downto 0);
    number  : in unsigned(6 downto 0);           -- of the bit in this step
    raw     : in std_ulogic;
    state   : in std_ulogic_vector(15 downto 0); -- the word +1
    value   : in std_ulogic_vector(15 downto 0)  -- the word +2
  );
end entity;

architecture properties of one_wire_formal is

  constant sample_at   : natural  := 13; -- places
  constant slot_end    : natural  := 69;
  constant presence_at : natural  := 70;
  constant waits       : natural  := 9;  -- steps
  constant reads       : natural  := 13;
  constant rests       : natural  := 14;
  constant bits        : positive := 72;
  constant mark        : std_ulogic_vector(7 downto 0) := x"69";

  signal s2m             : wishbone_s2m_t;
  signal sampled, failed : std_ulogic;
  signal begun           : std_ulogic := '0';
  signal off_1           : std_ulogic := '1';                    -- a reset, or not enabled, a clock ago
  signal looks, ends     : std_ulogic;                           -- of a slot with a bit
  signal looked          : std_ulogic := '0';                    -- this slot has been looked at
  signal level           : std_ulogic := '1';                    -- then
  signal seen            : natural range 0 to bits + 1 := 0;     -- bits that were looked at
  signal busy            : std_ulogic := '0';                    -- it has been so, in this try
  signal is_marked       : std_ulogic := '1';                    -- no mark was wrong so far
  signal got             : std_ulogic_vector(15 downto 0) := (others => '0'); -- the first bits
  signal crc             : std_ulogic_vector(7 downto 0) := (others => '0');
  signal is_right        : std_ulogic := '0';                    -- at the end of the last try that had all bits
  signal marked          : std_ulogic := '0';
  signal was_busy        : std_ulogic := '0';
  signal value_1         : std_ulogic_vector(15 downto 0) := (others => '0');
  signal cut, cut_told   : std_ulogic := '0';                    -- a period has ended a try
  signal bad             : natural range 0 to 2 := 0;            -- failures in a row

begin

  default clock is rising_edge(clk);

  dut : entity work.one_wire
    generic map (clock_hz => 1_000_000, period_ms => 1000, failures_most => 2, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      line_in => line_in, line_out => open, line_drive => open);

  looks <= '1' when turns = '1' and place = sample_at and (step = waits or step = reads) else '0';
  ends  <= '1' when turns = '1' and place = slot_end and (step = waits or step = reads) else '0';

  watch : process (clk) is
    variable feed : std_ulogic;
  begin
    if rising_edge(clk) then
      begun   <= '1';
      off_1   <= reset or not enable;
      value_1 <= value;

      if looks = '1' then
        looked <= '1';
        level  <= raw;
        if step = reads then
          feed := crc(0) xor raw;
          crc  <= (feed & crc(7 downto 1)) xor ("0000" & feed & feed & "00");
          seen <= minimum(seen + 1, bits + 1);
          if number < 16 then
            got <= raw & got(15 downto 1);
          elsif number < 32 and raw /= mark(to_integer(number(2 downto 0))) then
            is_marked <= '0';
          end if;
        end if;
      end if;
      if ends = '1' then
        looked <= '0';
        if step = waits and level = '0' then
          busy <= '1';
        end if;
        -- The last bit: what came stays the same while a block holds it back.
        if step = reads and number = bits - 1 then
          is_right <= to_bit(unsigned(crc) = 0);
          marked   <= is_marked;
          was_busy <= busy;
        end if;
      end if;
      if due = '1' then
        looked    <= '0';
        busy      <= '0';
        seen      <= 0;
        crc       <= (others => '0');
        is_marked <= '1';
      end if;

      cut <= '0';
      if due = '1' and step /= rests and enable = '1' then
        cut <= '1';
      end if;
      cut_told <= cut and not m2s.cyc;

      if sampled = '1' then
        bad <= 0;
      elsif failed = '1' then
        bad <= minimum(bad + 1, 2);
      end if;
      if reset = '1' then
        looked   <= '0';
        value_1  <= (others => '0');
        cut      <= '0';
        cut_told <= '0';
        bad      <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A slot has one look at the line, and then ends (one_wire_line). It never comes to the place of a presence.
  one_look : assume always (looks = '0' or looked = '0') and (ends = '0' or looked = '1') and
                           (place /= presence_at or (step /= waits and step /= reads));

  -- In a read each bit is looked at once.
  counts : assert always begun = '1' and step = reads and looked = '0' -> seen = number;
  -- The bit of this slot was looked at.
  counts_looked : assert always begun = '1' and step = reads and looked = '1' -> seen = number + 1;

  -- A sample is the first two bytes that came, however long the bus holds it back.
  right_value : assert always begun = '1' and sampled = '1' -> value = got;

  -- The check over all nine bytes of a sample is right.
  right_check : assert always begun = '1' and sampled = '1' -> is_right = '1';

  -- A sample has both marks: a thermometer that has restarted, and says 85 degC, never counts.
  has_marks : assert always begun = '1' and sampled = '1' -> marked = '1';

  -- A thermometer was busy before a sample of it: an old temperature is never taken for a new one.
  has_converted : assert always begun = '1' and sampled = '1' -> was_busy = '1';

  -- The value changes only with a sample.
  only_samples : assert always begun = '1' and value /= value_1 -> sampled = '1';

  -- A try that has not ended with its period is told as a failure, as soon as no block is open.
  hung_is_told : assert always begun = '1' and cut_told = '1' -> failed = '1';

  -- Two failures in a row end the validity.
  too_many : assert always begun = '1' and bad = 2 and sampled = '0' -> state(15) = '0';

  -- Without enable, nothing is valid.
  void_when_off : assert always begun = '1' and off_1 = '1' -> state(15) = '0';

end architecture;
