-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of rc_receiver with two channels: what the bus reads of the frames of a front end. The front end may give
-- whole and broken frames at any clock, and the age of the last frame may be any. The bus may do anything.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.wishbone_pkg.all;

entity rc_receiver_formal is
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in wishbone_m2s_t;
    watched : in std_ulogic;                     -- a channel, of which all is followed
    put     : in std_ulogic;                     -- shows a channel of a frame, as all of these show signals
    channel : in unsigned(3 downto 0);
    value   : in std_ulogic_vector(15 downto 0);
    whole   : in std_ulogic;
    broken  : in std_ulogic;
    flags   : in std_ulogic_vector(3 downto 0);
    age     : in unsigned(19 downto 0);
    valid   : in std_ulogic
  );
end entity;

architecture properties of rc_receiver_formal is

  constant timeout_us   : positive := 10_000;
  constant lost_us      : positive := 900;
  constant lost_channel : std_ulogic_vector(15 downto 0) := std_ulogic_vector(to_unsigned(8 * lost_us, 16));
  constant failsafe     : natural := 3; -- flags
  constant lost         : natural := 2;

  subtype half_t is std_ulogic_vector(15 downto 0);

  signal s2m             : wishbone_s2m_t;
  signal frame, failed   : std_ulogic;
  signal begun           : std_ulogic := '0';
  signal reset_1         : std_ulogic := '1';
  signal watched_1       : std_ulogic := '0';
  signal came            : std_ulogic := '0';                 -- the watched channel has, in this frame
  signal coming          : half_t := (others => '0');
  signal pending         : std_ulogic := '0';                 -- a whole frame is not taken yet
  signal is_safe         : std_ulogic := '0';                 -- it is a failsafe
  signal is_old          : std_ulogic := '0';                 -- it repeats an older one
  signal takes, takes_1  : std_ulogic;
  signal fresh, fresh_1  : std_ulogic;
  signal safe_1          : std_ulogic := '0';                 -- a failsafe was taken a clock ago
  signal shown, shown_1  : half_t := (others => '0');         -- the watched channel of the last frame that was taken
  signal valid_1         : std_ulogic := '0';
  signal expired_1       : std_ulogic := '0';                 -- the last frame was too old, a clock ago
  signal reads           : std_ulogic;                        -- the watched channel is read

begin

  default clock is rising_edge(clk);

  dut : entity work.rc_receiver
    generic map (clock_hz => 1_000_000, protocol => 1, channels => 2, timeout_ms => 10, lost_us => lost_us)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, frame => frame, failed => failed,
      line => '0');

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  takes <= pending and not m2s.cyc;
  fresh <= takes and not is_safe and not is_old;
  reads <= '1' when s2m.ack = '1' and unsigned(m2s.adr) = unsigned'("" & watched) else '0';

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun     <= '1';
      reset_1   <= reset;
      watched_1 <= watched;
      takes_1   <= takes;
      fresh_1   <= fresh;
      safe_1    <= takes and is_safe;
      shown_1   <= shown;
      valid_1   <= valid;
      expired_1 <= '0';
      if age >= timeout_us and m2s.cyc = '0' then
        expired_1 <= '1';
      end if;

      if fresh = '1' then
        shown <= coming;
      end if;
      if whole = '1' then
        pending <= '1';
        is_safe <= flags(failsafe);
        is_old  <= flags(lost);
      elsif takes = '1' or put = '1' then
        pending <= '0';
      end if;
      if whole = '1' or broken = '1' then
        came <= '0';
      elsif put = '1' and channel = unsigned'("" & watched) then
        came   <= '1';
        coming <= value;
      end if;

      if reset = '1' then
        came      <= '0';
        pending   <= '0';
        takes_1   <= '0';
        fresh_1   <= '0';
        safe_1    <= '0';
        expired_1 <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The watched channel is any, and stays the same.
  one_is_watched : assume always begun = '0' or watched = watched_1;

  -- A front end gives all channels of a frame before it says that the frame is whole.
  channels_first : assume always whole = '0' or (came = '1' and put = '0' and broken = '0');

  -- A channel that is read while the receiver is valid is that of the last whole frame which was taken. So no channel
  -- of a frame that is not whole is ever shown, and all words of a block are of one frame.
  right_channel : assert always begun = '1' and reads = '1' and valid_1 = '1' -> s2m.dat(15 downto 0) = shown_1;

  -- Without a valid frame a channel reads as the position for a lost link.
  lost_is_read : assert always begun = '1' and reads = '1' and valid_1 = '0' -> s2m.dat(15 downto 0) = lost_channel;

  -- A frame that is too old is no longer valid, as soon as no block is open.
  old_is_void : assert always begun = '1' and expired_1 = '1' and fresh_1 = '0' -> valid = '0';

  -- A failsafe of the transmitter is never shown as a position of the sticks.
  failsafe_is_void : assert always begun = '1' and safe_1 = '1' -> valid = '0';

  -- It is valid again only with a fresh frame.
  only_frames : assert always begun = '1' and valid = '1' and valid_1 = '0' -> frame = '1';

  -- A fresh frame that is taken is told, and nothing else is.
  frame_is_told : assert always begun = '1' -> frame = fresh_1;

  -- A link that is lost is told.
  loss_is_told  : assert always begun = '1' and reset_1 = '0' and valid = '0' and valid_1 = '1' -> failed = '1';
  -- What is told as a failure is a link that was lost.
  told_is_loss  : assert always begun = '1' and failed = '1' -> valid = '0' and valid_1 = '1';

  -- The second frame is read.
  second_seen : cover {begun = '1' and reads = '1' and valid_1 = '1' and shown_1 = x"1234"};

end architecture;
