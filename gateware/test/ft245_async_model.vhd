-- SPDX-License-Identifier: BSD-3-Clause
--
-- An FT232H or FT2232H in asynchronous FIFO mode. The USB behind it is two byte streams. Its delays are random within
-- the datasheet. It reports everything that the datasheet forbids: a strobe without its flag, a strobe that is too
-- short, both strobes at once, data without setup or hold time, a bus that both sides drive.
--
--   to_fpga_*    bytes from the PC; up to room_bytes wait for the FPGA
--   from_fpga_*  bytes to the PC; up to room_bytes wait for it, and then txe_n is high

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity ft245_async_model is
  generic (
    busy_percent : natural  := 0;     -- chance that a flag stays inactive for up to a microsecond longer
    slowest      : boolean  := false; -- every delay is the longest possible
    pad_ns       : natural  := 3;     -- delay of the FPGA's pads and the board, each way
    room_bytes   : positive := 64;
    seed         : positive := 1
  );
  port (
    clock : in std_ulogic; -- for the streams only

    rxf_n         : out std_ulogic := '1';
    txe_n         : out std_ulogic := '1';
    rd_n          : in  std_ulogic;
    wr_n          : in  std_ulogic;
    siwu_n        : in  std_ulogic;
    data_to_fpga  : out std_ulogic_vector(7 downto 0) := (others => 'X');
    data_to_chip  : in  std_ulogic_vector(7 downto 0);
    data_drive    : in  std_ulogic; -- the FPGA drives

    to_fpga_valid   : in  std_ulogic;
    to_fpga_ready   : out std_ulogic := '0';
    to_fpga_data    : in  std_ulogic_vector(7 downto 0);
    from_fpga_valid : out std_ulogic := '0';
    from_fpga_ready : in  std_ulogic;
    from_fpga_data  : out std_ulogic_vector(7 downto 0);

    written   : out natural := 0; -- bytes that came from the FPGA
    si_pulses : out natural := 0
  );
end entity;

architecture model of ft245_async_model is

  constant pad : time := pad_ns * 1 ns;

  constant strobe_least   : time := 30 ns; -- T4, T10
  constant inactive_least : time := 49 ns; -- T2, T7
  constant setup_least    : time := 5 ns;  -- T8
  constant hold_least     : time := 5 ns;  -- T9, of FT232H: after the end of wr_n
  constant hold_begun     : time := 20 ns; -- T9, of FT2232H: after its beginning
  constant si_least       : time := 200 ns;

  type bytes_t is array (0 to room_bytes - 1) of std_ulogic_vector(7 downto 0);

  signal out_bytes, in_bytes        : bytes_t; -- out: from the PC
  signal out_put, out_got           : natural := 0;
  signal in_put, in_got             : natural := 0;
  signal chip_rd_n, chip_wr_n       : std_ulogic := '1'; -- as the chip sees them
  signal chip_drive, chip_siwu_n    : std_ulogic;
  signal chip_data                  : std_ulogic_vector(7 downto 0);
  signal rxf_now, txe_now           : std_ulogic := '1';
  signal driving                    : boolean := false;  -- the chip drives

begin

  chip_rd_n   <= transport rd_n after pad;
  chip_wr_n   <= transport wr_n after pad;
  chip_siwu_n <= transport siwu_n after pad;
  chip_data   <= transport data_to_chip after pad;
  chip_drive  <= transport data_drive after pad;
  rxf_n       <= transport rxf_now after pad;
  txe_n       <= transport txe_now after pad;
  written     <= in_put;

  read_side : process is
    variable random : random_t;
    variable fell   : time;

    impure function delay return time is
    begin
      if slowest then
        return 14 ns;
      end if;
      return random.integer_between(1000, 14000) * 1 ps;
    end function;

    impure function extra return time is
    begin
      if random.chance(busy_percent) then
        return random.integer_between(0, 1000) * 1 ns;
      end if;
      return 0 ns;
    end function;

    variable behind : time;
  begin
    random.seed(seed);
    loop
      if out_put = out_got then
        wait until out_put /= out_got;
      end if;
      wait for extra;
      rxf_now <= '0';
      wait until chip_rd_n = '0';
      fell    := now;
      driving <= true after 1 ns;
      wait for delay;
      data_to_fpga <= transport out_bytes(out_got mod room_bytes) after pad;
      if chip_rd_n = '0' then
        wait until chip_rd_n = '1';
      end if;
      check(now - fell >= strobe_least, "rd_n was low for " & time'image(now - fell));
      out_got <= out_got + 1;
      behind  := delay;
      data_to_fpga <= transport (7 downto 0 => 'X') after pad;
      driving <= false after 14 ns;
      wait for behind;
      rxf_now <= '1';
      wait for inactive_least + extra;
    end loop;
  end process;

  write_side : process is
    variable random : random_t;
    variable fell   : time;
    variable behind : time;
    variable byte   : std_ulogic_vector(7 downto 0);
  begin
    random.seed(seed + 1);
    loop
      if in_put - in_got >= room_bytes then
        wait until in_put - in_got < room_bytes;
      end if;
      txe_now <= '0';
      wait until chip_wr_n = '0';
      fell := now;
      byte := chip_data;
      check_equal(chip_drive, '1', "the FPGA drives what it writes");
      check(chip_data'last_event >= setup_least and chip_drive'last_event >= setup_least, "data set up before wr_n");
      check(not is_x(byte), "a byte that is none was written");
      in_bytes(in_put mod room_bytes) <= byte;
      in_put <= in_put + 1;
      behind := 14 ns;
      if not slowest then
        behind := random.integer_between(1000, 14000) * 1 ps;
      end if;
      txe_now <= '1' after behind;
      wait until chip_wr_n = '1';
      check(now - fell >= strobe_least, "wr_n was low for " & time'image(now - fell));
      wait for maximum(hold_least, fell + hold_begun - now) - 1 ps;
      check(chip_data = byte and chip_data'last_event >= now - fell and chip_drive = '1', "data held behind wr_n");
      wait for maximum(fell + behind + inactive_least - now, 0 ns);
      if random.chance(busy_percent) then
        wait for random.integer_between(0, 1000) * 1 ns;
      end if;
    end loop;
  end process;

  rules : process (chip_rd_n, chip_wr_n, chip_drive, driving) is
  begin
    if falling_edge(chip_rd_n) then
      check_equal(rxf_now, '0', "rxf_n when rd_n falls");
    end if;
    if falling_edge(chip_wr_n) then
      check_equal(txe_now, '0', "txe_n when wr_n falls");
    end if;
    check(chip_rd_n = '1' or chip_wr_n = '1', "rd_n and wr_n at once");
    check(not driving or chip_drive = '0', "both sides drive the bus");
  end process;

  send_immediate : process (chip_siwu_n) is
    variable fell : time := 0 ns;
  begin
    if falling_edge(chip_siwu_n) then
      fell      := now;
      si_pulses <= si_pulses + 1;
    elsif rising_edge(chip_siwu_n) then
      check(now - fell >= si_least, "siwu_n was low for " & time'image(now - fell));
    end if;
  end process;

  host : process (clock) is
  begin
    if rising_edge(clock) then
      if to_fpga_valid = '1' and to_fpga_ready = '1' then
        out_bytes(out_put mod room_bytes) <= to_fpga_data;
        out_put <= out_put + 1;
      end if;
      to_fpga_ready <= '0';
      if out_put - out_got < room_bytes - 2 then
        to_fpga_ready <= '1';
      end if;
      if from_fpga_valid = '0' or from_fpga_ready = '1' then
        from_fpga_valid <= '0';
        if in_put /= in_got then
          from_fpga_valid <= '1';
          from_fpga_data  <= in_bytes(in_got mod room_bytes);
          in_got          <= in_got + 1;
        end if;
      end if;
    end if;
  end process;

end architecture;
