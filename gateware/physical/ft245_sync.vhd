-- SPDX-License-Identifier: BSD-3-Clause
--
-- FT245 synchronous FIFO physical layer. An FTDI chip (FT232H, FT2232H channel A) gives a clock of 60 MHz, and moves
-- one byte per clock, in one direction at a time.
--
--   chip_clock domain                               clock domain
--   rxf_n, rd_n, oe_n <--> |       | --> async_fifo --> rx_valid/ready/data
--   data              <--> |  bus  |
--   txe_n, wr_n       <--> |       | <-- async_fifo <-- tx_valid/ready/data/last/publish
--   siwu_n            <--
--
-- Ports     There is no tri-state inside. Connect data_in, data_out and data_drive to a pad that drives while
--           data_drive is high. All pins are synchronous to chip_clock, which is the chip's CLKOUT. Every output is a
--           register. txe_n acts on registers in the same clock.
--           DS_FT232H 2.1, table 4.1: inputs come up to 9 ns after chip_clock, and outputs are needed 7.5 ns before the
--           next. So give the tool a clock of 16.67 ns, 9 ns of input delay and 7.5 ns of output delay. This was not
--           checked on silicon.
-- Reset     reset must come out of a register, because it acts on chip_clock as well. While chip_clock is missing (the
--           chip is not in this mode yet), the streams are not ready. They begin 8 clocks of each domain after it came.
-- Rate      In one direction, one byte per clock: 60 MB/s at the pins, of which USB carries 40. If both directions are
--           saturated, each gets burst_clocks at a time. At a change of direction no byte moves for 1 clock (to write)
--           or 2 (to read).
-- Latency   rxf_n to rx_valid: 4 clocks of chip_clock, 3 to 4 of clock. tx_valid to wr_n: 1 clock, 4 to 5 of
--           chip_clock. siwu_n falls in the clock in which the last byte of a message is taken: see siwu_pulse.
-- Errors    None: the chip and the buffers lose nothing.
-- Pressure  While rx_ready is low, the chip keeps its bytes, and USB stalls the PC. tx_ready is low while the buffer is
--           full.

library ieee;
  use ieee.std_logic_1164.all;
  use work.physical_pkg.all;

entity ft245_sync is
  generic (
    send_immediate : send_immediate_t := both;
    rx_depth       : positive         := 64;  -- bytes, a power of two, at least 16
    tx_depth       : positive         := 64;  -- bytes, a power of two, at least 16
    burst_clocks   : positive         := 256; -- of one direction, while the other waits
    si_ns          : positive         := 250
  );
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    chip_clock : in  std_ulogic;
    rxf_n      : in  std_ulogic; -- the chip has a byte
    txe_n      : in  std_ulogic; -- the chip has room
    oe_n       : out std_ulogic := '1';
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

architecture rtl of ft245_sync is

  constant chip_clock_hz : positive := 60_000_000;

  -- Bytes that still come after the buffer has reported that it is full: one until rd_n is high, one in got_data.
  constant bytes_under_way : positive := 2;

  type state_t is (idle, opening, reading, writing);

  signal chip_reset   : std_ulogic;
  signal stream_reset : std_ulogic;

  signal state : state_t := idle;
  signal left  : natural range 0 to burst_clocks - 1 := 0; -- clocks left of the burst, if the other direction waits
  signal write_first : std_ulogic := '0';                  -- the other direction is next

  signal got_valid : std_ulogic := '0';
  signal got_data  : std_ulogic_vector(7 downto 0);
  signal got_room  : std_ulogic;

  signal send_valid, send_ready : std_ulogic;
  signal send_item              : std_ulogic_vector(8 downto 0); -- the byte, with the flush bit above it
  signal said_item              : std_ulogic_vector(8 downto 0);
  signal full                   : std_ulogic := '0';             -- data_out holds a byte
  signal flush                  : std_ulogic := '0';             -- … which ends a message
  signal still_full             : std_ulogic;                    -- … after this clock

  signal taken                 : std_ulogic;                     -- taken by the chip
  signal flushed               : std_ulogic;
  signal wants_in, wants_out   : std_ulogic;

begin

  -- Each side of the buffers stays in reset until the other side has been in reset, with or without its clock.
  chip_side : entity work.reset_synchroniser
    port map (clock => chip_clock, asynchronous_reset => reset, reset => chip_reset);

  stream_side : entity work.reset_synchroniser
    port map (clock => clock, asynchronous_reset => chip_reset, reset => stream_reset);

  wants_in  <= not rxf_n and got_room;
  wants_out <= full and not txe_n;

  taken      <= not wr_n and not txe_n;
  flushed    <= taken and flush;
  send_ready <= not full or taken;
  still_full <= send_valid or not send_ready;

  bus_cycle : process (chip_clock) is
  begin
    if rising_edge(chip_clock) then
      got_valid <= not rd_n and not rxf_n;
      got_data  <= data_in;

      full <= still_full;
      if send_ready = '1' then
        data_out <= send_item(7 downto 0);
        flush    <= send_item(8);
      end if;

      if left > 0 then
        left <= left - 1;
      end if;

      case state is
        when idle =>
          left        <= burst_clocks - 1;
          write_first <= '0';
          if wants_in = '1' and not (write_first = '1' and wants_out = '1') then
            oe_n  <= '0';
            state <= opening;
          elsif wants_out = '1' then
            data_drive <= '1';
            wr_n       <= '0';
            state      <= writing;
          end if;

        when opening =>
          rd_n  <= '0';
          state <= reading;

        when reading =>
          if wants_in = '0' or (left = 0 and wants_out = '1') then
            rd_n        <= '1';
            oe_n        <= '1';
            write_first <= '1';
            state       <= idle;
          end if;

        -- The FPGA keeps the bus until the chip has a byte.
        when writing =>
          wr_n <= not still_full;
          if wants_in = '1' and (left = 0 or wants_out = '0') then
            wr_n       <= '1';
            data_drive <= '0';
            state      <= idle;
          end if;
      end case;

      if chip_reset = '1' then
        oe_n       <= '1';
        rd_n       <= '1';
        wr_n       <= '1';
        data_drive <= '0';
        got_valid  <= '0';
        full       <= '0';
        state      <= idle;
      end if;
    end if;
  end process;

  send_at_once : entity work.siwu_pulse
    generic map (clock_hz => chip_clock_hz, pulse_ns => si_ns)
    port map (clock => chip_clock, reset => chip_reset, due => flushed, siwu_n => siwu_n);

  receive_buffer : entity work.async_fifo
    generic map (width => 8, depth => rx_depth, margin => bytes_under_way)
    port map (
      write_clock => chip_clock, write_reset => chip_reset,
      write_valid => got_valid, write_ready => got_room, write_data => got_data,
      read_clock => clock, read_reset => stream_reset,
      read_valid => rx_valid, read_ready => rx_ready, read_data => rx_data);

  said_item <= sends_at_once(send_immediate, tx_last, tx_publish) & tx_data;

  transmit_buffer : entity work.async_fifo
    generic map (width => 9, depth => tx_depth)
    port map (
      write_clock => clock, write_reset => stream_reset,
      write_valid => tx_valid, write_ready => tx_ready, write_data => said_item,
      read_clock => chip_clock, read_reset => chip_reset,
      read_valid => send_valid, read_ready => send_ready, read_data => send_item);

end architecture;
