-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the lines of i2c_device: those of its i2c_device_master. The sequencer may ask for any byte at any time
-- after the one before. The devices may hold or let go both lines at any clock. A quarter of a bit is 4 clocks here,
-- and the master waits one quarter for scl.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.sequencer_pkg.all;

entity i2c_device_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    go      : in std_ulogic;
    first   : in std_ulogic;
    last    : in std_ulogic;
    receive : in std_ulogic;
    byte    : in byte_t;
    scl_in  : in std_ulogic;
    sda_in  : in std_ulogic;
    scl     : in std_ulogic; -- shows the line behind the synchroniser, as does sda
    sda     : in std_ulogic;
    dirty   : in std_ulogic; -- shows that the bus must be freed
    state   : in unsigned(2 downto 0);
    quarter : in unsigned(1 downto 0);
    clocks  : in unsigned(1 downto 0); -- that are left of a quarter
    bits    : in unsigned(3 downto 0); -- that are done
    bad     : in std_ulogic;
    ends_frame, receives : in std_ulogic;
    shift   : in byte_t;
    again   : in std_ulogic  -- shows that the bus is freed before a frame
  );
end entity;

architecture properties of i2c_device_formal is

  constant quarter_clocks : positive := 4;
  constant half           : positive := 2 * quarter_clocks;
  constant since          : positive := quarter_clocks + 1; -- clocks from a sample until scl is seen to be pulled

  signal request                : bus_request_t;
  signal reply                  : bus_reply_t;
  signal scl_drive, sda_drive   : std_ulogic;
  signal scl_1, sda_1, reset_1  : std_ulogic := '1';               -- the drives, a clock ago
  signal begun                  : std_ulogic := '0';
  signal busy, open_frame       : std_ulogic := '0';
  signal own_last, own_receive  : std_ulogic := '0';
  signal own_byte               : byte_t := (others => '0');       -- what is still to be sent
  signal wants_start            : std_ulogic := '0';               -- a frame is asked for, and has not begun
  signal tangled                : std_ulogic := '0';               -- since the byte was asked for
  signal pulses                 : natural range 0 to 10 := 0;      -- rises of scl in this byte
  signal whole                  : std_ulogic := '0';               -- its nine bits have ended
  signal denied                 : std_ulogic := '0';               -- no device has acknowledged it
  signal got                    : byte_t := (others => '0');
  signal still                  : natural range 0 to quarter_clocks := quarter_clocks;  -- clocks since a drive changed
  signal lasted                 : natural range 0 to half := half;        -- clocks since that of scl changed
  signal scl_levels, sda_levels : std_ulogic_vector(1 to since) := (others => '1');
  signal rises, falls, moves    : std_ulogic;
  signal ends                   : std_ulogic;                      -- its ninth bit ends
  signal fits                   : std_ulogic;                      -- the design is where the reference is
  signal whole_now, denied_now  : std_ulogic;

begin

  default clock is rising_edge(clk);

  request <= (go => go, first => first, last => last, receive => receive, data => byte);

  dut : entity work.i2c_device_master
    generic map (clock_hz => 1_600_000, scl_hz => 100_000, stretch_us => 1)
    port map (
      clock => clk, reset => reset, request => request, reply => reply, scl_drive => scl_drive,
      sda_drive => sda_drive, scl_in => scl_in, sda_in => sda_in);

  rises <= scl_1 and not scl_drive; -- scl is let go
  falls <= scl_drive and not scl_1;
  moves <= sda_drive xor sda_1;

  ends       <= falls and not tangled when pulses = 9 else '0';
  whole_now  <= whole or ends;
  denied_now <= denied or (ends and sda_levels(since) and not own_receive);

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun      <= '1';
      reset_1    <= reset;
      scl_1      <= scl_drive;
      sda_1      <= sda_drive;
      scl_levels <= scl & scl_levels(1 to since - 1);
      sda_levels <= sda & sda_levels(1 to since - 1);
      still      <= minimum(still + 1, quarter_clocks);
      lasted     <= minimum(lasted + 1, half);
      if (rises or falls or moves) = '1' then
        still <= 1;
      end if;
      if (rises or falls) = '1' then
        lasted <= 1;
      end if;
      tangled <= tangled or dirty;

      if rises = '1' and wants_start = '0' and pulses < 10 then
        pulses <= pulses + 1;
      end if;
      if falls = '1' and pulses /= 0 and pulses < 10 and tangled = '0' then
        own_byte <= own_byte(6 downto 0) & '0';
        if pulses /= 9 then
          got <= got(6 downto 0) & sda_levels(since);
        end if;
      end if;
      whole  <= whole_now;
      denied <= denied_now;
      -- A start.
      if moves = '1' and sda_drive = '1' and scl_drive = '0' then
        wants_start <= '0';
        pulses      <= 0;
        tangled     <= dirty;
      end if;

      if reply.done = '1' then
        busy    <= '0';
        tangled <= '0';
        if reply.failed = '1' or own_last = '1' then
          open_frame <= '0';
        end if;
      end if;
      if go = '1' then
        busy        <= '1';
        open_frame  <= '1';
        own_byte    <= byte;
        own_last    <= last;
        own_receive <= receive;
        wants_start <= first;
        pulses      <= 0;
        whole       <= '0';
        denied      <= '0';
      end if;

      if reset = '1' then
        busy       <= '0';
        open_frame <= '0';
        tangled    <= '0';
        scl_1      <= '0';
        sda_1      <= '0';
        still      <= quarter_clocks;
        lasted     <= half;
      end if;
    end if;
  end process;

  -- Where the design is, and what the reference must then have.
  relate : process (all) is
    variable clear : boolean; -- the bus is not tangled
    variable count : natural range 0 to 11;
    variable left  : byte_t;
    variable taken : byte_t;
    variable since_it : natural range 1 to since; -- the sample in the last quarter
    variable good  : boolean;
  begin
    clear := tangled = '0' and dirty = '0';
    count := pulses;
    if rises = '1' and wants_start = '0' and pulses < 10 then
      count := pulses + 1;
    end if;
    left := own_byte;
    if falls = '1' and pulses /= 0 then
      left := own_byte(6 downto 0) & '0';
    end if;
    taken := got;
    if falls = '1' and pulses /= 0 and pulses /= 9 then
      taken := got(6 downto 0) & sda_levels(since);
    end if;
    since_it := quarter_clocks - to_integer(clocks);

    good := true;
    if state /= 0 then
      -- Clocks since a change, at least: those of this quarter, and for scl those of the one before.
      good := busy = '1' and open_frame = '1' and reply.done = '0' and reply.failed = '0' and
              ends_frame = own_last and receives = own_receive and
              still >= 3 - to_integer(clocks) and lasted >= 3 - to_integer(clocks) and
              (quarter(0) = '0' or lasted >= 7 - to_integer(clocks)) and
              (quarter /= 3 or dirty = '1' or scl_levels(since_it) = '1');
    end if;
    case to_integer(state) is
      when 0 =>
        if reply.done = '0' then
          good := busy = '0' and scl_drive = open_frame and (open_frame = '0' or (dirty = '0' and tangled = '0')) and
                  (open_frame = '1' or sda_drive = '0');
        elsif reply.failed = '1' then
          good := busy = '1' and open_frame = '1' and scl_drive = '0' and sda_drive = '0';
        else
          good := busy = '1' and open_frame = '1' and dirty = '0' and whole_now = '1' and denied_now = '0' and
                  shift = taken and scl_drive = not own_last and (own_last = '0' or sda_drive = '0');
        end if;
      when 1 =>
        good := good and again = '0' and pulses = 0 and whole = '0' and denied = '0' and own_byte = shift and
                bits = 0 and bad = dirty and (quarter < 2 or scl_drive = '0') and
                (quarter /= 0 or scl_drive = '1' or sda_drive = '0') and
                ((quarter /= 1 and quarter /= 2) or sda_drive = '0');
        if quarter /= 3 then
          good := good and wants_start = '1';
        else
          good := good and sda_drive = '1' and wants_start = moves and (moves = '1' or tangled = '0' or dirty = '1');
        end if;
      when 2 =>
        good := good and wants_start = '0' and again = '0' and bits <= 8 and scl_drive = not quarter(1) and
                (tangled = '0' or dirty = '1') and (dirty = '0' or bad = '1');
        if quarter = 1 or quarter = 2 then
          if bits = 8 then
            good := good and sda_drive = (own_receive and not own_last);
          else
            good := good and sda_drive = (not own_receive and not shift(7));
          end if;
        end if;
        if clear then
          good := good and whole_now = '0' and denied_now = '0' and
                  to_unsigned(count, 4) = bits + quarter(1 downto 1) and (bad = '0' or (quarter = 3 and bits = 8));
          if quarter = 3 and bits = 8 then
            good := good and bad = (sda_levels(since_it) and not own_receive) and shift = taken;
          elsif quarter = 3 then
            good := good and shift(0) = sda_levels(since_it);
          end if;
          for place in 0 to 7 loop
            if quarter /= 3 and place < bits then
              good := good and shift(place) = taken(place);
            elsif quarter = 3 and place > 0 and place <= bits and bits < 8 then
              good := good and shift(place) = taken(maximum(place, 1) - 1);
            end if;
            if quarter /= 3 and place >= bits then
              good := good and shift(place) = left(place);
            elsif quarter = 3 and place > bits then
              good := good and shift(place) = left(maximum(place, 1) - 1);
            end if;
          end loop;
        end if;
      when 3 =>
        good := good and scl_drive = not quarter(1) and wants_start = again and
                (quarter = 0 or sda_drive = not (quarter(1) and quarter(0))) and
                (tangled = '0' or dirty = '1' or again = '1' or bad = '1') and bits = 0;
        if again = '1' then
          good := good and pulses = 0 and whole = '0' and denied = '0' and own_byte = shift;
        end if;
        if clear then
          good := good and whole_now = '1' and to_unsigned(count, 4) = 9 + resize(quarter(1 downto 1), 4) and
                  again = '0' and (own_last = '1' or denied_now = '1') and bad = denied_now and shift = taken;
        end if;
      when 4 =>
        good := good and not clear and wants_start = again and (again = '1' or bad = '1') and bits <= 9;
        if again = '1' then
          good := good and pulses = 0 and whole = '0' and denied = '0' and own_byte = shift;
        end if;
      when others =>
        good := false;
    end case;
    fits <= '1' when good else '0';
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The sequencer asks for one byte at a time. A frame may begin again within a frame.
  asks : assume always go = '0' or (busy = '0' and (first = '1' or open_frame = '1'));

  -- The two lines change a quarter of a bit apart, or more: sda is set and held before and behind each edge of scl.
  apart : assert always begun = '1' and reset_1 = '0' and (rises = '1' or falls = '1' or moves = '1') ->
                   still = quarter_clocks and (moves = '0' or (rises = '0' and falls = '0'));

  -- Neither half of a period of scl is shorter than half a bit.
  never_faster : assert always begun = '1' and reset_1 = '0' and (rises = '1' or falls = '1') ->
                          lasted >= half;

  -- scl is pulled again only when it has been high: a device may stretch it. Or patience has ended.
  waits : assert always begun = '1' and reset_1 = '0' and falls = '1' ->
                   dirty = '1' or scl_levels(since) = '1';

  -- A byte that ends well leaves no bus behind that must be freed.
  held_fails : assert always begun = '1' and reply.done = '1' and reply.failed = '0' -> dirty = '0';

  -- sda is pulled while scl is let go only for the start of a frame that was asked for.
  right_start : assert always begun = '1' and reset_1 = '0' and scl_drive = '0' and moves = '1' and sda_drive = '1' ->
                         wants_start = '1';

  -- sda is let go while scl is let go only for a stop. It comes behind the last byte, behind one that no device
  -- acknowledges, or when the bus is freed.
  right_stop : assert always begun = '1' and reset_1 = '0' and scl_drive = '0' and moves = '1' and sda_drive = '0' ->
                        tangled = '1' or (whole = '1' and pulses = 10 and (own_last = '1' or denied = '1'));

  -- The bits of a byte go out in their order, the highest one first. A device that sends has the line for itself.
  right_bits : assert always begun = '1' and rises = '1' and tangled = '0' and wants_start = '0' and whole = '0' and
                             pulses < 8 -> sda_drive = (not own_receive and not own_byte(7));

  -- In the ninth bit the master acknowledges what it receives, but for the last byte of a frame.
  right_acknowledge : assert always begun = '1' and rises = '1' and tangled = '0' and wants_start = '0' and
                                    pulses = 8 -> sda_drive = (own_receive and not own_last);

  -- A byte that ends well had nine bits, and was acknowledged.
  whole_byte : assert always begun = '1' and reply.done = '1' and reply.failed = '0' ->
                        whole_now = '1' and denied_now = '0';

  -- A byte that is received is what was on sda in its first eight bits.
  right_reply : assert always begun = '1' and reply.done = '1' and reply.failed = '0' and own_receive = '1' ->
                         reply.data = got;

  -- Between two bytes of a frame scl is low.
  holds : assert always begun = '1' and reply.done = '1' and reply.failed = '0' and own_last = '0' -> scl_drive = '1';

  -- Behind a frame, and behind a failure, both lines are let go.
  lets_go : assert always begun = '1' and open_frame = '0' -> scl_drive = '0' and sda_drive = '0';

  -- Each byte has one result.
  one_result : assert always begun = '1' and reply.done = '1' -> busy = '1';

  -- A reset lets both lines go in the next clock.
  reset_lets_go : assert always begun = '1' and reset_1 = '1' -> scl_drive = '0' and sda_drive = '0';

  -- The reference is where the design is. The other properties need this.
  in_place : assert always begun = '1' -> fits = '1';

  -- A byte has been received, and has ended its frame.
  received_seen : cover {begun = '1' and reply.done = '1' and reply.failed = '0' and own_receive = '1' and
                         own_last = '1'};

  -- A byte that no device acknowledges.
  denied_seen : cover {begun = '1' and reply.done = '1' and reply.failed = '1' and denied = '1'};

end architecture;
