-- SPDX-License-Identifier: BSD-3-Clause
--
-- frame_transmitter with a file of frames and their bytes on the wire from the reference
-- (tests/gateware/test_framed_units.py).
--
-- Lines:  e NUMBER              the epoch from here on
--        f KIND PAYLOAD WIRE   a payload (- is none) is put, with a false start before every third; WIRE must be sent

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use std.textio.all;
use work.bench_pkg.all;
use work.frame_pkg.all;

entity frame_transmitter_tb is
  generic (
    vectors_file  : string;
    stall_percent : natural := 0
  );
end entity;

architecture bench of frame_transmitter_tb is

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal ended : boolean := false;
  signal epoch : crc16_t := x"FFFF";
  signal reply : frame_reply_t := frame_reply_idle;
  signal ready, idle : std_ulogic;
  signal tx_valid, tx_last, tx_publish : std_ulogic;
  signal tx_ready : std_ulogic := '1';
  signal tx_data  : std_ulogic_vector(7 downto 0);

  signal seen : natural := 0;  -- frames seen

begin

  clock <= not clock after 5 ns when not ended;

  transmitter : entity work.frame_transmitter
    port map (
      clock => clock, reset => reset, epoch => epoch, reply => reply, ready => ready, idle => idle,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  listen : process (clock)
    file vectors     : text open read_mode is vectors_file;
    variable wire    : line := new string'("");
    variable gap     : character;
    variable byte    : std_ulogic_vector(7 downto 0);
    variable random  : random_t;
    variable seeded  : boolean := false;
    variable opening : boolean := true;
    variable publish : boolean := false;
  begin
    if rising_edge(clock) then
      if not seeded then
        random.seed(2);
        seeded := true;
      end if;
      if reset = '0' and tx_valid = '1' and tx_ready = '1' then
        if wire'length < 2 then
          loop
            readline(vectors, wire);
            read(wire, gap);
            exit when gap = 'f';
          end loop;
          for field in 1 to 3 loop
            loop
              read(wire, gap);
              exit when gap = ' ';
            end loop;
          end loop;
        end if;
        hread(wire, byte);
        check_equal(tx_data, byte, "a byte of frame " & integer'image(seen));
        check((tx_last = '1') = (tx_data = x"00"), "tx_last");
        if opening then
          publish := tx_data = x"D2";
        end if;
        check((tx_publish = '1') = publish, "tx_publish");
        opening := tx_data = x"00";
        if opening then
          check(wire'length < 2, "the end of a frame");
          seen <= seen + 1;
        end if;
      end if;
      tx_ready <= '1';
      if random.chance(stall_percent) then
        tx_ready <= '0';
      end if;
    end if;
  end process;

  play : process
    file vectors    : text open read_mode is vectors_file;
    variable step   : line;
    variable what   : character;
    variable gap    : character;
    variable number : natural;
    variable byte   : std_ulogic_vector(7 downto 0);
    variable kind   : std_ulogic_vector(7 downto 0);
    variable frames : natural := 0;

    procedure give (put, is_kind, again, finish : std_ulogic; data : std_ulogic_vector(7 downto 0)) is
    begin
      reply <= (put => put, kind => is_kind, restart => again, finish => finish, data => data);
      wait until rising_edge(clock) and ready = '1';
      reply <= frame_reply_idle;
    end procedure;
  begin
    wait until rising_edge(clock);
    wait until rising_edge(clock);
    reset <= '0';
    wait until rising_edge(clock);
    while not endfile(vectors) loop
      readline(vectors, step);
      read(step, what);
      read(step, gap);
      if what = 'e' then
        read(step, number);
        wait until rising_edge(clock) and idle = '1';
        epoch <= std_ulogic_vector(to_unsigned(number, 16));
      else
        hread(step, kind);
        read(step, gap);
        frames := frames + 1;
        if frames mod 3 = 0 then
          give('1', '0', '0', '0', x"00");
          give('1', '0', '0', '0', x"77");
          give('0', '0', '1', '0', x"00");
        end if;
        if frames mod 2 = 0 then
          give('0', '1', '0', '0', kind);
        end if;
        if step(step'left) = '-' then
          read(step, gap);
        end if;
        while step(step'left) /= ' ' loop
          hread(step, byte);
          give('1', '0', '0', '0', byte);
        end loop;
        if frames mod 2 = 0 then
          give('0', '0', '0', '1', x"00");
        else
          give('0', '1', '0', '1', kind);
        end if;
      end if;
    end loop;
    wait until rising_edge(clock);
    wait until rising_edge(clock) and idle = '1';
    check(frames > 0, "frames were sent");
    check_equal(seen, frames, "frames on the wire");
    report_passed("frame_transmitter_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 50 ms, "frame_transmitter_tb");

end architecture;
