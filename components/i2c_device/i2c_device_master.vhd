-- SPDX-License-Identifier: BSD-3-Clause
--
-- Exchanges bytes with devices on I2C. Both lines are open drain: the master pulls them low, or lets them go.
--
--   scl  ‾‾‾‾‾\__/‾‾\__/‾‾\_ ... _/‾‾\__/‾‾‾‾‾‾
--   sda  ‾‾‾\____<7  ><6  > ...  <ack >___/‾‾‾‾‾
--        start   |q|q|q|q|                 stop      a bit is four quarters
--
-- first     begins with a start, or with a repeated start inside a frame. last ends with a stop.
-- receive   The device sends the byte. The master acknowledges it, but for the last one of a frame.
-- Clock     A quarter is a whole number of clocks, so scl is never faster than scl_hz. A device may hold scl low: the
--           master waits for it, at most stretch_us.
-- Errors    failed: no device acknowledges a byte, scl stays low, or sda is held low at a start or a stop. The master
--           then frees the bus: up to nine pulses of scl until sda is high, and a stop. So no device stays in a byte.
-- Latency   A byte takes 9 bits and 2 clocks, with start and stop up to 2 bits more.
-- Back-pressure  `go` comes only after the `done` of the byte before. A frame stays open until a byte with `last`.
-- Reset     Both lines are let go at once. The first frame after it frees the bus before.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.rate_pkg.all;
  use work.sequencer_pkg.all;

entity i2c_device_master is
  generic (
    clock_hz   : positive                 := 50_000_000;
    scl_hz     : positive                 := 400_000;
    stretch_us : positive range 1 to 2000 := 1000
  );
  port (
    clock     : in  std_ulogic;
    reset     : in  std_ulogic; -- synchronous
    request   : in  bus_request_t;
    reply     : out bus_reply_t;

    scl_drive : out std_ulogic; -- 1 pulls the line low
    sda_drive : out std_ulogic;
    scl_in    : in  std_ulogic; -- asynchronous
    sda_in    : in  std_ulogic
  );
end entity;

architecture rtl of i2c_device_master is

  -- Clocks of a quarter. In fast mode, above 100 kHz, scl must be low for 1.3 us, which is more than half a bit.
  function clocks_of_quarter return positive is
    constant clocks : positive := maximum(4, (clock_hz - 1) / (4 * scl_hz) + 1);
  begin
    if scl_hz > 100_000 and scl_hz <= 400_000 then
      return maximum(clocks, clocks_lasting(650, clock_hz));
    end if;
    return clocks;
  end function;

  constant quarter_clocks : positive := clocks_of_quarter;
  -- Quarters for which the master waits for scl.
  constant patience       : positive := 1 + (stretch_us * ((clock_hz + 999_999) / 1_000_000)) / quarter_clocks;

  type state_t is (idle, starting, shifting, stopping, freeing);

  signal state   : state_t;
  signal count   : natural range 0 to quarter_clocks - 1; -- clocks that are left of a quarter
  signal quarter : unsigned(1 downto 0);
  signal bits    : unsigned(3 downto 0);                  -- that are done
  signal waited  : natural range 0 to patience;           -- quarters for which scl has been held low
  signal shift   : byte_t := (others => '0');
  signal last, receive, bad : std_ulogic := '0';
  signal again   : std_ulogic := '0';                     -- the bus is freed before a frame, not behind it
  signal dirty   : std_ulogic;                            -- somebody may be inside a byte
  signal scl, sda, over, held : std_ulogic;
  signal pins    : std_ulogic_vector(1 downto 0);

begin

  line_synchroniser : entity work.synchroniser
    generic map (width => 2, idle => '1')
    port map (clock => clock, asynchronous => sda_in & scl_in, levels => pins);

  scl <= pins(0);
  sda <= pins(1);

  reply.data   <= shift;
  reply.reason <= failure_no_answer;

  over  <= '1' when count = 0 else '0';
  held  <= quarter(1) and not quarter(0) and not scl; -- scl has been let go, and does not rise

  process (clock) is

    procedure go (next_state : state_t) is
    begin
      state   <= next_state;
      quarter <= "00";
    end procedure;

  begin
    if rising_edge(clock) then
      reply.done <= '0';
      if over = '0' then
        count <= count - 1;
      end if;

      if state = idle then
        count  <= quarter_clocks - 1;
        waited <= 0;
        if request.go = '1' then
          shift        <= request.data;
          last         <= request.last;
          receive      <= request.receive;
          bits         <= (others => '0');
          bad          <= '0';
          again        <= dirty;
          reply.failed <= '0';
          if dirty = '1' then
            go(freeing);
          elsif request.first = '1' then
            go(starting);
          else
            go(shifting);
          end if;
        end if;

      elsif over = '1' and held = '1' and waited /= patience then
        count  <= quarter_clocks - 1; -- the device stretches the clock
        waited <= waited + 1;

      elsif over = '1' then
        count   <= quarter_clocks - 1;
        quarter <= quarter + 1;
        if held = '1' then
          bad   <= '1'; -- patience has ended
          dirty <= '1';
        end if;

        case state is
          when starting =>
            -- sda is let go, then scl; then sda falls, then scl.
            case quarter is
              when "00" =>
                sda_drive <= '0';
              when "01" =>
                scl_drive <= '0';
              when "10" =>
                bad       <= bad or held or not sda;
                dirty     <= dirty or held or not sda;
                sda_drive <= '1';
              when others =>
                scl_drive <= '1';
                go(shifting);
                if bad = '1' then
                  go(freeing);
                end if;
            end case;

          when shifting =>
            -- scl is low; sda gets its level, scl rises, sda is taken, scl falls.
            case quarter is
              when "00" =>
                sda_drive <= not receive and not shift(7);
                if bits = 8 then
                  sda_drive <= receive and not last; -- the acknowledge goes the other way
                end if;
              when "01" =>
                scl_drive <= '0';
              when "10" =>
                if bits /= 8 then
                  shift <= shift(6 downto 0) & sda;
                elsif sda = '1' and receive = '0' then
                  bad <= '1';
                end if;
              when others =>
                scl_drive <= '1';
                bits      <= bits + 1;
                if bits = 8 then
                  bits <= (others => '0');
                  if last = '1' or bad = '1' then
                    go(stopping);
                  else
                    reply.done <= '1';
                    state      <= idle;
                  end if;
                end if;
            end case;

          when stopping =>
            -- sda is pulled, scl let go, then sda.
            case quarter is
              when "00" =>
                sda_drive <= '1';
              when "01" =>
                scl_drive <= '0';
              when "10" =>
                sda_drive <= '0';
              when others =>
                dirty <= dirty or not sda;
                again <= '0';
                if again = '1' and bad = '0' and dirty = '0' and sda = '1' then
                  go(starting);
                else
                  reply.done   <= '1';
                  reply.failed <= bad or dirty or not sda;
                  state        <= idle;
                end if;
            end case;

          when others =>
            -- Pulses of scl until sda is high, at most nine. Then a stop.
            case quarter is
              when "00" =>
                sda_drive <= '0';
              when "01" =>
                scl_drive <= '0';
              when "10" =>
                dirty <= held;
              when others =>
                scl_drive <= '1';
                bits      <= bits + 1;
                if sda = '1' or bits = 9 then
                  bits <= (others => '0');
                  go(stopping);
                end if;
            end case;
        end case;
      end if;

      if reset = '1' then
        reply.done <= '0';
        state      <= idle;
        scl_drive  <= '0';
        sda_drive  <= '0';
        dirty      <= '1';
      end if;
    end if;
  end process;

end architecture;
