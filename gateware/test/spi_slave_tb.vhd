-- SPDX-License-Identifier: BSD-3-Clause
--
-- spi_slave with a master that clocks at any time: transfers of any length, pauses, transfers that break off within a
-- byte. Every byte arrives once and in order in both directions. No filler comes within a message of the FPGA, and
-- `waiting` is high until all is sent. Then an overrun.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;
  use work.stream_bench_pkg.all;

entity spi_slave_tb is
  generic (
    clock_hz      : positive := 50_000_000;
    sck_hz        : positive := 25_000_000;
    bytes         : positive := 1500; -- from the FPGA
    stall_percent : natural  := 30;
    seed          : positive := 1
  );
end entity;

architecture test of spi_slave_tb is

  constant clock_period : time     := 1 sec / clock_hz;
  constant half_bit     : time     := 0.5 sec / sck_hz;
  constant depth        : positive := 64;

  signal clock    : std_ulogic := '0';
  signal reset    : std_ulogic := '1';
  signal sck      : std_ulogic := '0';
  signal cs_n     : std_ulogic := '1';
  signal mosi     : std_ulogic := '0';
  signal miso, miso_drive, waiting : std_ulogic;
  signal rx_valid, rx_ready        : std_ulogic := '0';
  signal tx_valid, tx_ready        : std_ulogic := '0';
  signal tx_last                   : std_ulogic := '0';
  signal rx_data, tx_data          : std_ulogic_vector(7 downto 0) := x"00";
  signal rx_error                  : receive_error_t;

  signal deaf      : boolean := false;
  signal speaking  : boolean := false; -- the FPGA sends now and then
  signal said      : natural := 0;     -- sent by the FPGA
  signal heard     : natural := 0;     -- received by the PC, without filler
  signal given     : natural := 0;     -- sent by the PC, with filler
  signal received  : natural := 0;     -- received by the FPGA
  signal overruns  : natural := 0;
  signal done      : boolean := false;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.spi_slave
    generic map (rx_depth => depth, tx_depth => depth)
    port map (
      clock => clock, reset => reset,
      sck => sck, cs_n => cs_n, mosi => mosi, miso => miso, miso_drive => miso_drive, waiting => waiting,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error,
      tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last);

  -- Messages of 1 byte to two buffers. No byte is zero.
  speak : process is
    variable data, moments, sizes : random_t;
    variable size, place          : natural := 0;
    variable since_pause          : natural := 0;
  begin
    data.seed(seed + 1);
    moments.seed(seed + 2);
    sizes.seed(seed + 6);
    for index in 0 to bytes - 1 loop
      while not speaking loop
        wait until rising_edge(clock);
      end loop;
      if place = size then
        size  := sizes.integer_between(1, 2 * depth);
        place := 0;
        wait_clocks(clock, moments.integer_between(0, 3000));
      end if;
      pause(clock, moments, stall_percent);
      since_pause := since_pause + 1;
      if since_pause > depth and moments.chance(5) then -- the bus lets the core wait for as long as 20 bytes take
        since_pause := 0;
        wait for 320 * half_bit;
        wait until rising_edge(clock);
      end if;
      place    := place + 1;
      tx_last  <= '1' when place = size or index = bytes - 1 else '0';
      send(clock, tx_valid, tx_ready, tx_data, std_ulogic_vector(to_unsigned(data.integer_between(1, 255), 8)));
      said     <= index + 1;
    end loop;
    wait;
  end process;

  hear : process is
    variable data, moments : random_t;
  begin
    data.seed(seed + 3);
    moments.seed(seed + 4);
    loop
      wait until rising_edge(clock);
      if reset = '0' and rx_valid = '1' and rx_ready = '1' then
        if overruns = 0 then
          check_equal(rx_data, data.vector(8), "byte " & integer'image(received) & " of the PC");
        end if;
        received <= received + 1;
      end if;
      if reset = '0' and rx_error /= no_receive_error then
        check_equal(rx_error, receive_error_t'("100"), "kind of error");
        overruns <= overruns + 1;
      end if;
      rx_ready <= '0' when deaf or moments.chance(stall_percent) else '1';
    end loop;
  end process;

  master : process is

    variable out_data, in_data, moments, sizes : random_t;
    variable expected                          : std_ulogic_vector(7 downto 0);
    variable left                              : natural := 0; -- left of the incoming message
    variable size                              : positive;     -- of a transfer

    -- Clocks so many bits of a byte.
    procedure give_and_take is
      variable give, take : std_ulogic_vector(7 downto 0);
    begin
      give  := out_data.vector(8);
      given <= given + 1;
      spi_exchange(sck, mosi, miso, half_bit, give, take);
      check_equal(miso_drive, '1', "miso_drive");
      if take = x"00" then
        check_equal(left, 0, "bytes of a message behind filler");
      else
        if left = 0 then
          left := sizes.integer_between(1, 2 * depth); -- as in `speak`
        end if;
        left     := left - 1;
        expected := std_ulogic_vector(to_unsigned(in_data.integer_between(1, 255), 8));
        check_equal(take, expected, "byte " & integer'image(heard) & " of the FPGA");
        heard <= heard + 1;
        wait for 0 ns;
        if heard = bytes then
          left := 0;
        end if;
      end if;
    end procedure;

    variable take       : std_ulogic_vector(7 downto 0);
  begin
    out_data.seed(seed + 3);
    in_data.seed(seed + 1);
    moments.seed(seed + 5);
    sizes.seed(seed + 6);
    wait for 10 * clock_period;
    reset <= '0';
    wait for 10 * clock_period;
    check_equal(waiting, '0', "waiting with nothing to say");
    check_equal(miso_drive, '0', "miso_drive without cs_n");
    speaking <= true;

    while said < bytes or waiting = '1' loop
      cs_n <= '0';
      wait for half_bit;
      size := moments.integer_between(1, 40);
      if said = bytes then
        size := 1; -- a short transfer tests `waiting` best
      end if;
      for index in 1 to size loop
        give_and_take;
        if moments.chance(5) then
          wait for moments.integer_between(0, 2000) * 1 ns;
        end if;
      end loop;
      if moments.chance(20) then
        -- The transfer breaks off: this byte is not received.
        spi_exchange(sck, mosi, miso, half_bit, x"A5", take, moments.integer_between(1, 7));
      end if;
      wait for half_bit;
      cs_n <= '1';
      -- Another device may use the bus meanwhile.
      if moments.chance(20) then
        for edge in 1 to 30 loop
          wait for half_bit;
          sck <= not sck;
        end loop;
      end if;
      wait for moments.integer_between(100, 2000) * 1 ns;
    end loop;
    check_equal(said, heard, "bytes the FPGA said");
    while received < given loop
      wait until rising_edge(clock);
    end loop;
    check_equal(overruns, 0, "overruns of good traffic");

    -- An overrun: as many bytes as there is room for, then one error for all lost bytes.
    deaf <= true;
    cs_n <= '0';
    for index in 1 to depth + 8 loop
      give_and_take;
    end loop;
    cs_n <= '1';
    wait for 1 us;
    check_equal(overruns, 0, "overruns before the bytes in front were read");
    deaf <= false;
    wait for 2 * depth * 10 * clock_period;
    check_equal(overruns, 1, "overruns");
    check_equal(received, given - 6, "bytes in front of the overrun");

    report_passed("spi_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, bytes * 5000 * (clock_period + half_bit), "spi_slave_tb");

end architecture;
