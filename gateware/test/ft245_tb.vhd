-- SPDX-License-Identifier: BSD-3-Clause
--
-- ft245_async or ft245_sync with a model of the chip that checks its timing. First the speed of each direction alone,
-- then both directions at random with stalls on both sides. Every byte arrives once and in order. siwu_n falls at once
-- after the last byte of each chosen message, and never before. The synchronous layer also waits for its clock, and
-- survives a reset without it.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity ft245_tb is
  generic (
    synchronous    : boolean          := false;
    clock_hz       : positive         := 50_000_000;
    send_immediate : send_immediate_t := both;
    bytes          : positive         := 1500;
    slowest        : boolean          := true;   -- asynchronous: every delay is the longest
    busy_percent   : natural          := 0;  -- busy clocks of the chip
    stall_percent  : natural          := 30; -- stalled clocks of the streams
    rate_hz_least  : natural          := 0;  -- bytes per second, one direction
    flag_flops     : positive         := 2;  -- asynchronous
    seed           : positive         := 1
  );
end entity;

architecture test of ft245_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant rate_bytes   : positive := 300;
  constant total        : positive := bytes + 3 * rate_bytes;
  constant pause        : time     := 20 us;                  -- long enough to fill every buffer

  function size_least return positive is
  begin
    if synchronous then
      return 20;
    end if;
    return 6;
  end function;

  type marks_t is array (0 to total + 60) of boolean;

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean    := false;

  signal rxf_n, txe_n, rd_n, wr_n, siwu_n     : std_ulogic;
  signal data_to_fpga, data_to_chip           : std_ulogic_vector(7 downto 0);
  signal data_drive, oe_n, chip_clock         : std_ulogic;
  signal rx_valid, rx_ready                   : std_ulogic := '0';
  signal tx_valid, tx_ready                   : std_ulogic := '0';
  signal tx_last, tx_publish                  : std_ulogic := '0';
  signal rx_data, tx_data                     : std_ulogic_vector(7 downto 0) := x"00";
  signal to_fpga_valid, to_fpga_ready         : std_ulogic := '0';
  signal from_fpga_valid, from_fpga_ready     : std_ulogic := '0';
  signal to_fpga_data, from_fpga_data         : std_ulogic_vector(7 downto 0) := x"00";
  signal written, si_pulses                   : natural;

  signal stalls                : natural := 0; -- percent, on all sides
  signal deaf                  : boolean := false; -- the FPGA takes nothing
  signal allowed_in            : natural := 0; -- bytes that may go to the PC
  signal allowed_out           : natural := 0; -- bytes that may go to the FPGA
  signal received, heard       : natural := 0; -- by the FPGA; by the PC
  signal marks                 : marks_t := (others => false); -- siwu_n is due after this byte
  signal due                   : natural := 0;
  signal running               : boolean := false; -- the chip gives its clock

begin

  clock <= not clock after clock_period / 2 when not done;

  async : if not synchronous generate
    dut : entity work.ft245_async
      generic map (clock_hz => clock_hz, send_immediate => send_immediate, flag_flops => flag_flops)
      port map (
        clock => clock, reset => reset,
        rxf_n => rxf_n, txe_n => txe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_in => data_to_fpga, data_out => data_to_chip, data_drive => data_drive,
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

    chip : entity work.ft245_async_model
      generic map (busy_percent => busy_percent, slowest => slowest, seed => seed)
      port map (
        clock => clock, rxf_n => rxf_n, txe_n => txe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_to_fpga => data_to_fpga, data_to_chip => data_to_chip, data_drive => data_drive,
        to_fpga_valid => to_fpga_valid, to_fpga_ready => to_fpga_ready, to_fpga_data => to_fpga_data,
        from_fpga_valid => from_fpga_valid, from_fpga_ready => from_fpga_ready, from_fpga_data => from_fpga_data,
        written => written, si_pulses => si_pulses);

    oe_n <= '1';
  else generate
    dut : entity work.ft245_sync
      generic map (send_immediate => send_immediate, burst_clocks => 32)
      port map (
        clock => clock, reset => reset,
        chip_clock => chip_clock, rxf_n => rxf_n, txe_n => txe_n, oe_n => oe_n, rd_n => rd_n, wr_n => wr_n,
        siwu_n => siwu_n, data_in => data_to_fpga, data_out => data_to_chip, data_drive => data_drive,
        rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

    chip : entity work.ft245_sync_model
      generic map (busy_percent => busy_percent, seed => seed)
      port map (
        clock => clock, running => running and not done, chip_clock => chip_clock,
        rxf_n => rxf_n, txe_n => txe_n, oe_n => oe_n, rd_n => rd_n, wr_n => wr_n, siwu_n => siwu_n,
        data_to_fpga => data_to_fpga, data_to_chip => data_to_chip, data_drive => data_drive,
        to_fpga_valid => to_fpga_valid, to_fpga_ready => to_fpga_ready, to_fpga_data => to_fpga_data,
        from_fpga_valid => from_fpga_valid, from_fpga_ready => from_fpga_ready, from_fpga_data => from_fpga_data,
        written => written, si_pulses => si_pulses);
  end generate;

  -- Messages from the FPGA. None ends within the pulse of the message before.
  speak : process is
    variable data, moments : random_t;
    variable size, place   : natural := 0;
    variable publish       : std_ulogic := '0';
    variable sends         : std_ulogic;
  begin
    data.seed(seed + 1);
    moments.seed(seed + 2);
    for index in 0 to total - 1 loop
      while index >= allowed_in or moments.chance(stalls) loop
        wait until rising_edge(clock);
      end loop;
      if place = size then
        size    := moments.integer_between(size_least, 40);
        place   := 0;
        publish := '1' when moments.chance(50) else '0';
      end if;
      place      := place + 1;
      tx_valid   <= '1';
      tx_data    <= data.vector(8);
      tx_publish <= publish;
      tx_last    <= '1' when place = size else '0';
      sends      := '0';
      if place = size then
        case send_immediate is
          when never     => null;
          when both      => sends := '1';
          when replies   => sends := not publish;
          when publishes => sends := publish;
        end case;
      end if;
      if sends = '1' then
        marks(index) <= true;
        due          <= due + 1;
      end if;
      wait until rising_edge(clock) and tx_ready = '1';
      tx_valid <= '0';
    end loop;
    wait;
  end process;

  pc_hears : process is
    variable data, moments : random_t;
  begin
    data.seed(seed + 1);
    moments.seed(seed + 3);
    loop
      wait until rising_edge(clock);
      if from_fpga_valid = '1' and from_fpga_ready = '1' then
        check_equal(from_fpga_data, data.vector(8), "byte " & integer'image(heard) & " of the FPGA");
        heard <= heard + 1;
      end if;
      from_fpga_ready <= '0' when moments.chance(stalls) else '1';
      if stalls > 0 and moments.integer_between(1, 2000) = 1 then
        from_fpga_ready <= '0';
        wait for pause;
      end if;
    end loop;
  end process;

  pc_speaks : process is
    variable data, moments : random_t;
  begin
    data.seed(seed + 4);
    moments.seed(seed + 5);
    for index in 0 to total - 1 loop
      while index >= allowed_out or moments.chance(stalls) loop
        wait until rising_edge(clock);
      end loop;
      send(clock, to_fpga_valid, to_fpga_ready, to_fpga_data, data.vector(8));
    end loop;
    wait;
  end process;

  hear : process is
    variable data, moments : random_t;
  begin
    data.seed(seed + 4);
    moments.seed(seed + 6);
    loop
      wait until rising_edge(clock);
      if rx_valid = '1' and rx_ready = '1' then
        check_equal(rx_data, data.vector(8), "byte " & integer'image(received) & " of the PC");
        received <= received + 1;
      end if;
      rx_ready <= '0' when deaf or moments.chance(stalls) else '1';
      if stalls > 0 and moments.integer_between(1, 2000) = 1 then
        rx_ready <= '0';
        wait for pause;
      end if;
    end loop;
  end process;

  watch : process (siwu_n) is
  begin
    if falling_edge(siwu_n) then
      check(synchronous or wr_n = '1', "wr_n when siwu_n falls");
      check(written > 0 and marks(maximum(written, 1) - 1), "siwu_n behind a byte that ends no message");
      check(written'last_event <= 4 * clock_period,
            "siwu_n " & time'image(written'last_event) & " behind the last byte");
    end if;
  end process;

  play : process is
    variable start : time;

    procedure check_rate (start : time; way : string) is
      variable rate_hz : real;
    begin
      rate_hz := real(rate_bytes) * 1.0e12 / real((now - start) / 1 ps);
      report way & ": " & integer'image(integer(rate_hz)) & " bytes a second, "
             & real'image(real((now - start) / 1 ps) / real(clock_period / 1 ps) / real(rate_bytes)) & " clocks a byte";
      check(integer(rate_hz) >= rate_hz_least, way & " at " & integer'image(integer(rate_hz)) & " bytes a second");
    end procedure;
  begin
    wait for 10 * clock_period;
    check_equal(rd_n & wr_n & siwu_n & data_drive, std_ulogic_vector'("1110"), "pins in reset");
    reset <= '0';
    if synchronous then
      for index in 1 to 30 loop
        wait until rising_edge(clock);
        check_equal(tx_ready & rx_valid, std_ulogic_vector'("00"), "streams without the chip's clock");
      end loop;
    end if;
    running <= true;

    allowed_in <= rate_bytes;
    wait until written = 1;
    start := now;
    wait until written = rate_bytes;
    check_rate(start, "to the PC");

    allowed_out <= rate_bytes;
    wait until received = 1;
    start := now;
    wait until received = rate_bytes;
    check_rate(start, "to the FPGA");

    -- A buffer that fills while bytes follow at full speed.
    deaf        <= true;
    allowed_out <= 2 * rate_bytes;
    wait for pause;
    deaf <= false;
    wait until received = 2 * rate_bytes;

    -- Both directions at once take turns, so neither starves.
    allowed_in  <= 2 * rate_bytes;
    allowed_out <= 3 * rate_bytes;
    wait until written = 2 * rate_bytes - 20 or received = 3 * rate_bytes - 20;
    check(busy_percent > 0 or abs (written + rate_bytes - received) < rate_bytes / 5,
          integer'image(written - rate_bytes) & " bytes to the PC beside "
          & integer'image(received - 2 * rate_bytes) & " to the FPGA");

    stalls      <= stall_percent;
    allowed_in  <= total;
    allowed_out <= total;
    while heard < total or received < total loop
      wait until rising_edge(clock);
    end loop;
    wait for 2 us;
    check_equal(si_pulses, due, "pulses of siwu_n");
    check((due > 0) = (send_immediate /= never), "messages that raise siwu_n");
    check_equal(written, total, "bytes written");

    -- A reset releases the bus at any moment. Without its clock, the synchronous layer does so when the clock comes.
    running <= false;
    wait for 1 us;
    wait until rising_edge(clock);
    pulse(clock, reset);
    wait for 1 us;
    running <= true;
    while tx_ready = '0' loop
      wait until rising_edge(clock);
    end loop;
    wait for 1 us;
    check_equal(rd_n & wr_n & siwu_n & oe_n & data_drive, std_ulogic_vector'("11110"), "pins after a reset");
    check_equal(rx_valid, '0', "nothing came");
    check_equal(written, total, "nothing went");

    report_passed("ft245_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, total * 6 us + total * 100 * clock_period, "ft245_tb");

end architecture;
