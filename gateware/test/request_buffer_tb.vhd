-- SPDX-License-Identifier: BSD-3-Clause
--
-- request_buffer: commands from their letters, data bytes in order, two requests at a time, errors in their places.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bench_pkg.all;
use work.datalink_pkg.all;

entity request_buffer_tb is
  generic (
    complete : boolean := true  -- false: without read-many, publishing and RLC
  );
end entity;

architecture bench of request_buffer_tb is

  signal clock        : std_ulogic := '0';
  signal reset        : std_ulogic := '1';
  signal ended        : boolean := false;
  signal receive      : receive_t := (event => nothing, checked => '0', data => x"00");
  signal room         : std_ulogic;
  signal request      : request_t;
  signal take         : std_ulogic := '0';
  signal rewind       : std_ulogic := '0';
  signal request_done : std_ulogic := '0';

begin

  clock <= not clock after 1 ns when not ended;

  dut : entity work.request_buffer
    generic map (
      message_entries => 33, has_read_many => complete, has_publishing => complete, configuration_command => complete)
    port map (
      clock => clock, reset => reset, receive => receive, room => room,
      request => request, take => take, rewind => rewind, request_done => request_done);

  play : process

    procedure event(kind : receive_event_t; value : natural := 0; checked : std_ulogic := '0') is
    begin
      receive <= (event => kind, checked => checked, data => std_ulogic_vector(to_unsigned(value, 8)));
      wait until rising_edge(clock);
      receive.event <= nothing;
    end procedure;

    -- Sends letters, and after a colon `bytes` data bytes that count from `first`.
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

    procedure take_one is
    begin
      pulse(clock, take);
    end procedure;

    procedure done is
    begin
      pulse(clock, request_done);
      tick(clock);
    end procedure;

    procedure understand(letters : string; marked : boolean; command : natural; optional : boolean := true) is
      variable expected : natural := command;
    begin
      if optional and not complete then
        expected := command_unknown;
      end if;
      message(letters, marked);
      event(good);
      wait_clocks(clock, 2);
      wait for 1 ps;
      check_equal(request.valid, '1', "valid " & letters);
      check_equal(request.error, '0', "error " & letters);
      check_equal(request.checked, '1', "checked " & letters);
      if expected = command_unknown then  -- or another number without a command
        assert unsigned(request.command) = expected or unsigned(request.command) >= command_spelling
          report letters & " is " & to_string(request.command) severity failure;
        assert unsigned(request.command) < command_error report letters & " is no request" severity failure;
      else
        check_equal(to_integer(unsigned(request.command)), expected, "command " & letters);
      end if;
      take_one;
      check_equal(request.missing, '1', "missing " & letters);
      done;
    end procedure;

    procedure take_bytes(count : natural; first : natural) is
    begin
      for number in 0 to count - 1 loop
        check_equal(request.missing, '0', "missing");
        check_equal(to_integer(unsigned(request.data)), first + number, "data byte");
        take_one;
      end loop;
    end procedure;

  begin
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    understand("R", true, command_read, false);
    understand("r", true, command_read, false);
    understand("R", false, command_unknown, false);
    understand("W", true, command_write, false);
    understand("RM", true, command_read_many);
    understand("RMX", true, command_unknown);
    understand("RX", true, command_unknown);
    understand("", true, command_unknown);
    understand("RLC", false, command_read_configuration);
    understand("rLcX", false, command_read_configuration);
    understand("RL", false, command_unknown);
    understand("WSA", true, command_write_group_addresses);
    understand("WSAA", true, command_unknown);
    understand("WSR", true, command_write_group_rate);
    understand("RSI", true, command_read_group);
    understand("EPS", false, command_enable_publishing);
    understand("EPC", true, command_enable_checked_publishing);
    understand("DPSDPS", false, command_disable_publishing);
    understand("WIC", true, command_write_event_mask);
    understand("WIC", false, command_unknown);
    understand("RIC", false, command_read_event_mask);

    -- Two requests at a time, then no room. Data come in order, one byte per clock, and do not mix.
    message("R", true, 5, 10);
    event(good);
    message("W", true, 20, 100);
    check_equal(room, '1', "room for the second");
    event(good);
    wait for 1 ps;
    check_equal(room, '0', "room for a third");
    take_one;
    take_bytes(5, 10);
    check_equal(request.missing, '1', "nothing behind the first");
    -- Back to the start, and read again.
    pulse(clock, rewind);
    check_equal(to_integer(unsigned(request.command)), command_read, "the command again");
    take_one;
    take_bytes(3, 10);
    done;
    check_equal(room, '1', "room after the first is done");
    check_equal(request.valid, '1', "the second request follows");
    check_equal(to_integer(unsigned(request.command)), command_write, "its command");
    take_one;
    take_bytes(10, 100);
    -- A bad message drops only itself, and its error takes its place.
    message("R", true, 3, 50);
    event(bad, 16#F4#);
    take_bytes(10, 110);
    check_equal(request.missing, '1', "nothing behind the second");
    done;
    check_equal(request.valid, '1', "the error is next");
    check_equal(request.error, '1', "as an error");
    check_equal(request.data, std_ulogic_vector'(x"F4"), "its code");
    event(bad, 16#F1#);
    done;
    check_equal(request.error, '1', "a lone error");
    check_equal(request.data, std_ulogic_vector'(x"F1"), "its code");
    done;
    check_equal(request.valid, '0', "nothing left");
    -- A reset drops complete requests.
    message("R", true, 1, 0);
    event(good);
    pulse(clock, reset);
    for c in 1 to 3 loop
      wait until rising_edge(clock);
      check_equal(request.valid, '0', "valid after reset");
    end loop;
    report_passed("request_buffer_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 100 us, "request_buffer_tb");

end architecture;
