-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pins of absolute_encoder, for benches: an encoder of each kind behind a line that delays. It
-- checks the times that a datasheet asks for.
--
--   fault  0 none, 1 silent (the line is low), 2 silent (it is high), 3 one bit is wrong, 4 the device reports an
--          error, 5 it warns (BiSS-C)
--   shown  the last position that was latched

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity absolute_encoder_model is
  generic (
    kind        : natural range 0 to 2 := 0;
    bits        : positive             := 13;
    lead_bits   : natural              := 0;
    tail_bits   : natural              := 0;
    gray        : natural              := 1;
    half_least  : time                 := 50 ns;
    pause_least : time                 := 20 us
  );
  port (
    sclk     : in  std_ulogic;
    select_n : in  std_ulogic;
    mosi     : in  std_ulogic;
    miso     : out std_ulogic;

    delay    : in  time; -- of the line
    position : in  unsigned(bits - 1 downto 0);
    fault    : in  natural;
    shown    : out unsigned(bits - 1 downto 0);
    frames   : out natural
  );
end entity;

architecture behaviour of absolute_encoder_model is

  signal answer : std_ulogic := '1';

  -- CRC-6 of polynomial 43, as it is sent.
  function crc_of (word : std_ulogic_vector) return std_ulogic_vector is
    variable crc : std_ulogic_vector(5 downto 0) := (others => '0');
    variable top : std_ulogic;
  begin
    for place in word'range loop
      top := crc(5) xor word(place);
      crc := (crc(4 downto 0) & '0') xor ("0000" & top & top);
    end loop;
    return not crc;
  end function;

  function with_parity (word : std_ulogic_vector(14 downto 0)) return std_ulogic_vector is
  begin
    return (xor word) & word;
  end function;

begin

  -- Frames of the reference.
  assert crc_of(std_ulogic_vector(to_unsigned(0, 26)) & "11") = 6x"3A" and
         crc_of(std_ulogic_vector(to_unsigned(16#0123456#, 26)) & "11") = 6x"35" and
         crc_of(std_ulogic_vector(to_unsigned(16#3FFFFFF#, 26)) & "11") = 6x"22" and
         crc_of(std_ulogic_vector(to_unsigned(16#2AAAAAA#, 26)) & "10") = 6x"29" and
         crc_of(std_ulogic_vector(to_unsigned(16#1A2B3#, 18)) & "11") = 6x"2C"
    report "the CRC is not that of the reference"
    severity failure;

  miso <= transport answer after delay when fault /= 1 and fault /= 2 else
          '0' when fault = 1 else '1';

  -- SSI and BiSS-C: sclk is high at rest, and the first fall latches.
  serial : if kind /= 2 generate
    play : process is
      variable word  : std_ulogic_vector(lead_bits + bits + tail_bits - 1 downto 0);
      variable sent  : std_ulogic_vector(bits + 7 downto 0);
      variable here  : unsigned(bits - 1 downto 0);
      variable since : time := 0 ns;
      variable count : natural := 0;
      variable alive : boolean;
    begin
      answer <= '1';
      shown  <= (others => '0');
      frames <= 0;
      loop
        wait until falling_edge(sclk);
        check(since = 0 ns or now - since >= pause_least, "the pause is too short");
        here  := position;
        shown <= here;
        count := count + 1;
        since := now;
        alive := true;
        if kind = 0 then
          word := (others => '1');
          word(tail_bits + bits - 1 downto tail_bits) := std_ulogic_vector(here);
          if gray = 1 then
            word(tail_bits + bits - 1 downto tail_bits) := std_ulogic_vector(here xor ('0' & here(bits - 1 downto 1)));
          end if;
          for place in word'range loop
            wait until rising_edge(sclk);
            answer <= word(place);
            wait until falling_edge(sclk);
          end loop;
          wait until rising_edge(sclk);
          answer <= '0';
          since  := now;
          wait for pause_least;
          answer <= '1';
        else
          sent(bits + 7 downto 6) := std_ulogic_vector(here) & '1' & '1';
          sent(7) := '0' when fault = 4 else '1';
          sent(6) := '0' when fault = 5 else '1';
          sent(5 downto 0) := crc_of(sent(bits + 7 downto 6));
          if fault = 3 then
            sent(bits + 5) := not sent(bits + 5);
          end if;
          wait until rising_edge(sclk);
          wait until rising_edge(sclk);
          answer <= '0';
          for late in 1 to 3 + count mod 5 loop -- the device needs some clocks
            wait until rising_edge(sclk);
          end loop;
          answer <= '1';
          wait until rising_edge(sclk);
          answer <= '0';
          for place in sent'range loop
            wait until rising_edge(sclk);
            answer <= sent(place);
          end loop;
          wait until rising_edge(sclk) for 1 us;
          answer <= '0';
          -- The clock stops: the rest of what is under way on the line.
          while alive loop
            since := now;
            wait until sclk'event for pause_least - 2 us;
            alive := sclk'event;
          end loop;
          check(sclk = '1', "sclk is high at rest");
          answer <= '1';
        end if;
        frames <= count;
      end loop;
    end process;
  end generate;

  -- SPI: an answer is to the command before.
  spi : if kind = 2 generate
    play : process is
      variable command, reply : std_ulogic_vector(15 downto 0) := (others => '0');
      variable is_error       : std_ulogic := '0';
      variable count          : natural := 0;
      variable here           : unsigned(bits - 1 downto 0);
      variable since          : time := 0 ns;
    begin
      answer <= '1';
      shown  <= (others => '0');
      frames <= 0;
      reply  := x"0000";
      loop
        wait until falling_edge(select_n);
        check(sclk = '0', "sclk is low at rest");
        check(since = 0 ns or now - since >= 350 ns, "select_n is high for too short a time");
        since := now;
        if fault = 3 then
          reply(3) := not reply(3);
        end if;
        for place in reply'range loop
          wait until rising_edge(sclk);
          check(now - since >= half_least and (place < 15 or now - since >= 350 ns), "sclk comes too early");
          since  := now;
          answer <= reply(place);
          wait until falling_edge(sclk);
          check(now - since >= half_least and mosi'last_event >= half_least, "sclk is too fast");
          since := now;
          command(place) := mosi;
        end loop;
        wait until rising_edge(select_n) or rising_edge(sclk);
        check(rising_edge(select_n) and now - since >= half_least, "a frame has 16 bits");
        since  := now;
        answer <= '1';
        check((xor command) = '0', "a command has even parity");
        if fault = 4 then
          is_error := '1';
        end if;
        case command is
          when x"FFFF" =>
            here  := position;
            shown <= here;
            reply := with_parity(is_error & std_ulogic_vector(resize(here, 14)));
          when x"7FFD" => reply := with_parity(is_error & "00010110000011");
          when x"4001" =>
            reply    := with_parity(is_error & "00000000000001");
            is_error := '0';
          when others => report "an unknown command " & to_hstring(command) severity failure;
        end case;
        count  := count + 1;
        frames <= count;
      end loop;
    end process;
  end generate;

end architecture;
