-- SPDX-License-Identifier: BSD-3-Clause
--
-- Property of ft245_async: it keeps every byte, with a chip that gives, takes and waits at any time. The order is
-- checked by following any one byte each way by its number. A clock is 20 ns here. The flags change at once, as early
-- as the datasheet and the waits of the design allow.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;

entity ft245_async_bytes_formal is
  port (
    clk          : in std_ulogic;
    reset        : in std_ulogic;
    chip_has     : in std_ulogic; -- the chip has another byte for the FPGA
    chip_takes   : in std_ulogic; -- the chip has room for another byte from the FPGA
    data_to_fpga : in std_ulogic_vector(7 downto 0);
    rx_ready     : in std_ulogic;
    tx_valid     : in std_ulogic;
    tx_data      : in std_ulogic_vector(7 downto 0);
    tx_last      : in std_ulogic;
    follow_in    : in unsigned(2 downto 0);  -- numbers of the followed bytes
    follow_out   : in unsigned(2 downto 0)
  );
end entity;

architecture properties of ft245_async_bytes_formal is

  signal begun : std_ulogic := '0'; -- the reset of power-up is over

  signal rxf_n, txe_n, rd_n, wr_n, siwu_n, data_drive : std_ulogic;
  signal data_out, rx_data                            : std_ulogic_vector(7 downto 0);
  signal rx_valid, tx_ready                           : std_ulogic;

  signal offers, has_room              : std_ulogic := '0'; -- the chip's flags, low on their pins
  signal rd_before, wr_before          : std_ulogic := '1';
  signal siwu_before, drive_before     : std_ulogic := '1';
  signal data_before                   : std_ulogic_vector(7 downto 0);
  signal read_rest, write_rest         : natural range 0 to 2 := 0; -- clocks of an inactive flag after a byte: 49 ns
  signal letting_go                    : std_ulogic := '0'; -- the chip may still be driving
  signal read_age, write_age           : natural range 0 to 3 := 0; -- clocks of a strobe so far

  -- Numbers of bytes modulo 8; at most 6 are on their way.
  signal read, delivered, said, written : unsigned(2 downto 0) := "000";
  signal in_marked, out_marked          : std_ulogic := '0';
  signal chip_byte                      : std_ulogic_vector(7 downto 0); -- while rd_n was low
  signal in_byte, out_byte              : std_ulogic_vector(7 downto 0);
  signal number_in, number_out          : unsigned(2 downto 0);
  signal owed                           : std_ulogic := '0'; -- a message has ended and siwu_n has not fallen since
  signal last_bits                      : std_ulogic_vector(0 to 7) := (others => '0');

begin

  default clock is rising_edge(clk);

  dut : entity work.ft245_async
    generic map (clock_hz => 50_000_000, rx_depth => 2, tx_depth => 2, si_ns => 40)
    port map (
      clock => clk, reset => reset,
      rxf_n => rxf_n, txe_n => txe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
      data_in => data_to_fpga, data_out => data_out, data_drive => data_drive,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => '0');

  -- The flags become inactive at once: rxf_n at the end of rd_n, txe_n at the start of wr_n.
  rxf_n <= '0' when offers = '1' and not (rd_n = '1' and rd_before = '0') else '1';
  txe_n <= '0' when has_room = '1' and not (wr_n = '0' and wr_before = '1') else '1';

  chip : process (clk) is
  begin
    if rising_edge(clk) then
      begun        <= '1';
      rd_before    <= rd_n;
      wr_before    <= wr_n;
      siwu_before  <= siwu_n;
      drive_before <= data_drive;
      data_before  <= data_out;
      number_in    <= follow_in;
      number_out   <= follow_out;
      letting_go   <= not rd_n;

      if rd_n = '0' then
        chip_byte <= data_to_fpga;
      end if;

      read_age  <= 0;
      write_age <= 0;
      if rd_n = '0' and read_age < 3 then
        read_age <= read_age + 1;
      elsif rd_n = '0' then
        read_age <= 3;
      end if;
      if wr_n = '0' and write_age < 3 then
        write_age <= write_age + 1;
      elsif wr_n = '0' then
        write_age <= 3;
      end if;

      if read_rest > 0 then
        read_rest <= read_rest - 1;
      elsif chip_has = '1' then
        offers <= '1';
      end if;
      if rd_n = '1' and rd_before = '0' then -- the byte was read
        offers    <= '0';
        read_rest <= 2;
        read      <= read + 1;
      end if;
      if rd_n = '1' and rd_before = '0' and read = follow_in and in_marked = '0' then
        in_marked <= '1';
        in_byte   <= chip_byte;
      end if;

      if write_rest > 0 then
        write_rest <= write_rest - 1;
      elsif chip_takes = '1' then
        has_room <= '1';
      end if;
      if wr_n = '0' and wr_before = '1' then -- a byte was written
        has_room   <= '0';
        write_rest <= 2;
        written    <= written + 1;
      end if;

      if rx_valid = '1' and rx_ready = '1' and reset = '0' then
        delivered <= delivered + 1;
      end if;
      if tx_valid = '1' and tx_ready = '1' and reset = '0' then
        said <= said + 1;
        last_bits(to_integer(said)) <= tx_last;
        if said = follow_out and out_marked = '0' then
          out_marked <= '1';
          out_byte   <= tx_data;
        end if;
      end if;
      if siwu_n = '0' and siwu_before = '1' then
        owed <= '0';
      end if;
      if wr_n = '0' and wr_before = '1' and last_bits(to_integer(written)) = '1' then
        owed <= '1';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and not again, because a reset may lose a byte.
  reset_first : assume always begun = not reset;

  -- The numbers of the followed bytes stay the same.
  numbers_stand : assume always begun = '1' -> number_in = follow_in and number_out = follow_out;

  -- The chip holds its byte while rd_n is low.
  chip_holds : assume always rd_n = '0' and rd_before = '0' -> next (data_to_fpga = prev(data_to_fpga));

  -- rd_n falls only while the chip offers a byte.
  reads_what_is_there : assert always begun = '1' and rd_n = '0' and rd_before = '1' -> offers = '1';

  -- wr_n falls only while the chip has room.
  writes_where_room : assert always begun = '1' and wr_n = '0' and wr_before = '1' -> has_room = '1';

  -- Strobes are two clocks long, and never both at once.
  strobes_last : assert always begun = '1' -> (rd_n = '0' or rd_before = '1' or read_age = 2) and
                 (wr_n = '0' or wr_before = '1' or write_age = 2) and (rd_n = '1' or wr_n = '1');

  -- The bus is never driven from both sides. The FPGA does not drive while rd_n is low, nor in the clock after that.
  one_driver : assert always begun = '1' and data_drive = '1' -> rd_n = '1' and letting_go = '0';

  -- Data are driven and stable from the clock before wr_n falls to the clock after it rises.
  data_stand : assert always begun = '1' and (wr_n = '0' or wr_before = '0') ->
               data_drive = '1' and drive_before = '1' and data_out = data_before;

  -- No byte to the chip is lost, doubled or changed: the byte written is the next one sent.
  written_in_order : assert always begun = '1' and wr_n = '0' and wr_before = '1' -> written /= said and
                     (out_marked = '0' or written /= follow_out or data_out = out_byte);

  -- No byte from the chip is lost, doubled or changed: the byte on offer is the next one read.
  read_in_order : assert always begun = '1' and rx_valid = '1' -> delivered /= read and
                  (in_marked = '0' or delivered /= follow_in or rx_data = in_byte);

  -- siwu_n falls only after the end of a message, when the strobe is over.
  sends_behind_messages : assert always begun = '1' and siwu_n = '0' and siwu_before = '1' -> owed = '1';

  -- One byte is passed each way.
  both_ways : cover {begun = '1' and written = 1 and delivered = 1};
  -- The end of a message makes the chip send.
  sent : cover {begun = '1' and siwu_n = '0'};

end architecture;
