-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the Wishbone master. Its slave may answer at once, later, too late, or never. A slave that has taken an
-- access may answer up to twice the timeout later, even if the master has given up the access.

library ieee;
  use ieee.std_logic_1164.all;
  use work.bii_pkg.all;
  use work.wishbone_pkg.all;

entity wishbone_master_formal is
  generic (
    timeout_clocks : positive := 3
  );
  port (
    clk     : in std_ulogic;
    reset   : in std_ulogic;
    request : in bii_request_t;
    s2m     : in wishbone_s2m_t
  );
end entity;

architecture properties of wishbone_master_formal is

  signal response : bii_response_t;
  signal m2s      : wishbone_m2s_t;
  signal begun    : std_ulogic := '0';
  signal answered : std_ulogic;
  signal stb      : std_ulogic;

  -- The slave: clocks for which it may still answer the access that it took. 0 means none.
  signal owed    : natural range 0 to 2 * timeout_clocks := 0;
  signal current : std_ulogic := '0';  -- it is the access of the current request

  signal unanswered : natural range 0 to timeout_clocks := 0;          -- clocks of this access without an answer
  signal waiting    : natural range 0 to 2 * timeout_clocks + 1 := 0;  -- clocks of this request so far

begin

  default clock is rising_edge(clk);

  dut : entity work.wishbone_master
    generic map (address_width => 2, data_width => 8, timeout_clocks => timeout_clocks)
    port map (
      clock => clk, reset => reset, bii_request => request, bii_response => response,
      wishbone_m2s => m2s, wishbone_s2m => s2m);

  bus_side  : entity work.wishbone_master_view
    port map (late_answers => '1', clk => clk, reset => reset, m2s => m2s, s2m => s2m);
  user_side : entity work.bii_bus_view
    port map (clk => clk, reset => reset, request => request, response => response);

  answered <= s2m.ack or s2m.err;
  stb      <= m2s.stb;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';

      if answered = '1' then
        owed <= 0;
      elsif owed = 2 * timeout_clocks then
        owed <= 0;
      elsif owed > 0 then
        owed <= owed + 1;
      elsif stb = '1' then
        owed    <= 1;
        current <= '1';
      end if;
      if response.done = '1' then
        current <= '0';
      end if;

      unanswered <= 0;
      if stb = '1' and answered = '0' and unanswered < timeout_clocks then
        unanswered <= unanswered + 1;
      end if;
      waiting <= 0;
      if request.valid = '1' and response.done = '0' and waiting <= 2 * timeout_clocks then
        waiting <= waiting + 1;
      end if;

      if reset = '1' then
        owed       <= 0;
        current    <= '0';
        unanswered <= 0;
        waiting    <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A slave answers an access that it took once, at most twice the timeout later.
  slave_owes : assume always answered = '0' or stb = '1' or owed > 0;

  -- A request is done after at most two timeouts: its own, and that of the rest before it.
  always_ends : assert always waiting <= 2 * timeout_clocks;

  -- A request ends with `silent` only after all clocks of the timeout passed without an answer.
  silent_in_time : assert always begun = '0' or response.done = '0' or response.status /= silent or
                   unanswered = timeout_clocks;

  -- A late answer is never used for another access.
  late_answer_is_dropped : assert always response.done = '0' or response.status = silent or owed = 0 or current = '1';

  -- The bus is quiet without a request.
  quiet_without_request : assert always stb = '0' or request.valid = '1';

  -- The access on the bus is the requested one.
  asks_what_was_asked : assert always stb = '0' or
                        (m2s.we = request.write and m2s.adr(1 downto 0) = request.address(1 downto 0) and
                         m2s.dat(7 downto 0) = request.data(7 downto 0) and m2s.sel = "0001");

  -- The user gets the word and the status of the answer.
  answer_is_passed_on : assert always response.done = '0' or response.status = silent or
                        (answered = '1' and (response.status = error) = (s2m.err = '1') and
                         response.data(7 downto 0) = s2m.dat(7 downto 0));

  -- A block keeps the bus from its first access on, unless an access times out.
  block_keeps_bus : assert always m2s.cyc = '1' and request.block_hold = '1' and reset = '0' and
                    unanswered < timeout_clocks ->
                    next (request.block_hold = '0' or m2s.cyc = '1' or unanswered = timeout_clocks);

  -- After a timeout the bus is free for at least one clock.
  rests_when_silent : assert always response.done = '1' and response.status = silent and reset = '0' ->
                      next (m2s.cyc = '0');

  -- An access times out.
  silent_seen : cover {response.done = '1' and response.status = silent};

  -- An answer comes too late, while the next request waits.
  late_seen : cover {answered = '1' and stb = '0' and request.valid = '1'};

  -- A read is done in its first clock.
  quick_seen : cover {response.done = '1' and response.status = ok and waiting = 0};

end architecture;
