-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the AXI4-Lite slave. The master delays every channel by any number of clocks, and so does the slave on
-- the Wishbone bus, or it never answers.

library ieee;
  use ieee.std_logic_1164.all;
  use work.axi_lite_pkg.all;
  use work.wishbone_pkg.all;

entity axi_lite_slave_formal is
  generic (
    timeout_clocks : positive := 3
  );
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    m2s     : in axi_lite_m2s_t;
    bus_s2m : in wishbone_s2m_t
  );
end entity;

architecture properties of axi_lite_slave_formal is

  signal s2m     : axi_lite_s2m_t;
  signal bus_m2s : wishbone_m2s_t;
  signal begun   : std_ulogic := '0';

  -- What the slave has taken and not yet answered.
  signal address_taken, data_taken, read_taken : std_ulogic := '0';
  signal write_address, read_address           : std_ulogic_vector(31 downto 0) := (others => '0');
  signal data                                  : std_ulogic_vector(31 downto 0) := (others => '0');
  signal strobes                               : std_ulogic_vector(3 downto 0)  := "0000";

  -- The answer of the bus to the access in hand.
  signal answered, refused, writes : std_ulogic := '0';
  signal word                      : std_ulogic_vector(31 downto 0) := (others => '0');
  signal waiting                   : natural range 0 to timeout_clocks := 0;
  signal ends                      : std_ulogic;
  signal write_right, read_right   : boolean; -- the access is the one that was taken
  signal passed                    : std_ulogic := '0'; -- writes that were asked while a read waited

begin

  default clock is rising_edge(clk);

  dut : entity work.axi_lite_slave
    generic map (timeout_clocks => timeout_clocks)
    port map (
      clock => clk, reset => reset, axi_lite_m2s => m2s, axi_lite_s2m => s2m,
      wishbone_m2s => bus_m2s, wishbone_s2m => bus_s2m);

  bus_side : entity work.wishbone_master_view
    port map (clk => clk, reset => reset, m2s => bus_m2s, s2m => bus_s2m);

  ends <= bus_s2m.ack or bus_s2m.err when waiting < timeout_clocks - 1 else '1';

  write_right <= address_taken = '1' and data_taken = '1' and bus_m2s.adr = "00" & write_address(31 downto 2) and
                 bus_m2s.dat = data and bus_m2s.sel = strobes;
  read_right  <= read_taken = '1' and bus_m2s.adr = "00" & read_address(31 downto 2) and bus_m2s.sel = "1111";

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if m2s.awvalid = '1' and s2m.awready = '1' then
        address_taken <= '1';
        write_address <= m2s.awaddr;
      end if;
      if m2s.wvalid = '1' and s2m.wready = '1' then
        data_taken <= '1';
        data       <= m2s.wdata;
        strobes    <= m2s.wstrb;
      end if;
      if m2s.arvalid = '1' and s2m.arready = '1' then
        read_taken   <= '1';
        read_address <= m2s.araddr;
      end if;
      waiting <= 0;
      if bus_m2s.stb = '1' then
        if ends = '1' then
          answered <= '1';
          refused  <= not bus_s2m.ack;
          writes   <= bus_m2s.we;
          word     <= bus_s2m.dat;
        elsif waiting < timeout_clocks then
          waiting <= waiting + 1;
        end if;
      end if;
      if s2m.bvalid = '1' and m2s.bready = '1' then
        address_taken <= '0';
        data_taken    <= '0';
        answered      <= '0';
        passed        <= read_taken;
      end if;
      if s2m.rvalid = '1' and m2s.rready = '1' then
        read_taken <= '0';
        answered   <= '0';
        passed     <= '0';
      end if;
      if reset = '1' then
        address_taken <= '0';
        data_taken    <= '0';
        read_taken    <= '0';
        answered      <= '0';
        waiting       <= 0;
        passed        <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock, with its master.
  reset_first : assume always begun = '1' or reset = '1';

  -- The bus is asked for nothing that was not taken, and once for each.
  asks_what_was_taken : assert always begun = '1' and bus_m2s.stb = '1' -> answered = '0' and
                        (bus_m2s.we = '0' or write_right) and (bus_m2s.we = '1' or read_right);

  -- An access ends at the latest with the timeout.
  always_ends : assert always waiting <= timeout_clocks - 1;

  -- A write is answered only when the bus has done it, and a read likewise; never both at once.
  answers_what_was_done : assert always begun = '1' and (s2m.bvalid = '1' or s2m.rvalid = '1') ->
                          answered = '1' and s2m.bvalid = writes and s2m.rvalid = not writes;

  -- A refusal of the bus, or none of its answers, is an error to the master, and nothing else is.
  errors_are_told : assert always begun = '1' and s2m.bvalid = '1' -> (s2m.bresp = axi_slave_error_c) = (refused = '1');

  -- A read gives the word of the bus, or an error.
  word_is_the_one_read : assert always begun = '1' and s2m.rvalid = '1' ->
                         (s2m.rresp = axi_slave_error_c) = (refused = '1') and (refused = '1' or s2m.rdata = word);

  -- A response to a write stands until it is taken.
  write_answer_stands : assert always s2m.bvalid = '1' and m2s.bready = '0' and reset = '0' and begun = '1' ->
                        next (s2m.bvalid = '1' and s2m.bresp = prev(s2m.bresp));

  -- A word that was read stands until it is taken.
  read_answer_stands : assert always s2m.rvalid = '1' and m2s.rready = '0' and reset = '0' and begun = '1' ->
                       next (s2m.rvalid = '1' and s2m.rresp = prev(s2m.rresp) and s2m.rdata = prev(s2m.rdata));

  -- No second write goes before a read that waits.
  read_has_its_turn : assert always begun = '1' and bus_m2s.stb = '1' and passed = '1' -> bus_m2s.we = '0';

  -- A write and a read that waited are both done.
  both_seen : cover {s2m.rvalid = '1' and address_taken = '1' and data_taken = '1'};

  -- An access times out.
  silent_seen : cover {s2m.bvalid = '1' and refused = '1' and s2m.bresp = axi_slave_error_c};

end architecture;
