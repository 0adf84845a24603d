-- SPDX-License-Identifier: BSD-3-Clause
--
-- FT245 asynchronous FIFO physical layer. On one side is an FTDI chip (FT232H, FT2232H), on the other are byte streams
-- with buffers.
--
--   rxf_n --> |        | --> fifo --> rx_valid/ready/data        rd_n  ‾‾\____/‾‾    wr_n    ‾‾‾‾\____/‾‾‾‾
--   rd_n  <-- |        |                                         data  ---<chip>-    data    --<===FPGA===>--
--   data  <-> |  bus   |                                         rxf_n __/‾‾‾‾‾\_    txe_n   ____/‾‾‾‾‾‾‾\_
--   wr_n  <-- |        |
--   txe_n --> |        | <-- fifo <-- tx_valid/ready/data/last/publish
--   siwu_n <-- after the last byte of a message
--
-- Generics  The times are from table 4.2 of DS_FT232H 2.1, and the same in DS_FT2232H. Where the two differ, the longer
--           one is used. pad_ns is the delay of the FPGA's pads and the board, both ways together. si_ns: the
--           datasheets give no figure, and it was not checked on silicon.
-- Ports     There is no tri-state inside. Connect data_in, data_out and data_drive to a pad that drives while
--           data_drive is high.
--           rxf_n, txe_n: asynchronous. With two flag_flops they pass a synchroniser, and have a whole clock to settle.
--           With one they are sampled at falling edges, and have half a clock; above 60 MHz a second flip-flop follows.
--           tx_last, tx_publish: with tx_data. send_immediate says which messages raise siwu_n.
-- Rate      At 50 MHz and with the slowest chip, a byte takes 8 clocks to read and 7 to write: 6.2 and 7.1 MB/s. With
--           one of flag_flops 6 and 5: 8.3 and 10 MB/s. The chip does 8. At 100 MHz both do 8.3 and 10 MB/s.
-- Latency   rxf_n to rx_valid: strobe + 6 clocks. tx_valid to wr_n: 4. siwu_n falls `strobe` + 1 clocks after wr_n of
--           the last byte (3 at 50 MHz), and stays low for si_ns. Messages that end meanwhile share the next pulse.
-- Errors    None: the chip and the buffers lose nothing.
-- Pressure  While rx_ready is low, the chip keeps its bytes, and USB stalls the PC. tx_ready is low while the buffer is
--           full. If both directions have bytes, they take turns.
-- Reset     Cuts a strobe short. The byte of that strobe may be lost.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;
  use work.rate_pkg.all;

entity ft245_async is
  generic (
    clock_hz       : positive         := 50_000_000;
    send_immediate : send_immediate_t := both;
    rx_depth       : positive         := 16; -- bytes, a power of two
    tx_depth       : positive         := 16; -- bytes, a power of two
    strobe_ns      : positive         := 30; -- T4, T10: rd_n, wr_n low
    flag_ns        : positive         := 14; -- T1, T6: until rxf_n, txe_n react
    data_ns        : positive         := 14; -- T3: data after rd_n; also assumed until the chip releases the bus
    setup_ns       : positive         := 5;  -- T8: data before wr_n
    hold_ns        : positive         := 5;  -- T9: data after wr_n, counted from its end
    si_ns          : positive         := 250;
    pad_ns         : natural          := 6;
    flag_flops     : positive range 1 to 2 := 2 -- against metastability of rxf_n, txe_n
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    rxf_n      : in  std_ulogic; -- the chip has a byte
    txe_n      : in  std_ulogic; -- the chip has room
    rd_n       : out std_ulogic := '1';
    wr_n       : out std_ulogic := '1';
    siwu_n     : out std_ulogic := '1';
    data_in    : in  std_ulogic_vector(7 downto 0);
    data_out   : out std_ulogic_vector(7 downto 0);
    data_drive : out std_ulogic := '0';

    rx_valid : out std_ulogic;
    rx_ready : in  std_ulogic;
    rx_data  : out std_ulogic_vector(7 downto 0);

    tx_valid   : in  std_ulogic;
    tx_ready   : out std_ulogic;
    tx_data    : in  std_ulogic_vector(7 downto 0);
    tx_last    : in  std_ulogic := '0';
    tx_publish : in  std_ulogic := '0'
  );
end entity;

architecture rtl of ft245_async is

  constant settles_longer : boolean := clock_hz > 60_000_000; -- with one of flag_flops

  -- Clocks from an edge of a strobe until the flag seen here is the chip's answer to it.
  function answer_clocks return positive is
    constant half_clock_ns : natural  := (500_000_000 + clock_hz - 1) / clock_hz;
    constant sampling_ns   : positive := 2; -- set-up time of the first flip-flop
    constant clocks        : positive := clocks_lasting(flag_ns + pad_ns + half_clock_ns, clock_hz);
  begin
    if flag_flops = 2 then
      return clocks_lasting(flag_ns + pad_ns + sampling_ns, clock_hz) + 2;
    end if;
    if settles_longer then
      return clocks + 1;
    end if;
    return clocks;
  end function;

  constant read_clocks   : positive := clocks_lasting(maximum(strobe_ns, data_ns + pad_ns), clock_hz);
  constant write_clocks  : positive := clocks_lasting(strobe_ns, clock_hz);
  constant setup_clocks  : positive := clocks_lasting(setup_ns, clock_hz);
  -- Clocks until the data may change, and txe_n has reacted to the byte.
  constant hold_clocks   : positive := maximum(clocks_lasting(hold_ns, clock_hz), answer_clocks - write_clocks);
  constant turn_clocks   : positive := clocks_lasting(data_ns + pad_ns, clock_hz); -- until the chip is off the bus
  constant clocks_most   : positive := maximum(maximum(read_clocks, write_clocks), maximum(setup_clocks, hold_clocks));

  type state_t is (idle, reading, setting_up, writing, holding);

  signal flags, seen_flags       : std_ulogic_vector(1 downto 0);           -- txe_n, rxf_n
  signal early_flags             : std_ulogic_vector(1 downto 0) := "11";   -- sampled half a clock earlier
  signal seen_rxf_n, seen_txe_n  : std_ulogic;

  signal state       : state_t := idle;
  signal count       : natural range 0 to clocks_most - 1 := 0;       -- clocks left of the state
  signal read_wait   : natural range 0 to answer_clocks - 1 := 0;     -- … until rxf_n is valid
  signal turn_wait   : natural range 0 to turn_clocks - 1 := 0;       -- … until the bus is free
  signal flush       : std_ulogic := '0';                             -- flush after the byte in hand
  signal flushed     : std_ulogic := '0';                             -- this byte is written

  signal can_read, can_write : std_ulogic;
  signal got_valid, got_room : std_ulogic := '0';
  signal data_crossed        : std_ulogic_vector(7 downto 0);
  signal send_valid          : std_ulogic;
  signal send_ready          : std_ulogic;
  signal send_item           : std_ulogic_vector(8 downto 0);         -- the byte, with the flush bit above it
  signal said_item           : std_ulogic_vector(8 downto 0);

begin

  flags      <= txe_n & rxf_n;
  seen_rxf_n <= seen_flags(0);
  seen_txe_n <= seen_flags(1);

  see : if flag_flops = 2 generate
    flag_synchroniser : entity work.synchroniser
      generic map (width => 2, idle => '1')
      port map (clock => clock, asynchronous => flags, levels => seen_flags);
  else generate
    sample_early : process (clock) is
    begin
      if falling_edge(clock) then
        early_flags <= flags;
      end if;
    end process;

    sample : if settles_longer generate
      process (clock) is
      begin
        if rising_edge(clock) then
          seen_flags <= early_flags;
        end if;
      end process;
    else generate
      seen_flags <= early_flags;
    end generate;
  end generate;

  -- A byte in data_crossed does not yet count in the buffer. So after a read, a waiting write goes first. Otherwise
  -- reads go first.
  can_read   <= '1' when seen_rxf_n = '0' and read_wait = 0 and got_room = '1' and got_valid = '0' else '0';
  can_write  <= '1' when seen_txe_n = '0' and turn_wait = 0 and send_valid = '1' else '0';
  send_ready <= '1' when state = idle and can_write = '1' and can_read = '0' else '0';

  bus_cycle : process (clock) is
  begin
    if rising_edge(clock) then
      got_valid <= '0';
      flushed   <= '0';
      if count > 0 then
        count <= count - 1;
      end if;
      if read_wait > 0 then
        read_wait <= read_wait - 1;
      end if;
      if turn_wait > 0 then
        turn_wait <= turn_wait - 1;
      end if;

      case state is
        when idle =>
          if send_ready = '1' then
            data_out   <= send_item(7 downto 0);
            data_drive <= '1';
            flush      <= send_item(8);
            count      <= setup_clocks - 1;
            state      <= setting_up;
          elsif can_read = '1' then
            rd_n  <= '0';
            count <= read_clocks - 1;
            state <= reading;
          end if;

        when reading =>
          if count = 0 then
            rd_n         <= '1';
            got_valid    <= '1';
            data_crossed <= data_in; -- it stands still
            read_wait    <= answer_clocks - 1;
            turn_wait    <= turn_clocks - 1;
            state        <= idle;
          end if;

        when setting_up =>
          if count = 0 then
            wr_n  <= '0';
            count <= write_clocks - 1;
            state <= writing;
          end if;

        when writing =>
          if count = 0 then
            wr_n    <= '1';
            flushed <= flush;
            count   <= hold_clocks - 1;
            state   <= holding;
          end if;

        when holding =>
          if count = 0 then
            data_drive <= '0';
            state      <= idle;
          end if;
      end case;

      if reset = '1' then
        rd_n       <= '1';
        wr_n       <= '1';
        data_drive <= '0';
        got_valid  <= '0';
        flushed    <= '0';
        count      <= 0;
        read_wait  <= answer_clocks - 1;
        turn_wait  <= turn_clocks - 1;
        state      <= idle;
      end if;
    end if;
  end process;

  send_at_once : entity work.siwu_pulse
    generic map (clock_hz => clock_hz, pulse_ns => si_ns)
    port map (clock => clock, reset => reset, due => flushed, siwu_n => siwu_n);

  receive_buffer : entity work.fifo
    generic map (width => 8, depth => rx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => got_valid, write_ready => got_room, write_data => data_crossed,
      read_valid => rx_valid, read_ready => rx_ready, read_data => rx_data);

  said_item <= sends_at_once(send_immediate, tx_last, tx_publish) & tx_data;

  transmit_buffer : entity work.fifo
    generic map (width => 9, depth => tx_depth)
    port map (
      clock => clock, reset => reset,
      write_valid => tx_valid, write_ready => tx_ready, write_data => said_item,
      read_valid => send_valid, read_ready => send_ready, read_data => send_item);

end architecture;
