-- SPDX-License-Identifier: BSD-3-Clause
--
-- Receives the reply of one servo while `listens` is high. See servo_bus_pkg for the bytes.
--
--   put      A word of the reply: `word` belongs to the field `field` of the servo. Put before it is known whether the
--            reply is good.
--   good     The reply is complete, and its id, length and check are right.
--   failed   It is not: nothing has come for timeout_us, or 63 bytes have come. `any` says that some bytes came.
--
-- Bytes before a header are passed over. Behind a wrong byte it waits until the line is silent, so that nobody is
-- interrupted. With Dynamixel, the FD that a servo puts behind FF FF FD in its data is taken out.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;
  use work.servo_bus_pkg.all;
  use work.width_pkg.all;

entity servo_bus_receiver is
  generic (
    clock_hz   : positive;
    baud_hz    : positive;
    protocol   : natural range 0 to 1;
    timeout_us : positive
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic; -- synchronous
    tick    : in  std_ulogic; -- each microsecond
    listens : in  std_ulogic;
    id      : in  byte_t;
    put     : out std_ulogic;
    field   : out unsigned(2 downto 0);
    word    : out std_ulogic_vector(15 downto 0);
    good    : out std_ulogic;
    failed  : out std_ulogic;
    any     : out std_ulogic;

    line    : in  std_ulogic  -- asynchronous
  );
end entity;

architecture rtl of servo_bus_receiver is

  constant rules       : protocol_t := protocol_of(protocol);
  constant extra_most  : natural    := 3; -- stuffed bytes: three FF FF FD fit into 10 bytes
  constant first_data  : natural    := rules.error_place + 1;
  constant check_last  : natural    := rules.check_place + rules.tail_last;

  -- The fields of the words of the data, and 0 for those that are not kept.
  type fields_t is array (0 to 7) of natural;
  function fields return fields_t is
  begin
    if rules.feetech then
      return (position_field, speed_field, load_field, others => 0);
    end if;
    return (load_field, speed_field, 0, position_field, others => 0);
  end function;
  constant field_of : fields_t := fields;

  signal deaf      : std_ulogic;
  signal rx_valid  : std_ulogic;
  signal data      : byte_t;
  signal rx_error  : receive_error_t;
  signal place     : unsigned(4 downto 0) := (others => '0');
  signal heard     : unsigned(5 downto 0) := (others => '0'); -- bytes
  signal timer     : unsigned(bits_for(timeout_us + 1) - 1 downto 0) := (others => '0');
  signal wrong     : std_ulogic := '0';
  signal extra     : unsigned(1 downto 0) := (others => '0'); -- stuffed bytes that must still come
  signal run       : unsigned(1 downto 0) := (others => '0'); -- how much of FF FF FD the last bytes are
  signal low       : byte_t := (others => '0');
  signal is_header : std_ulogic;
  signal stuffed   : std_ulogic; -- the servo has put this byte in
  signal begins, takes : std_ulogic;
  signal check     : std_ulogic_vector(15 downto 0);

begin

  deaf      <= reset or not listens;
  any       <= or heard;
  is_header <= '1' when place <= rules.header_last else '0';
  -- With Feetech an FF more may come before the id.
  begins    <= rx_valid when place = rules.header_last or
               (rules.feetech and place = 2 and data = x"FF") else '0';
  stuffed   <= '1' when not rules.feetech and run = 3 and place > 7 and place <= rules.check_place else '0';
  takes     <= rx_valid when is_header = '0' and begins = '0' and (place < rules.check_place or stuffed = '1') else '0';

  receiver : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => deaf, line => line, line_break => open,
      rx_valid => rx_valid, rx_ready => '1', rx_data => data, rx_error => rx_error);

  checks : entity work.servo_bus_check
    generic map (feetech => rules.feetech)
    port map (clock => clock, begins => begins, takes => takes, data => data, busy => open, check => check);

  process (clock) is
    variable fits  : boolean;             -- this byte is right at its place
    variable index : unsigned(3 downto 0); -- in the data
  begin
    if rising_edge(clock) then
      put    <= '0';
      good   <= '0';
      failed <= '0';

      index := resize(place - first_data, 4);
      field <= to_unsigned(field_of(to_integer(index(3 downto 1))), field'length);
      word  <= data & low;
      if rules.feetech then
        word <= without_sign(data & low, 15);
        if field_of(to_integer(index(3 downto 1))) = load_field then
          word <= without_sign(data & low, 10);
        end if;
      end if;

      if tick = '1' then
        timer <= timer + 1;
      end if;
      if timer = timeout_us or (and heard) = '1' then
        failed <= listens and not failed and not good;
      end if;

      if rx_valid = '1' then
        timer <= (others => '0');
        heard <= heard + 1;
        place <= place + 1;
        run   <= "00";
        if data = x"FF" then
          run <= "01" when run = 0 else "10";
        elsif data = x"FD" and run = 2 then
          run <= "11";
        end if;

        fits := true;
        if stuffed = '1' then
          -- It belongs to the check, but it is no data.
          fits  := data = x"FD" and extra /= 0;
          place <= place;
          extra <= extra - 1;
          run   <= "00";
        elsif is_header = '1' then
          if rules.feetech or place < 2 then
            if data /= x"FF" then
              place <= (others => '0');
            end if;
          elsif data = x"FF" then
            place <= place; -- one FF more
          elsif data /= x"FD" then
            place <= (others => '0');
          end if;
        elsif place < rules.error_place then
          if rules.feetech then
            if place = 2 and data = x"FF" then
              place <= place;
            elsif place = 2 then
              fits := data = id;
            else
              fits := unsigned(data) = rules.reply_length;
            end if;
          else
            case to_integer(place) is
              when 4 => fits := data = id;
              when 5 =>
                fits  := unsigned(data) >= rules.reply_length and unsigned(data) <= rules.reply_length + extra_most;
                extra <= resize(unsigned(data) - rules.reply_length, extra'length);
              when 7 => fits := data = x"55";
              when others => fits := data = x"00";
            end case;
          end if;
        elsif place = rules.error_place then
          put   <= not wrong;
          field <= to_unsigned(status_field, field'length);
          word  <= "00000" & data & "000";
        elsif place < rules.check_place then
          low <= data;
          put <= index(0) and not wrong when field_of(to_integer(index(3 downto 1))) /= 0 else '0';
        elsif place = rules.check_place then
          fits := data = check(7 downto 0);
        else
          fits := data = check(15 downto 8);
        end if;

        if not fits or rx_error /= no_receive_error then
          wrong <= '1';
        elsif place = check_last and wrong = '0' and extra = 0 and stuffed = '0' then
          good <= '1';
        end if;
      end if;

      if deaf = '1' then
        place  <= (others => '0');
        heard  <= (others => '0');
        timer  <= (others => '0');
        wrong  <= '0';
        extra  <= (others => '0');
        run    <= "00";
        good   <= '0';
        failed <= '0';
        put    <= '0';
      end if;
    end if;
  end process;

end architecture;
