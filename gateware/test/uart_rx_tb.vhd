-- SPDX-License-Identifier: BSD-3-Clause
--
-- uart_rx with a sender made of wait statements: baud errors up to 3 %, jitter, stalls, every kind of broken frame.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.env.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity uart_rx_tb is
  generic (
    clock_hz : positive := 50_000_000;
    baud_hz  : positive := 3_000_000;
    parity   : parity_t := none;
    bytes    : positive := 60; -- at each baud error
    seed     : positive := 1
  );
end entity;

architecture test of uart_rx_tb is

  constant clock_period : time := 1 sec / clock_hz;

  signal clock      : std_ulogic := '0';
  signal reset      : std_ulogic := '1';
  signal line       : std_ulogic := '1';
  signal line_break : std_ulogic;
  signal rx_valid   : std_ulogic;
  signal rx_ready   : std_ulogic := '0';
  signal rx_data    : std_ulogic_vector(7 downto 0);
  signal rx_error   : receive_error_t;

  signal stall : boolean := false;  -- the reader takes nothing
  signal done  : boolean := false;

  -- The items that the reader must see next, in order. The data are valid if there is no error.
  type item_t is record
    data  : std_ulogic_vector(7 downto 0);
    error : receive_error_t;
  end record;

  type items_t is array (0 to 8191) of item_t;

  type scoreboard_t is protected
    procedure expect (data : std_ulogic_vector; error : receive_error_t);
    procedure take (data : std_ulogic_vector; wrong : receive_error_t);
    impure function waiting return natural;
  end protected;

  type scoreboard_t is protected body
    variable items : items_t;
    variable first : natural := 0;
    variable last  : natural := 0;

    procedure expect (data : std_ulogic_vector; error : receive_error_t) is
    begin
      items(last) := (data, error);
      last        := last + 1;
    end procedure;

    procedure take (data : std_ulogic_vector; wrong : receive_error_t) is
    begin
      if first = last then
        report "an item nobody sent: x" & to_hstring(data) & " error " & to_string(wrong)
          severity error;
      else
        check_equal(wrong, items(first).error, "error of item " & integer'image(first));
        if wrong = no_receive_error then
          check_equal(data, items(first).data, "data of item " & integer'image(first));
        end if;
        first := first + 1;
      end if;
    end procedure;

    impure function waiting return natural is
    begin
      return last - first;
    end function;
  end protected body;

  shared variable scoreboard : scoreboard_t;

  signal breaks : natural := 0;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.uart_rx
    generic map (clock_hz => clock_hz, baud_hz => baud_hz, parity => parity)
    port map (
      clock => clock, reset => reset, line => line, line_break => line_break,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

  reader : process is
    variable random : random_t;
  begin
    random.seed(seed + 100);
    while not done loop
      wait until rising_edge(clock) or done;
      if rx_valid = '1' and rx_ready = '1' then
        scoreboard.take(rx_data, rx_error);
      end if;
      if line_break = '1' then
        breaks <= breaks + 1;
      end if;
      rx_ready <= '1' when not stall and random.chance(40) else '0';
    end loop;
    wait;
  end process;

  sender : process is
    variable random   : random_t;
    variable bit_time : time;
    variable data     : std_ulogic_vector(7 downto 0);
    variable error    : receive_error_t;

    procedure set_speed (fast_percent : real) is
    begin
      bit_time := (1.0e15 / (real(baud_hz) * (1.0 + fast_percent / 100.0))) * 1 fs;
    end procedure;

    -- Sends one frame. Each edge is up to 2 % of a bit off its place. `spikes`: the level is wrong for most of a clock
    -- near the middle of each bit.
    procedure frame (
      value       : std_ulogic_vector(7 downto 0);
      flip_parity : boolean := false;
      no_stop     : boolean := false;
      spikes      : boolean := false
    ) is
      variable bits    : std_ulogic_vector(0 to 10);
      variable count   : positive;
      variable started : time;
      variable check   : std_ulogic;
    begin
      bits := (others => '1');
      bits(0) := '0';
      for index in 0 to 7 loop
        bits(1 + index) := value(index);
      end loop;
      count := 9;
      if parity /= none then
        check := xor value;
        if (parity = odd) /= flip_parity then
          check := not check;
        end if;
        bits(9) := check;
        count   := 10;
      end if;
      bits(count) := '0' when no_stop else '1';
      started := now;
      for index in 0 to count loop
        if index > 0 then
          wait for started + bit_time * index + bit_time * random.integer_between(-20, 20) / 1000 - now;
        end if;
        line <= bits(index);
        if spikes then
          wait for bit_time * random.integer_between(350, 600) / 1000;
          line <= not bits(index);
          wait for clock_period * 95 / 100;
          line <= bits(index);
        end if;
      end loop;
      wait for started + bit_time * (count + 1) - now;
      if no_stop then
        line <= '1';
        wait for bit_time * 2;
      end if;
    end procedure;

    procedure settle is
    begin
      wait for bit_time * 2 + clock_period * 40;
      check_equal(scoreboard.waiting, 0, "items still to come");
    end procedure;

    -- Values that look like good traffic, and values that are sensitive to timing.
    impure function some_byte return std_ulogic_vector is
    begin
      case random.integer_between(0, 7) is
        when 0      => return x"00";
        when 1      => return x"FF";
        when 2      => return x"55";
        when 3      => return x"80";
        when others => return random.vector(8);
      end case;
    end function;

    procedure good (count : positive; gaps : boolean) is
    begin
      for index in 1 to count loop
        data := some_byte;
        scoreboard.expect(data, no_receive_error);
        frame(data);
        if gaps and random.chance(30) then
          wait for bit_time * random.integer_between(0, 3000) / 1000;
        end if;
      end loop;
    end procedure;

  begin
    random.seed(seed);
    set_speed(0.0);
    wait for clock_period * 5 + clock_period / 3;
    reset <= '0';
    wait for bit_time;

    -- All baud errors, back to back and with gaps of any length.
    for step in -4 to 4 loop
      set_speed(3.0 * real(step) / 4.0);
      good(bytes, gaps => false);
      wait for bit_time * 2;
      good(bytes, gaps => true);
      settle;
    end loop;

    -- Broken frames between good ones, at any speed.
    for index in 1 to 60 loop
      set_speed(real(random.integer_between(-30, 30)) / 10.0);
      data  := some_byte;
      error := no_receive_error;
      if random.chance(40) then
        error(framing_error_bit) := '1';
        data(7) := '1'; -- otherwise a zero without stop bit is a break
      end if;
      if parity /= none and random.chance(40) then
        error(parity_error_bit) := '1';
      end if;
      scoreboard.expect(data, error);
      frame(data, flip_parity => error(parity_error_bit) = '1', no_stop => error(framing_error_bit) = '1');
      good(2, gaps => false);
    end loop;
    settle;
    check_equal(breaks, 0, "breaks before the first");

    -- Breaks: each is one framing error and one pulse, for any length.
    set_speed(0.0);
    for index in 1 to 5 loop
      error := no_receive_error;
      error(framing_error_bit) := '1';
      error(parity_error_bit)  := '1' when parity = odd else '0';
      scoreboard.expect(x"00", error);
      line <= '0';
      wait for bit_time * random.integer_between(12, 60);
      line <= '1';
      wait for bit_time;
      good(3, gaps => true);
    end loop;
    settle;
    check_equal(breaks, 5, "breaks");

    -- Spikes shorter than a clock, and start bits that are over by their middle, are ignored.
    for index in 1 to 50 loop
      line <= '0';
      wait for clock_period * random.integer_between(50, 950) / 1000;
      line <= '1';
      wait for clock_period * random.integer_between(4000, 30000) / 1000;
    end loop;
    for index in 1 to 20 loop
      line <= '0';
      wait for bit_time * random.integer_between(100, 330) / 1000;
      line <= '1';
      wait for bit_time * 1.5;
    end loop;
    settle;
    for index in 1 to bytes loop
      data := some_byte;
      scoreboard.expect(data, no_receive_error);
      frame(data, spikes => true);
    end loop;
    settle;

    -- Overrun: the byte that had room, then the error for the lost bytes, then the later bytes.
    for lost in 1 to 3 loop
      stall <= true;
      wait for clock_period * 3;
      good(1, gaps => false);
      for index in 1 to lost loop
        frame(some_byte);
      end loop;
      error := no_receive_error;
      error(overrun_error_bit) := '1';
      scoreboard.expect(x"00", error);
      stall <= false;
      wait for bit_time;
      good(4, gaps => true);
      settle;
    end loop;

    -- A reset within a frame drops all of it. The byte is all ones, so that its rest is not a start bit.
    line <= '0';
    wait for bit_time;
    line <= '1';
    wait for bit_time * 3;
    reset <= '1';
    wait for clock_period * 2;
    reset <= '0';
    wait for bit_time * 8;
    good(bytes, gaps => true);
    settle;

    report_passed("uart_rx_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, (1 sec / baud_hz) * (24 * (18 * bytes + 1500) + 8000), "uart_rx_tb");

end architecture;
