-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of servo_bus_sender with Feetech and two servos, with the ids 1 and 2. A bit may have any number of
-- clocks. That the bits of a character are right is proven in uart_tx. A reference says which byte comes at each place.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.servo_bus_pkg.all;

entity servo_bus_sender_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    go       : in std_ulogic;
    packet   : in packet_t;
    servo    : in servo_t;
    told     : in std_ulogic_vector(1 downto 0);
    engaged  : in std_ulogic_vector(1 downto 0);
    first    : in std_ulogic_vector(15 downto 0); -- the goal of servo 0
    second   : in std_ulogic_vector(15 downto 0); -- the goal of servo 1
    taken    : in std_ulogic;                     -- shows that a byte goes to the line, as all of these show signals
    tx_data  : in byte_t;
    tx_ready : in std_ulogic;                     -- the last stop bit has ended, or ends in this clock
    state    : in unsigned(1 downto 0);
    part     : in unsigned(1 downto 0);
    spot     : in unsigned(3 downto 0);           -- the place in the part
    timer    : in unsigned(1 downto 0);
    length   : in unsigned(7 downto 0);
    check    : in std_ulogic_vector(15 downto 0);
    left     : in unsigned(3 downto 0);           -- bits of the character on the line
    shift    : in std_ulogic_vector(9 downto 0);
    tx_ticks : in unsigned(12 downto 0);          -- drives the phase of a bit: it may end at any clock
    tx_phase : out unsigned(12 downto 0)
  );
end entity;

architecture properties of servo_bus_sender_formal is

  constant bit_clocks : positive := 4;
  constant head       : positive := 7;        -- bytes before the servos, or before the check
  constant most       : positive := head + 7; -- bytes of the longest packet
  constant gap_most   : positive := 4;        -- clocks between two bytes

  -- The places of `state` and of `part` in their types.
  constant at_rest   : natural := 0;
  constant leading   : natural := 1;
  constant sending   : natural := 2;
  constant ending    : natural := 3;
  constant in_head   : natural := 0;
  constant in_items  : natural := 1;
  constant in_tail   : natural := 2;

  subtype half_t is std_ulogic_vector(15 downto 0);

  signal ended, line, enable : std_ulogic;
  signal item      : servo_t;
  signal goal      : half_t := (others => '0');
  signal begun     : std_ulogic := '0';
  signal resets    : std_ulogic;
  signal reset_1   : std_ulogic := '1';
  signal enable_1  : std_ulogic := '0';
  signal busy      : std_ulogic := '0';                    -- from go until ended
  signal chosen    : std_ulogic_vector(1 downto 0);        -- the servos that are in this packet
  signal count     : unsigned(3 downto 0);
  signal size      : natural range 0 to 3;                 -- bytes for each of them
  signal last      : natural range 0 to most;              -- the place of the check
  signal place     : natural range 0 to most := 0;         -- of the next byte
  signal sum       : unsigned(7 downto 0) := (others => '0');
  signal expected  : byte_t;
  signal driven    : natural range 0 to bit_clocks + 1 := 0; -- clocks
  signal idle      : natural range 0 to gap_most + 1 := 0; -- clocks in which the line is driven, and no byte is sent
  signal in_place  : std_ulogic;                           -- the design is where these are
  signal packet_1  : packet_t := torques;
  signal servo_1   : servo_t := (others => '0');
  signal told_1, engaged_1 : std_ulogic_vector(1 downto 0) := "00";
  signal first_1, second_1 : half_t := (others => '0');

begin

  default clock is rising_edge(clk);

  dut : entity work.servo_bus_sender
    generic map (clock_hz => 4 * 57_600, baud_hz => 57_600, protocol => 1, servos => 2, first_id => 1)
    port map (
      clock => clk, reset => resets, go => go, packet => packet, servo => servo, told => told, engaged => engaged,
      count => count, item => item, goal => goal, ended => ended, line => line, enable => enable);

  resets   <= reset or not begun; -- at power-up, and at any later clock
  tx_phase <= tx_ticks;

  choose : process (all) is
    variable part   : natural range 0 to 3;    -- the byte of this servo
    variable number : std_ulogic;              -- of this servo
    variable value  : half_t;
    variable rest   : natural range 0 to most;
  begin
    chosen <= "00";
    size   <= 0;
    if packet = torques then
      chosen <= told;
      size   <= 2;
    elsif packet = goals then
      chosen <= engaged;
      size   <= 3;
    end if;
    count <= resize(unsigned'("" & chosen(0)), 4) + unsigned'("" & chosen(1));
    last  <= head;
    if chosen = "11" then
      last <= head + 2 * size;
    elsif chosen /= "00" then
      last <= head + size;
    end if;

    -- The byte of a servo.
    number := not chosen(0);
    part   := 0;
    if place >= head then
      rest := place - head;
      if rest >= size then
        number := '1';
        rest   := rest - size;
      end if;
      part := minimum(rest, 3);
    end if;
    value := first;
    if number = '1' then
      value := second;
    end if;
    value := with_sign(value);

    expected <= x"FF";
    case place is
      when 0 | 1 => null;
      when 2 =>
        expected <= x"FE";
        if packet = question then
          expected <= "00000" & std_ulogic_vector(servo + 1);
        end if;
      when 3 => expected <= std_ulogic_vector(to_unsigned(last - head + 4, 8));
      when 4 =>
        expected <= x"83";
        if packet = question then
          expected <= x"02";
        end if;
      when 5 =>
        expected <= x"28";
        if packet = goals then
          expected <= x"2A";
        elsif packet = question then
          expected <= x"38";
        end if;
      when 6 =>
        expected <= x"01";
        if packet = goals then
          expected <= x"02";
        elsif packet = question then
          expected <= x"06";
        end if;
      when others =>
        if place = last then
          expected <= not std_ulogic_vector(sum);
        elsif part = 0 then
          expected <= "000000" & number & not number;
        elsif packet = torques then
          expected <= "0000000" & engaged(0);
          if number = '1' then
            expected <= "0000000" & engaged(1);
          end if;
        elsif part = 1 then
          expected <= value(7 downto 0);
        else
          expected <= value(15 downto 8);
        end if;
    end case;
  end process;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun    <= '1';
      reset_1  <= resets;
      enable_1 <= enable;
      packet_1 <= packet;
      servo_1  <= servo;
      told_1   <= told;
      engaged_1 <= engaged;
      first_1  <= first;
      second_1 <= second;
      goal     <= first;
      if item(0) = '1' then
        goal <= second;
      end if;

      if taken = '1' then
        if place < most then
          place <= place + 1;
        end if;
        if place >= 2 then
          sum <= sum + unsigned(tx_data);
        end if;
      end if;
      driven <= 0;
      idle   <= 0;
      if enable = '1' then
        driven <= minimum(driven + 1, bit_clocks + 1);
        if taken = '0' and tx_ready = '1' then
          idle <= minimum(idle + 1, gap_most + 1);
        end if;
      end if;
      if ended = '1' then
        busy <= '0';
      end if;
      if go = '1' then
        busy  <= '1';
        place <= 0;
        sum   <= (others => '0');
      end if;
      if resets = '1' then
        busy     <= '0';
        enable_1 <= '0';
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits  : boolean;
    variable start : natural range 0 to 31; -- the place of the first byte of this item
    variable wants : boolean;               -- this item is in the packet
    variable mine  : half_t;                -- its goal
  begin
    start := head;
    wants := chosen(0) = '1';
    mine  := first;
    if item(0) = '1' then
      wants := chosen(1) = '1';
      mine  := second;
      if chosen(0) = '1' then
        start := head + size;
      end if;
    end if;

    fits := enable = (busy and not ended) and enable = to_bit(state /= at_rest) and
            (ended = '0' or place = last + 1) and left <= 10 and (left /= 0 or shift = "1111111111") and
            (enable = '1' or (left = 0 and driven <= bit_clocks + 1)) and idle <= gap_most;
    for number in 1 to 10 loop -- with so many bits left, the others are ones
      for one in number - 1 to 9 loop
        fits := fits and (left /= number or shift(one) = '1');
      end loop;
    end loop;
    if enable = '0' then
      fits := fits and (idle = 0 or reset_1 = '1' or ended = '1');
    else
      fits := fits and length = last - head + 4 and (item < 2 or part = in_tail);
    end if;
    if state = leading then
      fits := fits and place = 0 and spot = 0 and part = in_head and item = 0 and left = 0 and
              sum = 0 and driven = 3 - to_integer(timer) and idle = driven;
    end if;
    if state = sending or state = ending then
      fits := fits and driven >= bit_clocks and (place = 0 or driven > bit_clocks);
    end if;
    if state = sending then
      fits := fits and place <= last and (place >= 2 or sum = 0) and
              (place < 2 or check(7 downto 0) = not std_ulogic_vector(sum)) and
              (place /= 0 or left = 0);
      if part = in_head then
        fits := fits and place < head and spot = place and item = 0 and (place = 0 or idle = 0);
      elsif part = in_items then
        fits := fits and packet /= question and place = start + spot and (spot = 0 or (wants and spot < size and
                goal = mine)) and (spot = 0 or idle = 0) and idle <= item;
      else
        fits := fits and part = in_tail and place = last and spot = 0 and idle <= 2;
      end if;
    elsif state = ending then
      fits := fits and place = last + 1 and idle = 0;
    end if;
    in_place <= to_bit(fits);
  end process;

  -- What is to be sent stays the same until the packet has ended. Only then another one begins (servo_bus).
  stands : assume always begun = '1' and busy = '1' ->
                         go = '0' and packet = packet_1 and servo = servo_1 and told = told_1 and
                         engaged = engaged_1 and first = first_1 and second = second_1;

  -- A packet has one of three kinds, and a question is to one of the two.
  is_packet : assume always (packet = torques or packet = goals or packet = question) and servo < 2;

  -- At every clock, the design is at the place that the bytes so far say, with the right length and the right sum.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- Each byte is that of its place: the header, the length, the register, the id and the bytes of each servo that is in
  -- the packet, once and in their order, and the check.
  right_byte : assert always begun = '1' and taken = '1' -> busy = '1' and place <= last and tx_data = expected;

  -- A packet ends behind its check, and when its last stop bit has ended.
  whole_packet : assert always begun = '1' and ended = '1' -> place = last + 1 and line = '1';

  -- The line is low only while its driver is on, and that is on for more than a bit before.
  low_is_driven : assert always begun = '1' and line = '0' -> enable = '1' and driven > bit_clocks;

  -- The driver is on only from go until ended. It goes off with `ended`.
  lets_go : assert always begun = '1' and reset_1 = '0' -> enable = (busy and not ended);

  -- A packet always goes on: only the transmitter makes it wait.
  goes_on : assert always begun = '1' and enable = '1' -> idle <= gap_most;

  -- A reset releases the line in the next clock.
  reset_lets_go : assert always begun = '1' and reset_1 = '1' -> enable = '0' and line = '1';

  -- Goals of both servos are sent.
  goals_seen : cover {begun = '1' and ended = '1' and packet = goals and last = head + 6};

end architecture;
