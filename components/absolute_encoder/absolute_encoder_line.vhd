-- SPDX-License-Identifier: BSD-3-Clause
--
-- The lines of an absolute encoder: it makes a frame, and checks what comes. absolute_encoder has the kinds, the checks
-- and the registers.
--
--   rests    no frame is under way. ready: and the pause is over.
--   begins   high for one clock while ready: a reading begins
--   ended    a reading has ended: reason says whether it is good, and value, warns and began belong to it. It stands
--            until accept.
--
-- Latency   A bit is what the pin was at the fall of sclk, so the line may be half a period late. BiSS-C has no limit.
-- Reset     The line is at rest, and a pause begins.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.absolute_encoder_pkg.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;

entity absolute_encoder_line is
  generic (
    clock_hz  : positive                := 50_000_000;
    kind      : natural range 0 to 2    := 0;
    bits      : positive range 2 to 32  := 13;
    lead_bits : natural range 0 to 15   := 0;
    tail_bits : natural range 0 to 15   := 0;
    gray      : natural range 0 to 1    := 1;
    sclk_hz   : positive                := 1_000_000;
    pause_us  : positive range 1 to 100 := 25
  );
  port (
    clock    : in  std_ulogic;
    reset    : in  std_ulogic; -- synchronous
    rests    : out std_ulogic;
    ready    : out std_ulogic;
    begins   : in  std_ulogic;
    now      : in  unsigned(31 downto 0);
    ended    : out std_ulogic;
    accept   : in  std_ulogic;
    reason   : out reason_t;
    value    : out unsigned(bits - 1 downto 0);
    warns    : out std_ulogic;
    began    : out unsigned(31 downto 0);

    sclk     : out std_ulogic;
    select_n : out std_ulogic;
    mosi     : out std_ulogic;
    miso     : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of absolute_encoder_line is

  constant ssi         : natural := 0;
  constant biss        : natural := 1;
  constant spi         : natural := 2;
  constant select_ns   : natural := 400;
  constant answer_us   : natural := 40;

  constant clock_khz   : positive := (clock_hz + 999) / 1000;

  function chosen (for_ssi, for_biss, for_spi : integer) return integer is
  begin
    if kind = ssi then
      return for_ssi;
    elsif kind = biss then
      return for_biss;
    end if;
    return for_spi;
  end function;

  -- Clocks that last at least so many us.
  function clocks_of_us (us : positive) return positive is
  begin
    return (us * clock_khz + 999) / 1000;
  end function;

  constant half_clocks   : positive := maximum(3, (clock_hz - 1) / (2 * sclk_hz) + 1);
  constant pause_clocks  : positive :=
    maximum(4, chosen(clocks_of_us(pause_us), clocks_of_us(pause_us), clocks_lasting(select_ns, clock_hz)));
  constant answer_clocks : positive := clocks_of_us(answer_us);
  constant latency       : positive := 3;               -- of the input
  constant tail          : natural  := chosen(tail_bits, 8, 0);
  constant frame_bits    : positive := chosen(lead_bits + bits + tail, 1 + bits + tail, 16);
  constant timer_most    : positive := maximum(pause_clocks, 2 * half_clocks);
  constant rest          : std_ulogic := to_bit(kind /= spi); -- of sclk
  constant is_gray       : std_ulogic := to_bit(gray = 1);


  -- Commands of kind 2, with their parity.
  constant angle_command : std_ulogic_vector(15 downto 0) := x"FFFF";
  constant field_command : std_ulogic_vector(15 downto 0) := x"7FFD";
  constant clear_command : std_ulogic_vector(15 downto 0) := x"4001";

  type state_t is (resting, selecting, clocking, ending, deselected, judging);
  type stage_t is (acknowledge, start, data);

  signal level      : std_ulogic;
  signal state      : state_t := resting;
  signal stage      : stage_t := acknowledge; -- of a frame of BiSS-C
  signal timer      : natural range 0 to timer_most - 1 := pause_clocks - 1;
  signal sampler    : natural range 0 to 3 * half_clocks - 1 := 0; -- clocks until the middle of a bit of BiSS-C
  signal patience   : natural range 0 to answer_clocks - 1 := 0;
  signal left       : natural range 0 to frame_bits - 1 := 0;   -- bits behind the next one
  signal primed     : std_ulogic := '0';                        -- the next fall reads a bit
  signal done       : std_ulogic := '0';                        -- the last bit is there
  signal second     : std_ulogic := '0';                        -- frame of kind 2
  signal command    : std_ulogic_vector(15 downto 0) := (others => '0'); -- of kind 2
  signal renews     : natural range 0 to 2 := 2;                -- readings of kind 2 that only clear the error

  signal shift      : unsigned(bits - 1 downto 0) := (others => '0');
  signal crc        : std_ulogic_vector(5 downto 0) := (others => '0');
  signal parity     : std_ulogic := '0';
  signal is_error   : std_ulogic := '0';

begin

  assert kind /= spi or bits <= 14
    report "absolute_encoder: a device of kind 2 has at most 14 bits, got " & integer'image(bits)
    severity failure;

  filter : entity work.input_filter
    generic map (width => 1, stable_clocks => 1)
    port map (clock => clock, reset => reset, pins(0) => miso, levels(0) => level);

  rests <= '1' when state = resting else '0';
  ready <= '1' when state = resting and timer = 0 else '0';
  ended <= '1' when state = judging and (reason /= fine or renews = 0 or kind /= spi) else '0';
  value <= shift;

  run : process (clock) is
    variable takes    : boolean; -- a bit
    variable turns    : boolean; -- half a period of sclk ends
    variable finished : std_ulogic;
    variable inverted : std_ulogic;

    procedure fail (why : reason_t) is
    begin
      if reason = fine then
        reason <= why;
      end if;
    end procedure;

    procedure begin_frame is
    begin
      left     <= frame_bits - 1;
      shift    <= (others => '0');
      crc      <= (others => '0');
      parity   <= '0';
      is_error <= '0';
      done     <= '0';
    end procedure;

  begin
    if rising_edge(clock) then
      takes := false;
      turns := timer = 0;
      if timer /= 0 then
        timer <= timer - 1;
      end if;

      case state is
        when resting =>
          if begins = '1' then
            began  <= now;
            reason <= fine;
            second <= '0';
            primed <= '0';
            begin_frame;
            if kind = spi then
              command  <= angle_command;
              select_n <= '0';
              timer    <= pause_clocks - 1;
              state    <= selecting;
            elsif level = '0' then
              reason <= no_answer;
              state  <= judging;
            else
              sclk     <= '0';
              timer    <= half_clocks - 1;
              stage    <= acknowledge;
              patience <= answer_clocks - 1;
              state    <= clocking;
            end if;
          end if;

        when selecting =>
          if turns then
            sclk   <= '1';
            mosi   <= command(15);
            primed <= '1';
            timer  <= half_clocks - 1;
            state  <= clocking;
          end if;

        when clocking =>
          finished := done;
          if kind = biss then
            if sampler /= 0 then
              sampler <= sampler - 1;
            end if;
            if patience /= 0 then
              patience <= patience - 1;
            end if;
            case stage is
              when acknowledge =>
                if level = '0' then
                  stage <= start;
                end if;
              when start =>
                if level = '1' then
                  stage   <= data;
                  sampler <= 3 * half_clocks - 1;
                end if;
              when data =>
                if sampler = 0 and done = '0' then
                  takes   := true;
                  sampler <= 2 * half_clocks - 1;
                end if;
            end case;
            if stage /= data and patience = 0 then
              fail(no_answer);
              done <= '1';
            end if;
          else
            takes := sclk = '0' and primed = '1' and done = '0' and timer = half_clocks - latency;
          end if;
          if takes and left = 0 then
            finished := '1';
          end if;
          if turns then
            timer <= half_clocks - 1;
            sclk  <= not sclk;
            if sclk = '0' then
              primed  <= '1';
              command <= command(14 downto 0) & '0';
              mosi    <= command(14);
            end if;
            if finished = '1' and (kind = biss or sclk = '0') then
              sclk  <= rest;
              mosi  <= '0';
              timer <= chosen(2 * half_clocks, 1, pause_clocks) - 1;
              state <= ending;
            end if;
          end if;

        when ending =>
          if turns then
            state <= judging;
            if kind = ssi and level = '1' then
              fail(no_answer);
            elsif kind = biss and crc /= "000000" then
              fail(wrong_check);
            elsif kind = biss and is_error = '1' then
              fail(device_error);
            elsif kind = spi then
              select_n <= '1';
              timer    <= pause_clocks - 1;
              state    <= deselected;
              -- The reply of the first frame says nothing after a failure.
              if second = '1' or renews = 0 then
                if parity = '1' then
                  fail(wrong_check);
                elsif (second = '0' and shift = 0) or (is_error = '1' and (and shift) = '1') then
                  fail(no_answer);
                elsif is_error = '1' then
                  fail(device_error);
                end if;
              end if;
              if second = '0' then
                began <= now;
              end if;
            end if;
          end if;

        when deselected =>
          if turns then
            if second = '1' then
              state <= judging;
            else
              second  <= '1';
              primed  <= '0';
              begin_frame;
              command <= field_command;
              if renews = 2 then
                command <= clear_command;
              end if;
              select_n <= '0';
              timer    <= pause_clocks - 1;
              state    <= selecting;
            end if;
          end if;

        when judging =>
          if accept = '1' or ended = '0' then
            state <= resting;
            timer <= pause_clocks - 1;
            if reason /= fine then
              renews <= 2;
            elsif renews /= 0 then
              renews <= renews - 1; -- nothing is known yet, and nothing has failed
            end if;
          end if;
      end case;

      if takes then
        left <= maximum(left, 1) - 1;
        done <= finished;
        if left >= tail and left < tail + bits then
          shift <= shift(bits - 2 downto 0) & (level xor (shift(0) and is_gray));
        end if;
        if kind = biss then
          inverted := to_bit(left < 6);
          if left <= bits + 7 then -- position, nE, nW, and the CRC, whose inverse gives 0
            crc <= (crc(4 downto 0) & (level xor inverted)) xor ("0000" & crc(5) & crc(5));
          end if;
          if left = 7 then
            is_error <= not level;
          end if;
          if left = 6 then
            warns <= not level;
          end if;
        end if;
        if kind = spi then
          parity <= parity xor level;
          if left = 14 then
            is_error <= level;
          end if;
        end if;
      end if;

      if reset = '1' then
        state    <= resting;
        timer    <= pause_clocks - 1;
        done     <= '0';
        renews   <= 2;
        reason   <= fine;
        warns    <= '0';
        sclk     <= rest;
        select_n <= '1';
        mosi     <= '0';
      end if;
    end if;
  end process;

end architecture;
