-- SPDX-License-Identifier: BSD-3-Clause
--
-- request_buffer: commands by their letters, data bytes in order, two requests at a time, errors in their places.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bench_pkg.all;
use work.datalink_pkg.all;

entity request_buffer_tb is
  generic (
    complete : boolean := true  -- else without read-many, publishing and RLC
  );
end entity;

architecture bench of request_buffer_tb is

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal ended        : boolean := false;
  signal receive      : receive_t := (event => nothing, checked => '0', data => x"00");
  signal room         : std_ulogic;
  signal request      : request_t;
  signal data         : std_ulogic_vector(7 downto 0);
  signal take         : std_ulogic := '0';
  signal request_done : std_ulogic := '0';

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.request_buffer
    generic map (
      message_entries => 33, has_read_many => complete, has_publishing => complete, configuration_command => complete)
    port map (
      clock => clock, reset => reset, receive => receive, room => room,
      request => request, data => data, take => take, request_done => request_done);

  play : process

    procedure event(kind : receive_event_t; value : natural := 0; checked : std_ulogic := '0') is
    begin
      receive <= (event => kind, checked => checked, data => std_ulogic_vector(to_unsigned(value, 8)));
      wait until rising_edge(clock);
      receive.event <= nothing;
    end procedure;

    -- Letters, and `bytes` data bytes that count from `first` if there is a colon.
    procedure message(letters : string; marked : boolean; bytes : natural := 0; first : natural := 0) is
    begin
      event(start, checked => '1');
      for place in letters'range loop
        event(letter, character'pos(letters(place)));
      end loop;
      if marked then
        event(colon);
      end if;
      for number in 0 to bytes - 1 loop
        event(byte, first + number);
      end loop;
    end procedure;

    procedure done is
    begin
      request_done <= '1';
      wait until rising_edge(clock);
      request_done <= '0';
      wait until rising_edge(clock);
    end procedure;

    procedure understand(letters : string; marked : boolean; command : command_t; optional : boolean := true) is
      variable expected : command_t := command;
    begin
      if optional and not complete then
        expected := unknown;
      end if;
      message(letters, marked);
      event(good);
      wait until rising_edge(clock);
      check_equal(request.valid, '1', "valid " & letters);
      assert request.command = expected
        report letters & " is " & command_t'image(request.command) severity failure;
      done;
    end procedure;

    procedure take_bytes(count : natural; first : natural) is
    begin
      for number in 0 to count - 1 loop
        check_equal(to_integer(unsigned(data)), first + number, "data byte");
        take <= '1';
        wait until rising_edge(clock);
        take <= '0';
        wait for 1 ps;
      end loop;
    end procedure;

  begin
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    understand("R", true, read, false);
    understand("r", true, read, false);
    understand("R", false, unknown, false);
    understand("W", true, write, false);
    understand("RM", true, read_many);
    understand("RMX", true, unknown);
    understand("RX", true, unknown);
    understand("", true, unknown);
    understand("RLC", false, read_configuration);
    understand("rLcX", false, read_configuration);
    understand("RL", false, unknown);
    understand("WSA", true, write_group_addresses);
    understand("WSAA", true, unknown);
    understand("WSR", true, write_group_rate);
    understand("RSI", true, read_group);
    understand("EPS", false, enable_publishing);
    understand("EPC", true, enable_checked_publishing);
    understand("DPSDPS", false, disable_publishing);
    understand("WIC", true, write_event_mask);
    understand("WIC", false, unknown);
    understand("RIC", false, read_event_mask);

    -- Two requests at a time, then no room; data come in order, a byte a clock, and do not mix.
    message("R", true, 5, 10);
    event(good);
    message("W", true, 20, 100);
    check_equal(room, '1', "room for the second");
    event(good);
    wait for 1 ps;
    check_equal(room, '0', "room for a third");
    check_equal(to_integer(request.length), 5, "length of the first");
    take_bytes(3, 10);
    done;
    check_equal(room, '1', "room after the first is done");
    check(request.command = write, "the second request follows");
    check_equal(to_integer(request.length), 20, "length of the second");
    take_bytes(10, 100);
    -- A message that turns out bad takes only itself along, and its error stands in its place.
    message("R", true, 3, 50);
    event(bad, 16#F4#);
    take_bytes(10, 110);
    done;
    check_equal(request.error, '1', "the error is next");
    check_equal(request.code, std_ulogic_vector'(x"F4"), "its code");
    event(bad, 16#F1#);
    done;
    check_equal(request.code, std_ulogic_vector'(x"F1"), "code of a lone error");
    done;
    check_equal(request.valid, '0', "nothing left");
    -- A reset forgets what is complete.
    message("R", true, 1, 0);
    event(good);
    reset <= '1';
    wait until rising_edge(clock);
    reset <= '0';
    wait until rising_edge(clock);
    check_equal(request.valid, '0', "valid after reset");
    report_passed("request_buffer_tb");
    ended <= true;
    wait;
  end process;

  watchdog : process
  begin
    wait for 100 us;
    assert ended report "request_buffer_tb: took too long" severity failure;
    wait;
  end process;

end architecture;
