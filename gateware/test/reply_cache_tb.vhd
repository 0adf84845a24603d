-- SPDX-License-Identifier: BSD-3-Clause
--
-- reply_cache, compared with the page in docs: a full id for each place, and arrays of the answers.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bench_pkg.all;
use work.frame_layout_pkg.no_status;

entity reply_cache_tb is
  generic (
    window : positive := 8;
    seed   : positive := 1;
    steps  : positive := 3000
  );
end entity;

architecture bench of reply_cache_tb is

  signal clock : std_ulogic := '0';
  signal ended : boolean := false;
  signal id    : std_ulogic_vector(15 downto 0) := x"0000";
  signal before, new_id, repeated, order, too_long : std_ulogic := '0';
  signal status, status_in : std_ulogic_vector(3 downto 0) := x"0";
  signal kept         : unsigned(4 downto 0);
  signal forget_index : unsigned(6 downto 0) := (others => '0');
  signal remember, forget, start, keep, recall : std_ulogic := '0';
  signal data_in, data_out : std_ulogic_vector(7 downto 0) := x"00";

begin

  clock <= not clock after 5 ns when not ended;

  cache : entity work.reply_cache
    generic map (window => window)
    port map (
      clock => clock, id => id, before => before, new_id => new_id,
      repeated => repeated, order => order, status => status, kept => kept, too_long => too_long,
      remember => remember, status_in => status_in, forget => forget, forget_index => forget_index, start => start,
      keep => keep, data_in => data_in, recall => recall, data_out => data_out);

  play : process
    type place_t is record
      id     : natural;
      empty  : boolean;
      status : natural;
      length : natural;
    end record;
    type places_t is array (0 to window - 1) of place_t;
    type bytes_t is array (0 to window - 1, 0 to 15) of std_ulogic_vector(7 downto 0);
    variable random   : random_t;
    variable places   : places_t;
    variable bytes    : bytes_t;
    variable next_id, now_id, place, past, distance, length : natural := 0;
    variable executed, recalls, refusals : natural := 0;

  begin
    random.seed(seed);
    tick(clock);
    for index in 0 to window - 1 loop
      places(index) := (id => (65536 + index - window) mod 65536, empty => true, status => 0, length => 0);
      forget_index  <= to_unsigned(index, 7);
      status_in     <= std_ulogic_vector(to_unsigned(no_status, 4));
      pulse(clock, forget);
    end loop;
    next_id := 0;
    for step in 1 to steps loop
      case random.integer_between(0, 9) is
        when 0      => now_id := random.integer_between(0, 65535);
        when 1 to 3 => now_id := (next_id + 65536 - random.integer_between(1, 2 * window)) mod 65536;
        when 4      => now_id := (next_id + random.integer_between(0, window)) mod 65536;
        when others => now_id := next_id;
      end case;
      place    := now_id mod window;
      distance := (now_id + 65536 - places(place).id) mod 65536;
      id <= std_ulogic_vector(to_unsigned(now_id, 16));
      tick(clock, 2);
      check((new_id = '1') = (distance > 0 and distance < 32768), "new id " & integer'image(now_id));
      check((repeated = '1') = (distance = 0 and not places(place).empty), "repeated id " & integer'image(now_id));
      before <= '1';
      tick(clock, 2);
      past     := (now_id + 65535) mod 65536;
      distance := (places(past mod window).id + 65536 - past) mod 65536;
      check((order = '1') = (distance >= 32768), "order before " & integer'image(now_id));
      if order = '1' then
        refusals := refusals + 1;
      end if;
      before <= '0';
      tick(clock, 2);
      if repeated = '1' then
        check_equal(to_integer(unsigned(status)), places(place).status, "status");
        check((too_long = '1') = (places(place).length > 16), "too long");
        if too_long = '0' then
          check_equal(to_integer(kept), places(place).length, "length");
          pulse(clock, start);
          for index in 0 to places(place).length - 1 loop
            tick(clock, 2);
            check_equal(data_out, bytes(place, index), "byte " & integer'image(index));
            pulse(clock, recall);
          end loop;
          recalls := recalls + 1;
        end if;
      elsif new_id = '1' and random.chance(80) then
        pulse(clock, start);
        length := random.integer_between(0, 20);
        if random.chance(5) then
          length := 200;
        end if;
        for index in 0 to length - 1 loop
          data_in <= random.vector(8);
          wait for 1 ns;
          if index < 16 then
            bytes(place, index) := data_in;
          end if;
          pulse(clock, keep);
        end loop;
        places(place) := (id => now_id, empty => false, status => random.integer_between(0, 2), length => length);
        status_in     <= std_ulogic_vector(to_unsigned(places(place).status, 4));
        pulse(clock, remember);
        executed := executed + 1;
        next_id  := (now_id + 1) mod 65536;
      end if;
    end loop;
    check(executed > steps / 10 and recalls > 10 and refusals > 10, "every sort has come");
    report_passed("reply_cache_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, steps * 2 us, "reply_cache_tb");

end architecture;
