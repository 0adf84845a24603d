-- SPDX-License-Identifier: BSD-3-Clause
--
-- receive_buffer: bytes and errors leave in the order of arrival, each once, under random stalls of both sides;
-- capacity, latency, an error without a reader, reset.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bench_pkg.all;
  use work.physical_pkg.all;

entity receive_buffer_tb is
  generic (
    depth : positive := 4;
    items : positive := 1000;
    seed  : positive := 1
  );
end entity;

architecture test of receive_buffer_tb is

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean    := false;

  signal line_valid : std_ulogic := '0';
  signal line_ready : std_ulogic;
  signal line_data  : std_ulogic_vector(7 downto 0) := x"00";
  signal line_error : receive_error_t := no_receive_error;
  signal rx_valid   : std_ulogic;
  signal rx_ready   : std_ulogic := '0';
  signal rx_data    : std_ulogic_vector(7 downto 0);
  signal rx_error   : receive_error_t;

  signal playing                    : boolean := false; -- random items from here on
  signal come_percent, take_percent : natural := 50;
  signal came, went                 : natural := 0;
  signal bytes, errors              : natural := 0;

  -- Both sides draw the same items: a byte, or sometimes an error instead.
  procedure next_item (variable random : inout random_t; variable error : out receive_error_t;
                       variable data : out std_ulogic_vector(7 downto 0)) is
  begin
    data  := random.vector(8);
    error := no_receive_error;
    if random.chance(30) then
      error := random.vector(3);
    end if;
  end procedure;

begin

  clock <= not clock after 5 ns when not done;

  dut : entity work.receive_buffer
    generic map (rx_depth => depth)
    port map (
      clock => clock, reset => reset,
      line_valid => line_valid, line_ready => line_ready, line_data => line_data, line_error => line_error,
      rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data, rx_error => rx_error);

  play : process is

    variable content, stall : random_t;
    variable error          : receive_error_t;
    variable data           : std_ulogic_vector(7 downto 0);

    procedure give (error : receive_error_t; data : std_ulogic_vector(7 downto 0)) is
    begin
      line_valid <= '1';
      line_error <= error;
      line_data  <= data;
      wait until rising_edge(clock) and line_ready = '1';
      line_valid <= '0';
    end procedure;

  begin
    content.seed(seed);
    stall.seed(seed + 1);
    wait until rising_edge(clock);
    reset <= '0';
    wait until rising_edge(clock);

    -- An error lasts one clock, whether or not a byte can be taken. The byte after it stays.
    give("010", x"11");
    wait until rising_edge(clock);
    check_equal(rx_error, no_receive_error, "no error a clock behind the item");
    give(no_receive_error, x"22");
    check_equal(rx_error, "010", "an error 2 clocks behind its item");
    check_equal(rx_valid, '0', "an error is no byte");
    wait until rising_edge(clock);
    check_equal(rx_error, no_receive_error, "the error is over");
    wait until rising_edge(clock);
    check_equal(rx_valid, '1', "the byte behind the error");
    check_equal(rx_data, x"22", "the byte behind the error");

    -- One item is in the output register, and `depth` more find room. The last one is an error that waits for its
    -- place.
    for index in 1 to depth - 1 loop
      give(no_receive_error, x"33");
    end loop;
    give("100", x"44");
    wait until rising_edge(clock);
    check_equal(line_ready, '0', "full");
    check_equal(rx_error, no_receive_error, "the error waits behind the bytes");

    pulse(clock, reset);
    wait until rising_edge(clock);
    check_equal(rx_valid, '0', "empty after a reset");
    check_equal(line_ready, '1', "room after a reset");

    playing <= true;
    for index in 1 to items loop
      if index mod 50 = 0 then
        come_percent <= stall.integer_between(10, 100);
        take_percent <= stall.integer_between(10, 100);
      end if;
      while not stall.chance(come_percent) loop
        wait until rising_edge(clock);
      end loop;
      next_item(content, error, data);
      give(error, data);
      came <= came + 1;
    end loop;
    wait until went = items;
    check(bytes > items / 2 and errors > items / 8, "bytes and errors came");
    wait until rising_edge(clock);
    check_equal(rx_valid, '0', "nothing is left");
    check_equal(rx_error, no_receive_error, "nothing is left");
    report_passed("receive_buffer_tb");
    done <= true;
    wait;
  end process;

  judge : process (clock) is
    variable content, stall : random_t;
    variable seeded         : boolean := false;
    variable error          : receive_error_t;
    variable data           : std_ulogic_vector(7 downto 0);
  begin
    if rising_edge(clock) and playing then
      if not seeded then
        content.seed(seed);
        stall.seed(seed + 2);
        seeded := true;
      end if;
      if rx_error /= no_receive_error then
        next_item(content, error, data);
        check_equal(rx_error, error, "the error in its place");
        check_equal(rx_valid, '0', "an error is no byte");
        went   <= went + 1;
        errors <= errors + 1;
      elsif rx_valid = '1' and rx_ready = '1' then
        next_item(content, error, data);
        check_equal(no_receive_error, error, "a byte in its place");
        check_equal(rx_data, data, "the byte");
        went  <= went + 1;
        bytes <= bytes + 1;
      end if;
      rx_ready <= '0';
      if stall.chance(take_percent) then
        rx_ready <= '1';
      end if;
    end if;
  end process;

  watchdog(done, items * 1 us, "receive_buffer_tb");

end architecture;
