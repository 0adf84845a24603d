-- SPDX-License-Identifier: BSD-3-Clause
--
-- The framed protocol in few cells, for slow lines: the same bytes as `framed`, from a program of byte_processor.
--
--   frame --> ring |                |            | reply --> tx
--                  | memory of 512  | processor  |
--            bii <-- word, address  | its CRC    | --> dead-man
--
-- It has one block RAM for data, or two with publishing. The processor uses the memory in the two clocks of its
-- instructions as follows. In the first it reads, and a byte that has come in is written. In the second it writes, and
-- a byte that goes out is read. So bytes come and go beside the program, each at most every second clock.
--
-- Ports     As `framed`. It does not stand beside the classic protocol, so there is no session_open, may_begin, wants
--           or busy. It publishes by itself: `events` has one line for each group, synchronous to the clock.
-- Latency   The program checks a frame when its 00 has come. Figures: docs/gateware/framed_small.md.
-- Errors    docs/protocol.md. No lists or exchange groups; docs/gateware/framed_small.md has the sizes.
-- Pressure  A request waits until the reply before it is sent. The ring takes up to 127 bytes meanwhile. Frames in it
--           are checked, so the dead-man hears them. frame_ready is low while the ring is full.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;
use work.settings_pkg.all;
use work.small_instruction_pkg.all;
use work.small_memory_pkg.all;
use work.small_program_pkg.all;
use work.width_pkg.all;

entity framed_small is
  generic (
    settings : settings_t := core_settings(  -- docs/settings.md
      protocol => protocol_framed, publish_mode => 0, lists => false, exchanges => 0, window => 8);
    clock_start : natural range 0 to 65535 := 0  -- of the clock after a reset; for benches, which see it turn soon
  );
  port (
    clock             : in  std_ulogic;
    reset             : in  std_ulogic;
    frame_valid       : in  std_ulogic;
    frame_ready       : out std_ulogic;
    frame_data        : in  byte_t;
    receive_overrun   : in  std_ulogic := '0';
    tx_valid          : out std_ulogic;
    tx_ready          : in  std_ulogic;
    tx_data           : out byte_t;
    tx_last           : out std_ulogic;
    tx_publish        : out std_ulogic;
    events            : in  std_ulogic_vector(settings.groups - 1 downto 0) := (others => '0');
    dead_man_request  : out dead_man_request_t;
    dead_man_response : in  dead_man_response_t := dead_man_response_idle;
    bii_request       : out bii_request_t;
    bii_response      : in  bii_response_t
  );
end entity;

architecture rtl of framed_small is

  constant s : frame_settings_t := small_settings_of(settings);

  constant publishing   : boolean  := s.groups > 0;
  constant memory_bits  : positive := bits_for(memory_size(settings));

  function program_of (publishes : boolean) return small_program_t is
  begin
    if publishes then
      return publishing_program;
    end if;
    return plain_program;
  end function;

  subtype place_t is unsigned(6 downto 0);  -- within 128 bytes of the memory

  constant reply_start : place_t := to_unsigned(small_reply mod 128, 7);
  constant put_start   : place_t := reply_start + 2;  -- behind the kind and the first COBS code
  constant reply_page  : unsigned(1 downto 0) := to_unsigned(small_reply / 128, 2);
  constant ring_page   : unsigned(1 downto 0) := to_unsigned(small_ring / 128, 2);

  signal memory : small_memory_t(0 to 2 ** memory_bits - 1) := memory_content(settings);

  signal executing, store, put : std_ulogic;
  signal address, pointer      : unsigned(9 downto 0);
  signal operand, looked, accumulator, given, port_read, port_data : byte_t;
  signal acts, tells, notes    : small_actions_t;
  signal port_number           : small_port_t;
  signal conditions            : small_conditions_t;
  signal status                : byte_t;

  signal read_address, write_address : unsigned(9 downto 0);
  signal written                     : byte_t;
  signal writes                      : std_ulogic;

  signal come    : place_t := (others => '0');  -- of the next byte in the ring
  signal free    : place_t := (others => '0');  -- the first byte that is still in use
  signal full    : std_ulogic := '0';
  signal pieces  : unsigned(5 downto 0) := (others => '0');  -- that wait in the ring, with their 00
  signal accepts : std_ulogic;

  signal reply_place : place_t := put_start;
  signal sending, reading, offers, last : std_ulogic := '0';
  signal goes, ends, sent      : std_ulogic;

  signal crc     : crc16_t := (others => '0');
  signal clocks  : unsigned(15 downto 0) := to_unsigned(clock_start, 16);
  signal turned, overran : std_ulogic := '0';
  signal wants   : std_ulogic_vector(6 downto 0);  -- of publishing
  signal alert   : std_ulogic;
  signal hold    : std_ulogic;

  signal word         : word32_t := (others => '0');
  signal word_address : unsigned(8 * s.address_bytes - 1 downto 0) := (others => '0');
  signal accessing, bus_writes : std_ulogic := '0';
  signal answer       : std_ulogic_vector(1 downto 0) := "00";

begin

  assert not settings.lists and settings.exchanges = 0
    report "framed_small: it has no lists and exchange groups; set lists false, exchanges 0" severity failure;
  assert s.groups <= small_groups_max
    report "framed_small: groups is " & integer'image(s.groups) & "; it has room for "
      & integer'image(small_groups_max) severity failure;
  assert s.group_size <= group_size_most(s)
    report "framed_small: group_size is " & integer'image(s.group_size) & "; a group has room for "
      & integer'image(group_size_most(s)) & " words of these widths" severity failure;
  assert not publishing or s.rate_bytes = small_rate_bytes
    report "framed_small: rate_bytes is " & integer'image(s.rate_bytes) & "; set it to "
      & integer'image(small_rate_bytes) severity failure;
  assert settings.window <= small_window_max
    report "framed_small: window is " & integer'image(settings.window) & "; it has places for "
      & integer'image(small_window_max) severity failure;
  assert settings.window = 2 ** bits_for(settings.window)
    report "framed_small: window is " & integer'image(settings.window) & "; set it to a power of two" severity failure;

  processor : entity work.byte_processor
    generic map (program => program_of(publishing))
    port map (
      clock => clock, reset => reset, executing => executing, address => address, operand => operand,
      accumulator => accumulator, given => given, pointer => pointer, store => store, put => put,
      acts => acts, tells => tells, notes => notes,
      port_number => port_number, port_data => port_data, conditions => conditions);

  conditions <= (
    piece => or pieces, sending => sending, accessing => accessing, alert => turned or alert);

  status <= overran & dead_man_response.uncounted & answer & dead_man_response.tripped_now & full &
            dead_man_response.running & dead_man_response.tripped;

  with port_number(1 downto 0) select port_read <=
    word(31 downto 24)             when "00",
    '1' & crc(6 downto 0)          when "01",
    status                         when "10",
    byte_t(pointer(7 downto 0))    when others;
  port_data <= port_read when port_number(2) = '0' else
               turned & wants when publishing and port_number(0) = '0' else
               '0' & std_ulogic_vector(reply_place);

  -- The memory: one port reads and one writes, by turns for the program and for the line.

  accepts     <= frame_valid and not executing and not full;
  frame_ready <= not executing and not full;

  turns : process (all)
  begin
    read_address  <= address;
    write_address <= '0' & ring_page & come;
    written       <= frame_data;
    writes        <= accepts;
    if executing = '1' then
      read_address  <= '0' & reply_page & reply_place;
      write_address <= address;
      written       <= given;
      writes        <= store or put;
      if put = '1' then
        write_address <= '0' & reply_page & reply_place;
      end if;
    end if;
  end process;

  remember : process (clock)
  begin
    if rising_edge(clock) then
      if writes = '1' then
        memory(to_integer(write_address(memory_bits - 1 downto 0))) <= written;
      end if;
      looked <= memory(to_integer(read_address(memory_bits - 1 downto 0)));
    end if;
  end process;

  operand <= to_stdlogicvector(to_bitvector(looked));  -- known before the first clock, too

  receive : process (clock)
  begin
    if rising_edge(clock) then
      if accepts = '1' then
        come <= come + 1;
      end if;
      full <= (come + 1) ?= free;
      if notes(note_piece_taken) = '1' then
        pieces <= pieces - 1;
      elsif accepts = '1' and nor frame_data = '1' then
        pieces <= pieces + 1;
      end if;
      if acts(out_free) = '1' then
        free <= unsigned(accumulator(6 downto 0));
      end if;
      overran <= receive_overrun or (overran and not tells(tell_overrun_seen));
      if reset = '1' then
        come    <= (others => '0');
        free    <= (others => '0');
        pieces  <= (others => '0');
        full    <= '0';
        overran <= '0';
      end if;
    end if;
  end process;

  -- The reply goes out up to its 00, which is the only zero in it.

  goes <= reading and not executing and (tx_ready or not offers);
  ends <= nor operand;
  sent <= goes and ends;

  tx_valid <= offers;
  tx_last  <= last;

  send : process (clock)
  begin
    if rising_edge(clock) then
      if tx_ready = '1' then
        offers <= '0';
      end if;
      if goes = '1' then
        tx_data <= operand;
        last    <= ends;
        offers  <= '1';
      end if;
      if executing = '1' then
        reading <= sending;  -- from the next clock on `operand` is a byte of the reply in each first clock
      end if;
      if put = '1' or goes = '1' then
        reply_place <= reply_place + 1;
      end if;
      if acts(out_send) = '1' then
        sending <= '1';
      elsif sent = '1' then
        sending <= '0';
      end if;
      if acts(out_send) = '1' then
        reply_place <= reply_start;
      end if;
      if sent = '1' or notes(note_again) = '1' or reset = '1' then
        reply_place <= put_start;
      end if;
      if reset = '1' then
        sending <= '0';
        reading <= '0';
        offers  <= '0';
      end if;
    end if;
  end process;

  -- Publishing.

  publishes : if publishing generate
    constant groups   : positive := minimum(s.groups, small_groups_max);  -- so that the assertion above speaks
    signal is_publish : std_ulogic;
  begin
    small_publishing : entity work.small_publishing
      generic map (
        clock_hz => s.clock_hz, base_hz => s.base_hz, groups => groups, edge_events => settings.edge_events)
      port map (
        clock => clock, reset => reset, events => events(groups - 1 downto 0), notes => notes, given => given,
        sent => sent, wants => wants, alert => alert, hold => hold, is_publish => is_publish);

    -- The last byte is still offered when it was read as `sent`.
    publish_flag : process (clock)
    begin
      if rising_edge(clock) then
        if goes = '1' then
          tx_publish <= is_publish;
        end if;
      end if;
    end process;
  else generate
    wants      <= (others => '0');
    alert      <= '0';
    hold       <= '0';
    tx_publish <= '0';
  end generate;

  -- CRC and clock.

  sum : process (clock)
  begin
    if rising_edge(clock) then
      if acts(out_crc_clear) = '1' then
        crc <= (others => '0');
      elsif acts(out_crc) = '1' then
        crc <= next_crc16(crc, given);
      elsif tells(tell_check_next) = '1' then
        crc <= "0000000" & crc(15 downto 7);
      end if;
    end if;
  end process;

  count : process (clock)
  begin
    if rising_edge(clock) then
      clocks <= clocks + 1;
      if and clocks = '1' then
        turned <= '1';
      elsif tells(tell_turn_seen) = '1' then
        turned <= '0';
      end if;
      if reset = '1' then
        clocks <= to_unsigned(clock_start, 16);
        turned <= '0';
      end if;
    end if;
  end process;

  -- The bus.

  bus_access : process (clock)
  begin
    if rising_edge(clock) then
      if acts(out_shift_address) = '1' then
        word_address <= word_address(word_address'left - 8 downto 0) & unsigned(given);
      end if;
      if acts(out_shift_data) = '1' then
        word <= word(23 downto 0) & given;
      end if;
      if acts(out_time) = '1' then
        word(31 downto 16) <= std_ulogic_vector(clocks);
      end if;
      if acts(out_read) = '1' or acts(out_write) = '1' then
        accessing  <= '1';
        bus_writes <= acts(out_write);
      elsif accessing = '1' and bii_response.done = '1' then
        accessing <= '0';
        case bii_response.status is
          when ok     => answer <= "00";
          when error  => answer <= "01";
          when silent => answer <= "10";
          when denied => answer <= "11";
        end case;
        if bus_writes = '0' then
          -- Its highest byte is the first one of the word.
          word <= std_ulogic_vector(shift_left(unsigned(bii_response.data), 32 - 8 * s.data_bytes));
        end if;
      end if;
      if reset = '1' then
        accessing <= '0';
      end if;
    end if;
  end process;

  ask : process (all)
  begin
    bii_request       <= bii_request_idle;
    bii_request.valid <= accessing;
    bii_request.write <= bus_writes;
    bii_request.block_hold <= hold;
    bii_request.address(s.address_width - 1 downto 0) <= std_ulogic_vector(word_address(s.address_width - 1 downto 0));
    bii_request.data(s.data_width - 1 downto 0)       <= word(s.data_width - 1 downto 0);
  end process;

  dead_man_request <= (
    alive => tells(tell_alive), start => tells(tell_start), ticks => word, trip => tells(tell_trip),
    renew => tells(tell_renew), arm => tells(tell_arm), counted => tells(tell_counted));

end architecture;
