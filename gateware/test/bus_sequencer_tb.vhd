-- SPDX-License-Identifier: BSD-3-Clause
--
-- bus_sequencer with a bus that answers late, wrongly or not at all, at random: what it asks for, what becomes of it,
-- and how failures are counted.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.sequencer_pkg.all;
  use work.wishbone_bench_pkg.all;
  use work.wishbone_pkg.all;

entity bus_sequencer_tb is
  generic (
    seed : positive := 1
  );
end entity;

architecture test of bus_sequencer_tb is

  -- A pause of 20 us. A byte that must answer 3C. Then each 40 us a frame: two bytes, the reply to the second is kept;
  -- a value of three bytes, the lowest first; one of two, the highest first.
  constant program : string := "C014C000" & "20553000" & "583C" & "D800" & "C028C800" &
                               "20110422" & "0C000D000E01" & "0D001C01" & "D006";

  signal clock : std_ulogic := '0';
  signal reset : std_ulogic := '1';
  signal done  : boolean := false;
  signal m2s   : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m   : wishbone_s2m_t;
  signal sampled, failed : std_ulogic;
  signal request : bus_request_t;
  signal reply   : bus_reply_t :=
    (done => '0', failed => '0', reason => failure_no_answer, data => x"00");

  type bytes_t is array (0 to 6) of byte_t;
  signal replies : bytes_t := (others => x"00"); -- of the frame that ended
  signal no_answer, wrong, failures : natural := 0;

begin

  clock <= not clock after 50 ns when not done;

  dut : entity work.bus_sequencer
    generic map (clock_hz => 10_000_000, program => program, values => 3, failures_most => 2, data_width => 32)
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m, sampled => sampled, failed => failed,
      request => request, reply => reply);

  watchdog(done, 50 ms, "bus_sequencer_tb");

  bus_side : process is
    variable random : random_t;
    variable number : natural := 0; -- of the byte in its frame
    variable heard  : bytes_t := (others => x"00");
  begin
    random.seed(seed + 7);
    loop
      wait until rising_edge(clock) and request.go = '1' and reset = '0';
      number := 0 when request.first = '1' else number + 1;
      reply.failed <= '0';
      reply.data   <= random.vector(8);
      if request.receive = '1' and request.data = x"3C" then
        reply.data <= x"3C";
        if random.chance(40) then
          reply.data <= x"3D";
          wrong      <= wrong + 1;
        end if;
      elsif random.chance(7) then
        reply.failed <= '1';
        no_answer    <= no_answer + 1;
      end if;
      wait_clocks(clock, random.integer_between(1, 12));
      reply.done <= '1';
      wait_clocks(clock, 1);
      reply.done <= '0';
      heard(number) := reply.data;
      if request.last = '1' then
        replies <= heard;
      end if;
    end loop;
  end process;

  count : process (clock) is
  begin
    if rising_edge(clock) and failed = '1' then
      failures <= failures + 1;
    end if;
  end process;

  play : process is
    variable random   : random_t;
    variable answer   : bus_answer_t;
    variable samples  : natural := 0;
  begin
    random.seed(seed);
    wait_clocks(clock, 4);
    reset <= '0';
    while samples < 200 loop
      if random.chance(10) then -- a reset behind a byte, often of a sample
        wait until rising_edge(clock) and reply.done = '1' and reply.failed = '0' and reply.data /= x"3D" for 1 ms;
        reset <= '1';
        wait_clocks(clock, 1);
        reset <= '0';
      end if;
      wait until rising_edge(clock) and (sampled = '1' or failed = '1') for 1 ms;
      check(sampled = '1' or failed = '1', "a sample or a failure");
      if failed = '1' then
        wait for 1 us;
        check_equal(failures, no_answer + wrong, "failures");
        bus_expect(clock, m2s, s2m, 2, std_ulogic_vector(to_unsigned(failures, 32)));
      else
        samples := samples + 1;
        bus_expect(clock, m2s, s2m, 5, x"000000" & replies(1));
        bus_expect(clock, m2s, s2m, 6, x"00" & replies(4) & replies(3) & replies(2));
        bus_expect(clock, m2s, s2m, 7, x"0000" & replies(5) & replies(6));
        bus_read(clock, m2s, s2m, 1, answer);
        check_equal(answer.word(1 downto 0), std_ulogic_vector'("11"), "valid and set up");
      end if;
    end loop;
    check(no_answer > 10 and wrong > 5, "failures of both kinds");
    report_passed("bus_sequencer_tb");
    done <= true;
    wait;
  end process;

end architecture;
