-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of uart_bridge with queues of two bytes, half_duplex, and a hold of 3 clocks. A bit may have any number of
-- clocks, of both sides, and so may the line. That the bits of a frame are right is proven in uart_tx and uart_rx.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.wishbone_pkg.all;

entity uart_bridge_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    m2s        : in wishbone_m2s_t;
    rx         : in std_ulogic;
    mark_out   : in std_ulogic;                     -- the byte that is written now is followed
    mark_in    : in std_ulogic;                     -- the byte that comes now is followed
    sent       : in std_ulogic;                     -- shows that the line takes a byte, as all of these show signals
    send_data  : in std_ulogic_vector(7 downto 0);
    tx_ready   : in std_ulogic;                     -- the last stop bit has ended, or ends in this clock
    rx_valid   : in std_ulogic;                     -- a character has come …
    rx_data    : in std_ulogic_vector(7 downto 0);
    rx_error   : in std_ulogic_vector(2 downto 0);  -- … that is broken if this is not zero
    rate       : in std_ulogic_vector(3 downto 0)   -- on the line
  );
end entity;

architecture properties of uart_bridge_formal is

  constant depth       : positive := 2;
  constant hold_clocks : positive := 3;

  signal s2m                 : wishbone_s2m_t;
  signal arrival             : std_ulogic;
  signal tx, tx_enable       : std_ulogic;
  signal begun               : std_ulogic := '0';
  signal reset_1             : std_ulogic := '1';
  signal asked               : std_ulogic := '0';
  signal is_byte, puts       : std_ulogic;
  signal takes, is_read      : std_ulogic;
  signal write_came          : std_ulogic;                                 -- a byte from the bus
  signal to_send             : natural range 0 to depth + 1 := 0;          -- bytes in the queue to the line
  signal to_send_1           : natural range 0 to depth + 1 := 0;          -- a clock ago
  signal waiting             : natural range 0 to depth + 2 := 0;          -- bytes in the queue from the line
  signal gap                 : std_ulogic := '0';
  signal broken              : unsigned(7 downto 0) := (others => '0');
  signal lost                : unsigned(6 downto 0) := (others => '0');
  signal state_expected      : std_ulogic_vector(14 downto 0) := (others => '0');
  signal tx_1, enable_1      : std_ulogic := '0';
  signal driven              : natural range 0 to hold_clocks + 1 := 0;    -- clocks of tx_enable
  signal quiet               : natural range 0 to hold_clocks + 4 := 0;    -- clocks without a frame, and none to send
  signal calm                : natural range 0 to hold_clocks + 1 := 0;    -- clocks in which the transmitter was ready
  signal rate_1              : std_ulogic_vector(3 downto 0) := (others => '0');
  signal stood               : natural range 0 to 3 := 0;                  -- clocks in which a byte waits
  signal told                : std_ulogic := '0';                          -- since it came to the front
  signal is_new              : natural range 0 to 3 := 0;                  -- clocks since a byte came, none read
  signal new_told            : std_ulogic := '0';
  signal is_told, is_new_told : std_ulogic;                                -- now
  signal unread              : std_ulogic := '0';                          -- no byte was read since the last one came

begin

  default clock is rising_edge(clk);

  dut : entity work.uart_bridge
    generic map (clock_hz => 2400, baud_hz => 300, half_duplex => 1, hold_us => 1000, depth => depth, data_width => 16)
    port map (
      clock => clk, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, arrival => arrival, rx => rx, tx => tx,
      tx_enable => tx_enable);

  bus_side : entity work.wishbone_slave_view port map (clk => clk, reset => reset, m2s => m2s, s2m => s2m);

  is_told     <= told or arrival;
  is_new_told <= new_told or arrival;
  write_came <= s2m.ack and m2s.we and nor m2s.adr;
  is_read    <= s2m.ack and not m2s.we and nor m2s.adr(31 downto 1) and m2s.adr(0);
  takes      <= is_read and s2m.dat(9);
  is_byte    <= rx_valid and nor rx_error;
  puts       <= is_byte when waiting <= depth else '0';

  outward : entity work.order_view
    generic map (width => 8, most => depth)
    port map (
      clk => clk, reset => reset, comes => write_came, came => m2s.dat(7 downto 0), mark => mark_out,
      offered => sent, goes => sent, word => send_data);

  inward : entity work.order_view
    generic map (width => 9, most => depth + 1)
    port map (
      clk => clk, reset => reset, comes => puts, came => gap & rx_data, mark => mark_in,
      offered => takes, goes => takes, word => s2m.dat(8 downto 0));

  follow : process (clk) is
    variable left : natural range 0 to depth + 2;
  begin
    if rising_edge(clk) then
      begun    <= '1';
      reset_1  <= reset;
      asked    <= m2s.stb and not s2m.ack and not s2m.err and not reset;
      tx_1     <= tx;
      enable_1 <= tx_enable;
      rate_1   <= rate;

      left := to_send;
      if sent = '1' and to_send > 0 then
        left := to_send - 1;
      end if;
      to_send   <= left;
      to_send_1 <= to_send;
      if write_came = '1' and left <= depth then
        to_send <= left + 1;
      end if;

      left := waiting;
      if takes = '1' and waiting > 0 then
        left := waiting - 1;
      end if;
      waiting <= left;
      if puts = '1' then
        waiting <= left + 1;
      end if;

      state_expected <= std_ulogic_vector(lost & broken);
      if rx_valid = '1' then
        gap <= not puts;
        if is_byte = '0' then
          broken <= broken + 1;
        elsif puts = '0' then
          lost <= lost + 1;
        end if;
      end if;

      driven <= 0;
      if tx_enable = '1' then
        driven <= minimum(driven + 1, hold_clocks + 1);
      end if;
      calm <= 0;
      if tx_ready = '1' and sent = '0' then
        calm <= minimum(calm + 1, hold_clocks + 1);
      end if;
      quiet <= 0;
      if tx_ready = '1' and to_send = 0 and write_came = '0' then
        quiet <= minimum(quiet + 1, hold_clocks + 4);
      end if;

      -- The byte at the front, and its event.
      told  <= (told or arrival) and not takes and to_bit(waiting > 0);
      stood <= 0;
      if waiting > 0 and takes = '0' then
        stood <= minimum(stood + 1, 3);
      end if;
      -- A byte that comes while no byte was read since the one before came.
      new_told <= new_told or arrival;
      if is_new > 0 and is_new < 3 then
        is_new <= is_new + 1;
      end if;
      unread <= (unread or puts) and not takes;
      if puts = '1' and unread = '1' then
        is_new   <= 1;
        new_told <= '0';
      end if;
      if takes = '1' then
        is_new <= 0;
      end if;

      if reset = '1' then
        to_send        <= 0;
        to_send_1      <= 0;
        waiting        <= 0;
        gap            <= '0';
        broken         <= (others => '0');
        lost           <= (others => '0');
        state_expected <= (others => '0');
        driven         <= 0;
        calm           <= hold_clocks + 1;
        quiet          <= 0;
        told           <= '0';
        stood          <= 0;
        is_new         <= 0;
        unread         <= '0';
        rate_1         <= (others => '0');
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- There is no access at power-up.
  quiet_first : assume always begun = '1' or (m2s.cyc = '0' and m2s.stb = '0');

  -- The master waits for the answer to each access.
  patient : assume always asked = '1' -> m2s.cyc = '1';

  -- A write to the queue is refused only when it has no room, or does not select all bytes.
  room_is_used : assert always begun = '1' and reset = '0' and s2m.err = '1' and m2s.we = '1' and nor m2s.adr = '1' and
                               m2s.sel(1 downto 0) = "11" -> to_send_1 = depth;

  -- The room that is told is there.
  room_is_told : assert always begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and nor m2s.adr = '1' ->
                               unsigned(s2m.dat(1 downto 0)) = depth - to_send_1;

  -- A read without a byte says so, and one with a byte takes it.
  says_valid : assert always begun = '1' and reset = '0' and is_read = '1' and s2m.dat(9) = '0' ->
                             s2m.dat(8 downto 0) = "000000000";

  -- What was broken or lost is counted, each once.
  losses_are_told : assert always begun = '1' and reset = '0' and s2m.ack = '1' and m2s.we = '0' and
                                  unsigned(m2s.adr) = 3 -> s2m.dat(14 downto 0) = state_expected;

  -- The line is low only while its driver is on.
  low_is_driven : assert always begun = '1' and tx = '0' -> tx_enable = '1';

  -- The driver is on for the hold before the first start bit.
  leads : assert always begun = '1' and tx = '0' -> driven > hold_clocks;

  -- It stays on for the hold behind the last stop bit. Only a reset ends that sooner.
  holds : assert always begun = '1' and tx_enable = '0' and enable_1 = '1' and reset_1 = '0' -> calm > hold_clocks;

  -- It is always released: when nothing is to be sent, a hold and two clocks behind the last stop bit.
  lets_go : assert always begun = '1' and tx_enable = '1' -> quiet < hold_clocks + 2;

  -- A reset releases it in the next clock, and the line is high.
  reset_lets_go : assert always begun = '1' and reset_1 = '1' -> tx_enable = '0' and tx = '1';

  -- With half_duplex, no character comes while the driver is on: it does not hear itself.
  no_echo : assert always begun = '1' and rx_valid = '1' -> enable_1 = '0';

  -- The rate changes only while no frame is on the line, and the driver is off.
  rate_stands : assert always begun = '1' and reset_1 = '0' and rate /= rate_1 ->
                              enable_1 = '0' and tx_1 = '1' and tx = '1';

  -- A byte at the front has had its event within 3 clocks.
  each_is_told : assert always begun = '1' and reset_1 = '0' and stood = 3 -> is_told = '1';

  -- A byte that comes while none is read has an event, also when the one before it has had one.
  told_again : assert always begun = '1' and reset_1 = '0' and is_new = 3 and waiting > 1 -> is_new_told = '1';

  -- Both queues are full.
  full_seen : cover {begun = '1' and to_send = depth and waiting = depth + 1};

  -- A byte has a gap before it.
  gap_seen : cover {begun = '1' and takes = '1' and s2m.dat(8) = '1'};

end architecture;
