-- SPDX-License-Identifier: BSD-3-Clause
--
-- A TosNet node with a user who knows what must come. Each word that a node gives has its address on top and the
-- time of the strobe below. So a word that stands at a wrong place, a set whose words are of two strobes, and a set
-- that is too old are each noticed where they are received.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.tosnet_bench_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_bench_node is
  generic (
    ring              : ring_t;
    place             : natural;
    clock_period      : time;
    clocks_per_bit    : positive;
    samples_per_clock : positive;
    hop_bits          : positive;
    watchdog_bits     : positive;
    may_be_master     : boolean;
    most_nodes        : positive;
    two_rings         : boolean; -- some nodes may be absent
    check_bytes       : positive;
    exact_hops        : boolean; -- then the first word of the lowest id's first register is that of the clock
    oldest            : time -- a set that is older must not be taken for fresh
  );
  port (
    ended     : in  boolean;
    reset     : in  std_ulogic;
    id        : in  natural range 0 to 15;
    line_in   : in  std_ulogic;
    line_out  : out std_ulogic;
    running   : out std_ulogic;
    is_master : out std_ulogic;
    trouble   : out trouble_t;
    strobe    : out std_ulogic;
    fresh     : out natural; -- strobes of each kind so far
    stale     : out natural;
    restarts  : out natural;
    oldest_set : out time;   -- of all that were taken for fresh
    age        : out time;   -- of the oldest set of the last fresh cycle
    address   : out natural range 0 to 15;
    time_valid : out std_ulogic;
    time_bits  : out unsigned(31 downto 0);

    post_message    : in  std_ulogic;                     -- each change posts a message
    post_words      : in  std_ulogic_vector(95 downto 0); -- its first byte is on top
    post_bytes      : in  natural range 0 to 12;
    post_id         : in  natural range 0 to 15;
    heard_bytes     : out natural;                       -- of all messages that came
    heard_words     : out std_ulogic_vector(31 downto 0); -- their words, by exclusive or
    heard_from      : out natural range 0 to 15           -- the sender of the last one
  );
end entity;

architecture test of tosnet_bench_node is

  constant tick_time : time := 20 ns; -- of the times in the words

  -- The synchroniser of a wire, or the registers of the samples below.
  function clocks_of_input return positive is
  begin
    if samples_per_clock = 1 then
      return 2;
    end if;
    return 1;
  end function;

  constant input_clocks : positive := clocks_of_input;

  function place_of_time return natural is
    variable lowest : natural := 15;
    variable result : natural := 0;
  begin
    for node in ring'range loop
      if ring(node).id < lowest then
        lowest := ring(node).id;
        result := ring(node).id * 64;
        for number in 7 downto 0 loop
          if ring(node).registers(number) = '1' then
            result := ring(node).id * 64 + number * 8;
          end if;
        end loop;
      end if;
    end loop;
    return result;
  end function;

  constant time_address : natural := place_of_time;

  subtype stamp_t is unsigned(21 downto 0);
  type memory_t is array (0 to 1023) of std_ulogic_vector(31 downto 0);
  type flags_t is array (natural range <>) of boolean;

  signal clock         : std_ulogic := '0';
  signal samples       : std_ulogic_vector(samples_per_clock - 1 downto 0);
  signal node_id       : std_ulogic_vector(3 downto 0);
  signal own_address   : unsigned(3 downto 0);
  signal restarted     : std_ulogic;
  signal strobe_fresh  : std_ulogic;
  signal received_valid   : std_ulogic;
  signal received_address : std_ulogic_vector(9 downto 0);
  signal received_word    : std_ulogic_vector(31 downto 0);
  signal send_address     : std_ulogic_vector(9 downto 0);
  signal send_word        : std_ulogic_vector(31 downto 0);
  signal time_word        : std_ulogic_vector(31 downto 0);
  signal to_ring_valid, to_ring_ready : std_ulogic;
  signal to_ring_last     : std_ulogic_vector(1 downto 0);
  signal to_ring_id       : std_ulogic_vector(3 downto 0);
  signal words            : std_ulogic_vector(95 downto 0);
  signal left             : natural range 0 to 12 := 0; -- bytes of the message that are not sent
  signal posted           : std_ulogic := '0';
  signal from_ring_valid  : std_ulogic;
  signal from_ring_data   : std_ulogic_vector(31 downto 0);
  signal from_ring_last   : std_ulogic_vector(1 downto 0);
  signal from_ring_id     : std_ulogic_vector(3 downto 0);

  impure function stamp_now return stamp_t is
  begin
    return to_unsigned((now / tick_time) mod 2 ** stamp_t'length, stamp_t'length);
  end function;

  impure function age_of (stamp : stamp_t) return time is
  begin
    return to_integer(stamp_now - stamp) * tick_time;
  end function;

begin

  clock   <= not clock after clock_period / 2 when not ended;
  node_id <= std_ulogic_vector(to_unsigned(id, 4));
  address <= to_integer(own_address);

  -- What a DDR or SERDES input would give: samples at equal distances, the oldest in bit 0.
  one_sample : if samples_per_clock = 1 generate
    entry : entity work.synchroniser
      port map (clock => clock, asynchronous(0) => line_in, levels => samples);
  end generate;

  many_samples : if samples_per_clock > 1 generate
    process is
      variable taken : std_ulogic_vector(samples_per_clock - 1 downto 0) := (others => '0');
    begin
      wait until rising_edge(clock);
      samples <= taken;
      for sample in 0 to samples_per_clock - 1 loop
        taken(sample) := line_in;
        if sample < samples_per_clock - 1 then
          wait for clock_period / samples_per_clock;
        end if;
      end loop;
    end process;
  end generate;

  dut : entity work.tosnet_node
    generic map (
      clocks_per_bit => clocks_per_bit, samples_per_clock => samples_per_clock, hop_bits => hop_bits,
      watchdog_bits => watchdog_bits, may_be_master => may_be_master,
      most_nodes => most_nodes, check_bytes => check_bytes, exact_hops => exact_hops,
      line_clocks => input_clocks)
    port map (
      clock => clock, reset => reset, line_in => samples, line_out => line_out, id => node_id,
      registers => ring(place).registers, running => running, is_master => is_master, own_address => own_address,
      nodes => open, trouble => trouble, restarted => restarted, damaged => open, strobe => strobe,
      strobe_fresh => strobe_fresh, received_valid => received_valid, received_address => received_address,
      received_word => received_word, send_address => send_address, send_word => send_word,
      told => open, told_id => open, told_word => open, members => open, table_entry => open,
      table_mask => open,
      to_ring_valid => to_ring_valid, to_ring_ready => to_ring_ready, to_ring_data => words(95 downto 64),
      to_ring_last => to_ring_last, to_ring_id => to_ring_id, from_ring_valid => from_ring_valid,
      from_ring_ready => '1', from_ring_data => from_ring_data, from_ring_last => from_ring_last,
      from_ring_id => from_ring_id, message_lost => open);

  shared_time : if exact_hops generate
    clock_of_ring : entity work.tosnet_clock
      generic map (address => time_address, clocks_per_bit => clocks_per_bit)
      port map (
        clock => clock, reset => reset, running => running, is_master => is_master, strobe => strobe,
        strobe_fresh => strobe_fresh, received_valid => received_valid, received_address => received_address,
        received_word => received_word, word => time_word, valid => time_valid, now_bits => time_bits);
  end generate;

  no_shared_time : if not exact_hops generate
    time_valid <= '0';
    time_bits  <= (others => '0');
  end generate;

  to_ring_valid <= to_bit(left > 0);
  to_ring_last  <= std_ulogic_vector(to_unsigned(minimum(left, 4) - 1, 2)) when left > 0 else "00";
  to_ring_id    <= std_ulogic_vector(to_unsigned(post_id, 4));

  post : process (clock) is
  begin
    if rising_edge(clock) then
      if post_message /= posted then
        posted <= post_message;
        words  <= post_words;
        left   <= post_bytes;
      elsif to_ring_valid = '1' and to_ring_ready = '1' then
        words <= words(63 downto 0) & x"00000000";
        left  <= maximum(left, 4) - 4;
      end if;
    end if;
  end process;

  listen : process (clock) is
  begin
    if rising_edge(clock) then
      if from_ring_valid = '1' then
        heard_bytes <= heard_bytes + to_integer(unsigned(from_ring_last)) + 1;
        heard_words <= heard_words xor from_ring_data;
        heard_from  <= to_integer(unsigned(from_ring_id));
      end if;
      if reset = '1' then
        heard_bytes <= 0;
        heard_words <= (others => '0');
      end if;
    end if;
  end process;

  user : process (clock) is
    variable hidden, shown : memory_t := (others => (others => '0'));
    variable came          : flags_t(0 to 1023) := (others => false);
    variable known         : flags_t(0 to 15)   := (others => false); -- nodes whose words came since the start
    variable stamp         : stamp_t   := (others => '0');
    variable ran           : std_ulogic := '0';
    variable first_cycle   : boolean   := true;
    variable where         : natural;
    variable who           : natural;
    variable oldest_now    : time;

    -- One set: a node's words of one direction.
    procedure judge (node : natural; direction : natural; allow_nothing : boolean) is
      variable at          : natural;
      variable first_stamp : stamp_t;
      variable first_word  : boolean := true;
      variable word        : std_ulogic_vector(31 downto 0);
    begin
      if two_rings and node /= place and not came(ring(node).id * 64) then
        return;
      end if;
      for number in 0 to 7 loop
        for lane in 0 to 3 loop
          if ring(node).registers(number) = '1'
            and not (exact_hops and ring(node).id * 64 + number * 8 + direction * 4 + lane = time_address)
          then
            at   := ring(node).id * 64 + number * 8 + direction * 4 + lane;
            word := hidden(at);
            check(came(at), "node " & integer'image(id) & ": word " & integer'image(at) & " did not come");
            if not (allow_nothing and word = x"00000000") then
              check_equal(to_integer(unsigned(word(31 downto 22))), at, "address of a word at " & integer'image(id));
              if first_word then
                first_stamp := unsigned(word(21 downto 0));
                check(age_of(first_stamp) <= oldest, "node " & integer'image(id) & " takes a set of node "
                      & integer'image(ring(node).id) & " for fresh that is old: " & time'image(age_of(first_stamp)));
                oldest_now := maximum(oldest_now, age_of(first_stamp));
                if age_of(first_stamp) > oldest_set then
                  oldest_set <= age_of(first_stamp);
                end if;
                first_word := false;
              end if;
              check(first_stamp = unsigned(word(21 downto 0)), "node " & integer'image(id) & " takes a torn set");
            end if;
          end if;
        end loop;
      end loop;
      known(ring(node).id) := true;
    end procedure;

  begin
    if rising_edge(clock) then
      if received_valid = '1' then
        where := to_integer(unsigned(received_address));
        hidden(where) := received_word;
        came(where)   := true;
      end if;

      if running = '1' and ran = '0' then
        known       := (others => false);
        first_cycle := true;
        stamp       := stamp_now;
      end if;
      ran := running;

      if strobe = '1' then
        if strobe_fresh = '1' then
          oldest_now := 0 ns;
          for node in ring'range loop
            if is_master = '1' and node /= place then
              judge(node, 0, false);
            elsif is_master = '0' then
              if node = place then
                judge(node, 1, false);
              else
                judge(node, 0, first_cycle);
              end if;
            end if;
          end loop;
          shown       := hidden;
          age         <= oldest_now;
          first_cycle := false;
          fresh       <= fresh + 1;
        else
          stale <= stale + 1;
        end if;
        came  := (others => false);
        stamp := stamp_now;
      end if;
      if restarted = '1' then
        restarts <= restarts + 1;
        came     := (others => false);
      end if;

      if reset = '0' then
        who := to_integer(unsigned(send_address(9 downto 6)));
        send_word <= send_address & std_ulogic_vector(stamp);
        if is_master = '1' and who /= id and send_address(2) = '0' then
          send_word <= shown(to_integer(unsigned(send_address)));
          if not known(who) then
            send_word <= (others => '0');
          end if;
        elsif exact_hops and to_integer(unsigned(send_address)) = time_address then
          send_word <= time_word;
        end if;
      end if;
    end if;
  end process;

end architecture;
