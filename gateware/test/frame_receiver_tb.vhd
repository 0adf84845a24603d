-- SPDX-License-Identifier: BSD-3-Clause
--
-- frame_receiver with a file of bytes on the wire, checked against the reference (tests/gateware/test_framed_units.py).
--
-- Lines:  e NUMBER          the epoch from here on
--         s HEX             bytes from the host
--        x ENTRY PAYLOAD   the next frame; its payload is read twice, and the frame is done
--        n                 there is no frame

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use std.textio.all;
use work.bench_pkg.all;
use work.frame_pkg.all;

entity frame_receiver_tb is
  generic (
    vectors_file  : string;
    request_max   : positive := 250;
    ring_bytes    : positive := 512;
    stall_percent : natural  := 0
  );
end entity;

architecture bench of frame_receiver_tb is

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;
  signal epoch : crc16_t := x"FFFF";
  signal frame_valid, frame_ready : std_ulogic := '0';
  signal frame_data  : std_ulogic_vector(7 downto 0) := x"00";
  signal request     : frame_request_t;
  signal take, rewind, done : std_ulogic := '0';

begin

  clock <= not clock after 5 ns when not ended;

  receiver : entity work.frame_receiver
    generic map (request_max => request_max, ring_bytes => ring_bytes)
    port map (
      clock => clock, reset => reset, epoch => epoch, frame_valid => frame_valid, frame_ready => frame_ready,
      frame_data => frame_data, request => request, take => take, rewind => rewind, done => done);

  play : process
    file vectors     : text open read_mode is vectors_file;
    variable random  : random_t;
    variable step    : line;
    variable kind    : character;
    variable gap     : character;
    variable number  : natural;
    variable byte    : std_ulogic_vector(7 downto 0);
    variable good    : boolean;
    variable checked : natural := 0;
    type bytes_t is array (0 to 255) of std_ulogic_vector(7 downto 0);
    variable payload : bytes_t;
    variable length  : natural;
  begin
    random.seed(1);
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    wait until rising_edge(clock);
    while not endfile(vectors) loop
      readline(vectors, step);
      read(step, kind);
      if step'length > 0 then
        read(step, gap);
      end if;
      case kind is
        when 'e' =>
          read(step, number);
          epoch <= std_ulogic_vector(to_unsigned(number, 16));
        when 's' =>
          while step'length >= 2 loop
            hread(step, byte);
            pause(clock, random, stall_percent);
            send(clock, frame_valid, frame_ready, frame_data, byte);
          end loop;
        when 'x' =>
          read(step, number);
          read(step, gap, good);
          length := 0;
          while step'length >= 2 loop
            hread(step, payload(length));
            length := length + 1;
          end loop;
          for count in 1 to 4 loop
            exit when request.valid = '1';
            tick(clock);
          end loop;
          check_equal(request.valid, '1', "a frame stands");
          check_equal(to_integer(unsigned(request.entry)), number, "its entry");
          check_equal(to_integer(request.length), length, "its length");
          for pass in 1 to 2 loop
            pulse(clock, rewind);
            tick(clock);
            for place in 0 to length - 1 loop
              check_equal(to_integer(request.left), length - place, "bytes left");
              check_equal(request.data, payload(place), "byte " & integer'image(place));
              pulse(clock, take);
            end loop;
            check_equal(request.missing, '1', "nothing is left");
          end loop;
          pulse(clock, done);
          checked := checked + 1;
        when 'n' =>
          wait_clocks(clock, 4);
          check_equal(request.valid, '0', "no frame stands");
        when others =>
          report "frame_receiver_tb: a line is " & kind severity failure;
      end case;
    end loop;
    check(checked > 0, "frames were checked");
    report_passed("frame_receiver_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 50 ms, "frame_receiver_tb");

end architecture;
