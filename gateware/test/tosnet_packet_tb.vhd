-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_packet_out and tosnet_packet_in, symbol by symbol: good and poisoned packets of all lengths, a sender that
-- runs dry, symbols that do not exist, packets that are cut off by the next one, and `go`. What is between the two is
-- compared with a scrambler and a checksum of the bench's own, bit by bit.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;

entity tosnet_packet_tb is
  generic (
    symbol_clocks : positive := 10; -- from one symbol to the next
    packets       : positive := 120;
    check_bytes   : positive := 1;
    exact_start   : boolean  := false;
    longest       : positive := 300;
    seed          : positive := 1
  );
end entity;

architecture test of tosnet_packet_tb is

  -- What happens to a packet: nothing; it is poisoned; no item comes in its middle; a symbol is damaged; the line is
  -- dead from a symbol on until the next packet; it has no byte.
  type kind_t is (good_one, poisoned, dry, damaged, cut_off, empty);

  type plan_t is record
    kind   : kind_t;
    length : natural;  -- bytes
    place  : natural;  -- of the fault: a byte for `dry`, otherwise a symbol
    pause  : natural;  -- clocks before it
    first  : byte_t;
  end record;

  type plans_t is array (natural range <>) of plan_t;

  impure function random_plans return plans_t is
    variable random : random_t;
    variable plans  : plans_t(0 to packets);
  begin
    random.seed(seed);
    for number in plans'range loop
      plans(number).length := random.integer_between(1, 20);
      if random.chance(20) then
        plans(number).length := random.integer_between(1, longest);
      end if;
      plans(number).kind  := kind_t'val(maximum(0, random.integer_between(-4, 5)));
      plans(number).pause := 0;
      if random.chance(50) then
        plans(number).pause := random.integer_between(0, 20 * symbol_clocks);
      end if;
      plans(number).first := random.vector(8);
      case plans(number).kind is
        when dry =>
          plans(number).length := maximum(plans(number).length, 2);
          plans(number).place  := random.integer_between(1, plans(number).length - 1);
        when damaged | cut_off =>
          plans(number).place  := random.integer_between(1, plans(number).length + 1 + check_bytes);
        when empty =>
          plans(number).length := 0;
          plans(number).place  := 0;
        when others =>
          plans(number).place  := 0;
      end case;
      if number = 0 then
        plans(number) := (kind => good_one, length => 9, place => 0, pause => 50, first => x"00");
      elsif number = 1 then
        plans(number) := (kind => good_one, length => longest, place => 0, pause => 0, first => x"55");
      elsif number = packets then
        plans(number).kind := good_one; -- so nothing is cut off at the end
      end if;
    end loop;
    return plans;
  end function;

  constant plans  : plans_t := random_plans;
  constant digits : string  := "123456789";

  -- Byte `index` of a packet.
  function byte_at (number : natural; index : natural) return byte_t is
  begin
    if number = 0 then
      return byte_of(digits(1 + index));
    end if;
    return byte_t(unsigned(plans(number).first) + (index * (2 * number + 1)) mod 256);
  end function;

  -- One step of the scrambler x^8 + x^7 + 1 as it is written down: the two last bits give the first.
  function stepped (register_now : byte_t) return byte_t is
    variable result : byte_t;
  begin
    for number in 0 to 6 loop
      result(number) := register_now(number + 1);
    end loop;
    result(7) := register_now(0) xor register_now(1);
    return result;
  end function;

  subtype sum_t is std_ulogic_vector(8 * check_bytes - 1 downto 0);

  -- Division by x^8 + x^6 + x^5 + x^2 + 1, or by x^16 + x^12 + x^5 + 1, one bit after the other.
  function divided (rest : sum_t; data : byte_t) return sum_t is
    variable result : sum_t := rest;
    variable top    : std_ulogic;
  begin
    if check_bytes = 2 then
      for number in 7 downto 0 loop
        top    := result(result'high) xor data(number);
        result := result(result'high - 1 downto 12) & (result(11) xor top) & result(10 downto 5)
                  & (result(4) xor top) & result(3 downto 0) & top;
      end loop;
      return result;
    end if;
    for number in 7 downto 0 loop
      top    := result(7) xor data(number);
      result := result(6) & (result(5) xor top) & (result(4) xor top) & result(3) & result(2)
                & (result(1) xor top) & result(0) & top;
    end loop;
    return result;
  end function;

  signal clock      : std_ulogic := '0';
  signal reset      : std_ulogic := '1';
  signal done_all   : boolean := false;
  signal go         : std_ulogic := '1';
  signal item_valid : std_ulogic := '0';
  signal item_ready : std_ulogic;
  signal item_data  : std_ulogic_vector(8 downto 0) := (others => '0');
  signal busy       : std_ulogic;
  signal take       : std_ulogic := '0';
  signal cut        : std_ulogic;
  signal data       : byte_t;
  signal control    : std_ulogic;

  signal symbol_valid : std_ulogic := '0';
  signal symbol_data  : byte_t     := x"00";
  signal is_control   : std_ulogic := '0';
  signal wrong        : std_ulogic := '0';
  signal start, valid, done, good : std_ulogic;
  signal data_out : byte_t;

  signal kinds_judged : natural := 0; -- packets that `check_packets` has seen the end of

begin

  clock <= not clock after 10 ns when not done_all;

  sender : entity work.tosnet_packet_out
    generic map (check_bytes => check_bytes, exact_start => exact_start)
    port map (
      clock => clock, reset => reset, go => go, item_valid => item_valid, item_ready => item_ready,
      item_data => item_data, busy => busy, take => take, cut => cut, data => data, control => control);

  receiver : entity work.tosnet_packet_in
    generic map (check_bytes => check_bytes)
    port map (
      clock => clock, reset => reset, symbol_valid => symbol_valid, symbol_data => symbol_data,
      control => is_control, wrong => wrong, start => start, valid => valid, data => data_out, done => done,
      good => good);

  ticks : process is
  begin
    wait_clocks(clock, symbol_clocks - 1);
    take <= '1';
    wait_clocks(clock, 1);
    take <= '0';
  end process;

  items : process is
    variable random : random_t;

    procedure item (word : std_ulogic_vector(8 downto 0)) is
    begin
      item_valid <= '1';
      item_data  <= word;
      wait until rising_edge(clock) and item_ready = '1';
      item_valid <= '0';
      item_data  <= random.vector(9);
    end procedure;

  begin
    random.seed(seed + 100);
    wait until reset = '0';
    for number in plans'range loop
      wait_clocks(clock, plans(number).pause);
      for index in 0 to plans(number).length - 1 loop
        if plans(number).kind = dry and index = plans(number).place then
          wait_clocks(clock, 4 * symbol_clocks);
        end if;
        if index = 0 and number mod 3 = 0 then
          go         <= '0';
          item_valid <= '1';
          item_data  <= '0' & byte_at(number, 0);
          wait_clocks(clock, random.integer_between(2 * symbol_clocks, 5 * symbol_clocks));
          check_equal(busy, '0', "a packet without go");
          go <= '1';
        end if;
        item('0' & byte_at(number, index));
      end loop;
      item("10000000" & to_bit(plans(number).kind = poisoned));
    end loop;
    wait;
  end process;

  -- Between the two: it checks each symbol, and does what is planned with it.
  between : process is
    variable scramble : byte_t  := x"55";
    variable sum      : sum_t;
    variable number   : natural := 0;
    variable place    : natural := 0; -- of the symbol in its packet
    variable idles    : natural := 0;
    variable last     : natural;      -- bytes of the packet that are sent
    variable dead     : boolean := false;
    variable expected : byte_t;
    variable is_bad   : boolean;
    variable at_once  : natural := 0; -- clocks for which a packet could begin
  begin
    wait until rising_edge(clock);
    symbol_valid <= '0';
    if not exact_start or cut = '1' or busy = '1' or idles < 3 or go = '0' or item_valid = '0' then
      at_once := 0;
    else
      at_once := at_once + 1;
    end if;
    check(at_once < 2, "a packet does not begin at once");
    check(cut = '0' or exact_start, "a symbol is cut");
    if reset = '0' and (take = '1' or cut = '1') then
      wrong       <= '0';
      is_control  <= control;
      symbol_data <= data;
      if control = '1' and data = x"3C" then
        scramble := stepped(scramble);
        check(place = 0 or place = last + 2 + check_bytes, "the end of a packet");
        if place > 0 then
          number := number + 1;
        end if;
        place := 0;
        idles := idles + 1;
      elsif control = '1' then
        check_equal(data, x"BC", "the begin of a packet");
        check(idles > 0, "no idle symbol before a packet");
        check(cut = to_bit(exact_start), "a packet begins with a symbol of its own");
        check(cut = '0' or idles > 2, "the idle symbol before a packet may not have been on the line");
        check(number <= packets, "more packets than planned");
        last := plans(number).length;
        if plans(number).kind = dry then
          last := plans(number).place;
        end if;
        place := 1;
        idles := 0;
        dead  := false;
      elsif place = 1 then
        check_equal(data, scramble, "the seed");
        sum      := (others => '0');
        place    := 2;
      else
        expected := data xor scramble;
        scramble := stepped(scramble);
        is_bad   := plans(number).kind = dry or plans(number).kind = poisoned;
        if place < last + 2 then
          check_equal(expected, byte_at(number, place - 2), "a byte on the line");
          sum := divided(sum, expected);
        else
          check_equal(expected xor (7 downto 0 => to_bit(is_bad)), sum(sum'high downto sum'high - 7), "the checksum");
          if number = 0 and place = last + 2 and check_bytes = 1 then
            check_equal(sum, x"DF", "the checksum of 123456789");
          elsif number = 0 and place = last + 2 then
            check_equal(sum, x"31C3", "the checksum of 123456789");
          end if;
          sum := sum_t(shift_left(unsigned(sum), 8));
        end if;
        place := place + 1;
      end if;
      if place > 0 and plans(number).kind = damaged and place - 1 = plans(number).place then
        wrong <= '1';
      end if;
      if place > 0 and plans(number).kind = cut_off and place - 1 = plans(number).place then
        dead := true;
      end if;
      symbol_valid <= '0' when dead else '1';
    end if;
  end process;

  check_packets : process is
    variable number  : integer := -1;
    variable index   : natural := 0;
    variable open_now : boolean := false;
    variable whole   : natural;
  begin
    wait until rising_edge(clock);
    if done = '1' then
      check(open_now, "the end of a packet that did not begin");
      whole := plans(number).length;
      case plans(number).kind is
        when dry              => whole := plans(number).place;
        when damaged | cut_off => whole := maximum(plans(number).place - 2 - check_bytes, 0);
        when others           => null;
      end case;
      check_equal(index, whole, "the number of bytes");
      check_equal(good, to_bit(plans(number).kind = good_one), "is good: " & kind_t'image(plans(number).kind));
      open_now := false;
      kinds_judged <= number + 1;
    end if;
    if start = '1' then
      check(not open_now, "a packet that has no end");
      number   := number + 1;
      index    := 0;
      open_now := true;
    end if;
    if valid = '1' then
      check(open_now, "a byte outside of a packet");
      check(index < plans(number).length, "more bytes than were sent");
      check_equal(data_out, byte_at(number, index), "a byte");
      index := index + 1;
    end if;
  end process;

  play : process is
  begin
    wait_clocks(clock, 5);
    reset <= '0';
    wait until kinds_judged = packets + 1;
    report_passed("tosnet_packet_tb");
    done_all <= true;
    wait;
  end process;

  watchdog(done_all, 1 sec, "tosnet_packet_tb");

end architecture;
