-- SPDX-License-Identifier: BSD-3-Clause
--
-- Step and direction for the stepper motors of several axes, with ramps. Axis n has 16 words from n * 16 on:
--
--   +0   control: bit 0 enable, bit 1 velocity mode, bit 2 stop at a limit, bits 4:3 what latches: 0 nothing, 1 the
--        low limit, 2 the high limit, 3 home. A write ends a halt, and arms the latch.
--   +1   target position in steps, two's complement
--   +2   speed limit in 1/256 step/s, 28 bits
--   +3   acceleration in 64 step/s**2, 20 bits, not zero
--   +4   target velocity in 1/256 step/s, two's complement; the speed limit holds for it, too
--   +5   position in steps (read)
--   +6   velocity in 1/256 step/s (read)
--   +7   status (read): bit 0 moving, 1 at target, 2 low limit, 3 high limit, 4 home, 5 halted, 6 latched, 7 late
--   +8   position at the latch (read)        +9   stamp of the latch in clocks since the reset (read)
--   +10  shift (write): is added to the position within one ramp period, and no step is lost
--
--   velocity        ____                          step   __/‾\___/‾\________________/‾\__/‾\__
--                  /    \                         dir    ‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\__________________
--                 /      \                               |-length-|-space-|-hold-|-setup-|
--   _____________/        \______
--
-- Position  It counts the pulses on STEP with their sign, and wraps at 32 bits. The way to a target may wrap, too. A
--           step that must wait for its pulse or for DIR is neither lost nor doubled. After a move the axis is at rest
--           in the middle of the target's step.
-- Velocity  All velocities change 16,384 times a second (a ramp period), at the same time for all axes. A step is at
--           most a base period late: base_bits in stepgen_pkg says how long that is (0.24 us with 4 axes at 50 MHz).
--           The rates are exact for any clock_hz.
-- Safe      With enable 0 an axis ramps down to rest, and stays there. So 0 is the safe value of the control word. A
--           step towards an active limit, with bit 2 set, halts the axis: it ramps down. `stop` halts all axes. A halt
--           stays until the control word is written while `stop` is low.
-- Latch     The first edge of the source after the control word was written. The position and the stamp belong
--           together. They are of a moment 2 + stable_clocks clocks, and at most axes + 1 base periods, after the edge.
-- Event     settled is high for one clock when an axis comes to rest.
-- Latency   An access takes 2 clocks. While the ramp uses the same memory it waits for a few clocks, and a read of a
--           position or a latch for at most two base periods.
-- Errors    err for other addresses, for a write of a word to read, for an acceleration of zero, for a shift before
--           the one before was done, and for a write that does not select all bytes.
-- Reset     STEP falls, all axes stop at once, all words are zero. The first access waits until they are cleared.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.stepgen_pkg.all;
  use work.wishbone_pkg.all;

entity stepgen is
  generic (
    clock_hz      : positive                  := 50_000_000;
    axes          : positive range 1 to 8     := 4;
    step_len_ns   : natural range 0 to 100000 := 200;
    step_space_ns : natural range 0 to 100000 := 200;
    dir_setup_ns  : natural range 0 to 100000 := 200;
    dir_hold_ns   : natural range 0 to 100000 := 200;
    stable_clocks : positive                  := 1;  -- clocks for which a limit, home or stop must be stable
    data_width    : positive range 32 to 32   := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    settled      : out std_ulogic;

    step       : out std_ulogic_vector(axes - 1 downto 0);
    direction  : out std_ulogic_vector(axes - 1 downto 0); -- high is up
    limit_low  : in  std_ulogic_vector(axes - 1 downto 0); -- asynchronous; high is active
    limit_high : in  std_ulogic_vector(axes - 1 downto 0);
    home       : in  std_ulogic_vector(axes - 1 downto 0);
    stop       : in  std_ulogic
  );
end entity;

architecture rtl of stepgen is

  constant number_bits : positive := axis_bits(axes);

  subtype number_t is natural range 0 to 2 ** number_bits - 1; -- axes that do not exist have no logic
  subtype axes_t is std_ulogic_vector(axes - 1 downto 0);
  subtype word_t is std_ulogic_vector(31 downto 0);
  subtype address_t is unsigned(number_bits + 3 downto 0);
  type memory_t is array (0 to 2 ** address_t'length - 1) of word_t;
  type sources_t is array (axes_t'range) of std_ulogic_vector(1 downto 0);

  signal memory     : memory_t;
  signal parameters : word_t;

  -- The bus.
  signal asked, known, may_write, is_motion, bus_reads, bus_looks, bus_writes : std_ulogic;
  signal ack, err     : std_ulogic := '0';
  signal bus_axis     : number_t;
  signal bus_word     : word_index_t;
  signal put_word     : std_ulogic;
  signal bus_data     : word_t;
  signal status       : std_ulogic_vector(7 downto 0);
  type answer_t is (of_parameters, of_motion, of_status);
  signal answer       : answer_t := of_parameters;

  -- The ramp and the motion.
  signal clearing, base, bank        : std_ulogic;
  signal sweep                       : address_t; -- the word that is being cleared
  signal axis                        : natural range 0 to axes - 1;
  signal reads, writes, store        : std_ulogic;
  signal store_shift, put            : std_ulogic;
  signal read_word, write_word       : word_index_t;
  signal result                      : word_t;
  signal look, looked, ramp_looks    : std_ulogic;
  signal look_axis                   : number_t;
  signal look_word, ramp_word        : motion_word_t;
  signal look_data                   : word_t;
  signal shifts, shifted             : std_ulogic;
  signal stepped, step_down, late    : std_ulogic;
  signal step_axis                   : number_t;
  signal velocity_write              : std_ulogic;
  signal velocity_axis               : number_t;
  signal velocity_bank               : std_ulogic;

  -- The axes.
  signal levels                      : std_ulogic_vector(3 * axes downto 0);
  signal stops                        : std_ulogic;
  signal low, high, at_home           : axes_t := (others => '0');
  signal near, moving, moved          : axes_t := (others => '0');
  signal enabled                      : axes_t;
  signal halted, stops_at_limit       : axes_t := (others => '0');
  signal was_late, shifting           : axes_t := (others => '0');
  signal source_before                : axes_t := (others => '0');
  signal armed, catch, caught, latched : axes_t := (others => '0');
  signal sources                      : sources_t := (others => "00");

  function address (number : number_t; word : word_index_t) return address_t is
  begin
    return to_unsigned(number, number_bits) & to_unsigned(word, 4);
  end function;

  function flag (flags : axes_t; number : number_t) return std_ulogic is
    variable result : std_ulogic := '0';
  begin
    for index in flags'range loop
      if index = number then
        result := flags(index);
      end if;
    end loop;
    return result;
  end function;

begin

  inputs : entity work.input_filter
    generic map (width => 3 * axes + 1, stable_clocks => stable_clocks)
    port map (clock => clock, reset => reset, pins => stop & home & limit_high & limit_low, levels => levels);

  low     <= levels(axes - 1 downto 0);
  high    <= levels(2 * axes - 1 downto axes);
  at_home <= levels(3 * axes - 1 downto 2 * axes);
  stops   <= levels(3 * axes);
  enabled <= not halted;

  ramp : entity work.stepgen_ramp
    generic map (axes => axes, clock_hz => clock_hz)
    port map (
      clock => clock, reset => reset, clearing => clearing, base => base, bank => bank,
      axis => axis, reads => reads, read_word => read_word, read_data => parameters,
      writes => writes, write_word => write_word, result => result, store => store, store_shift => store_shift,
      stored => put,
      look => ramp_looks, look_word => ramp_word, looked => looked, look_data => look_data,
      enabled => enabled, near => near, moving => moving, shift => shifting, shifts => shifts, shifted => shifted);

  motion : entity work.stepgen_motion
    generic map (
      axes => axes, clock_hz => clock_hz, step_len_ns => step_len_ns, step_space_ns => step_space_ns,
      dir_setup_ns => dir_setup_ns, dir_hold_ns => dir_hold_ns)
    port map (
      clock => clock, reset => reset, clearing => clearing, sweep => sweep,
      velocity_write => velocity_write, shift_write => store_shift, velocity_bank => velocity_bank,
      velocity_axis => velocity_axis, velocity_data => result, put => put, bank => bank, base => base,
      look => look, look_axis => look_axis, look_word => look_word, looked => looked, look_data => look_data,
      shift => shifts, shift_axis => axis, shifted => shifted,
      catch => catch, caught => caught,
      stepped => stepped, step_axis => step_axis, step_down => step_down, late => late,
      step => step, direction => direction);

  -- While the words are cleared, the result of the ramp is zero.
  velocity_write <= store or clearing;
  velocity_axis  <= to_integer(sweep(number_bits - 1 downto 0)) when clearing = '1' else axis;
  velocity_bank  <= sweep(number_bits) when clearing = '1' else not bank;

  -- The bus. The ramp comes first.
  bus_word  <= to_integer(unsigned(wishbone_m2s.adr(3 downto 0)));
  bus_axis  <= to_integer(unsigned(wishbone_m2s.adr(number_bits + 3 downto 4)));
  asked     <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err and not clearing;
  known     <= '1' when unsigned(wishbone_m2s.adr(31 downto address_t'length)) = 0 and bus_axis < axes and
                        bus_word <= word_shift else '0';
  is_motion <= '1' when bus_word = word_position or bus_word = word_latched or bus_word = word_stamp else '0';

  allow : process (all) is
  begin
    may_write <= '0';
    case bus_word is
      when word_control | word_target | word_speed | word_velocity_target =>
        may_write <= '1';
      when word_acceleration =>
        may_write <= or wishbone_m2s.dat(acceleration_bits - 1 downto 0);
      when word_shift =>
        may_write <= not flag(shifting, bus_axis);
      when others =>
        null;
    end case;
    if wishbone_m2s.sel /= "1111" then
      may_write <= '0';
    end if;

    -- What the narrow words cannot hold is not stored.
    bus_data <= wishbone_m2s.dat;
    if bus_word = word_speed then
      bus_data(31 downto speed_bits) <= (others => '0');
    elsif bus_word = word_acceleration then
      bus_data(31 downto acceleration_bits) <= (others => '0');
    end if;
  end process;

  -- The parameters are never read and written at once: what such a read gives depends on the chip.
  bus_reads  <= asked and known and not wishbone_m2s.we and not is_motion and not reads and not writes;
  bus_looks  <= asked and known and not wishbone_m2s.we and is_motion and not ramp_looks;
  bus_writes <= asked and known and wishbone_m2s.we and may_write and not reads and not writes;

  look      <= ramp_looks or bus_looks;
  look_axis <= axis when ramp_looks = '1' else bus_axis;

  pick : process (all) is
  begin
    look_word <= motion_position;
    if ramp_looks = '1' then
      look_word <= ramp_word;
    elsif bus_word = word_latched then
      look_word <= motion_latched;
    elsif bus_word = word_stamp then
      look_word <= motion_stamp;
    end if;
  end process;

  status <= (
    status_late => flag(was_late, bus_axis), status_latched => flag(latched, bus_axis),
    status_halted => flag(halted, bus_axis), status_home => flag(at_home, bus_axis),
    status_high => flag(high, bus_axis), status_low => flag(low, bus_axis),
    status_at_target => flag(near and not moving, bus_axis), status_moving => flag(moving, bus_axis));

  put_word <= writes or bus_writes or clearing;

  store_words : process (clock) is
    variable to_address, from_address : address_t;
    variable data : word_t;
  begin
    if rising_edge(clock) then
      from_address := address(axis, read_word);
      if reads = '0' then
        from_address := address(bus_axis, bus_word);
        if bus_word = word_velocity and bank = '1' then
          from_address := address(bus_axis, word_next);
        end if;
      end if;
      to_address := address(axis, write_word);
      data       := result;
      if clearing = '1' then
        to_address := sweep;
      elsif writes = '0' then
        to_address := address(bus_axis, bus_word);
        data       := bus_data;
      end if;
      if put_word = '1' then
        memory(to_integer(to_address)) <= data;
      end if;
      -- Not an `else` of the line above: GHDL 2.0 synthesises its condition without the `not`.
      if put_word = '0' then
        parameters <= memory(to_integer(from_address));
      end if;
    end if;
  end process;

  answer_bus : process (clock) is
  begin
    if rising_edge(clock) then
      ack    <= bus_reads or bus_writes or (bus_looks and looked);
      err    <= asked and (not known or (wishbone_m2s.we and not may_write));
      answer <= of_parameters;
      if is_motion = '1' then
        answer <= of_motion;
      elsif bus_word = word_status then
        answer <= of_status;
      end if;

      if reset = '1' then
        ack <= '0';
        err <= '0';
      end if;
    end if;
  end process;

  reply : process (all) is
  begin
    wishbone_s2m     <= wishbone_s2m_idle;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
    case answer is
      when of_parameters =>
        wishbone_s2m.dat <= parameters;
      when of_motion =>
        wishbone_s2m.dat <= look_data;
      when of_status =>
        wishbone_s2m.dat(status'range) <= status;
    end case;
  end process;

  watch : process (clock) is
    variable rewritten : boolean;
    variable source    : std_ulogic;
  begin
    if rising_edge(clock) then
      moved   <= moving;
      settled <= or (moved and not moving);

      for number in 0 to axes - 1 loop
        rewritten := bus_writes = '1' and bus_word = word_control and bus_axis = number;

        case sources(number) is
          when "01" => source := low(number);
          when "10" => source := high(number);
          when "11" => source := at_home(number);
          when others => source := '0';
        end case;
        source_before(number) <= source;
        if armed(number) = '1' and source = '1' and source_before(number) = '0' then
          armed(number) <= '0';
          catch(number) <= '1';
        end if;
        if caught(number) = '1' then
          catch(number)   <= '0';
          latched(number) <= catch(number);
        end if;

        if stepped = '1' and step_axis = number and stops_at_limit(number) = '1' and
           ((step_down = '1' and low(number) = '1') or (step_down = '0' and high(number) = '1')) then
          halted(number) <= '1';
        end if;
        if late = '1' and step_axis = number then
          was_late(number) <= '1';
        end if;
        if shifted = '1' and axis = number then
          shifting(number) <= '0';
        end if;
        if bus_writes = '1' and bus_word = word_shift and bus_axis = number then
          shifting(number) <= '1';
        end if;

        -- A level that is high when the control word is written is no edge.
        if rewritten then
          stops_at_limit(number) <= wishbone_m2s.dat(control_stop_at_limit);
          sources(number)        <= wishbone_m2s.dat(control_source);
          source_before(number)  <= '1';
          armed(number)          <= '1';
          catch(number)          <= '0';
          latched(number)        <= '0';
          was_late(number)       <= '0';
          halted(number)         <= '0';
        end if;
        if stops = '1' then
          halted(number) <= '1';
        end if;
        if reset = '1' then
          stops_at_limit(number) <= '0';
          sources(number)        <= "00";
          armed(number)          <= '0';
          catch(number)          <= '0';
          latched(number)        <= '0';
          was_late(number)       <= '0';
          halted(number)         <= '0';
          shifting(number)       <= '0';
        end if;
      end loop;
      if reset = '1' then
        moved <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
