-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the cycle of servo_bus with two servos, and with a failures_most of 2. A cycle may begin, a packet may
-- end, and a reply may come, be wrong, or not come, at any clock: what is sent and received is proven in
-- servo_bus_sender and servo_bus_receiver. A us may end at any clock. One of both servos is followed.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.servo_bus_pkg.all;
  use work.wishbone_pkg.all;

entity servo_bus_formal is
  port (
    clk       : in std_ulogic;
    reset     : in std_ulogic;
    m2s       : in wishbone_m2s_t;
    followed  : in std_ulogic;                     -- the servo: the solver chooses
    state     : in unsigned(2 downto 0);           -- shows the place in the cycle, as all of these show signals
    packet    : in unsigned(1 downto 0);
    servo     : in servo_t;
    half      : in std_ulogic;
    timer     : in std_ulogic;                     -- a us of the gap has ended
    tick      : in std_ulogic;
    go        : in std_ulogic;
    ended     : in std_ulogic;
    listens   : in std_ulogic;
    put       : in std_ulogic;
    field     : in unsigned(2 downto 0);
    word      : in std_ulogic_vector(15 downto 0);
    good      : in std_ulogic;
    lost      : in std_ulogic;
    item      : in servo_t;
    goal_out  : in std_ulogic_vector(15 downto 0); -- the goal that the bus gave the servo, of a clock ago
    last_out  : in std_ulogic_vector(15 downto 0); -- its last position
    sent_out  : in std_ulogic_vector(15 downto 0); -- the goal that is sent to the item
    position  : in std_ulogic_vector(15 downto 0); -- of the reply that comes
    puts_goal : in std_ulogic;
    stamps    : in std_ulogic;
    copies    : in std_ulogic;
    keeps     : in std_ulogic;
    drive     : in std_ulogic_vector(1 downto 0);  -- of the servo whose turn it is
    told      : in std_ulogic_vector(1 downto 0);
    engaged   : in std_ulogic_vector(1 downto 0);
    holding   : in std_ulogic_vector(1 downto 0);
    valid     : in std_ulogic_vector(1 downto 0);
    bank      : in std_ulogic_vector(1 downto 0);
    told_count, engaged_count : in unsigned(3 downto 0);
    count     : in unsigned(3 downto 0);
    enable    : in std_ulogic
  );
end entity;

architecture properties of servo_bus_formal is

  constant failures_most : positive := 2;
  constant clocks_most   : positive := 22; -- of a cycle in which it waits for nothing

  -- The places of `state` and of `packet` in their types.
  constant idle      : natural := 0;
  constant copying   : natural := 1;
  constant choosing  : natural := 2;
  constant sending   : natural := 3;
  constant listening : natural := 4;
  constant keeping   : natural := 5;
  constant pausing   : natural := 6;
  constant of_torques  : natural := 0;
  constant of_goals    : natural := 1;
  constant of_question : natural := 2;

  subtype half_t is std_ulogic_vector(15 downto 0);
  type halves_t is array (0 to 1) of half_t;

  signal s2m              : wishbone_s2m_t;
  signal cycled, failed   : std_ulogic;
  signal begun            : std_ulogic := '0';
  signal reset_1          : std_ulogic := '1';
  signal asked            : std_ulogic;
  signal asked_1          : std_ulogic := '0';
  signal chosen           : std_ulogic := '0';
  signal index            : natural range 0 to 1;
  signal own              : std_ulogic;                -- it is the turn of the servo that is followed
  signal state_1          : unsigned(2 downto 0) := (others => '0');
  signal listens_1        : std_ulogic := '0';
  signal item_1           : servo_t := (others => '0');
  signal bank_1           : std_ulogic := '0';
  signal busy             : std_ulogic := '0';         -- a packet is sent
  signal awaits           : std_ulogic := '0';         -- a question has ended, and has no result yet
  signal rank             : natural range 0 to 4;      -- of a packet: torques, goals, question 0, question 1
  signal sent_last        : natural range 0 to 4 := 0; -- the rank of the last packet of this cycle
  signal pause            : natural range 0 to 1 := 0; -- us since the last packet or its result
  signal free             : natural range 0 to 4 := 0; -- clocks in which a cycle could copy
  signal works            : natural range 0 to clocks_most + 1 := 0; -- clocks of a cycle in which it waits for nothing
  signal waits            : std_ulogic;
  signal drive_given      : std_ulogic_vector(1 downto 0) := "00"; -- by the bus
  signal goal_given       : half_t := (others => '0');
  signal drive_now        : std_ulogic_vector(1 downto 0) := "00"; -- of this cycle
  signal goal_now         : half_t := (others => '0');
  signal came             : half_t := (others => '0'); -- the position of the reply that comes
  signal good_1           : std_ulogic := '0';
  signal replied          : std_ulogic := '0';         -- a good reply came, and nothing was sent since
  signal may_commit       : std_ulogic := '0';         -- a clock ago there was one of the servo, and the bus was free
  signal last_position    : half_t := (others => '0'); -- of the last good reply
  signal has_given        : std_ulogic := '0';         -- a position, since the bus stopped
  signal holds            : std_ulogic := '0';
  signal held             : half_t := (others => '0'); -- the position where its hold began
  signal in_a_row         : natural range 0 to failures_most - 1 := 0;
  signal lasting          : std_ulogic := '0';         -- no good reply for failures_most questions
  signal stopped          : std_ulogic := '0';         -- it was idle and off, a clock ago
  signal fails            : std_ulogic := '0';
  signal goals_copy, lasts_copy, sents_copy : halves_t := (others => (others => '0')); -- the memories once more
  signal in_place         : std_ulogic;                -- the design is where these are

begin

  default clock is rising_edge(clk);

  dut : entity work.servo_bus
    generic map (
      clock_hz => 1_000_000, protocol => 1, servos => 2, baud_hz => 57_600, cycle_hz => 2000, gap_us => 1,
      failures_most => failures_most, data_width => 20)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, cycled => cycled, failed => failed,
      rx => '1', tx => open, tx_enable => open);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  index <= 1 when chosen = '1' else 0;
  own   <= to_bit(servo = index);
  asked <= m2s.cyc and m2s.stb and not s2m.ack and not s2m.err;
  rank  <= 1 when packet = of_torques else 2 when packet = of_goals else 4 when servo(0) = '1' else 3;

  -- It waits for the end of a packet, for a result, for the bus, and for the end of a us.
  waits <= to_bit((state = sending and ended = '0') or (state = listening and good = '0' and lost = '0') or
                  (state = keeping and m2s.cyc = '1') or (state = pausing and pause = 0 and tick = '0'));

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun      <= '1';
      reset_1    <= reset;
      asked_1    <= asked and not reset;
      chosen     <= followed;
      listens_1  <= listens;
      state_1    <= state;
      item_1     <= item;
      bank_1     <= bank(index);
      good_1     <= '0';
      fails      <= '0';
      stopped    <= '0';
      may_commit <= replied and own and not m2s.cyc;

      -- What the bus gives, in the first clock of an access.
      if asked = '1' and m2s.we = '1' and m2s.sel(2 downto 0) = "111" then
        if unsigned(m2s.adr) = 8 * index then
          drive_given <= m2s.dat(1 downto 0);
        elsif unsigned(m2s.adr) = 8 * index + 1 then
          goal_given <= m2s.dat(15 downto 0);
        end if;
      end if;

      -- A cycle begins: what it has is of one moment, in which the bus is free.
      if state = copying and m2s.cyc = '0' and own = '1' then
        drive_now <= drive_given;
        goal_now  <= goal_given;
      end if;
      if state = copying and half = '1' and m2s.cyc = '0' and own = '1' then
        holds <= to_bit(drive_given = "01") and (valid(index) or holds);
        if holds = '0' then
          held <= last_position;
        end if;
      end if;
      free <= 0;
      if state = copying and m2s.cyc = '0' and free < 4 then
        free <= free + 1;
      end if;

      -- The packets of a cycle.
      if state = idle or state = copying then
        sent_last <= 0;
        works     <= 0;
      elsif waits = '0' and works <= clocks_most then
        works <= works + 1;
      end if;
      if state = idle then
        works <= works;
      end if;
      if tick = '1' then
        pause <= 1;
      end if;
      if go = '1' then
        busy      <= '1';
        sent_last <= rank;
        replied   <= '0';
      elsif ended = '1' then
        busy   <= '0';
        awaits <= to_bit(packet = of_question);
        pause  <= 0;
      end if;

      -- What comes back.
      if put = '1' and field = position_field then
        came <= word;
      end if;
      if good_1 = '1' and own = '1' then
        last_position <= came;
      end if;
      if awaits = '1' and (good or lost) = '1' then
        awaits <= '0';
        if good = '1' then
          good_1  <= not reset;
          replied <= '1';
          if own = '1' then
            has_given <= '1';
          end if;
        else
          fails <= '1';
          if own = '1' then
            if in_a_row = failures_most - 1 then
              lasting <= '1';
            else
              in_a_row <= in_a_row + 1;
            end if;
          end if;
        end if;
      end if;
      if state = listening or state = keeping then
        pause <= 0;
      end if;
      if state = keeping and half = '1' and m2s.cyc = '0' and own = '1' then
        lasting  <= '0';
        in_a_row <= 0;
      end if;

      if state = idle and enable = '0' then
        stopped   <= '1';
        has_given <= '0';
        holds     <= '0';
      end if;

      -- The memories once more. What is in them is asserted below.
      for number in 0 to 1 loop
        if puts_goal = '1' and unsigned(m2s.adr(5 downto 3)) = number then
          goals_copy(number) <= m2s.dat(15 downto 0);
        end if;
        if stamps = '1' and servo = number then
          lasts_copy(number) <= position;
        end if;
        if copies = '1' and keeps = '0' and servo = number then
          sents_copy(number) <= last_out;
          if drive(1) = '1' then
            sents_copy(number) <= goal_out;
          end if;
        end if;
      end loop;

      if reset = '1' then
        busy        <= '0';
        awaits      <= '0';
        replied     <= '0';
        drive_given <= "00";
        has_given   <= '0';
        holds       <= '0';
        sent_last   <= 0;
        works       <= 0;
      end if;
    end if;
  end process;

  compare : process (all) is
    variable fits      : boolean;
    variable is_copied : boolean; -- the servo that is followed has its drive and its goal of this cycle
    variable before    : natural range 0 to 31; -- clocks until this packet
    variable is_asked  : boolean;
  begin
    is_asked  := packet = of_question;
    is_copied := state > copying or (state = copying and servo > index);
    fits := state <= pausing and packet <= of_question and (servo < 2 or state = idle) and
            busy = to_bit(state = sending) and awaits = to_bit(state = listening) and came = position and
            (own = '0' or drive = drive_given) and goals_copy(index) = goal_given and
            (engaged(index) = '0' or has_given = '1') and (valid(index) = '0' or has_given = '1') and
            holding(index) = holds and (holds = '0' or (sents_copy(index) = held and engaged(index) = '1'));
    -- The last position is in the memory, at once.
    fits := fits and lasts_copy(index) = last_position and
            (good_1 = '1') = (state = keeping and half = '0') and (replied = '1' or state /= keeping);
    if state = idle then
      fits := fits and works <= clocks_most;
    elsif state = copying then
      fits := fits and packet = of_torques and sent_last = 0 and
              (half = '0' or (goal_out = goals_copy(to_integer(servo(0 downto 0))) and
                              last_out = lasts_copy(to_integer(servo(0 downto 0))))) and
              (free = 2 * to_integer(servo) + to_integer(unsigned'("" & half))) and
              (servo = 0 or (told_count = unsigned'("" & told(0)) and engaged_count = unsigned'("" & engaged(0)))) and
              (servo > 0 or (told_count = 0 and engaged_count = 0));
    else
      fits := fits and told_count = unsigned'("0" & told(0)) + unsigned'("0" & told(1)) and
              engaged_count = unsigned'("0" & engaged(0)) + unsigned'("0" & engaged(1)) and
              (servo = 0 or is_asked);
    end if;
    if is_copied then
      fits := fits and (drive_now /= "00" or (told(index) = '1' and engaged(index) = '0')) and
              (engaged(index) = '0' or drive_now(1) = '0' or sents_copy(index) = goal_now) and
              (holds = '0' or drive_now = "01");
    end if;

    before := 0;
    if packet = of_goals then
      before := 4;
    elsif is_asked and servo = 0 then
      before := 8;
    elsif is_asked then
      before := 15;
    end if;
    case to_integer(state) is
      when choosing =>
        fits := fits and works <= before and sent_last < rank and (sent_last = 0 or pause = 1) and
                (servo = 0 or sent_last = 3);
      when sending =>
        fits := fits and works <= before + 1 and sent_last = rank;
      when listening =>
        fits := fits and works <= before + 2 and sent_last = rank and is_asked;
      when keeping =>
        fits := fits and works <= before + 3 + to_integer(unsigned'("" & half)) and sent_last = rank and is_asked;
      when pausing =>
        fits := fits and sent_last = rank and (timer = '0' or pause = 1);
        if is_asked then
          fits := fits and works <= before + 5 + pause and (pause = 0 or timer = '1');
        else
          fits := fits and works <= before + 2 + pause and (pause = 0 or timer = '1');
        end if;
      when others =>
        null;
    end case;
    in_place <= to_bit(fits);
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no access at power-up.
  quiet_first : assume always begun = '1' or (m2s.cyc = '0' and m2s.stb = '0');

  -- At power-up the place in the cycle is any that there is.
  known_first : assume always begun = '1' or state <= pausing;

  -- The master waits for the answer to each access.
  patient : assume always asked_1 = '1' -> m2s.cyc = '1';

  -- The servo that is followed stays the same.
  one_servo : assume always begun = '1' -> followed = chosen;

  -- A packet ends once, a clock or more behind its go (servo_bus_sender).
  ends : assume always ended = '1' -> busy = '1';

  -- A result comes only while it listens (servo_bus_receiver).
  results : assume always listens_1 = '1' or (good or lost or put) = '0';

  -- At every clock, the design is where these say.
  stays_in_place : assert always begun = '1' -> in_place = '1';

  -- From the end of a question until its result, or its timeout, nothing is sent: the line is left to the servo.
  never_interrupts : assert always begun = '1' and awaits = '1' -> go = '0' and busy = '0' and listens = '1';

  -- The line has one speaker: a packet begins only when no packet is sent, and nothing is heard while one is.
  one_speaker : assert always begun = '1' and busy = '1' -> go = '0' and listens = '0';

  -- A cycle has its packets in one order, and each at most once: torques, goals, and a question to each servo.
  in_order : assert always begun = '1' and go = '1' -> rank > sent_last;

  -- Each servo is asked.
  none_left_out : assert always begun = '1' and go = '1' and rank = 4 -> sent_last = 3;

  -- A cycle ends only behind the question to the last servo.
  whole_cycle : assert always begun = '1' and cycled = '1' -> sent_last = 4;

  -- The line rests for gap_us before each packet but the first one.
  keeps_gap : assert always begun = '1' and go = '1' -> sent_last = 0 or pause = 1;

  -- A cycle always ends: it waits only for the end of a packet, for a result, for the gap, and for a free bus, and
  -- apart from these it takes so many clocks at most.
  always_ends : assert always begun = '1' -> works <= clocks_most;

  -- A cycle has what it sends after four clocks in which the bus is free.
  copies_soon : assert always begun = '1' and state = copying -> free <= 3;

  -- The words that the bus reads change only behind a good reply of this servo, while the bus is free.
  no_other_reply : assert always begun = '1' and bank(index) /= bank_1 -> may_commit = '1';

  -- A servo whose drive is 0 is told so in the next cycle, and gets no goal.
  off_is_told : assert always begun = '1' and state = sending and drive_now = "00" ->
                              told(index) = '1' and engaged(index) = '0';

  -- No servo gets its torque before it has given a position.
  never_jumps : assert always begun = '1' and state = sending and engaged(index) = '1' -> has_given = '1';

  -- A servo that follows gets the goal that was written last when the cycle began.
  follows : assert always begun = '1' and state = sending and state_1 = sending and packet = of_goals and
                          engaged(index) = '1' and drive_now(1) = '1' and item_1 = index -> sent_out = goal_now;

  -- A servo that holds gets the position that it had when its hold began.
  right_hold : assert always begun = '1' and state = sending and state_1 = sending and packet = of_goals and
                             holds = '1' and item_1 = index -> sent_out = held;

  -- The number of servos in a packet is that of those that are told or engaged.
  right_count : assert always begun = '1' and state = sending and packet /= of_question ->
                              (packet /= of_torques or count = unsigned'("0" & told(0)) + unsigned'("0" & told(1))) and
                              (packet /= of_goals or
                               count = unsigned'("0" & engaged(0)) + unsigned'("0" & engaged(1)));

  -- A question without a good reply has one event.
  each_is_told : assert always begun = '1' -> failed = (fails and not reset_1);

  -- Failures in a row end the validity.
  too_many : assert always begun = '1' and lasting = '1' -> valid(index) = '0';

  -- Behind a stop nothing is valid or engaged.
  void_when_off : assert always begun = '1' and stopped = '1' -> valid = "00" and engaged = "00";

  -- A cycle has ended.
  cycled_seen : cover {begun = '1' and cycled = '1'};

end architecture;
