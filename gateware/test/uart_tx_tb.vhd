-- SPDX-License-Identifier: BSD-3-Clause
--
-- uart_tx: every bit is sampled a quarter and three quarters into its ideal time, and the rate of many frames is
-- measured.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity uart_tx_tb is
  generic (
    clock_hz  : positive              := 50_000_000;
    baud_hz   : positive              := 3_000_000;
    parity    : parity_t              := none;
    stop_bits : positive range 1 to 2 := 1;
    bytes     : positive              := 200;
    seed      : positive              := 1
  );
end entity;

architecture test of uart_tx_tb is

  constant clock_period : time := 1 sec / clock_hz;
  constant bit_time     : time := 1 sec / baud_hz;

  signal clock    : std_ulogic := '0';
  signal reset    : std_ulogic := '1';
  signal line     : std_ulogic;
  signal tx_valid : std_ulogic := '0';
  signal tx_ready : std_ulogic;
  signal tx_data  : std_ulogic_vector(7 downto 0) := x"00";

  signal pauses : boolean := true; -- between frames
  signal sent   : natural := 0;
  signal done   : boolean := false;

  function parity_bits return natural is
  begin
    if parity = none then
      return 0;
    end if;
    return 1;
  end function;

  constant frame_bits : positive := 9 + parity_bits + stop_bits;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.uart_tx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity, stop_bits => stop_bits)
    port map (clock => clock, reset => reset, tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data,
              line => line);

  -- Sender and reader draw the same bytes from the same seed.
  sender : process is
    variable data, moments : random_t;
  begin
    data.seed(seed);
    moments.seed(seed + 1);
    wait_clocks(clock, 5);
    check_equal(line, '1', "line in reset");
    reset <= '0';
    while sent < 2 * bytes loop
      send(clock, tx_valid, tx_ready, tx_data, data.vector(8));
      tx_data  <= x"AA";
      sent     <= sent + 1;
      wait for 0 ns;
      if pauses then
        wait_clocks(clock, moments.integer_between(0, 15 * (clock_hz / baud_hz + 1)));
      end if;
    end loop;
    wait;
  end process;

  reader : process is
    variable data            : random_t;
    variable expected        : std_ulogic_vector(7 downto 0);
    variable check_bit       : std_ulogic;
    variable bits            : std_ulogic_vector(0 to frame_bits - 1);
    variable started, run    : time;
    variable ideal, measured : time;
  begin
    data.seed(seed);
    wait until reset = '0';
    for frame in 1 to 2 * bytes loop
      if line = '1' then
        wait until line = '0';
      end if;
      started := now;
      if frame = bytes + 2 then
        run := now; -- frames follow without a pause from here
      end if;
      pauses <= frame < bytes;

      expected := data.vector(8);
      check_bit := xor expected;
      if parity = odd then
        check_bit := not check_bit;
      end if;
      bits(0) := '0';
      for index in 0 to 7 loop
        bits(1 + index) := expected(index);
      end loop;
      bits(9 to bits'high) := (others => '1');
      if parity /= none then
        bits(9) := check_bit;
      end if;

      for index in bits'range loop
        wait for started + bit_time * (4 * index + 1) / 4 - now;
        check_equal(line, bits(index), "frame " & integer'image(frame) & " bit " & integer'image(index) & " early");
        wait for started + bit_time * (4 * index + 3) / 4 - now;
        check_equal(line, bits(index), "frame " & integer'image(frame) & " bit " & integer'image(index) & " late");
      end loop;
    end loop;

    -- From the start of the first frame to the start of the last: the rate is exact to 0.05 % and the clocks of both
    -- edges.
    measured := started - run;
    ideal    := bit_time * (frame_bits * (bytes - 2));
    check(abs (measured - ideal) < ideal / 2000 + 2 * clock_period,
          "a run of frames took " & time'image(measured) & ", not " & time'image(ideal));

    wait for bit_time * 3;
    check_equal(line, '1', "line at rest");
    report_passed("uart_tx_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, bit_time * (bytes * 80 + 1000), "uart_tx_tb");

end architecture;
