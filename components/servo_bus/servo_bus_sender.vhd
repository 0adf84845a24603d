-- SPDX-License-Identifier: BSD-3-Clause
--
-- Sends the packets of a servo bus: the torques or the goals of many servos, or a question to one. See servo_bus_pkg
-- for the bytes.
--
--   go      _/‾\______________________________
--   enable  __/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\____   a bit before the first start bit, until the last stop bit ends
--   ended   ______________________________/‾\_
--
-- told: which servos get their torque, on if it is `engaged`. engaged: which servos get their goal, too.
-- `item` is the servo whose `goal` is sent next. `goal` may come one clock later.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;
  use work.servo_bus_pkg.all;
  use work.width_pkg.all;

entity servo_bus_sender is
  generic (
    clock_hz : positive;
    baud_hz  : positive;
    protocol : natural range 0 to 1;
    servos   : positive range 1 to 8;
    first_id : natural range 0 to 245
  );
  port (
    clock   : in  std_ulogic;
    reset   : in  std_ulogic; -- synchronous
    go      : in  std_ulogic;
    packet  : in  packet_t;
    servo   : in  servo_t;    -- that is asked
    told    : in  std_ulogic_vector(servos - 1 downto 0);
    engaged : in  std_ulogic_vector(servos - 1 downto 0);
    count   : in  unsigned(3 downto 0); -- how many of them are in this packet
    item    : out servo_t := (others => '0');
    goal    : in  std_ulogic_vector(15 downto 0);
    ended   : out std_ulogic;

    line    : out std_ulogic;
    enable  : out std_ulogic
  );
end entity;

architecture rtl of servo_bus_sender is

  constant rules      : protocol_t := protocol_of(protocol);
  constant bit_clocks : positive   := (clock_hz + baud_hz - 1) / baud_hz;
  constant last       : servo_t    := to_unsigned(servos - 1, servo_t'length);

  type state_t is (idle, leading, sending, ending);
  type part_t is (head, items, tail);

  signal state    : state_t := idle;
  signal part     : part_t := head;
  signal place    : unsigned(3 downto 0) := (others => '0');
  signal timer    : unsigned(bits_for(bit_clocks) - 1 downto 0) := (others => '0');
  signal tx_data  : byte_t;
  signal tx_valid, tx_ready, taken, skips : std_ulogic;
  signal begins, takes, busy : std_ulogic;
  signal check    : std_ulogic_vector(15 downto 0);
  signal length   : unsigned(7 downto 0) := (others => '0'); -- of the packet

  function id_of (number : servo_t) return byte_t is
  begin
    return std_ulogic_vector(to_unsigned(first_id, 8) + number);
  end function;

begin

  skips    <= '1' when part = items and place = 0 and
              ((packet = torques and told(to_integer(item)) = '0') or
               (packet = goals and engaged(to_integer(item)) = '0')) else '0';
  tx_valid <= '1' when state = sending and skips = '0' and busy = '0' else '0';
  taken    <= tx_valid and tx_ready;
  begins   <= taken when part = head and place = rules.header_last else '0';
  takes    <= taken when part = items or (part = head and place > rules.header_last) else '0';

  -- It stands from `go` on, so a register of its own costs no time.
  measure : process (clock) is
    variable bytes : unsigned(7 downto 0);
  begin
    if rising_edge(clock) then
      bytes := to_unsigned(rules.length_least, 8);
      case packet is
        when torques =>
          bytes := bytes + (count & '0');
        when goals =>
          bytes := bytes + count + (count & '0');
          if not rules.feetech then
            bytes := bytes + (count & '0');
          end if;
        when question =>
          null;
      end case;
      length <= bytes;
    end if;
  end process;

  choose : process (all) is
    variable id            : byte_t;
    variable instruction   : byte_t;
    variable register_byte : byte_t;
    variable size          : byte_t;
    variable sent          : std_ulogic_vector(15 downto 0);
    variable kind          : natural range 0 to 2;
  begin
    kind := packet_t'pos(packet);
    id          := x"FE";
    instruction := x"83";
    if packet = question then
      id          := id_of(servo);
      instruction := x"02";
    end if;
    register_byte := rules.registers(kind);
    size          := rules.sizes(kind);
    sent          := goal;
    if rules.feetech then
      sent := with_sign(goal);
    end if;

    tx_data <= x"FF";
    case part is
      when head =>
        if rules.feetech then
          case to_integer(place) is
            when 2 => tx_data <= id;
            when 3 => tx_data <= std_ulogic_vector(length);
            when 4 => tx_data <= instruction;
            when 5 => tx_data <= register_byte;
            when 6 => tx_data <= size;
            when others => null;
          end case;
        else
          case to_integer(place) is
            when 2 => tx_data <= x"FD";
            when 4 => tx_data <= id;
            when 5 => tx_data <= std_ulogic_vector(length);
            when 7 => tx_data <= instruction;
            when 8 => tx_data <= register_byte;
            when 10 => tx_data <= size;
            when 3 | 6 | 9 | 11 => tx_data <= x"00";
            when others => null;
          end case;
        end if;
      when items =>
        case to_integer(place) is
          when 0 => tx_data <= id_of(item);
          when 1 =>
            tx_data <= sent(7 downto 0);
            if packet = torques then
              tx_data <= "0000000" & engaged(to_integer(item));
            end if;
          when 2 => tx_data <= sent(15 downto 8);
          when others => tx_data <= (others => sent(15));
        end case;
      when tail =>
        tx_data <= check(7 downto 0);
        if place = 1 then
          tx_data <= check(15 downto 8);
        end if;
    end case;
  end process;

  process (clock) is
    variable item_last : natural range 0 to 4;
    variable leaves    : boolean; -- this servo
  begin
    if rising_edge(clock) then
      ended <= '0';
      item_last := 1;
      if packet = goals then
        item_last := rules.goal_last;
      end if;
      leaves := false;

      case state is
        when idle =>
          timer <= to_unsigned(bit_clocks - 1, timer'length);
          part  <= head;
          place <= (others => '0');
          item  <= (others => '0');
          if go = '1' then
            enable <= '1';
            state  <= leading;
          end if;

        when leading =>
          timer <= timer - 1;
          if timer = 0 then
            state <= sending;
          end if;

        when sending =>
          if taken = '1' then
            place <= place + 1;
          end if;
          case part is
            when head =>
              if taken = '1' and place = rules.head_last then
                place <= (others => '0');
                part  <= items;
                if packet = question then
                  part <= tail;
                end if;
              end if;
            when items =>
              leaves := skips = '1' or (taken = '1' and place = item_last);
            when tail =>
              if taken = '1' and place = rules.tail_last then
                state <= ending;
              end if;
          end case;
          if leaves then
            place <= (others => '0');
            item  <= item + 1;
            if item = last then
              part <= tail;
            end if;
          end if;

        when ending =>
          if tx_ready = '1' then
            enable <= '0';
            ended  <= '1';
            state  <= idle;
          end if;
      end case;

      if reset = '1' then
        state  <= idle;
        enable <= '0';
        ended  <= '0';
      end if;
    end if;
  end process;

  transmitter : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz)
    port map (
      clock => clock, reset => reset, tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, line => line);

  checks : entity work.servo_bus_check
    generic map (feetech => rules.feetech)
    port map (clock => clock, begins => begins, takes => takes, data => tx_data, busy => busy, check => check);

end architecture;
