-- SPDX-License-Identifier: BSD-3-Clause
--
-- datalink with its transmitter wired to its own receiver. In each variant and at any pace, it receives what it sends.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity datalink_tb is
  generic (
    datalink : string   := "full";
    checksum : string   := "crc8";
    stalls   : natural  := 30;   -- percent of the clocks
    messages : positive := 200;
    seed     : positive := 1
  );
end entity;

architecture bench of datalink_tb is

  constant events_most : positive := 40 * messages;

  type events_t is array (0 to events_most - 1) of receive_t;

  signal clock       : std_ulogic := '0';
  signal reset       : std_ulogic := '1';
  signal ended       : boolean := false;
  signal stalled     : std_ulogic := '0';
  signal link_valid  : std_ulogic;
  signal link_ready  : std_ulogic;
  signal link_data   : byte_t;
  signal rx_valid    : std_ulogic;
  signal tx_ready    : std_ulogic;
  signal rx_error    : std_ulogic_vector(2 downto 0) := "000";
  signal receive     : receive_t;
  signal room        : std_ulogic := '1';
  signal message_end : std_ulogic;
  signal word_valid  : std_ulogic := '0';
  signal word_ready  : std_ulogic;
  signal word_data   : word_t := (others => '0');
  signal expected    : events_t;
  signal planned     : natural := 0;  -- events of the messages sent so far
  signal seen        : natural := 0;
  signal last_byte   : natural := 0;  -- the event that ends the current message

begin

  clock    <= not clock after 1 ns when not ended;
  rx_valid <= link_valid and not stalled;
  tx_ready <= link_ready and not stalled;

  message_end <= '1' when (receive.event = byte or receive.event = colon) and seen = last_byte else '0';

  dut : entity work.datalink
    generic map (datalink => datalink, message_entries => 64, checksum => checksum)
    port map (
      clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => link_ready, rx_data => link_data,
      rx_error => rx_error, receive => receive, room => room, message_end => message_end,
      word_valid => word_valid, word_ready => word_ready, word_data => word_data,
      tx_valid => link_valid, tx_ready => tx_ready, tx_data => link_data);

  listen : process (clock)
    variable random : random_t;
    variable seeded : boolean := false;
  begin
    if rising_edge(clock) and reset = '0' then
      if not seeded then
        random.seed(seed + 100);
        seeded := true;
      end if;
      stalled <= '0';
      if random.chance(stalls) then
        stalled <= '1';
      end if;
      room <= '1';
      if random.chance(stalls) and (datalink /= "full" or seen = planned) then
        room <= '0';
      end if;
      if receive.event /= nothing then
        check(seen < planned, "an event of nothing that was sent");
        check(receive.event = expected(seen).event,
              "event " & integer'image(seen) & " is " & receive_event_t'image(receive.event));
        if receive.event = start then
          check_equal(receive.checked, expected(seen).checked, "checked");
        elsif receive.event = letter or receive.event = byte or receive.event = bad then
          check_equal(receive.data, expected(seen).data, "data");
        end if;
        seen <= seen + 1;
      end if;
    end if;
  end process;

  play : process

    variable random : random_t;
    variable plan   : natural := 0;

    procedure send(kind : std_ulogic_vector(2 downto 0); data : byte_t) is
    begin
      send(clock, word_valid, word_ready, word_data, kind & data);
    end procedure;

    procedure expect(event : receive_event_t; data : byte_t := x"00"; checked : std_ulogic := '0') is
    begin
      expected(plan) <= (event => event, checked => checked, data => data);
      plan := plan + 1;
      planned <= plan;
    end procedure;

    variable head    : byte_t;
    variable data    : byte_t;
    variable checked : std_ulogic;
    variable bytes   : natural;
  begin
    random.seed(seed);
    wait until rising_edge(clock);
    reset <= '0';
    for message in 1 to messages loop
      head    := byte_plain_head_c;
      checked := '0';
      if datalink = "full" and checksum /= "none" and random.chance(50) then
        head    := byte_checked_head_c;
        checked := '1';
      end if;
      expect(start, checked => checked);
      send(word_head, head);
      for count in 1 to random.integer_between(1, 4) loop
        data := byte_t(to_unsigned(random.integer_between(65, 90), 8));
        expect(letter, data);
        send(word_letter, data);
      end loop;
      if random.chance(80) then
        expect(colon);
        bytes     := random.integer_between(0, 20);
        last_byte <= plan - 1 + bytes;
        send(word_mark, byte_data_mark_c);
        for count in 1 to bytes loop
          data := byte_t(random.vector(8));
          expect(byte, data);
          send(word_byte, data);
        end loop;
        if datalink /= "none" then
          expect(good);
        end if;
      else
        expect(good);
      end if;
      send(word_tail, x"00");
      if random.chance(20) or datalink = "none" then  -- `last_byte` is for one message only
        wait until rising_edge(clock) and seen = plan;
      end if;
    end loop;
    wait until rising_edge(clock) and seen = plan;
    -- Only the full datalink uses the errors of the physical layer.
    rx_error <= "010";
    if datalink = "full" then
      expect(bad, x"F7");
    end if;
    wait until rising_edge(clock);
    rx_error <= "000";
    wait_clocks(clock, 100);
    check_equal(seen, plan, "events in all");
    report_passed("datalink_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 ms, "datalink_tb");

end architecture;
