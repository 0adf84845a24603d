-- SPDX-License-Identifier: BSD-3-Clause
--
-- Makes the outputs safe when the host has been silent for too long. This works whatever link, bus and applications do.
-- The entity stands in front of the bus, beside the applications. It counts by itself, and its writes go before theirs.
--
--   applications --> asked ----> | dead_man | --> bii
--                <-- answered <- |          | <-- bii
--   framed side <--> request, response        --> tripped
--
-- Ports     request, response: see dead_man_pkg. asked, answered: the bus as the applications see it. bii: the bus.
--           tripped: high from the trip until `arm` or reset, low after power-up. It comes from a flip-flop, so it may
--           switch drivers off. A pin with a pull-up is high before the FPGA is configured, too.
-- Trip      It comes `ticks` ticks of base_hz after the last sign of life. There is a tick every clock_hz / base_hz
--           clocks since reset. From the next clock on, no write of an application begins on the bus. The answer to
--           such a write is `denied`, also if the application had decided on it before the trip. A write that is
--           already on the bus ends first. Then all safe values are written, before anything else.
-- Latency   With n safe values and accesses of at most b clocks, the last value is written within (n + 1) * (b + 1)
--           clocks of the trip. wishbone_master ends an access within 2 * timeout_clocks + 1, its rest included.
--           Without a trip the latency is zero.
-- Hold      A hold of the bus (bii_pkg) ends with the trip. So slaves that wait for the end of a hold take the safe
--           values.
-- Errors    If a slave does not answer a safe value in time, all values are written again at each tick. This ends when
--           all are answered, or with `arm`. A value that a slave refuses is not repeated.
-- Pressure  Accesses of the applications wait while safe values are written.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;
use work.protocol_pkg.all;
use work.width_pkg.all;

entity dead_man is
  generic (
    address_width : positive range 1 to 32 := 8;
    data_width    : positive range 8 to 32 := 32;
    clock_hz      : positive := limits_clock_hz_default_c;
    base_hz       : positive := limits_base_hz_default_c;
    safe_values   : safe_values_t := no_safe_values
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    request      : in  dead_man_request_t;
    response     : out dead_man_response_t;
    tripped      : out std_ulogic;
    asked        : in  bii_request_t;
    answered     : out bii_response_t;
    bii_request  : out bii_request_t;
    bii_response : in  bii_response_t
  );
end entity;

architecture rtl of dead_man is

  constant period : positive := maximum(1, clock_hz / base_hz);
  constant count  : natural  := safe_values'length;

  -- Time.
  signal divider   : natural range 0 to period - 1 := 0;
  signal tick      : std_ulogic;
  signal ticks     : unsigned(31 downto 0) := (others => '0');
  signal silent_ticks : unsigned(31 downto 0) := (others => '0');  -- including the next one
  signal due, trips   : std_ulogic;
  signal running, has_tripped, tripped_now, uncounted : std_ulogic := '0';

  -- Safe writes.
  signal writing   : std_ulogic := '0';  -- safe values are being written
  signal ours      : std_ulogic;         -- the bus is used for safe values
  signal safe      : bii_request_t;
  signal passed    : std_ulogic;         -- the request of the applications is on the bus
  signal passing   : std_ulogic := '0';  -- and has been since the clock before
  signal refuses   : std_ulogic;

begin

  assert base_hz <= clock_hz
    report "dead_man: base_hz is " & integer'image(base_hz) & ", above clock_hz; lower base_hz" severity failure;

  tripped  <= has_tripped;
  response <= (running => running, tripped => has_tripped, tripped_now => tripped_now, uncounted => uncounted);

  tick  <= '1' when divider = period - 1 else '0';
  due   <= '1' when silent_ticks = ticks else '0';
  trips <= running and (request.trip or (tick and due and not request.alive and not request.start));

  watch : process (clock)
  begin
    if rising_edge(clock) then
      if tick = '1' then
        divider      <= 0;
        silent_ticks <= silent_ticks + 1;
      else
        divider <= divider + 1;
      end if;
      if request.alive = '1' or request.start = '1' then
        silent_ticks <= to_unsigned(1, 32);
      end if;
      if request.start = '1' then
        ticks   <= unsigned(request.ticks);
        running <= or request.ticks and not has_tripped;
      end if;
      if request.arm = '1' and tripped_now = '0' then
        has_tripped <= '0';
      end if;
      if request.counted = '1' then
        uncounted <= '0';
      end if;
      if trips = '1' then
        has_tripped <= '1';
        tripped_now <= '1';
        uncounted   <= '1';
      end if;
      if request.renew = '1' then
        tripped_now <= '0';
      end if;
      if trips = '1' or request.renew = '1' then
        running <= '0';
      end if;
      if reset = '1' then
        divider     <= 0;
        running     <= '0';
        has_tripped <= '0';
        tripped_now <= '0';
        uncounted   <= '0';
      end if;
    end if;
  end process;

  with_values : if count > 0 generate

    constant index_bits : positive := bits_for(count + 1);
    constant word_bits  : positive := address_width + data_width;

    subtype word_t is std_ulogic_vector(word_bits - 1 downto 0);
    type words_t is array (0 to 2 ** index_bits - 1) of word_t;

    function words_of (values : safe_values_t) return words_t is
      variable words : words_t := (others => (others => '0'));
    begin
      for number in 0 to values'length - 1 loop
        words(number) := values(values'low + number).address(address_width - 1 downto 0) &
                         values(values'low + number).value(data_width - 1 downto 0);
      end loop;
      return words;
    end function;

    constant words : words_t := words_of(safe_values);

    signal index  : unsigned(index_bits - 1 downto 0) := (others => '0');
    signal found  : std_ulogic := '0';  -- `word` is the one at `index`
    signal word   : word_t;
    signal whole  : std_ulogic;         -- all values are written
    signal ended  : std_ulogic;         -- a safe write ends
    signal missed : std_ulogic := '0';  -- a value had no answer

  begin

    whole <= '1' when index = count else '0';
    ended <= ours and safe.valid and bii_response.done;

    -- A trip during the safe writes starts no new round, because nobody else has used the bus since. Between two
    -- accesses there is one clock without a request (bii_pkg).
    write_values : process (clock)
    begin
      if rising_edge(clock) then
        found <= ours and not ended and not whole;
        if ended = '1' then
          index <= index + 1;
          if bii_response.status = silent then
            missed <= '1';
          end if;
        end if;
        if whole = '1' then
          writing <= '0';
        end if;
        if writing = '0' and (trips = '1' or (tick and missed and has_tripped) = '1') then
          writing <= '1';
          missed  <= '0';
          index   <= (others => '0');
        end if;
        if reset = '1' then
          writing <= '0';
          missed  <= '0';
          found   <= '0';
        end if;
      end if;
    end process;

    -- A few words become logic, and more become block RAM.
    few : if count <= 16 generate
      word <= words(to_integer(index));
    else generate
      look : process (clock)
      begin
        if rising_edge(clock) then
          word <= words(to_integer(index));
        end if;
      end process;
    end generate;

    say : process (all)
    begin
      safe       <= bii_request_idle;
      safe.valid <= found;
      safe.write <= '1';
      safe.address(address_width - 1 downto 0) <= word(word_bits - 1 downto data_width);
      safe.data(data_width - 1 downto 0)       <= word(data_width - 1 downto 0);
    end process;

  else generate
    safe    <= bii_request_idle;
    writing <= '0';
  end generate;

  ours    <= writing and not passing;
  refuses <= asked.valid and asked.write and has_tripped and not passing;
  passed  <= asked.valid and not refuses and not ours;

  go_on : process (clock)
  begin
    if rising_edge(clock) then
      passing <= passed and not bii_response.done and not reset;
    end if;
  end process;

  ask : process (all)
  begin
    bii_request <= asked;
    bii_request.valid <= passed;
    bii_request.block_hold <= asked.block_hold and not writing;
    if ours = '1' then
      bii_request <= safe;
    end if;
  end process;

  answer : process (all)
  begin
    answered      <= bii_response;
    answered.done <= (bii_response.done and not ours) or refuses;
    if refuses = '1' then
      answered.status <= denied;
    end if;
  end process;

end architecture;
