-- SPDX-License-Identifier: BSD-3-Clause
--
-- axi_lite_slave: writes and reads at the same time, each channel with random stalls, and a bus that waits, refuses, or
-- never answers. Words, strobes and errors arrive with their own access, and nothing is done twice. Then
-- axi_lite_master in front of it reaches a wishbone_memory.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.axi_lite_pkg.all;
  use work.bench_pkg.all;
  use work.bii_pkg.all;
  use work.wishbone_pkg.all;

entity axi_lite_slave_tb is
  generic (
    stalls         : natural  := 40; -- percent, on each channel
    timeout_clocks : positive := 20;
    accesses       : positive := 400; -- of each kind
    seed           : positive := 1
  );
end entity;

architecture test of axi_lite_slave_tb is

  constant clock_period : time := 20 ns;

  constant refused_c : natural := 16; -- words from here on are refused
  constant silent_c  : natural := 24; -- … and from here on not answered

  signal clock         : std_ulogic := '0';
  signal reset         : std_ulogic := '1';
  signal done          : boolean    := false;
  signal m2s           : axi_lite_m2s_t := axi_lite_m2s_idle;
  signal s2m           : axi_lite_s2m_t;
  signal bus_m2s       : wishbone_m2s_t;
  signal bus_s2m       : wishbone_s2m_t := wishbone_s2m_idle;
  signal aw_sent, w_sent, answered, ar_sent, read : natural := 0; -- transfers on the channels
  signal written, looked_up : natural := 0;                        -- accesses on the bus

  signal bii_request  : bii_request_t := bii_request_idle;
  signal bii_response : bii_response_t;
  signal chain_m2s    : axi_lite_m2s_t;
  signal chain_s2m    : axi_lite_s2m_t;
  signal memory_m2s   : wishbone_m2s_t;
  signal memory_s2m   : wishbone_s2m_t;

  -- What access `number` of a kind is: from its number and its kind alone, so that both ends know it.
  function place (number, kind : natural) return natural is
  begin
    return (number * 7 + kind * 3) mod 32;
  end function;

  function value (number, kind : natural) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned((number * 40503 + kind * 77) mod 2 ** 30, 32));
  end function;

  function wanted (number, kind : natural) return axi_response_t is
  begin
    if place(number, kind) < refused_c then
      return axi_okay_c;
    end if;
    return axi_slave_error_c;
  end function;

  function bytes (number : natural) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned(number mod 16, 4));
  end function;

begin

  clock <= not clock after clock_period / 2 when not done;

  dut : entity work.axi_lite_slave
    generic map (timeout_clocks => timeout_clocks)
    port map (
      clock => clock, reset => reset, axi_lite_m2s => m2s, axi_lite_s2m => s2m,
      wishbone_m2s => bus_m2s, wishbone_s2m => bus_s2m);

  monitor : entity work.wishbone_monitor
    port map (clock => clock, reset => reset, wishbone_m2s => bus_m2s, wishbone_s2m => bus_s2m);

  -- One process for each channel: valid comes after a random pause, and stands until ready.
  write_addresses : process is
    variable random : random_t;
  begin
    random.seed(seed);
    wait until falling_edge(reset);
    for number in 0 to accesses - 1 loop
      pause(clock, random, stalls);
      m2s.awvalid <= '1';
      m2s.awaddr  <= std_ulogic_vector(to_unsigned(4 * place(number, 0) + random.integer_between(0, 3), 32));
      wait until rising_edge(clock) and s2m.awready = '1';
      m2s.awvalid <= '0';
      aw_sent     <= aw_sent + 1;
    end loop;
    wait;
  end process;

  write_words : process is
    variable random : random_t;
  begin
    random.seed(seed + 1);
    wait until falling_edge(reset);
    for number in 0 to accesses - 1 loop
      pause(clock, random, stalls);
      m2s.wvalid <= '1';
      m2s.wdata  <= value(number, 0);
      m2s.wstrb  <= bytes(number);
      wait until rising_edge(clock) and s2m.wready = '1';
      m2s.wvalid <= '0';
      w_sent     <= w_sent + 1;
    end loop;
    wait;
  end process;

  take_answers : process is
    variable random : random_t;
  begin
    random.seed(seed + 2);
    loop
      m2s.bready <= '0' when random.chance(stalls) else '1';
      wait until rising_edge(clock);
      if s2m.bvalid = '1' and m2s.bready = '1' then
        check_equal(s2m.bresp, wanted(answered, 0), "the response to write " & integer'image(answered));
        check(answered < aw_sent and answered < w_sent, "a response to a write that was not sent");
        check_equal(written, answered + 1, "writes on the bus");
        answered <= answered + 1;
      end if;
    end loop;
  end process;

  read_addresses : process is
    variable random : random_t;
  begin
    random.seed(seed + 3);
    wait until falling_edge(reset);
    for number in 0 to accesses - 1 loop
      pause(clock, random, stalls);
      m2s.arvalid <= '1';
      m2s.araddr  <= std_ulogic_vector(to_unsigned(4 * place(number, 1), 32));
      wait until rising_edge(clock) and s2m.arready = '1';
      m2s.arvalid <= '0';
      ar_sent     <= ar_sent + 1;
    end loop;
    wait;
  end process;

  take_words : process is
    variable random : random_t;
  begin
    random.seed(seed + 4);
    loop
      m2s.rready <= '0' when random.chance(stalls) else '1';
      wait until rising_edge(clock);
      if s2m.rvalid = '1' and m2s.rready = '1' then
        check_equal(s2m.rresp, wanted(read, 1), "the response to read " & integer'image(read));
        if wanted(read, 1) = axi_okay_c then
          check_equal(s2m.rdata, value(read, 1), "the word of read " & integer'image(read));
        end if;
        check(read < ar_sent, "a word that nobody asked for");
        check_equal(looked_up, read + 1, "reads on the bus");
        read <= read + 1;
      end if;
    end loop;
  end process;

  -- A slave that waits, refuses, or never answers, by the address.
  serve : process is
    variable random : random_t;
    variable where  : natural;
    variable kind   : natural range 0 to 1;
    variable number : natural;
    variable silent : natural;
  begin
    random.seed(seed + 5);
    loop
      wait until rising_edge(clock) and bus_m2s.stb = '1' and reset = '0';
      check(bus_m2s.cyc = '1', "a strobe without a cycle");
      where  := to_integer(unsigned(bus_m2s.adr));
      kind   := 0 when bus_m2s.we = '1' else 1;
      number := written when bus_m2s.we = '1' else looked_up;
      check_equal(where, place(number, kind), "the address of an access");
      if bus_m2s.we = '1' then
        check_equal(bus_m2s.dat, value(number, 0), "the word of a write");
        check_equal(bus_m2s.sel, bytes(number), "the bytes of a write");
        written <= written + 1;
      else
        check_equal(bus_m2s.sel, std_ulogic_vector'("1111"), "the bytes of a read");
        looked_up <= looked_up + 1;
      end if;
      if where >= silent_c then
        silent := 1;
        loop
          wait until rising_edge(clock);
          exit when bus_m2s.stb = '0';
          silent := silent + 1;
        end loop;
        check_equal(silent, timeout_clocks, "clocks until an access is given up");
      else
        for clocks in 1 to random.integer_between(0, 3) loop
          wait until rising_edge(clock);
        end loop;
        bus_s2m.dat <= value(number, 1);
        bus_s2m.ack <= '1' when where < refused_c else '0';
        bus_s2m.err <= '0' when where < refused_c else '1';
        wait until rising_edge(clock);
        bus_s2m.ack <= '0';
        bus_s2m.err <= '0';
      end if;
    end loop;
  end process;

  -- The project's own master in front of the project's own memory.
  master : entity work.axi_lite_master
    generic map (address_width => 8)
    port map (
      clock => clock, reset => reset, bii_request => bii_request, bii_response => bii_response,
      axi_lite_m2s => chain_m2s, axi_lite_s2m => chain_s2m, hold => open);

  slave : entity work.axi_lite_slave
    port map (
      clock => clock, reset => reset, axi_lite_m2s => chain_m2s, axi_lite_s2m => chain_s2m,
      wishbone_m2s => memory_m2s, wishbone_s2m => memory_s2m);

  memory : entity work.wishbone_memory
    generic map (words => 64)
    port map (clock => clock, reset => reset, wishbone_m2s => memory_m2s, wishbone_s2m => memory_s2m);

  play : process is

    procedure go (write : std_ulogic; address : natural; data : std_ulogic_vector(31 downto 0); clocks : out natural) is
    begin
      bii_request <= (
        valid => '1', write => write, block_hold => '0', data => data,
        address => std_ulogic_vector(to_unsigned(address, 32)));
      clocks := 0;
      loop
        wait until rising_edge(clock);
        clocks := clocks + 1;
        exit when bii_response.done = '1';
      end loop;
      bii_request.valid <= '0';
    end procedure;

    variable clocks : natural;

  begin
    tick(clock, 2);
    reset <= '0';
    for number in 0 to 31 loop
      go('1', number * 3 mod 64, value(number, 5), clocks);
      check(bii_response.status = ok, "a write to the memory");
    end loop;
    for number in 0 to 31 loop
      go('0', number * 3 mod 64, x"00000000", clocks);
      check(bii_response.status = ok, "a read of the memory");
      check_equal(bii_response.data, value(number, 5), "the word of the memory");
      check_equal(clocks, 6, "clocks of a read through both");
    end loop;
    go('0', 64, x"00000000", clocks);
    check(bii_response.status = error, "a word beyond the memory");

    while answered < accesses or read < accesses loop
      wait until rising_edge(clock);
    end loop;
    tick(clock, 10);
    check_equal(written, accesses, "writes in all");
    check_equal(looked_up, accesses, "reads in all");
    report_passed("axi_lite_slave_tb");
    done <= true;
    wait;
  end process;

  watchdog(done, clock_period * accesses * 400, "axi_lite_slave_tb");

end architecture;
