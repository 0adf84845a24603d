-- SPDX-License-Identifier: BSD-3-Clause
--
-- tosnet_exchange: the bench is the rest of a random ring. It gives DATA packets, which may be damaged, too short, too
-- long or foreign, and checks each byte that the node passes on or sends, the words that it takes, and the messages.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bench_pkg.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_ring_pkg.all;

entity tosnet_exchange_tb is
  generic (
    master        : boolean  := false;
    may_be_master : boolean  := true;
    rings         : positive := 12;
    symbol_clocks : positive := 10;
    word_clocks   : positive range 1 to 2 := 1; -- from send_address to send_word
    tells         : boolean  := true; -- from which spec the node was built
    seed          : positive := 1
  );
end entity;

architecture test of tosnet_exchange_tb is

  constant spec_word : std_ulogic_vector(31 downto 0) := x"89ABCDEF" and (31 downto 0 => to_bit(tells));

  type fields_t is array (0 to 15) of std_ulogic_vector(7 downto 0);
  type bytes_t is array (0 to 4200) of byte_t;
  type addresses_t is array (0 to 4200) of integer;
  type counts_t is array (0 to 6) of natural;
  type fault_t is (no_fault, damaged, short, long, foreign_slot, other_command);

  signal clock, send, running : std_ulogic := '0';
  signal reset       : std_ulogic := '1';
  signal ended       : boolean := false;
  signal id, master_id, send_id, take_id, kept_id : std_ulogic_vector(3 downto 0) := x"1";
  signal own_address, nodes, take_count, kept_count, send_count : unsigned(3 downto 0) := "0000";
  signal members     : std_ulogic_vector(15 downto 0) := (others => '0');
  signal start, valid, done, good : std_ulogic := '0';
  signal data        : byte_t := x"00";
  signal item_valid  : std_ulogic;
  signal item_ready  : std_ulogic := '1';
  signal item_data   : item_t;
  signal in_index, out_index : unsigned(3 downto 0);
  signal in_entry, in_mask, out_entry, out_mask : std_ulogic_vector(7 downto 0) := x"00";
  signal received_valid : std_ulogic;
  signal received_address, send_address      : std_ulogic_vector(9 downto 0);
  signal received_word, send_word, late_word : std_ulogic_vector(31 downto 0);
  signal sent, packet_done, fresh, broken, foreign : std_ulogic;
  signal send_waiting : std_ulogic := '0';
  signal send_begin, send_step, take_valid, take_keep : std_ulogic;
  signal take_data, send_data : byte_t := x"00";

  signal entries, masks : fields_t := (others => x"00");
  signal cycle       : natural := 0; -- the words to send change with it
  signal items       : bytes_t;
  signal last_item   : item_t;       -- the end of a packet
  signal steps       : natural := 0;
  signal forget      : boolean := false; -- sets these to zero
  signal item_count, begun, keeps, dones, brokens, foreigns, ends : natural := 0;
  signal was_fresh   : std_ulogic;
  signal taken       : std_ulogic_vector(95 downto 0);

  function word_at (address : natural; turn : natural) return std_ulogic_vector is
  begin
    return std_ulogic_vector(to_unsigned(address * 4001 + turn * 1234567 + address * address, 32));
  end function;

begin

  clock <= not clock after 10 ns when not ended;

  dut : entity work.tosnet_exchange
    generic map (may_be_master => may_be_master, spec_word => spec_word)
    port map (
      clock => clock, reset => reset, id => id, running => running, is_master => to_bit(master),
      master_id => master_id, own_address => own_address, nodes => nodes, members => members, start => start,
      valid => valid, data => data, done => done, good => good, item_valid => item_valid,
      item_ready => item_ready, item_data => item_data, in_index => in_index, in_entry => in_entry,
      in_mask => in_mask, out_index => out_index, out_entry => out_entry, out_mask => out_mask,
      received_valid => received_valid, received_address => received_address, received_word => received_word,
      send_address => send_address, send_word => send_word, send => send, sent => sent,
      packet_done => packet_done, fresh => fresh, broken => broken, foreign => foreign, told => open, told_id => open,
      told_word => open, send_waiting => send_waiting, send_id => send_id, send_begin => send_begin,
      send_step => send_step, send_data => send_data, send_count => send_count, take_valid => take_valid,
      take_data => take_data, take_keep => take_keep, take_count => take_count, take_id => take_id);

  around : process is
  begin
    wait until rising_edge(clock) and reset = '0';
    in_entry  <= entries(to_integer(in_index));
    in_mask   <= masks(to_integer(in_index));
    out_entry <= entries(to_integer(out_index));
    out_mask  <= masks(to_integer(out_index));
    late_word <= word_at(to_integer(unsigned(send_address)), cycle);
    send_word <= word_at(to_integer(unsigned(send_address)), cycle) when word_clocks = 1 else late_word;
    if item_valid = '1' and item_ready = '1' then
      if item_data(8) = '1' then
        last_item <= item_data;
        ends      <= ends + 1;
      else
        items(item_count) <= item_data(7 downto 0);
        item_count        <= item_count + 1;
      end if;
    end if;
    if send_begin = '1' then
      begun     <= begun + 1;
      steps     <= 0;
      send_data <= x"40";
    elsif send_step = '1' then
      steps     <= steps + 1;
      send_data <= std_ulogic_vector(to_unsigned(16#41# + steps, 8));
    end if;
    taken      <= taken(87 downto 0) & take_data when take_valid = '1';
    keeps      <= keeps + 1 when take_keep = '1';
    kept_count <= take_count when take_keep = '1';
    kept_id    <= take_id when take_keep = '1';
    dones      <= dones + 1 when packet_done = '1';
    was_fresh  <= fresh when packet_done = '1';
    brokens    <= brokens + 1 when broken = '1';
    foreigns   <= foreigns + 1 when foreign = '1';
    if forget then
      (item_count, begun, keeps, dones, brokens, foreigns, ends) <= counts_t'(others => 0);
    end if;
    item_ready <= to_bit(not master or now / 20 ns mod symbol_clocks = 3);
  end process;

  play : process is

    variable random   : random_t;
    variable count    : positive;            -- nodes
    variable own      : natural;             -- the node's place
    variable packet   : bytes_t;             -- as it comes
    variable expected : bytes_t;             -- as the node sends it
    variable length   : natural;
    variable words    : addresses_t;         -- of the word that byte i completes, or -1 if the node does not take it
    variable slot     : natural;             -- where it begins
    variable missing  : std_ulogic_vector(15 downto 0); -- members that were not asked in this ring
    variable untold   : natural;             -- answers of the slave since it has told spec_word
    variable asked    : natural;             -- by the master

    procedure put (came : byte_t; goes : byte_t; word : integer := -1) is
    begin
      packet(length)   := came;
      expected(length) := goes;
      words(length)    := word;
      length := length + 1;
    end procedure;

    procedure new_ring is
      variable all_ids : std_ulogic_vector(15 downto 0) := x"0001";
      variable one     : natural;
    begin
      count := random.integer_between(2, 15);
      own   := 0;
      if not master then
        own := random.integer_between(1, count - 1);
      end if;
      for place in 0 to count - 1 loop
        loop
          one := random.integer_between(1, 15);
          exit when all_ids(one) = '0';
        end loop;
        all_ids(one)   := '1';
        entries(place) <= std_ulogic_vector(to_unsigned(place, 4)) & std_ulogic_vector(to_unsigned(one, 4));
        masks(place)   <= random.vector(8) and random.vector(8) and random.vector(8);
        if place = own then
          id <= std_ulogic_vector(to_unsigned(one, 4));
          masks(place)(random.integer_between(0, 7)) <= '1';
        end if;
        if place = 0 then
          master_id <= std_ulogic_vector(to_unsigned(one, 4));
        end if;
      end loop;
      all_ids(0)  := '0';
      members     <= all_ids;
      missing     := all_ids;
      nodes       <= to_unsigned(count, 4);
      own_address <= to_unsigned(own, 4);
      untold      := 0;
      running     <= '1';
      tick(clock, 20); -- the master looks for the first one to ask
      missing(to_integer(unsigned(id))) := '0';
    end procedure;

    -- A packet of this ring up to its slot, as it comes to the node and as it leaves it.
    procedure make is
      variable where : natural;
      variable byte  : byte_t;
      variable mine  : std_ulogic_vector(31 downto 0);
      variable word  : integer; -- the address of a word that the node takes
    begin
      length := 0;
      put(x"A0", x"A0");
      for node in 0 to count - 1 loop
        for section in 0 to 1 loop
          for number in 7 downto 0 loop
            for place in 0 to 15 loop
              next when masks(node)(number) = '0';
              byte  := random.vector(8);
              where := to_integer(unsigned(entries(node)(3 downto 0))) * 64 + number * 8 + section * 4 + place / 4;
              word  := -1;
              mine  := word_at(where, cycle);
              if master then
                if node /= own and section = 1 then
                  word := where - 4;
                elsif node = own and section = 1 then
                  mine := x"00000000";
                end if;
              else
                if (node = own) = (section = 1) then
                  word := where;
                end if;
                mine := byte & byte & byte & byte;
                if node = own and section = 1 then
                  mine := word_at(where - 4, cycle);
                end if;
              end if;
              if place mod 4 /= 3 then
                word := -1;
              end if;
              put(byte, mine(8 * (place mod 4) + 7 downto 8 * (place mod 4)), word);
            end loop;
          end loop;
        end loop;
      end loop;
      slot := length;
    end procedure;

    -- The slot at a slave: a message from the master to `who`, or nothing for it. Is it one for this node?
    procedure make_slot (kind : natural; who : natural; bytes : natural) is
      constant low     : std_ulogic_vector(3 downto 0) := std_ulogic_vector(to_unsigned(who, 4));
      constant answers : boolean := not master and low = id and (kind = 9 or kind = 1);
      constant turn    : boolean := tells and kind = 1 and untold = 0; -- to tell, even with a message
      constant message : boolean := send_waiting = '1' and not turn;
      variable byte    : byte_t;
    begin
      byte := halves(kind, low);
      if not answers then
        put(byte, byte);
      elsif message then
        put(byte, halves(10, id));
      else
        put(byte, halves(2, id));
      end if;
      for index in 0 to 11 loop
        byte := random.vector(8);
        put(byte, byte);
        if answers and message then
          expected(length - 1) := std_ulogic_vector(to_unsigned(16#40# + index, 8));
        elsif answers and tells and kind = 1 and index < 4 then
          expected(length - 1) := spec_word(8 * index + 7 downto 8 * index);
        end if;
      end loop;
      byte := halves(bytes, low);
      put(byte, byte);
      if answers and message then
        expected(length - 1) := std_ulogic_vector(send_count) & id;
      end if;
    end procedure;

    procedure give (gap : positive; is_good : boolean; from_this_ring : boolean := true) is
    begin
      pulse(clock, start);
      tick(clock, 30 + gap);
      for at in 0 to length - 1 loop
        data  <= packet(at);
        valid <= '1';
        wait for 1 ps;
        check_equal(received_valid, to_bit(from_this_ring and at < slot and words(at) >= 0),
                    "a word after byte " & integer'image(at));
        if received_valid = '1' then
          check_equal(to_integer(unsigned(received_address)), words(at), "the address of a word");
          check_equal(received_word, packet(at) & packet(at - 1) & packet(at - 2) & packet(at - 3), "a word");
        end if;
        tick(clock);
        valid <= '0';
        tick(clock, gap - 1);
      end loop;
      done <= '1';
      good <= to_bit(is_good);
      tick(clock);
      done <= '0';
      good <= not good;
      tick(clock, 3);
    end procedure;

    procedure check_items (what : string) is
    begin
      check_equal(item_count, length, "how many bytes are sent: " & what);
      for at in 0 to length - 1 loop
        check_equal(items(at), expected(at), "byte " & integer'image(at) & " that is sent: " & what);
      end loop;
      check_equal(ends, 1, "ends of a packet: " & what);
    end procedure;

    procedure forget_all is
    begin
      forget <= true;
      tick(clock);
      forget <= false;
      tick(clock);
    end procedure;

    -- The master's packet as it leaves.
    procedure master_sends is
      variable waiting : boolean := send_waiting = '1';
    begin
      pulse(clock, send);
      while sent = '0' loop
        tick(clock);
      end loop;
      tick(clock, 2);
      asked := to_integer(unsigned(items(slot)(3 downto 0)));
      if waiting then
        check_equal(asked, to_integer(unsigned(send_id)), "to whom the message is");
        check_equal(begun, 1, "messages that are begun");
        make_slot(9, asked, to_integer(send_count));
      else
        check_equal(members(asked), '1', "a node that is asked is in the ring");
        check_equal(begun, 0, "messages that are begun");
        missing(asked) := '0';
        make_slot(1, asked, 0);
      end if;
      for index in 0 to 11 loop
        expected(slot + 1 + index) := x"00";
        if waiting then
          expected(slot + 1 + index) := std_ulogic_vector(to_unsigned(16#40# + index, 8));
        end if;
      end loop;
      check_items("the master's packet");
      check_equal(last_item, item_end, "the end of the master's packet");
      length := slot;
    end procedure;

    procedure one_packet (fault : fault_t) is
      constant what : string := fault_t'image(fault);
      variable kind, who, bytes : natural;
      variable for_us    : boolean;
      variable whole     : boolean := fault /= short and fault /= long;
      variable stranger  : boolean := false; -- the slot is of another ring
      variable is_fresh  : boolean;
    begin
      forget_all;
      cycle        <= cycle + 1;
      send_waiting <= random.vector(1)(0);
      send_id      <= random.vector(4);
      send_count   <= to_unsigned(random.integer_between(1, 12), 4);
      tick(clock);
      make;
      if master then
        master_sends;
        forget_all;
      end if;

      bytes := random.integer_between(0, 12);
      if random.chance(20) then
        bytes := random.integer_between(13, 15);
      end if;
      if master then
        kind := 10 when random.chance(50) else 2;
        who  := asked;
        if fault = foreign_slot then
          who := (who + 1) mod 16;
        end if;
        for_us := kind = 10;
      else
        kind := 9 when random.chance(50) else 1;
        loop
          who := random.integer_between(0, 15);
          exit when (who = 0 or members(who) = '1') = (fault /= foreign_slot) or members = x"FFFE";
        end loop;
        if random.chance(30) and fault /= foreign_slot then
          who := to_integer(unsigned(id));
        end if;
        for_us := kind = 9 and (who = 0 or who = to_integer(unsigned(id)));
      end if;
      stranger := fault = foreign_slot and (master or (who > 0 and members(who) = '0'));
      is_fresh := fault = no_fault or (fault = foreign_slot and not stranger); -- 15 nodes know all ids
      make_slot(kind, who, bytes);
      if fault = short then
        length := random.integer_between(1, length - 1);
      elsif fault = long then
        put(x"55", x"55");
      elsif fault = other_command then
        packet(0) := halves(random.integer_between(0, 9), random.vector(4));
      end if;
      if who = to_integer(unsigned(id)) and fault /= other_command and length > slot
        and ((tells and kind = 1) or untold > 0) then
        untold := (untold + 1) mod 8;
      end if;
      give(random.integer_between(6, symbol_clocks), fault /= damaged, fault /= other_command);

      if fault = other_command then
        check_equal(item_count + ends + dones + brokens, 0, "what becomes of another packet");
        return;
      end if;
      if not master then
        check_items(what);
        check_equal(last_item, item_end(8 downto 1) & to_bit(not is_fresh), "the end of a packet: " & what);
      else
        check_equal(item_count + ends, 0, "what the master passes on");
      end if;
      check_equal(to_bit(dones = 1), to_bit(whole), "packet_done: " & what);
      check_equal(to_bit(brokens = 1), to_bit(not whole), "broken: " & what);
      check_equal(to_bit(foreigns = 1), to_bit(stranger), "foreign: " & what);
      if whole then
        check_equal(was_fresh, to_bit(is_fresh), "fresh: " & what);
      end if;
      check_equal(to_bit(keeps = 1), to_bit(is_fresh and for_us and bytes <= 12), "a message that is kept: " & what);
      if keeps = 1 then
        check_equal(to_integer(kept_count), bytes, "the bytes of a message");
        for index in 0 to 11 loop
          check_equal(taken(95 - 8 * index downto 88 - 8 * index), packet(slot + 1 + index), "a byte of a message");
        end loop;
        who := who when master else to_integer(unsigned(master_id));
        check_equal(to_integer(unsigned(kept_id)), who, "from whom a message is");
      end if;
    end procedure;

  begin
    random.seed(seed);
    tick(clock, 4);
    reset <= '0';
    for ring in 1 to rings loop
      running <= '0';
      tick(clock, 2);
      new_ring;
      for fault in fault_t loop
        one_packet(fault);
        one_packet(no_fault);
      end loop;
      if master and ring mod 4 = 0 then
        for turn in 1 to 60 loop
          one_packet(no_fault);
        end loop;
        check_equal(missing, x"0000", "nodes that are never asked");
      end if;
    end loop;
    report_passed("tosnet_exchange_tb");
    ended <= true;
    wait;
  end process;

  watchdog(ended, 1 sec, "tosnet_exchange_tb");

end architecture;
