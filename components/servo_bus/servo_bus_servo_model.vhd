-- SPDX-License-Identifier: BSD-3-Clause
--
-- A servo on a bus, for benches: it takes writes to all servos, and answers questions to it. protocol 0 is that of
-- Dynamixel, 1 that of Feetech.
--
-- Ports     position, speed, load: what it measures, in two's complement. alarm: its error byte.
--           fault: 0 none, 1 silent, 2 a wrong check, 3 a byte is lost, 4 noise before the reply, 5 the id of another,
--           6 it stops in a byte, 7 it sends until the fault ends.
--           crowded: somebody else sends at any time, so nothing is asserted.
--           torque and goal are what it was told. packets counts the packets that it understood.
-- Errors    Assertions fail for a wrong check, a wrong length and a broken byte of the master, and if the line is
--           driven while it answers.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

entity servo_bus_servo_model is
  generic (
    protocol : natural;
    id       : natural;
    bit_time : time
  );
  port (
    wire     : inout std_logic;
    delay    : in    time := 30 us;
    position : in    integer;
    speed    : in    integer;
    load     : in    integer;
    alarm    : in    integer := 0;
    fault    : in    integer := 0;
    crowded  : in    boolean := false;
    torque   : out   std_ulogic := '0';
    goal     : out   integer := 0;
    packets  : out   natural := 0
  );
end entity;

architecture model of servo_bus_servo_model is

  subtype byte_t is natural range 0 to 255;
  type bytes_t is array (0 to 127) of byte_t;
  constant is_feetech : boolean := protocol = 1;

  -- From the definition: 16 bits that are shifted into a division by 18005.
  function crc_of (bytes : bytes_t; count : natural) return natural is
    variable crc : unsigned(15 downto 0) := (others => '0');
  begin
    for place in 0 to count - 1 loop
      crc := crc xor shift_left(to_unsigned(bytes(place), 16), 8);
      for number in 1 to 8 loop
        if crc(15) = '1' then
          crc := shift_left(crc, 1) xor x"8005";
        else
          crc := shift_left(crc, 1);
        end if;
      end loop;
    end loop;
    return to_integer(crc);
  end function;

  function sum_of (bytes : bytes_t; count : natural) return natural is
    variable sum : natural := 0;
  begin
    for place in 2 to count - 1 loop
      sum := sum + bytes(place);
    end loop;
    return 255 - sum mod 256;
  end function;

  -- A number as the servo has it in its registers.
  function coded (value : integer; bits : positive; sign_bit : natural) return std_ulogic_vector is
  begin
    if not is_feetech then
      return std_ulogic_vector(to_signed(value, bits));
    elsif value < 0 then
      return std_ulogic_vector(to_unsigned(2 ** sign_bit - value, bits));
    end if;
    return std_ulogic_vector(to_unsigned(value, bits));
  end function;

begin

  process is
    variable heard  : bytes_t;
    variable answer : bytes_t;
    variable count, first, size, sent, run : natural := 0;
    variable data   : std_ulogic_vector(79 downto 0);
    variable word   : unsigned(31 downto 0);

    -- The next byte of a packet.
    procedure hear is
      variable bits : unsigned(7 downto 0);
    begin
      wait until to_x01(wire) = '0' for 4 * 10 * bit_time;
      if to_x01(wire) /= '0' then
        count := 0; -- a silence ends a packet
        wait until to_x01(wire) = '0';
      end if;
      wait for bit_time / 2;
      for place in 0 to 7 loop
        wait for bit_time;
        bits(place) := '1' when to_x01(wire) = '1' else '0'; -- two at once are a 0
      end loop;
      wait for bit_time;
      assert to_x01(wire) = '1' or crowded
        report "servo_bus_servo_model: a byte without a stop bit"
        severity error;
      heard(count) := to_integer(bits);
      count        := count + 1;
    end procedure;

    procedure say (byte : byte_t; bits_most : natural := 10) is
      constant bits : std_ulogic_vector(9 downto 0) := '1' & std_ulogic_vector(to_unsigned(byte, 8)) & '0';
    begin
      for place in 0 to bits_most - 1 loop
        wire <= bits(place);
        wait for 1 ps;
        assert wire = bits(place) or crowded report "servo_bus_servo_model: two drive the line" severity error;
        wait for bit_time - 1 ps;
      end loop;
    end procedure;

    procedure add (byte : byte_t) is
    begin
      answer(sent) := byte;
      sent         := sent + 1;
    end procedure;

    procedure reply is
    begin
      if is_feetech then
        data := (others => '0');
        data(47 downto 0) := coded(load, 16, 10) & coded(speed, 16, 15) & coded(position, 16, 15);
      else
        data := coded(position, 32, 0) & coded(speed, 32, 0) & coded(load, 16, 0);
      end if;
      sent := 0;
      add(255);
      add(255);
      if is_feetech then
        add(id);
        add(size + 2);
        add(alarm);
      else
        add(253);
        add(0);
        add(id);
        add(size + 4);
        add(0);
        add(16#55#);
        add(alarm);
      end if;
      run := 0;
      for place in 0 to size - 1 loop
        add(to_integer(unsigned(data(8 * place + 7 downto 8 * place))));
        if not is_feetech and answer(sent - 3) = 255 and answer(sent - 2) = 255 and answer(sent - 1) = 253 then
          add(253);
          answer(5) := answer(5) + 1;
        end if;
      end loop;
      if fault = 5 then
        answer(4 - 2 * protocol) := id + 1;
      end if;
      if is_feetech then
        add(sum_of(answer, sent));
      else
        first := crc_of(answer, sent);
        add(first mod 256);
        add(first / 256);
      end if;
      if fault = 2 then
        answer(sent - 2) := (answer(sent - 2) + 1) mod 256;
      end if;
      wait for delay;
      assert wire = 'H' report "servo_bus_servo_model: the line is driven before the reply" severity error;
      if fault = 4 then
        say(16#55#);
        say(255);
      end if;
      for place in 0 to sent - 1 loop
        if fault = 6 and place = 8 then
          say(answer(place), 4);
          exit;
        elsif not (fault = 3 and place = 8) then
          say(answer(place));
        end if;
      end loop;
      while fault = 7 loop
        say(16#A5#);
      end loop;
      wire <= 'Z';
      wait for 1 ps;
    end procedure;

    procedure take is
      variable base, step, name : natural;
    begin
      -- From the instruction on: its place, and those of the parameters.
      base := 4 when is_feetech else 7;
      if heard(base) = 16#83# then
        first := heard(base + 1);
        size  := heard(base + 2) when is_feetech else heard(base + 3);
        step  := base + 3 when is_feetech else base + 5;
        name  := count - 1 when is_feetech else count - 2;
        while step < name loop
          if heard(step) = id then
            word := (others => '0');
            for place in 0 to size - 1 loop
              word(8 * place + 7 downto 8 * place) := to_unsigned(heard(step + 1 + place), 8);
            end loop;
            if first = 16#40# or first = 16#28# then
              torque <= word(0);
            elsif is_feetech then
              goal <= to_integer(word(14 downto 0)) when word(15) = '0' else -to_integer(word(14 downto 0));
            else
              goal <= to_integer(signed(word));
            end if;
          end if;
          step := step + size + 1;
        end loop;
        assert step = name report "servo_bus_servo_model: a packet has a wrong length" severity error;
        packets <= packets + 1;
      elsif heard(base) = 2 and heard(base - 3 + protocol) = id then
        size    := heard(base + 2) when is_feetech else heard(base + 3);
        packets <= packets + 1;
        if fault /= 1 then
          reply;
        end if;
      end if;
    end procedure;

  begin
    wire <= 'Z';
    count := 0;
    packet : loop
      hear;
      if count <= 2 + (1 - protocol) then
        if heard(count - 1) /= 255 and not (count = 3 and heard(2) = 253) then
          count := 0;
        elsif count = 3 and heard(2) = 255 then
          count := 2;
        end if;
      elsif is_feetech and count > 4 and count = heard(3) + 4 then
        assert heard(count - 1) = sum_of(heard, count - 1) or heard(2) /= 254 -- or a reply
          report "servo_bus_servo_model: a wrong sum"
          severity error;
        take;
        count := 0;
      elsif not is_feetech and count > 7 and count = heard(5) + 7 then
        assert heard(count - 2) + 256 * heard(count - 1) = crc_of(heard, count - 2) or heard(7) = 16#55#
          report "servo_bus_servo_model: a wrong CRC"
          severity error;
        take;
        count := 0;
      elsif count > 60 then
        count := 0;
      end if;
    end loop;
  end process;

end architecture;
