-- SPDX-License-Identifier: BSD-3-Clause
--
-- The channels of a remote control, from the receiver of its radio. protocol 0 is PPM, 1 is S.Bus.
--
--   +n      channel n in 1/8 us, 16 bits. While `valid` is 0 it is lost_us. N is the number of channels
--   +N      state: bit 0 valid: the channels are what the pilot does. Bit 1 lost: the last frame repeated old values,
--           bit 2 failsafe: the receiver says that it lost the pilot, bits 4:3 switches 18 and 17. Only bit 0 with PPM
--   +N + 1  age: us since the last fresh frame; 2**20 - 1 while `valid` is 0
--   +N + 2  fresh frames, 16 bits, it wraps
--   +N + 3  broken frames, 16 bits, it wraps
--   +N + 4  frames that repeated old values, 16 bits, it wraps
--
--   PPM     _/‾\___/‾\_____/‾\___/‾\______________/‾\___     N + 1 edges: each distance is a channel
--            |  0   |   1   |  2  |     more than 2.7 ms
--   S.Bus   0F, 16 channels of 11 bits with the lowest one first, flags, 00 or 04 to 34; 100 kBd, 8E2, inverted
--
-- Frames    A frame changes all channels and the state at once, and only while cyc is low. One that is broken changes
--           nothing but its count. PPM: not N distances of 0.7 to 2.3 ms between two pauses of more than 2.7 ms. S.Bus:
--           a broken character, a wrong first or last byte, or 600 us without a character. Behind a broken frame of
--           S.Bus, the next one begins after such a pause.
-- Never     an old value as a fresh one: a frame that the receiver repeats (`lost`) changes only the state, and the age
--           goes on. `failsafe` clears `valid` at once, and so does an age of timeout_ms.
-- Inverted  inverted 1: S.Bus as it is, or the falling edges of PPM count. 0: the line has been inverted, or the rising
--           edges count.
-- Filter    PPM: a level counts when it has been stable for filter_ns, rounded up to whole clocks.
-- Events    frame: a fresh frame has come. failed: `valid` has fallen.
-- Latency   2 clocks per access. A frame of PPM is taken when its pause has lasted for 2.7 ms, one of S.Bus 8 clocks
--           behind the middle of its first stop bit. Then it waits while cyc is high.
-- Errors    err for a write, and for addresses from N + 5 on.
-- Clock     PPM needs 8 MHz, S.Bus 1 MHz: rate_pkg refuses less.
-- Reset     `valid` is 0 and the counts are 0. The first frame begins behind a pause.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.rate_pkg.all;
  use work.wishbone_pkg.all;

entity rc_receiver is
  generic (
    clock_hz   : positive                 := 50_000_000;
    protocol   : natural range 0 to 1     := 1;
    channels   : positive range 1 to 16   := 16;
    inverted   : natural range 0 to 1     := 1;
    timeout_ms : positive range 10 to 1000 := 100;
    lost_us    : natural range 0 to 2500  := 0;
    filter_ns  : natural range 0 to 2000  := 1000;
    data_width : positive range 20 to 32  := 32
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;
    frame        : out std_ulogic := '0';
    failed       : out std_ulogic := '0';

    line         : in  std_ulogic -- asynchronous
  );
end entity;

architecture rtl of rc_receiver is

  constant words        : positive := channels + 5;
  constant tick_bits    : positive := phase_bits(clock_hz, 1_000_000);
  constant timeout_us   : positive := 1000 * timeout_ms;
  constant lost_channel : std_ulogic_vector(15 downto 0) := std_ulogic_vector(to_unsigned(8 * lost_us, 16));

  subtype half_t is std_ulogic_vector(15 downto 0);
  subtype age_t is unsigned(19 downto 0);
  type memory_t is array (0 to 31) of half_t;

  constant oldest : age_t := (others => '1');

  -- The bus.
  signal asked, known : std_ulogic;
  signal ack, err     : std_ulogic := '0';
  signal number       : natural range 0 to 31; -- of the word
  signal is_channel   : std_ulogic := '0';
  signal found        : half_t;                -- the channel
  signal side         : age_t := (others => '0');

  -- Two banks: one is read, and a frame is written to the other.
  signal memory : memory_t := (others => (others => '0'));
  signal bank   : std_ulogic := '0';

  -- What a front end gives.
  signal put     : std_ulogic;                    -- a channel of the frame that is coming in
  signal channel : unsigned(3 downto 0);
  signal value   : half_t;
  signal whole   : std_ulogic;                    -- the frame is right
  signal broken  : std_ulogic;                    -- it is not
  signal flags   : std_ulogic_vector(3 downto 0); -- failsafe, lost, switches 18 and 17

  signal pending : std_ulogic := '0'; -- a frame waits for the end of a block of accesses
  signal kept    : std_ulogic_vector(3 downto 0) := (others => '0'); -- its flags
  signal takes   : std_ulogic;
  signal fresh   : std_ulogic;
  signal expires : std_ulogic;

  signal phase    : unsigned(tick_bits downto 0) := (others => '0'); -- its highest bit is a tick each us
  signal tick     : std_ulogic;
  signal valid    : std_ulogic := '0';
  signal state    : std_ulogic_vector(3 downto 0) := (others => '0'); -- switches 17 and 18, failsafe, lost
  signal age      : age_t := (others => '1');
  signal frames   : unsigned(15 downto 0) := (others => '0');
  signal breaks   : unsigned(15 downto 0) := (others => '0');
  signal repeats  : unsigned(15 downto 0) := (others => '0');

begin

  -- The bus.
  number <= to_integer(unsigned(wishbone_m2s.adr(4 downto 0)));
  asked  <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;
  known  <= not wishbone_m2s.we and (nor wishbone_m2s.adr(wishbone_m2s.adr'high downto 5)) and to_bit(number < words);

  answer : process (clock) is
  begin
    if rising_edge(clock) then
      ack <= asked and known;
      err <= asked and not known;
      if asked = '1' then
        found      <= memory(to_integer(unsigned'(bank & unsigned(wishbone_m2s.adr(3 downto 0)))));
        is_channel <= valid and to_bit(number < channels);
        side       <= x"0" & unsigned(lost_channel);
        if number = channels then
          side <= resize(unsigned(state & valid), side'length);
        elsif number = channels + 1 then
          side <= age;
        elsif number = channels + 2 then
          side <= x"0" & frames;
        elsif number = channels + 3 then
          side <= x"0" & breaks;
        elsif number = channels + 4 then
          side <= x"0" & repeats;
        end if;
      end if;
      if reset = '1' then
        ack <= '0';
        err <= '0';
      end if;
    end if;
  end process;

  reply : process (all) is
  begin
    wishbone_s2m                  <= wishbone_s2m_idle;
    wishbone_s2m.dat(age_t'range) <= std_ulogic_vector(side);
    if is_channel = '1' then
      wishbone_s2m.dat(age_t'range) <= x"0" & found;
    end if;
    wishbone_s2m.ack <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
  end process;

  store : process (clock) is
  begin
    if rising_edge(clock) then
      if put = '1' then
        -- If the frame before is taken in this clock, the banks change places.
        memory(to_integer(unsigned'((bank xnor fresh) & channel))) <= value;
      end if;
    end if;
  end process;

  -- The frames.
  tick    <= phase(tick_bits);
  takes   <= pending and not wishbone_m2s.cyc;
  fresh   <= takes and not kept(3) and not kept(2);
  expires <= valid and to_bit(age >= timeout_us) and not wishbone_m2s.cyc;

  take : process (clock) is
  begin
    if rising_edge(clock) then
      phase  <= ('0' & phase(tick_bits - 1 downto 0)) + phase_increment(clock_hz, 1_000_000);
      frame  <= fresh;
      failed <= valid and ((takes and kept(3)) or expires) and not fresh;

      if whole = '1' then
        pending <= '1';
        kept    <= flags;
      elsif takes = '1' or put = '1' then
        pending <= '0';
      end if;

      if tick = '1' and age /= oldest then
        age <= age + 1;
      end if;
      if (takes and kept(3)) = '1' or expires = '1' then
        valid <= '0';
        age   <= oldest;
      end if;
      if fresh = '1' then
        valid  <= '1';
        age    <= (others => '0');
        bank   <= not bank;
        frames <= frames + 1;
      end if;
      if takes = '1' then
        state   <= kept(1 downto 0) & kept(3 downto 2);
        if fresh = '0' then
          state(3 downto 2) <= state(3 downto 2);
        end if;
        if kept(2) = '1' then
          repeats <= repeats + 1;
        end if;
      end if;
      if broken = '1' then
        breaks <= breaks + 1;
      end if;

      if reset = '1' then
        phase   <= (others => '0');
        frame   <= '0';
        failed  <= '0';
        pending <= '0';
        valid   <= '0';
        state   <= (others => '0');
        age     <= oldest;
        frames  <= (others => '0');
        breaks  <= (others => '0');
        repeats <= (others => '0');
      end if;
    end if;
  end process;

  ppm : if protocol = 0 generate
    flags <= (others => '0');
    front_end : entity work.rc_receiver_ppm
      generic map (clock_hz => clock_hz, channels => channels, inverted => inverted, filter_ns => filter_ns)
      port map (
        clock => clock, reset => reset, line => line, put => put, channel => channel, value => value, whole => whole,
        broken => broken);
  else generate
    front_end : entity work.rc_receiver_sbus
      generic map (clock_hz => clock_hz, channels => channels, inverted => inverted)
      port map (
        clock => clock, reset => reset, line => line, tick => tick, put => put, channel => channel, value => value,
        whole => whole, broken => broken, flags => flags);
  end generate;

end architecture;
