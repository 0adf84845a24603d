-- SPDX-License-Identifier: BSD-3-Clause
--
-- What is outside of the pin of one_wire, for benches: a DS18B20 on a line with a pull-up. It checks the times that its
-- datasheet asks for.
--
--   fault    0 none, 1 it is away, 2 the line is shorted, 3 one bit that it sends is wrong, 4 it does not convert,
--            5 it never ends, 6 it sends nothing behind its presence
--   restart  its rise: the power was away for a moment
--   tries    resets that it has answered

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;

entity one_wire_thermometer_model is
  generic (
    resolution : positive := 12;
    parasite   : natural  := 0
  );
  port (
    line_out    : in  std_ulogic;
    line_drive  : in  std_ulogic;
    line_in     : out std_ulogic;

    temperature : in  signed(15 downto 0);
    fault       : in  natural;
    restart     : in  std_ulogic;
    done        : in  boolean;
    tries       : out natural := 0
  );
end entity;

architecture behaviour of one_wire_thermometer_model is

  type bytes_t is array (natural range <>) of std_ulogic_vector(7 downto 0);
  type state_t is (idle, rom, command, writing, converting, reading);

  constant power_up     : bytes_t(0 to 7) := (x"50", x"05", x"4B", x"46", x"7F", x"FF", x"0C", x"10");
  constant convert_time : time            := 750 ms / 2 ** (12 - resolution) - 1 ms;

  signal master, pull : std_ulogic := '0'; -- low

  function crc_of (bytes : bytes_t) return std_ulogic_vector is
    variable crc    : std_ulogic_vector(7 downto 0) := x"00";
    variable topple : std_ulogic;
  begin
    for place in bytes'range loop
      for number in 0 to 7 loop
        topple := crc(0) xor bytes(place)(number);
        crc    := '0' & crc(7 downto 1);
        if topple = '1' then
          crc := crc xor x"8C";
        end if;
      end loop;
    end loop;
    return crc;
  end function;

begin

  -- Scratchpads and a ROM of the datasheet.
  assert crc_of(power_up) = x"1C" and
         crc_of((x"91", x"01", x"4B", x"46", x"7F", x"FF", x"0C", x"10")) = x"70" and
         crc_of((x"02", x"1C", x"B8", x"01", x"00", x"00", x"00")) = x"A2"
    report "the CRC is not that of the datasheet"
    severity failure;

  master  <= line_drive and not line_out;
  line_in <= '0' when master = '1' or pull = '1' or fault = 2 else '1';

  answer : process is
    variable scratchpad : bytes_t(0 to 8);
    variable state      : state_t := idle;
    variable fell       : time := -1 ms;
    variable rose       : time := -1 ms;
    variable low        : time;
    variable ready      : time := 0 ns;
    variable shift      : std_ulogic_vector(7 downto 0);
    variable bits       : natural := 0;
    variable unknown    : signed(15 downto 0);

    procedure begin_again is
    begin
      scratchpad(0 to 7) := power_up;
      state              := idle;
    end procedure;

    -- What it sends in a slot.
    impure function next_bit return std_ulogic is
    begin
      if fault = 6 then
        return '1';
      elsif state = converting then
        return to_bit(now >= ready and fault /= 5);
      elsif state = reading and bits < 72 then
        return scratchpad(bits / 8)(bits mod 8) xor to_bit(fault = 3 and bits = 40);
      end if;
      return '1';
    end function;

    procedure obey is
    begin
      bits := 0;
      case state is
        when rom =>
          check_equal(shift, x"CC", "the command to the ROM");
          state := command;
        when command =>
          case shift is
            when x"4E"  => state := writing;
            when x"44"  =>
              state := converting;
              ready := now + convert_time;
              if fault = 4 then
                ready := now;
              end if;
            when x"BE"  =>
              state         := reading;
              scratchpad(8) := crc_of(scratchpad(0 to 7));
            when others => check(false, "a command that there is not: " & to_hstring(shift));
          end case;
        when others => null;
      end case;
    end procedure;

  begin
    begin_again;
    loop
      wait until rising_edge(master) or rising_edge(restart) or done;
      exit when done;
      if rising_edge(restart) then
        begin_again;
        next;
      end if;
      check(now - rose >= 1 us, "the line recovers for 1 us");
      check(now - fell >= 61 us, "a slot takes 61 us or longer");
      fell := now;
      if (state = converting or state = reading) and next_bit = '0' then
        pull <= '1', '0' after 30 us;
      end if;
      wait until falling_edge(master) or done;
      exit when done;
      low  := now - fell;
      rose := now;
      if state = converting and now >= ready and fault /= 4 and fault /= 5 then
        check(parasite = 0 or rose - ready < 500 ms, "a conversion that was fed");
        unknown := shift_right(temperature, 12 - resolution);
        unknown := shift_left(unknown, 12 - resolution) or to_signed(2 ** (12 - resolution) - 1, 16);
        scratchpad(0) := std_ulogic_vector(unknown(7 downto 0));
        scratchpad(1) := std_ulogic_vector(unknown(15 downto 8));
      end if;
      if low > 120 us then
        check(low >= 480 us, "a reset takes 480 us or longer, not " & time'image(low));
        state := idle;
        bits  := 0;
        if fault /= 1 then
          state := rom;
          tries <= tries + 1;
          pull  <= '0', '1' after 30 us, '0' after 150 us;
        end if;
      else
        check((low >= 1 us and low <= 15 us) or low >= 60 us, "a slot is low for " & time'image(low));
        bits := bits + 1;
        if state = rom or state = command or state = writing then
          shift := to_bit(low <= 15 us) & shift(7 downto 1);
          if state = writing and bits mod 8 = 0 then
            check(bits <= 24, "three bytes are written");
            scratchpad(bits / 8 + 1) := shift;
          elsif state /= writing and bits = 8 then
            obey;
          end if;
        end if;
      end if;
    end loop;
    wait;
  end process;

  -- It is fed while it converts, and nothing pulls against that.
  fed : if parasite = 1 generate
    watch : process is
      variable begun : time;
    begin
      wait until (line_drive and line_out) = '1' or done;
      if not done then
        begun := now;
        check(pull = '0', "the line is not fed against the thermometer");
        wait until (line_drive and line_out) = '0' or done;
        check(now - begun >= convert_time or done, "it is fed for the whole conversion");
      else
        wait;
      end if;
    end process;
  else generate
    check(line_out /= '1', "the line is never driven high");
  end generate;

end architecture;
