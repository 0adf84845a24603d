-- SPDX-License-Identifier: BSD-3-Clause
--
-- Bus servos on one line (RS-485, or one wire behind a buffer): goals go out and positions come in, again and again,
-- without the PC. protocol 0 is that of Dynamixel (2.0, X series), 1 that of Feetech (STS).
--
--   +8n      drive of servo n: 0 torque off, 1 hold where it is, 2 follow the goal
--   +8n + 1  goal, with a sign, 16 bits
--   +8n + 2  position, with a sign, 16 bits                                                            (read only)
--   +8n + 3  speed, with a sign, 16 bits                                                               (read only)
--   +8n + 4  load, or current, with a sign, 16 bits                                                    (read only)
--   +8n + 5  status: bit 0 valid, bits 2:1 why the last question failed: 1 no answer, 2 a wrong reply,
--            bits 10:3 the error byte of its last reply                                                (read only)
--   +8n + 6  age: us since its last good reply; 2**20 - 1 while it is not valid                        (read only)
--   +8n + 7  failures: questions without a good reply, 8 bits, it wraps                                (read only)
--   +8N      control: bit 0 enable; it is 1 after a reset. N is the number of servos
--   +8N + 1  lasted: us that the last cycle took, 16 bits                                              (read only)
--
--   cycle  | torques to all | goals to all | ask 0 | reply | ask 1 | reply | ...
--
-- Cycle     The drives and the goals of a cycle are of one moment, in which cyc is low. A servo that does not answer
--           costs timeout_us, and the others go on. A cycle that takes longer than 1/cycle_hz takes the next turn.
-- Drive     A servo gets its torque when it has given a position, so none jumps to a goal that it never had. `hold`
--           is the position that it had when its hold began. If a servo falls silent, its torque and goal go on.
-- Replies   position, speed, load and the error byte of a reply change at once, and while cyc is low. After
--           failures_most failures in a row `valid` falls. A wrong reply changes nothing but the status.
-- Echo      The line is not heard while this side sends.
-- Events    cycled: a cycle has ended. failed: a question had no good reply.
-- Latency   2 clocks per access.
-- Errors    err for addresses from 8N + 2 on, for a write of what is read only, and if it does not select all bytes.
-- Reset     All drives are 0. The first cycle begins a period later: torques off.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.servo_bus_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity servo_bus is
  generic (
    clock_hz      : positive                           := 50_000_000;
    protocol      : natural range 0 to 1               := 0;
    servos        : positive range 1 to 8              := 6;
    first_id      : natural range 0 to 245             := 1;
    baud_hz       : positive range 57_600 to 4_500_000 := 1_000_000;
    cycle_hz      : positive range 10 to 2000          := 200;
    timeout_us    : positive range 20 to 5000          := 1000;
    gap_us        : positive range 1 to 1000           := 20;
    failures_most : positive range 1 to 7              := 3;
    data_width    : positive range 20 to 32            := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    cycled       : out std_ulogic;
    failed       : out std_ulogic;

    rx           : in  std_ulogic; -- asynchronous, high at rest
    tx           : out std_ulogic;
    tx_enable    : out std_ulogic  -- of the driver of the line
  );
end entity;

architecture rtl of servo_bus is

  constant tick_bits  : positive := phase_bits(clock_hz, 1_000_000);
  constant cycle_us   : positive := 1_000_000 / cycle_hz;
  constant lanes      : positive := bytes_for(data_width);
  constant all_bytes  : std_ulogic_vector(lanes - 1 downto 0) := (others => '1');
  constant words      : positive := 8 * servos + 2;
  constant last       : servo_t  := to_unsigned(servos - 1, servo_t'length);
  constant oldest     : unsigned(19 downto 0) := (others => '1');

  subtype half_t is std_ulogic_vector(15 downto 0);
  subtype flags_t is std_ulogic_vector(servos - 1 downto 0);
  type halves_t is array (0 to 7) of half_t;
  type results_t is array (0 to 127) of std_ulogic_vector(19 downto 0);
  type drives_t is array (0 to servos - 1) of std_ulogic_vector(1 downto 0);
  type state_t is (idle, copying, choosing, sending, listening, keeping, pausing);
  type shown_t is (nothing, result, status, goal, age);

  -- The bus.
  signal asked, ack, err, enable : std_ulogic;
  signal shown       : shown_t;
  signal side        : half_t := (others => '0');
  signal asked_us    : unsigned(19 downto 0) := (others => '0');
  signal drives      : drives_t := (others => "00");
  signal puts_goal   : std_ulogic;
  signal goals_bus, goals_cycle : halves_t := (others => (others => '0')); -- the same, for two readers
  signal goal_read, goal_out    : half_t := (others => '0');

  -- The cycle.
  signal state       : state_t;
  signal packet      : packet_t := torques;
  signal servo       : servo_t := (others => '0');
  signal half        : std_ulogic := '0';    -- the second clock of a servo
  signal due         : std_ulogic := '0';    -- a cycle may begin
  signal turn        : unsigned(bits_for(cycle_us) - 1 downto 0) := (others => '0');
  signal timer       : unsigned(bits_for(gap_us + 1) - 1 downto 0) := (others => '0');
  signal lasts       : unsigned(15 downto 0) := (others => '0');
  signal lasted      : unsigned(15 downto 0) := (others => '0');
  signal tick_phase  : unsigned(tick_bits downto 0); -- its highest bit is a tick each us
  signal tick        : std_ulogic;
  signal now_us      : unsigned(19 downto 0) := (others => '0');
  signal told, engaged, holding, valid : flags_t := (others => '0');
  signal told_count, engaged_count, count : unsigned(3 downto 0) := (others => '0');
  signal drive       : std_ulogic_vector(1 downto 0);
  signal known       : std_ulogic; -- the servo has given a position
  signal keeps       : std_ulogic; -- what it holds

  -- What the servos get, and what they give.
  signal sent, lasts_of : halves_t := (others => (others => '0')); -- goals of this cycle, last positions
  signal sent_out, last_out, position : half_t := (others => '0');
  signal results     : results_t := (others => (others => '0'));
  signal stored      : std_ulogic_vector(19 downto 0) := (others => '0');
  signal bank        : flags_t := (others => '0');     -- that is read
  signal reported    : servo_t;                        -- the servo of an access, with …
  signal failures    : unsigned(7 downto 0);
  signal reason      : std_ulogic_vector(1 downto 0);
  signal go, ended, listens, put, good, lost, any : std_ulogic;
  signal item        : servo_t := (others => '0');
  signal id          : byte_t;
  signal field       : unsigned(2 downto 0);
  signal word        : half_t;
  signal put_at      : unsigned(6 downto 0);
  signal got_at      : unsigned(6 downto 0);
  signal put_word    : std_ulogic_vector(19 downto 0);
  signal puts, stamps, commits, copies, gives_up, stops : std_ulogic;

  function index (number : servo_t) return natural is
  begin
    return minimum(to_integer(number), servos - 1);
  end function;

begin

  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  tick      <= tick_phase(tick_bits);
  puts_goal <= '1' when asked = '1' and wishbone_m2s.we = '1' and wishbone_m2s.sel(all_bytes'range) = all_bytes and
               unsigned(wishbone_m2s.adr) < 8 * servos and unsigned(wishbone_m2s.adr(2 downto 0)) = goal_field
               else '0';

  bus_side : process (clock) is
    variable address : natural range 0 to 127;
    variable number  : natural range 0 to servos - 1;
    variable place   : natural range 0 to 7;
    variable exists  : boolean;
    variable whole   : boolean; -- a word of the bus, not of a servo
  begin
    if rising_edge(clock) then
      ack     <= '0';
      err     <= '0';
      address := to_integer(unsigned(wishbone_m2s.adr(6 downto 0)));
      number  := index(unsigned(wishbone_m2s.adr(5 downto 3)));
      place   := to_integer(unsigned(wishbone_m2s.adr(2 downto 0)));
      whole   := address >= 8 * servos;
      exists  := unsigned(wishbone_m2s.adr(31 downto 7)) = 0 and address < words;
      if wishbone_m2s.we = '1' then
        exists := exists and wishbone_m2s.sel(all_bytes'range) = all_bytes and place <= goal_field;
        if whole then
          exists := exists and place = 0;
        end if;
      end if;

      goal_read <= goals_bus(to_integer(unsigned(wishbone_m2s.adr(5 downto 3))));
      if puts_goal = '1' then
        goals_bus(to_integer(unsigned(wishbone_m2s.adr(5 downto 3))))   <= wishbone_m2s.dat(15 downto 0);
        goals_cycle(to_integer(unsigned(wishbone_m2s.adr(5 downto 3)))) <= wishbone_m2s.dat(15 downto 0);
      end if;

      if asked = '1' then
        ack <= '1' when exists else '0';
        err <= '0' when exists else '1';
        if exists and wishbone_m2s.we = '1' then
          if whole then
            enable <= wishbone_m2s.dat(0);
          end if;
          for one in drives'range loop -- an index would make a memory of it, which GHDL 2.0 cannot
            if place = drive_field and not whole and number = one then
              drives(one) <= wishbone_m2s.dat(1 downto 0);
            end if;
          end loop;
        end if;

        side     <= (others => '0');
        shown    <= nothing;
        asked_us <= now_us;
        if whole and place = 0 then
          side(0) <= enable;
        elsif whole then
          side <= std_ulogic_vector(lasted);
        else
          case place is
            when drive_field =>
              side(1 downto 0) <= drives(number);
            when goal_field =>
              shown <= goal;
            when status_field =>
              shown            <= status;
              side(2 downto 0) <= reason & valid(number);
            when age_field =>
              shown   <= age;
              side(0) <= valid(number);
            when failures_field =>
              side(7 downto 0) <= std_ulogic_vector(failures);
            when others =>
              shown <= result;
          end case;
        end if;
      end if;

      if reset = '1' then
        ack    <= '0';
        err    <= '0';
        enable <= '1';
        drives <= (others => "00");
      end if;
    end if;
  end process;

  answer : process (all) is
    variable dat : std_ulogic_vector(31 downto 0);
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    dat := (others => '0');
    case shown is
      when goal    => dat(15 downto 0) := goal_read;
      when result  => dat(15 downto 0) := stored(15 downto 0);
      when status  => dat(15 downto 0) := stored(15 downto 0) or side;
      when nothing => dat(15 downto 0) := side;
      when age     =>
        dat(19 downto 0) := std_ulogic_vector(oldest);
        if side(0) = '1' then
          dat(19 downto 0) := std_ulogic_vector(asked_us - unsigned(stored));
        end if;
    end case;
    wishbone_s2m.dat(data_width - 1 downto 0) <= dat(data_width - 1 downto 0);
  end process;

  -- What the servos give: two banks each. One is read, and a reply is written to the other.
  stamps   <= '1' when state = keeping and half = '0' else '0';
  commits  <= '1' when state = keeping and half = '1' and wishbone_m2s.cyc = '0' else '0';
  puts     <= stamps or put;
  put_at   <= servo & not bank(index(servo)) & field when stamps = '0' else
              servo & not bank(index(servo)) & to_unsigned(age_field, 3);
  put_word <= std_ulogic_vector(now_us) when stamps = '1' else x"0" & word;
  got_at   <= unsigned(wishbone_m2s.adr(5 downto 3)) & bank(index(unsigned(wishbone_m2s.adr(5 downto 3)))) &
              unsigned(wishbone_m2s.adr(2 downto 0));

  memory : process (clock) is
  begin
    if rising_edge(clock) then
      stored <= results(to_integer(got_at));
      if puts = '1' then
        results(to_integer(put_at)) <= put_word;
      end if;
    end if;
  end process;

  -- What the servos get.
  drive    <= drives(index(servo));
  known    <= valid(index(servo)) or engaged(index(servo));
  keeps    <= not drive(1) and drive(0) and holding(index(servo));
  copies   <= '1' when state = copying and half = '1' and wishbone_m2s.cyc = '0' else '0';
  gives_up <= '1' when state = listening and lost = '1' and good = '0' else '0';

  targets : process (clock) is
  begin
    if rising_edge(clock) then
      goal_out <= goals_cycle(to_integer(servo));
      last_out <= lasts_of(to_integer(servo));
      sent_out <= sent(to_integer(item));
      if stamps = '1' then
        lasts_of(to_integer(servo)) <= position;
      end if;
      if copies = '1' and keeps = '0' then
        if drive(1) = '1' then
          sent(to_integer(servo)) <= goal_out;
        else
          sent(to_integer(servo)) <= last_out;
        end if;
      end if;
    end if;
  end process;

  go       <= '1' when state = choosing and (packet = question or count /= 0) else '0';
  count   <= engaged_count when packet = goals else told_count;
  listens <= '1' when state = listening else '0';
  id      <= std_ulogic_vector(to_unsigned(first_id, 8) + servo);

  stops    <= '1' when state = idle and enable = '0' else '0';
  reported <= unsigned(wishbone_m2s.adr(5 downto 3));

  states : entity work.servo_bus_states
    generic map (servos => servos, failures_most => failures_most)
    port map (
      clock => clock, reset => reset, stops => stops, servo => servo, drive => drive, copies => copies,
      gives_up => gives_up, any => any, commits => commits, told => told, engaged => engaged, holding => holding,
      valid => valid, bank => bank, reported => reported, failures => failures, reason => reason);

  cycle : process (clock) is

    procedure start_copy is
    begin
      servo         <= (others => '0');
      half          <= '0';
      told_count    <= (others => '0');
      engaged_count <= (others => '0');
    end procedure;

  begin
    if rising_edge(clock) then
      cycled <= '0';
      failed <= '0';
      tick_phase <= ('0' & tick_phase(tick_bits - 1 downto 0)) + phase_increment(clock_hz, 1_000_000);

      if tick = '1' then
        now_us <= now_us + 1;
        turn   <= turn + 1;
        if turn = cycle_us - 1 then
          turn <= (others => '0');
        end if;
        timer <= timer + 1;
        lasts  <= lasts + (nand lasts);
      end if;
      due <= tick when turn = cycle_us - 1 else '0';

      if put = '1' and field = position_field then
        position <= word;
      end if;

      case state is
        when idle =>
          packet <= torques;
          start_copy;
          if enable = '1' and due = '1' then
            lasts <= (others => '0');
            state <= copying;
          end if;

        when copying =>
          half <= not half;
          if wishbone_m2s.cyc = '1' then
            start_copy;
          elsif half = '1' then
            if nor drive = '1' or known = '1' then
              told_count <= told_count + 1;
            end if;
            if or drive = '1' and known = '1' then
              engaged_count <= engaged_count + 1;
            end if;
            servo <= servo + 1;
            if servo = last then
              servo <= (others => '0');
              state <= choosing;
            end if;
          end if;

        when choosing =>
          if go = '1' then
            state <= sending;
          elsif packet = torques then
            packet <= goals;
          else
            packet <= question;
          end if;

        when sending =>
          timer <= (others => '0');
          if ended = '1' then
            state <= pausing;
            if packet = question then
              state <= listening;
            end if;
          end if;

        when listening =>
          half  <= '0';
          timer <= (others => '0');
          if good = '1' then
            state <= keeping;
          elsif lost = '1' then
            failed <= '1';
            state  <= pausing;
          end if;

        when keeping =>
          half  <= '1';
          timer <= (others => '0');
          if commits = '1' then
            state <= pausing;
          end if;

        when pausing =>
          if timer = gap_us then
            state <= choosing;
            case packet is
              when torques =>
                packet <= goals;
              when goals =>
                packet <= question;
              when question =>
                servo <= servo + 1;
                if servo = last then
                  cycled <= '1';
                  lasted <= lasts;
                  state  <= idle;
                end if;
            end case;
            if enable = '0' then
              state <= idle;
            end if;
          end if;
      end case;

      if reset = '1' then
        state      <= idle;
        cycled     <= '0';
        failed     <= '0';
        lasted     <= (others => '0');
        turn       <= (others => '0');
        due        <= '0';
        tick_phase <= (others => '0');
      end if;
    end if;
  end process;

  sender : entity work.servo_bus_sender
    generic map (
      clock_hz => clock_hz, baud_hz => baud_hz, protocol => protocol, servos => servos, first_id => first_id)
    port map (
      clock => clock, reset => reset, go => go, packet => packet, servo => servo, told => told, engaged => engaged,
      count => count, item => item, goal => sent_out, ended => ended, line => tx, enable => tx_enable);

  receiver : entity work.servo_bus_receiver
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, protocol => protocol, timeout_us => timeout_us)
    port map (
      clock => clock, reset => reset, tick => tick, listens => listens, id => id, put => put, field => field,
      word => word, good => good, failed => lost, any => any, line => rx);

end architecture;
