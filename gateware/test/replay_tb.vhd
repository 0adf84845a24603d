-- SPDX-License-Identifier: BSD-3-Clause
--
-- Plays a file of steps to the core, and writes down its answers with their clocks. The author of the steps checks the
-- answers (tests/gateware): recordings, or the twin.
--
-- Steps, one per line:
--
--   s HEX  send these bytes back to back
--   w N    wait N clocks
--   q N    wait until no byte has moved in either direction for N clocks
--   e N    set the event inputs to this mask
--   x N    pulse the physical error bits for one clock
--   r N    reset for N clocks
--   d N    the host takes no more bytes, N clocks from now on; 0: it takes bytes again
--   k N    the same, and the bytes that it would send are lost
--
-- Answers:
--
--   b CLOCK BYTE     a byte was sent
--   o CLOCK          the first byte of an `s` was taken
--   i CLOCK          its last byte was taken
--   t CLOCK ADDRESS  a bus strobe began (with the low 16 bits of the address)
--   u CLOCK ADDRESS  a write was acknowledged
--   v CLOCK DATA     the data of this write
--   p CLOCK LEVEL    `tripped` changed to this level
--   k CLOCK LEVEL    the host is dead, or alive again
--   s                a step has ended
--   end              all steps have ended

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use std.textio.all;
use work.bench_pkg.all;
use work.engine_pkg.all;
use work.frame_layout_pkg.all;
use work.register_pkg.all;
use work.settings_pkg.all;
use work.wishbone_pkg.all;

entity replay_tb is
  generic (
    steps_file    : string;
    answers_file  : string;
    address_bits  : positive := 8;
    data_bits     : positive := 32;
    base_hz       : positive := 1000;
    groups        : positive := 2;
    group_size    : positive := 16;
    rate_bytes    : positive := 2;
    read_many     : natural  := 32;
    publish_mode  : natural  := 2;
    configuration_command : boolean := true;
    datalink      : string   := "full";
    checksum      : string   := "crc8";
    polynomial    : natural  := 7;
    edge_events   : natural  := 0;
    protocol      : string   := "classic";
    engine        : string   := "fast";
    lists         : boolean  := true;
    deadman       : boolean  := true;
    exchanges     : natural  := 2;
    exchange_size : positive := 16;
    window        : positive := 32;
    clock_hz      : positive := 50_000_000;
    recorded      : natural  := 1;       -- the memory of the recordings
    bad_base      : natural  := 0;       -- see bench_memory
    registers     : natural  := 0;       -- so many words from 0 on are a register_slave with snapshots
    fifo_words    : natural  := 0;       -- 16: the core is between two FIFOs of this depth
    physical      : string   := "none";  -- the physical layer of the core, with the other end of its wires: see far_end
    stall_percent : natural  := 0;       -- clocks in which the bench neither gives nor takes a byte
    bus_stall_percent : natural := 0;    -- clocks in which the bus could acknowledge but does not
    byte_clocks   : positive := 1;       -- clocks that a sent byte takes on its line
    bus_waits     : natural  := 0;       -- clocks by which an acknowledge is late
    seed          : positive := 1
  );
end entity;

architecture bench of replay_tb is

  constant safe_values : safe_values_t(0 to 1) := ((address => x"00000010", value => x"00000001"),
                                                   (address => x"00000011", value => x"FFFFFFFF"));

  constant step_clocks_most : natural := 4_000_000;  -- watchdog of one step

  -- Chips have real times, so they need a clock of 50 MHz.
  function half_period return time is
  begin
    if physical = "none" then
      return 1 ns;
    end if;
    return 10 ns;
  end function;

  function line_kind return string is
  begin
    if fifo_words > 0 then
      return "fifo";
    end if;
    return physical;
  end function;

  signal clock    : std_ulogic := '0';
  signal reset    : std_ulogic := '1';
  signal ended    : boolean := false;
  signal now_clock     : natural := 0;
  signal last_activity : natural := 0;

  signal rx_valid : std_ulogic := '0';
  signal rx_ready : std_ulogic;
  signal rx_data  : std_ulogic_vector(7 downto 0) := x"00";
  signal core_rx_valid : std_ulogic;
  signal core_rx_ready : std_ulogic;
  signal core_rx_data  : std_ulogic_vector(7 downto 0);
  signal core_tx_valid : std_ulogic;
  signal core_tx_ready : std_ulogic;
  signal core_tx_data  : std_ulogic_vector(7 downto 0);
  signal core_tx_last, core_tx_publish : std_ulogic;
  signal rx_error, line_error, core_rx_error : std_ulogic_vector(2 downto 0) := "000";
  signal tripped  : std_ulogic;
  signal deaf_from, dead_from : natural := natural'high;  -- clocks
  signal deaf, dead : boolean;
  signal tx_valid : std_ulogic;
  signal tx_ready : std_ulogic := '1';
  signal tx_data  : std_ulogic_vector(7 downto 0);
  signal events   : std_ulogic_vector(groups - 1 downto 0) := (others => '0');
  signal wishbone_m2s : wishbone_m2s_t;
  signal wishbone_s2m : wishbone_s2m_t;
  signal memory_m2s   : wishbone_m2s_t;
  signal memory_s2m   : wishbone_s2m_t;

  file answers : text open write_mode is answers_file;

begin

  clock     <= not clock after half_period when not ended;
  now_clock <= now_clock + 1 when rising_edge(clock);

  core_rx_error <= rx_error or line_error;
  dead <= now_clock >= dead_from;
  deaf <= now_clock >= deaf_from or dead;

  core : entity work.core
    generic map (
      settings => core_settings(
        address_bits => address_bits, data_bits => data_bits, clock_hz => clock_hz, base_hz => base_hz,
        groups => groups, group_size => group_size, rate_bytes => rate_bytes, read_many => read_many,
        publish_mode => publish_mode, configuration_command => configuration_command, datalink => datalink_of(datalink),
        checksum => checksum_of(checksum), polynomial => polynomial,
        edge_events => std_ulogic_vector(to_unsigned(edge_events, 256)), protocol => protocol_of(protocol),
        lists => lists, deadman => deadman, exchanges => exchanges,
        exchange_size => exchange_size, window => window,
        spec_hash => x"0123456789ABCDEF"),
      engine => engine_of(engine), safe_values => safe_values)
    port map (
      clock => clock, reset => reset,
      rx_valid => core_rx_valid, rx_ready => core_rx_ready, rx_data => core_rx_data, rx_error => core_rx_error,
      tx_valid => core_tx_valid, tx_ready => core_tx_ready, tx_data => core_tx_data,
      tx_last => core_tx_last, tx_publish => core_tx_publish, events => events,
      tripped => tripped,
      wishbone_m2s => wishbone_m2s, wishbone_s2m => wishbone_s2m);

  line_side : entity work.far_end
    generic map (kind => line_kind, fifo_words => maximum(fifo_words, 1), seed => seed)
    port map (
      clock => clock, reset => reset, running => not ended,
      in_valid => rx_valid, in_ready => rx_ready, in_data => rx_data,
      out_valid => tx_valid, out_ready => tx_ready, out_data => tx_data,
      rx_valid => core_rx_valid, rx_ready => core_rx_ready, rx_data => core_rx_data, rx_error => line_error,
      tx_valid => core_tx_valid, tx_ready => core_tx_ready, tx_data => core_tx_data,
      tx_last => core_tx_last, tx_publish => core_tx_publish);

  memory : entity work.bench_memory
    generic map (address_width => address_bits, data_width => data_bits, recorded => recorded = 1, bad_base => bad_base,
                 waits => bus_waits, stall_percent => bus_stall_percent, seed => seed + 2000)
    port map (clock => clock, wishbone_m2s => memory_m2s, wishbone_s2m => memory_s2m);

  with_registers : if registers > 0 generate
    signal words         : word_vector_t(0 to registers - 1);
    signal registers_m2s : wishbone_m2s_t;
    signal registers_s2m : wishbone_s2m_t;
    signal here          : std_ulogic;
  begin
    here <= '1' when unsigned(wishbone_m2s.adr) < registers else '0';

    split : process (all)
    begin
      memory_m2s        <= wishbone_m2s;
      memory_m2s.stb    <= wishbone_m2s.stb and not here;
      registers_m2s     <= wishbone_m2s;
      registers_m2s.stb <= wishbone_m2s.stb and here;
    end process;

    wishbone_s2m <= registers_s2m when here = '1' else memory_s2m;

    slave : entity work.register_slave
      generic map (writable => (0 to registers - 1 => '1'), data_width => data_bits, snapshot => true)
      port map (
        clock => clock, reset => reset, wishbone_m2s => registers_m2s, wishbone_s2m => registers_s2m,
        read_words => words, write_words => words, written => open, was_read => open);
  else generate
    memory_m2s   <= wishbone_m2s;
    wishbone_s2m <= memory_s2m;
  end generate;

  listen : process (clock)
    variable random : random_t;
    variable seeded : boolean := false;
    variable strobe : std_ulogic := '0';
    variable level  : std_ulogic := '0';
    variable silence : boolean := false;
    variable answer : line;

    procedure tell (what : character; number : integer) is
    begin
      write(answer, what & " " & integer'image(now_clock) & " " & integer'image(number));
      writeline(answers, answer);
    end procedure;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(seed + 1000);
        seeded := true;
      end if;
      if reset = '0' and tx_valid = '1' and tx_ready = '1' then
        tell('b', to_integer(unsigned(tx_data)));
      end if;
      if wishbone_m2s.stb = '1' and strobe = '0' then
        tell('t', to_integer(unsigned(wishbone_m2s.adr(15 downto 0))));
      end if;
      if (wishbone_m2s.stb and wishbone_m2s.we and wishbone_s2m.ack) = '1' then
        tell('u', to_integer(unsigned(wishbone_m2s.adr(15 downto 0))));
        tell('v', to_integer(signed(wishbone_m2s.dat)));
      end if;
      if dead /= silence then
        silence := dead;
        tell('k', boolean'pos(dead));
      end if;
      if reset = '0' and tripped /= level then
        level := tripped;
        tell('p', boolean'pos(level = '1'));
      end if;
      strobe := wishbone_m2s.stb;
      if (tx_valid = '1' and tx_ready = '1') or (rx_valid = '1' and rx_ready = '1') then
        last_activity <= now_clock;
      end if;
      tx_ready <= '1';
      if random.chance(stall_percent) or now_clock mod byte_clocks /= 0 or deaf then
        tx_ready <= '0';
      end if;
    end if;
  end process;

  play : process
    file steps      : text open read_mode is steps_file;
    variable random : random_t;
    variable step   : line;
    variable answer : line;
    variable kind   : character;
    variable gap    : character;
    variable number : natural;
    variable start  : natural;
    variable first  : boolean;
    variable good   : boolean;

    procedure send(byte : natural) is
    begin
      pause(clock, random, stall_percent);
      if dead then
        return;
      end if;
      rx_valid <= '1';
      rx_data  <= std_ulogic_vector(to_unsigned(byte, 8));
      loop
        wait until rising_edge(clock);
        exit when rx_ready = '1' or dead;
        assert now_clock - start < step_clocks_most
          report "replay_tb: the core takes no more bytes" severity failure;
      end loop;
      rx_valid <= '0';
    end procedure;

    variable place : positive;
  begin
    random.seed(seed);
    wait_clocks(clock, 4);
    reset <= '0';
    wait until rising_edge(clock);
    while not endfile(steps) loop
      readline(steps, step);
      read(step, kind);
      read(step, gap);
      start := now_clock;
      if kind = 's' then
        first := true;
        place := step'left;
        while place < step'right loop  -- a read of each digit would copy what is left of the line, each time
          send(16 * digit_value(step(place)) + digit_value(step(place + 1)));
          place := place + 2;
          if first then
            first := false;
            write(answer, string'("o ") & integer'image(now_clock));
            writeline(answers, answer);
          end if;
        end loop;
        write(answer, string'("i ") & integer'image(now_clock));
        writeline(answers, answer);
      else
        read(step, number, good);
        assert good report "replay_tb: a step has no number" severity failure;
        case kind is
          when 'w' =>
            wait_clocks(clock, number);
          when 'q' =>
            while now_clock < maximum(start, last_activity) + number loop
              wait until rising_edge(clock);
              assert now_clock - start < step_clocks_most
                report "replay_tb: the core does not fall quiet" severity failure;
            end loop;
          when 'e' =>
            wait until rising_edge(clock);
            events <= std_ulogic_vector(to_unsigned(number, groups));
          when 'x' =>
            rx_error <= std_ulogic_vector(to_unsigned(number, 3));
            wait until rising_edge(clock);
            rx_error <= "000";
          when 'd' | 'k' =>
            start := natural'high;
            if number > 0 then
              start := now_clock + number;
            end if;
            if kind = 'd' then
              deaf_from <= start;
            else
              dead_from <= start;
            end if;
          when 'r' =>
            reset <= '1';
            wait_clocks(clock, number);
            reset <= '0';
          when others =>
            report "replay_tb: a step is " & kind severity failure;
        end case;
      end if;
      wait for 1 ps;  -- a byte that is sent in the last clock of a step belongs to it
      write(answer, string'("s"));
      writeline(answers, answer);
    end loop;
    write(answer, string'("end"));
    writeline(answers, answer);
    report_passed("replay_tb");
    ended <= true;
    wait;
  end process;

end architecture;
