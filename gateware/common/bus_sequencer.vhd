-- SPDX-License-Identifier: BSD-3-Clause
--
-- Runs a program that sets a device up and reads it again and again, and keeps what it reads as words on the bus. The
-- program is in sequencer_pkg, and spi_master or i2c_master exchanges its bytes.
--
--   +0  control: bit 0 enable; it is 1 after a reset
--   +1  status: bit 0 valid, bit 1 set up, bits 5:4 why the last try failed: 1 no answer, 2 a wrong reply,
--       3 the device refused it, with the code of its last refusal in bits 13:6                            (read only)
--   +2  failures: samples and set-ups that failed, 16 bits, it wraps                                       (read only)
--   +3  age: us since the last good sample ended, at most 2**20 - 1                                        (read only)
--   +4  stamp: when this sample began, in clocks since the reset                                           (read only)
--   +5  the values, in the order of the program                                                            (read only)
--   then the outputs, which the program sends
--
--   program  | set-up | sample | sample | ...      a period each, counted without a drift
--   bank     ----A----|---B----|---A----           a sample is written beside the one that is read
--
-- Samples   A sample shows at once, with its stamp, when it is complete. It waits while cyc is high, so all words of a
--           block are of one sample. A sample that failed changes nothing but the status.
-- Outputs   are 0 after a reset. What the bus has written goes out with the next sample, and with each one behind it.
--           All bytes of an output are of one write.
-- Failures  After failures_most in a row `valid` falls, and the set-up is done again. So it is after each failure in
--           the set-up. While `enable` is 0 `valid` is 0, and nothing is asked; a frame ends before.
-- Events    sampled: a sample has become visible. failed: a try has failed.
-- Latency   2 clocks per access. A word of the program takes 3 clocks, and a byte those of its bus. A period is exact
--           in the long run if clock_hz is at least 8 MHz.
-- Errors    err for addresses behind the last output, for a write of anything but +0 and the outputs, and for one that
--           does not select all bytes.
-- Reset     Starts the program anew when its timer has expired. `valid` falls. The failures stay.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.sequencer_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity bus_sequencer is
  generic (
    clock_hz      : positive                := 50_000_000;
    program       : string                  := "";
    values        : positive range 1 to 27  := 1;
    outputs       : natural range 0 to 8    := 0;
    failures_most : positive range 1 to 15  := 3;
    data_width    : positive range 8 to 32  := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    sampled      : out std_ulogic;
    failed       : out std_ulogic;

    request      : out bus_request_t;
    reply        : in  bus_reply_t
  );
end entity;

architecture rtl of bus_sequencer is

  constant lanes        : positive := bytes_for(data_width);
  constant stamp_index  : natural  := 4;
  constant first_output : positive := stamp_index + 1 + values;
  constant words        : positive := first_output + outputs;
  constant all_bytes    : std_ulogic_vector(lanes - 1 downto 0) := (others => '1');

  subtype index_t is unsigned(4 downto 0);
  subtype places_t is std_ulogic_vector(31 downto 0);
  subtype word_t is std_ulogic_vector(31 downto 0);
  type outputs_t is array (0 to 7) of word_t;
  type rom_t is array (255 downto 0) of program_word_t; -- GHDL inverts the address of an index that rises

  function rom_of (words : program_t(0 to 255)) return rom_t is
    variable rom : rom_t;
  begin
    for number in words'range loop
      rom(number) := words(number);
    end loop;
    return rom;
  end function;

  function places(first, last : natural) return places_t is
    variable found : places_t := (others => '0');
  begin
    for place in first to last loop
      found(place) := '1';
    end loop;
    return found;
  end function;

  -- The words that the bus may read, and those that it may write.
  constant readable : places_t := places(0, words - 1);
  constant writable : places_t := places(0, 0) or places(first_output, words - 1);

  constant rom : rom_t := rom_of(program_of(program));

  -- The bus.
  signal asked, ack, err, enable : std_ulogic;
  signal stored       : word_t; -- the word of a sample; no initial value, for which an iCE40 would take a mux
  signal side, status : word_t := (others => '0'); -- a word that is none of a sample
  signal given       : outputs_t := (others => (others => '0'));
  signal told        : std_ulogic_vector(7 downto 0) := (others => '0'); -- the output was written

  -- The program.
  type state_t is (fetching, loading, running, exchanging);
  signal state      : state_t;
  signal pc, next_pc : unsigned(7 downto 0) := (others => '0');
  signal fetched    : program_word_t; -- in the block RAM's register, which has no initial value
  signal word       : program_word_t := (others => '0'); -- in one of its own, which is faster to read
  signal operation  : std_ulogic_vector(2 downto 0);
  signal is_byte    : std_ulogic;
  signal is_output  : std_ulogic;
  signal sends      : word_t := (others => '0'); -- the output whose bytes are sent
  signal taken      : word_t := (others => '0'); -- the same, for the bytes behind the first
  signal failing    : std_ulogic := '0'; -- the rest of this try is passed over
  signal valid      : std_ulogic;
  signal set_up     : std_ulogic;
  signal reason     : failure_t := "00";
  signal code       : byte_t := (others => '0'); -- of the last refusal
  signal failures   : unsigned(15 downto 0) := (others => '0');
  signal in_a_row   : unsigned(bits_for(failures_most) - 1 downto 0);

  signal operates, waits, halts, starts, stamps, ends, commits, readies, jumps : std_ulogic;
  signal fails, too_many, anew, passes, skips, steps, answered, differs, keeps, ends_value : std_ulogic;

  -- Times.
  signal tick       : std_ulogic := '0'; -- each us
  signal timer, next_timer : unsigned(7 downto 0) := (others => '0'); -- in us, or in 256 us
  signal expired    : std_ulogic;
  signal part       : unsigned(7 downto 0) := (others => '0'); -- of a step of the timer
  signal next_part  : unsigned(8 downto 0); -- the highest bit is the carry
  signal coarse     : std_ulogic := '0';
  signal age        : unsigned(19 downto 0);
  signal next_age   : unsigned(20 downto 0); -- the same
  signal now        : unsigned(31 downto 0) := (others => '0');

  -- The values: two banks.
  signal bank       : std_ulogic := '0'; -- is read
  signal pointer    : index_t := to_unsigned(stamp_index, index_t'length); -- a sample begins with its stamp
  signal put_at     : unsigned(5 downto 0);
  signal got_at     : unsigned(5 downto 0);
  signal put_word   : word_t;
  signal put        : std_ulogic_vector(3 downto 0);

begin

  assert values + outputs <= 27
    report "bus_sequencer: at most 27 values and outputs fit, got " & integer'image(values + outputs)
    severity failure;

  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  operation <= word(13 downto 11);

  is_output <= word(15) and not word(14) and to_bit(outputs > 0);
  is_byte   <= not word(15) or is_output;

  request.go      <= '1' when state = running and is_byte = '1' and failing = '0' else '0';
  request.first   <= word(13);
  request.last    <= word(12);
  request.receive <= word(11);

  send : process (all) is
  begin
    request.data <= word(7 downto 0);
    sends        <= taken;
    if is_output = '1' then
      if word(10) = '1' then
        sends <= given(to_integer(unsigned(word(2 downto 0))));
      end if;
      case word(9 downto 8) is
        when "00"   => request.data <= sends(7 downto 0);
        when "01"   => request.data <= sends(15 downto 8);
        when "10"   => request.data <= sends(23 downto 16);
        when others => request.data <= sends(31 downto 24);
      end case;
    end if;
  end process;

  status <= (0 => valid, 1 => set_up, 4 => reason(0), 5 => reason(1), 6 => code(0), 7 => code(1), 8 => code(2),
             9 => code(3), 10 => code(4), 11 => code(5), 12 => code(6), 13 => code(7), others => '0');

  -- What is written to the bank that is not read.
  stamps     <= operates and not failing when operation = operation_sample else '0';
  keeps      <= answered and word(10) and not is_output;
  ends_value <= keeps and word(0) when word(11) = '1' else keeps and nor word(9 downto 8);
  put_at <= (not bank) & pointer;
  got_at <= bank & unsigned(wishbone_m2s.adr(index_t'range));

  put_word <= std_ulogic_vector(now) when stamps = '1' else reply.data & reply.data & reply.data & reply.data;

  values_of : for lane in 0 to lanes - 1 generate
    type memory_t is array (0 to 63) of byte_t;
    signal memory : memory_t := (others => (others => '0'));
  begin
    put(lane) <= stamps or (keeps and (unsigned(word(9 downto 8)) ?= lane));

    process (clock) is
    begin
      if rising_edge(clock) then
        stored(8 * lane + 7 downto 8 * lane) <= memory(to_integer(got_at));
        if put(lane) = '1' then
          memory(to_integer(put_at)) <= put_word(8 * lane + 7 downto 8 * lane);
        end if;
      end if;
    end process;
  end generate;

  bus_side : process (clock) is
    variable index : natural range 0 to 31;
    variable known : boolean;
  begin
    if rising_edge(clock) then
      ack   <= '0';
      err   <= '0';
      index := to_integer(unsigned(wishbone_m2s.adr(index_t'range)));
      known := unsigned(wishbone_m2s.adr(31 downto index_t'length)) = 0 and readable(index) = '1';
      if wishbone_m2s.we = '1' then
        known := known and writable(index) = '1' and wishbone_m2s.sel(all_bytes'range) = all_bytes;
      end if;

      if asked = '1' then
        ack <= '1' when known else '0';
        err <= '0' when known else '1';
        if known and wishbone_m2s.we = '1' and index = 0 then
          enable <= wishbone_m2s.dat(0);
        end if;
        side <= (others => '0');
        for number in 0 to outputs - 1 loop
          if index = first_output + number then
            side <= given(number);
            if known and wishbone_m2s.we = '1' then
              given(number)(data_width - 1 downto 0) <= wishbone_m2s.dat(data_width - 1 downto 0);
              told(number)                            <= '1';
            end if;
          end if;
        end loop;
        case index is
          when 0 =>
            side(0) <= enable;
          when 1 =>
            side <= status;
          when 2 =>
            side(failures'range) <= std_ulogic_vector(failures);
          when 3 =>
            side(age'range) <= std_ulogic_vector(age);
          when others =>
            null;
        end case;
      end if;

      if reset = '1' then
        ack    <= '0';
        err    <= '0';
        enable <= '1';
        given  <= (others => (others => '0'));
        told   <= (others => '0');
      end if;
    end if;
  end process;

  answer : process (all) is
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    -- Words 0 to 3 of a bank are never written, so they are zero.
    wishbone_s2m.dat(data_width - 1 downto 0) <= stored(data_width - 1 downto 0) or side(data_width - 1 downto 0);
  end process;

  fetch : process (clock) is
  begin
    if rising_edge(clock) then
      fetched <= rom(to_integer(pc));
      if state = loading then
        word <= fetched;
      end if;
    end if;
  end process;

  -- What a word of the program does.
  operates <= '1' when state = running and is_byte = '0' else '0';
  waits    <= operates when operation = operation_wait else '0';
  ends     <= operates when operation = operation_commit else '0';
  readies  <= operates when operation = operation_ready else '0';
  halts    <= waits and not enable;
  expired  <= nor timer;
  starts   <= waits and enable and expired and not failing;
  commits  <= ends and not failing and not wishbone_m2s.cyc;
  fails    <= (ends or readies) and failing;
  too_many <= fails when in_a_row = failures_most - 1 or readies = '1' else '0';
  anew     <= halts or too_many;
  answered <= reply.done when state = exchanging else '0';
  differs  <= word(14) when reply.data /= word(7 downto 0) else '0';
  passes   <= '1' when state = running and is_byte = '1' and failing = '1' else '0';
  skips    <= operates when operation = operation_skip and outputs > 0 else '0';
  steps    <= answered or passes or stamps or starts or (waits and failing) or (readies and not failing) or skips;

  jumps    <= commits or fails or (skips and not told(to_integer(unsigned(word(10 downto 8)))));

  -- pc + 1 and timer - 1. The sums have what loads the counter as an operand, which says nothing while it counts. So
  -- counting and loading share a cell of an iCE40, whose LUT has the operands of its carry as inputs. What counts ticks
  -- adds the tick itself, so its carry has no cell of its own.
  next_pc    <= pc - unsigned'(7 downto 0 => not jumps);
  next_timer <= timer + unsigned'(7 downto 0 => not starts);
  next_part  <= ('0' & part) + unsigned'("" & tick);
  next_age   <= ('0' & age) + unsigned'("" & tick);

  run : process (clock) is
  begin
    if rising_edge(clock) then
      sampled <= commits;
      failed  <= fails;

      if reset = '1' or anew = '1' then
        pc <= (others => '0');
      elsif jumps = '1' then
        pc <= unsigned(word(7 downto 0));
      elsif steps = '1' then
        pc <= next_pc;
      end if;

      if reset = '1' or anew = '1' or commits = '1' or fails = '1' or steps = '1' then
        state <= fetching;
      elsif state = fetching then
        state <= loading;
      elsif state = loading then
        state <= running;
      elsif request.go = '1' then
        state <= exchanging;
      end if;

      if reset = '1' or halts = '1' or fails = '1' then
        failing <= '0';
      elsif answered = '1' and (reply.failed = '1' or differs = '1') then
        failing <= '1';
      end if;

      if answered = '1' and (reply.failed = '1' or differs = '1') then
        reason <= failure_wrong_reply;
        if reply.failed = '1' then
          reason <= reply.reason;
          if reply.reason = failure_refused then
            code <= reply.data;
          end if;
        end if;
      end if;

      if request.go = '1' then
        taken <= sends;
      end if;

      if reset = '1' or anew = '1' then
        valid <= '0';
      elsif commits = '1' then
        valid <= '1';
      end if;

      if reset = '1' or anew = '1' then
        set_up <= '0';
      elsif readies = '1' then
        set_up <= '1';
      end if;

      if reset = '1' or anew = '1' or commits = '1' then
        in_a_row <= (others => '0');
      elsif fails = '1' then
        in_a_row <= in_a_row + 1;
      end if;

      failures <= failures + unsigned'("" & fails);

      if commits = '1' then
        bank <= not bank;
      end if;

      if ends = '1' or readies = '1' then
        pointer <= to_unsigned(stamp_index, index_t'length);
      elsif stamps = '1' or ends_value = '1' then
        pointer <= pointer + 1;
      end if;
    end if;
  end process;

  microseconds : entity work.ticker
    generic map (clock_hz => clock_hz, rate_hz => 1_000_000)
    port map (clock => clock, reset => reset, tick => tick);

  times : process (clock) is
  begin
    if rising_edge(clock) then
      now <= now + 1;

      if starts = '1' then
        timer  <= unsigned(word(7 downto 0));
        coarse <= word(10);
      elsif expired = '0' and (next_part(8) = '1' or (coarse = '0' and tick = '1')) then
        timer <= next_timer;
      end if;

      if starts = '1' then
        part <= (others => '0');
      else
        part <= next_part(part'range);
      end if;

      if reset = '1' or commits = '1' then
        age <= (others => '0');
      elsif next_age(age'length) = '0' then
        age <= next_age(age'range);
      end if;

      if reset = '1' then
        now <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
