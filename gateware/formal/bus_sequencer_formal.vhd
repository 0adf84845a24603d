-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of bus_sequencer with any program: each word may be any at any time. So they hold for all devices. Its
-- bus may answer each byte with anything at any clock, and a us may end at any clock. A failures_most of 3, one value.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.sequencer_pkg.all;
  use work.wishbone_pkg.all;

entity bus_sequencer_formal is
  port (
    clk          : in std_ulogic;
    reset        : in std_ulogic;
    m2s          : in wishbone_m2s_t;
    done         : in std_ulogic;
    fails        : in std_ulogic;
    reason       : in std_ulogic_vector(1 downto 0);
    data         : in byte_t;
    state        : in unsigned(1 downto 0);          -- shows the place, as all of these show signals
    word         : in program_word_t;                -- of the program
    tick         : in std_ulogic;
    enable       : in std_ulogic;
    valid        : in std_ulogic;
    bank         : in std_ulogic;
    pointer      : in unsigned(4 downto 0);
    failing      : in std_ulogic;
    in_a_row     : in unsigned(1 downto 0);
    age          : in unsigned(19 downto 0);
    failures     : in unsigned(15 downto 0)
  );
end entity;

architecture properties of bus_sequencer_formal is

  constant failures_most : positive := 3;
  constant oldest        : unsigned(19 downto 0) := (others => '1');

  -- The places of `state` in its type.
  constant running    : natural := 2;
  constant exchanging : natural := 3;

  signal s2m             : wishbone_s2m_t;
  signal sampled, failed : std_ulogic;
  signal request         : bus_request_t;
  signal begun           : std_ulogic := '0';
  signal void_1          : std_ulogic := '1';                            -- it was reset a clock ago
  signal asked           : std_ulogic;
  signal asked_1         : std_ulogic := '0';
  signal place_1         : unsigned(4 downto 0) := (others => '0');      -- the word of the access, with …
  signal reads_1         : std_ulogic := '0';
  signal operates        : std_ulogic;                                   -- an operation of the program is done
  signal ends, readies, waits : std_ulogic;
  signal bad             : std_ulogic := '0';                            -- a byte of this try has failed
  signal ends_well       : std_ulogic;
  signal ends_well_1     : std_ulogic := '0';
  signal ends_badly      : std_ulogic;
  signal ends_badly_1    : std_ulogic := '0';
  signal halts_1         : std_ulogic := '0';
  signal failed_tries    : natural range 0 to failures_most := 0;        -- since the last good sample
  signal since           : unsigned(19 downto 0) := (others => '0');     -- us since the last good sample
  signal bank_1, valid_1 : std_ulogic := '0';
  signal age_1           : unsigned(19 downto 0) := (others => '0');
  signal failures_1      : unsigned(15 downto 0) := (others => '0');
  signal word_1          : program_word_t := (others => '0');
  signal in_place        : std_ulogic;                                   -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.bus_sequencer
    generic map (clock_hz => 1_000_000, values => 1, failures_most => failures_most, data_width => 8)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      request => request, reply => (done => done, failed => fails, reason => reason, data => data));

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  asked    <= m2s.cyc and m2s.stb and not s2m.ack and not s2m.err;
  operates <= to_bit(state = running) and word(15); -- there are no outputs
  waits    <= operates and to_bit(word(13 downto 11) = operation_wait);
  ends     <= operates and to_bit(word(13 downto 11) = operation_commit);
  readies  <= operates and to_bit(word(13 downto 11) = operation_ready);

  ends_well  <= ends and not bad and not m2s.cyc;
  ends_badly <= (ends or readies) and bad;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun        <= '1';
      void_1       <= reset;
      asked_1      <= asked and not reset;
      place_1      <= unsigned(m2s.adr(4 downto 0));
      reads_1      <= to_bit(unsigned(m2s.adr(31 downto 5)) = 0) and not m2s.we;
      ends_well_1  <= ends_well;
      ends_badly_1 <= ends_badly;
      halts_1      <= waits and not enable;
      bank_1       <= bank;
      valid_1      <= valid;
      age_1        <= age;
      failures_1   <= failures;
      word_1       <= word;

      if state = exchanging and done = '1' and (fails = '1' or (word(15 downto 14) = "01" and data /= word(7 downto 0)))
      then
        bad <= '1';
      end if;
      if ends_badly = '1' or (waits = '1' and enable = '0') or reset = '1' then
        bad <= '0';
      end if;

      if tick = '1' and since /= oldest then
        since <= since + 1;
      end if;
      if ends_badly = '1' and failed_tries /= failures_most then
        failed_tries <= failed_tries + 1;
      end if;
      if ends_well = '1' then
        since        <= (others => '0');
        failed_tries <= 0;
      end if;
      if reset = '1' then
        since <= (others => '0');
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits : boolean;
  begin
    fits := failing = bad and (valid = '0' or in_a_row = failed_tries) and in_a_row < failures_most;
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no access at power-up.
  quiet_first : assume always begun = '1' or (m2s.cyc = '0' and m2s.stb = '0');

  -- The master waits for the answer to each access.
  patient : assume always asked_1 = '1' -> m2s.cyc = '1';

  -- A program keeps no more values than there are.
  program_fits : assume always pointer >= 4 and pointer <= 6;

  -- At every clock, the design is where these say.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- The values that the bus reads change only behind a try in which each byte was answered, and none was wrong. And
  -- only while the bus is free, so a block is of one sample.
  only_good_samples : assert always begun = '1' and bank /= bank_1 -> ends_well_1 = '1';

  -- Each good sample becomes visible, with its event.
  each_is_seen : assert always begun = '1' and ends_well_1 = '1' -> bank /= bank_1 and sampled = '1';

  -- The values are valid only behind a good sample, and only if fewer than failures_most tries have failed since.
  valid_is_fresh : assert always begun = '1' and valid = '1' -> failed_tries < failures_most;

  -- Nothing else makes them valid.
  valid_by_sample : assert always begun = '1' and valid = '1' and valid_1 = '0' and void_1 = '0' -> ends_well_1 = '1';

  -- A device that is off has no valid values.
  void_when_off : assert always begun = '1' and halts_1 = '1' -> valid = '0';

  -- A reset makes them invalid.
  void_by_reset : assert always begun = '1' and void_1 = '1' -> valid = '0';

  -- The age is the us since the last good sample, or since the reset. At its most it stands still: old values never
  -- look young.
  right_age : assert always begun = '1' -> age = since;

  -- A read of the status says whether the values are valid, as of its access.
  status_is_told : assert always begun = '1' and s2m.ack = '1' and reads_1 = '1' and place_1 = 1 ->
                          s2m.dat(0) = valid_1;

  -- A read of the age gives it.
  age_is_told : assert always begun = '1' and s2m.ack = '1' and reads_1 = '1' and place_1 = 3 ->
                       unsigned(s2m.dat(7 downto 0)) = age_1(7 downto 0);

  -- Each try that failed has one event, and is counted once.
  each_is_told : assert always begun = '1' and void_1 = '0' -> failed = ends_badly_1;
  -- The count changes with nothing else.
  each_is_counted : assert always begun = '1' -> failures - failures_1 = unsigned'("" & ends_badly_1);

  -- Behind a byte that failed, the rest of the try is passed over: nothing more is asked of the device.
  passes_over : assert always begun = '1' and request.go = '1' -> bad = '0';

  -- What is asked of the bus stands from its request to its answer.
  request_stands : assert always begun = '1' and state = exchanging -> word = word_1;

  -- A third failure has ended the validity.
  too_many_seen : cover {begun = '1' and valid = '0' and valid_1 = '1' and failed_tries = failures_most};

end architecture;
