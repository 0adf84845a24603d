-- SPDX-License-Identifier: BSD-3-Clause
--
-- An FT232H or FT2232H in synchronous FIFO mode. The USB behind it is two byte streams. It gives the clock. Its delays
-- are random within the datasheet. It reports everything that the datasheet forbids: inputs without setup or hold time,
-- rd_n without a clock of oe_n before, a byte that nobody drives, a bus that both sides drive.
--
--   to_fpga_*    bytes from the PC; up to room_bytes wait for the FPGA
--   from_fpga_*  bytes to the PC; up to room_bytes wait for it, and then txe_n is high

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;

entity ft245_sync_model is
  generic (
    busy_percent : natural  := 0; -- chance per clock that a flag goes high for 1 to 40 clocks
    pad_ns       : natural  := 2; -- delay of the FPGA's pads and the board, each way
    room_bytes   : positive := 512;
    seed         : positive := 1
  );
  port (
    clock   : in std_ulogic; -- for the streams only
    running : in boolean;    -- the chip is in this mode; otherwise chip_clock stops

    chip_clock   : out std_ulogic := '0';
    rxf_n        : out std_ulogic := '1';
    txe_n        : out std_ulogic := '1';
    oe_n         : in  std_ulogic;
    rd_n         : in  std_ulogic;
    wr_n         : in  std_ulogic;
    siwu_n       : in  std_ulogic;
    data_to_fpga : out std_ulogic_vector(7 downto 0) := (others => 'X');
    data_to_chip : in  std_ulogic_vector(7 downto 0);
    data_drive   : in  std_ulogic; -- the FPGA drives

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

architecture model of ft245_sync_model is

  constant period      : time := 16.667 ns;
  constant pad         : time := pad_ns * 1 ns;
  constant setup_least : time := 7.5 ns; -- t7, t9, t12, t14
  constant delay_most  : time := 9 ns;   -- t4, t5, t6, t11
  constant delay_least : time := 100 ps; -- the same: anything above zero
  constant si_least    : time := 200 ns;

  type bytes_t is array (0 to room_bytes - 1) of std_ulogic_vector(7 downto 0);

  signal out_bytes, in_bytes           : bytes_t; -- out: from the PC
  signal out_put, out_got              : natural := 0;
  signal in_put, in_got                : natural := 0;
  signal own_clock                     : std_ulogic := '0';
  signal chip_oe_n, chip_rd_n          : std_ulogic := '1'; -- as the chip sees them
  signal chip_wr_n, chip_siwu_n        : std_ulogic := '1';
  signal chip_drive                    : std_ulogic := '0';
  signal chip_data                     : std_ulogic_vector(7 downto 0) := x"00";
  signal rxf_now, txe_now              : std_ulogic := '1';
  signal driving                       : boolean := false;  -- the chip drives

begin

  own_clock  <= not own_clock after period / 2 when running;
  chip_clock <= transport own_clock after pad;

  chip_oe_n   <= transport oe_n after pad;
  chip_rd_n   <= transport rd_n after pad;
  chip_wr_n   <= transport wr_n after pad;
  chip_siwu_n <= transport siwu_n after pad;
  chip_data   <= transport data_to_chip after pad;
  chip_drive  <= transport data_drive after pad;
  written     <= in_put;

  moves : process (own_clock) is

    variable random             : random_t;
    variable seeded             : boolean := false;
    variable oe_before          : std_ulogic := '1';
    variable rx_away, tx_away   : natural := 0;      -- clocks for which a flag stays high
    variable got, put           : natural := 0;

    impure function delay return time is
    begin
      return random.integer_between(delay_least / 1 ps, delay_most / 1 ps) * 1 ps;
    end function;

    procedure flag (signal now_n : inout std_ulogic; signal pin_n : out std_ulogic; away : boolean) is
      variable value : std_ulogic := '0';
    begin
      if away then
        value := '1';
      end if;
      if now_n /= value then
        now_n <= value;
        pin_n <= transport value after delay + pad;
      end if;
    end procedure;

  begin
    if rising_edge(own_clock) then
      if not seeded then
        random.seed(seed);
        seeded := true;
      end if;

      check(chip_oe_n'last_event >= setup_least, "oe_n set up before chip_clock");
      check(chip_rd_n'last_event >= setup_least, "rd_n set up before chip_clock");
      check(chip_wr_n'last_event >= setup_least, "wr_n set up before chip_clock");
      check(chip_siwu_n'last_event >= setup_least, "siwu_n set up before chip_clock");
      if chip_wr_n = '0' then
        check(chip_data'last_event >= setup_least and chip_drive'last_event >= setup_least, "data set up");
        check_equal(chip_drive, '1', "the FPGA drives what it writes");
      end if;
      check(chip_rd_n = '1' or (chip_oe_n = '0' and oe_before = '0'), "rd_n a clock behind oe_n");
      oe_before := chip_oe_n;

      got := out_got;
      if chip_rd_n = '0' and rxf_now = '0' then
        got := out_got + 1;
        out_got <= got;
      end if;
      put := in_put;
      if chip_wr_n = '0' and txe_now = '0' then
        check(not is_x(chip_data), "a byte that is none was written");
        in_bytes(in_put mod room_bytes) <= chip_data;
        put := in_put + 1;
        in_put <= put;
      end if;

      rx_away := maximum(rx_away, 1) - 1;
      tx_away := maximum(tx_away, 1) - 1;
      if random.chance(busy_percent) then
        rx_away := random.integer_between(1, 40);
      end if;
      if random.chance(busy_percent) then
        tx_away := random.integer_between(1, 40);
      end if;
      flag(rxf_now, rxf_n, got = out_put or rx_away > 0);
      flag(txe_now, txe_n, put - in_got >= room_bytes or tx_away > 0);

      -- The byte on offer; without one, an undefined value.
      data_to_fpga <= transport (7 downto 0 => 'X') after delay_least + pad;
      if chip_oe_n = '0' then
        if got = out_put then
          data_to_fpga <= transport random.vector(8) after delay_most + pad;
        else
          data_to_fpga <= transport out_bytes(got mod room_bytes) after delay + pad;
        end if;
      end if;
    end if;
  end process;

  -- Output enable works at once, without the clock.
  enable : process (chip_oe_n) is
  begin
    if falling_edge(chip_oe_n) then
      driving <= true;
    elsif rising_edge(chip_oe_n) then
      driving <= false after delay_most;
    end if;
  end process;

  rules : process (chip_drive, driving) is
  begin
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
