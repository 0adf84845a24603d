-- SPDX-License-Identifier: BSD-3-Clause
--
-- The start of a TosNet ring, as each node sees it: who is master, who is there, and which registers they have.
--
--   electing --> counting --> registering --> running          `restart` or an MASTER_DSC packet goes back to electing
--
-- Electing     Every node sends its id now and then. A node passes on the lower one of its own id and one that comes.
--              So only the lowest id comes round, and its node is the master. It says so to all (MASTER_SET).
-- Counting     The master sends a list with itself (NET_DSC). Each node appends its id and takes the length of the list
--              for its address. What comes back goes round again as NET_SET, and all store it.
-- Registering  The same with the mask of each node's enabled registers (REG_DSC, REG_SET).
-- Running      `running` is high, and DATA packets may come. `begins` is high in its first clock.
-- Forwarding   Lists are passed on byte by byte, with the node's own entry at their end. A list that came damaged is
--              passed on poisoned.
-- Ghosts       An id whose node has gone would go round forever. So each node drops every 32nd foreign id.
-- Refused      With a `trouble`, and electing begins again: a list that does not have this node at its address, an id
--              twice, more than `most_nodes`, two masks of a node that differ.
-- Not master   With may_be_master low, a node never becomes master. If it has the lowest id, the ring does not start:
--              `trouble` is no_master.
-- Reset        Electing, after 128 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;
  use work.width_pkg.all;

entity tosnet_start is
  generic (
    may_be_master   : boolean                := true;
    most_nodes      : positive range 2 to 15 := 15;
    election_clocks : positive               := 4800 -- from an own id to the next one; rounded up to a power of two
  );
  port (
    clock     : in std_ulogic;
    reset     : in std_ulogic; -- synchronous
    id        : in std_ulogic_vector(3 downto 0); -- 1 to 15
    registers : in std_ulogic_vector(7 downto 0);
    restart   : in std_ulogic;
    cause     : in trouble_t; -- with restart: why

    -- The packets that come (tosnet_packet_in), and the items to send (tosnet_packet_out).
    start      : in  std_ulogic;
    valid      : in  std_ulogic;
    data       : in  byte_t;
    done       : in  std_ulogic;
    good       : in  std_ulogic;
    item_valid : out std_ulogic;
    item_data  : out item_t;

    running     : out std_ulogic;
    begins      : out std_ulogic;
    restarted   : out std_ulogic; -- high for one clock when electing begins again
    is_master   : out std_ulogic;
    master_id   : out std_ulogic_vector(3 downto 0);
    own_address : out unsigned(3 downto 0) := "0000";
    nodes       : out unsigned(3 downto 0) := "0000";
    members     : out std_ulogic_vector(15 downto 0); -- bit i: the node with id i is in the ring
    trouble     : out trouble_t;                      -- why the ring did not start, or electing began again

    write_entry : out std_ulogic; -- to tosnet_table
    write_mask  : out std_ulogic;
    write_index : out unsigned(3 downto 0);
    write_data  : out byte_t
  );
end entity;

architecture rtl of tosnet_start is

  -- The phase is the kind of the packets that belong to it: bits 6 and 5 of their first byte. The first bit of that
  -- kind is high for lists. Bit 4 tells a list that comes to an end (SET) from one that grows (DSC).
  subtype phase_t is std_ulogic_vector(1 downto 0);

  constant goes        : phase_t := "00";
  constant electing    : phase_t := "01";
  constant counting    : phase_t := "10";
  constant registering : phase_t := "11";

  -- A byte to send: the byte that has come; the node's id; the first byte of the master's list; the node's entry in a
  -- list; the mask of its registers.
  type source_t is (passed, own_id, head, entry, mask);

  constant ghost_limit : positive := 32;
  constant rest_bits   : positive := 8; -- a node rests for 128 clocks after its reset
  constant timer_bits  : positive := maximum(bits_for(election_clocks) + 1, rest_bits);

  -- The bits of a number of nodes that may be.
  constant room : unsigned(3 downto 0) := to_unsigned(2 ** bits_for(most_nodes + 1) - 1, 4);

  signal phase      : phase_t;
  signal rests      : std_ulogic; -- after the reset
  signal master     : std_ulogic;
  signal claimed    : std_ulogic; -- this node has said that it is the master
  signal timer      : unsigned(timer_bits - 1 downto 0); -- since the node spoke by itself
  signal passed_on  : natural range 0 to ghost_limit - 1;

  -- The packet that comes.
  signal first      : std_ulogic; -- the next byte is its first
  signal elects     : std_ulogic; -- it is MASTER_DSC or MASTER_SET
  signal lists      : std_ulogic; -- it is a list, and one of this phase
  signal is_set     : std_ulogic; -- it is SET, not DSC
  signal forwarding : std_ulogic;
  signal count      : unsigned(3 downto 0); -- entries that have come
  signal present    : std_ulogic;           -- this node's entry was among them
  signal second     : std_ulogic;           -- the second mask of a node is next
  signal first_mask : byte_t;
  signal flaw       : trouble_t;            -- of the list; of several flaws, trouble_other_list

  -- What is sent next: up to three bytes, and the end of the packet. The bytes that follow the first are an entry after
  -- the head of NET_DSC, and masks otherwise.
  signal source       : source_t;
  signal begins_list  : std_ulogic;       -- with `passed`: it is the first byte of a list
  signal says_set     : std_ulogic;       -- with `own_id`: MASTER_SET instead of MASTER_DSC
  signal bytes        : natural range 0 to 3;
  signal byte         : byte_t;
  signal ends, poison : std_ulogic;

begin

  assert trouble_other_list = (trouble_too_many or trouble_same_id)
    report "tosnet_start: the codes of the flaws do not fit"
    severity failure;

  running     <= to_bit(phase = goes) and not rests;
  is_master   <= master when may_be_master else '0';
  item_valid  <= to_bit(bytes > 0) or ends;
  item_data   <= '0' & byte when bytes > 0 else item_end(8 downto 1) & poison;
  write_index <= count;
  write_data  <= data; -- it stands still until the next symbol

  bytes_to_send : process (all) is
  begin
    case source is
      when passed =>
        byte <= data;
        if begins_list = '1' and is_master = '1' then
          byte(4) <= '1'; -- DSC has come round, and goes on as SET
        elsif begins_list = '1' and is_set = '0' and phase = counting then
          byte(3 downto 0) <= std_ulogic_vector(unsigned(data(3 downto 0)) + 1);
        end if;
      when own_id =>
        byte <= halves(tosnet_wire_master_discovery_c, id);
        if says_set = '1' and may_be_master then
          byte(4) <= '1';
        end if;
      when head =>
        byte <= halves(tosnet_wire_register_discovery_c, "0000");
        if phase = counting then
          byte <= halves(tosnet_wire_network_discovery_c, "0001");
        end if;
      when entry =>
        byte <= std_ulogic_vector(own_address) & id;
      when mask =>
        byte <= registers;
    end case;
  end process;

  process (clock) is
    variable low    : std_ulogic_vector(3 downto 0);
    variable fits   : std_ulogic; -- a list of this phase begins
    variable passes : std_ulogic; -- and is passed on
    variable joins  : std_ulogic; -- the node `low` is a member
    variable leave  : std_ulogic; -- no node is
    variable again  : std_ulogic; -- electing begins again
    variable why    : trouble_t;

    -- The next event is at least ten clocks away, so all has been sent by then.
    procedure send (what : source_t; number : positive := 1) is
    begin
      source <= what;
      bytes  <= number;
    end procedure;

    procedure send_packet (what : source_t; number : positive := 1) is
    begin
      send(what, number);
      ends   <= '1';
      poison <= '0';
    end procedure;

  begin
    if rising_edge(clock) then
      write_entry <= '0';
      write_mask  <= '0';
      begins      <= '0';
      restarted   <= '0';
      again       := restart;
      why         := cause;
      low         := data(3 downto 0);
      joins       := '0';
      leave       := '0';

      if bytes > 0 then
        bytes  <= bytes - 1;
        source <= entry when source = head and phase = counting else mask;
      else
        ends <= '0';
      end if;

      -- What a node sends by itself.
      timer <= timer + 1;
      if rests = '1' then
        if timer(rest_bits - 1) = '1' then
          rests <= '0';
          timer <= (others => '1');
        end if;
      elsif timer(timer'high) = '1' and phase = electing and first = '1' and item_valid = '0' then
        timer    <= (others => '0');
        says_set <= claimed;
        send_packet(own_id);
      elsif timer(timer'high) = '1' then
        timer <= timer;
      end if;

      if (write_entry or write_mask) = '1' then
        count <= count + 1;
      end if;

      if valid = '1' and first = '1' then
        fits   := not data(7) and data(6) and to_bit(data(6 downto 5) = phase) and not rests;
        passes := fits and not (data(4) and is_master);
        if data(5 downto 4) = "00" and is_master = '0' and unsigned(low) >= most_nodes then
          passes := '0';
        end if;
        first       <= '0';
        elects      <= to_bit(data(7 downto 5) = "001");
        lists       <= fits;
        is_set      <= data(4);
        forwarding  <= passes;
        begins_list <= '1';
        count       <= "0000";
        present     <= '0';
        second      <= '0';
        flaw        <= trouble_none;
        if passes = '1' then
          send(passed);
        end if;
        if fits = '1' and data(5 downto 4) = "00" then
          own_address <= unsigned(low) and room when is_master = '0' else "0000"; -- more are refused below
          if passes = '0' then
            flaw <= trouble_too_many;
          end if;
        elsif fits = '1' and data(5 downto 4) = "01" then
          nodes   <= unsigned(low) and room; -- more are refused below
          leave   := '1';
          if unsigned(low) > most_nodes or low = "0000" then
            flaw <= trouble_too_many;
          end if;
        end if;
      elsif valid = '1' then
        begins_list <= '0';
        if forwarding = '1' then
          send(passed);
        end if;
        if (lists and is_set) = '1' and phase(0) = '0' then
          write_entry <= '1';
          if count = own_address then
            present <= '1';
          end if;
          if unsigned(data(7 downto 4)) /= count or (count = own_address and low /= id) then
            flaw <= flaw or trouble_other_list;
          elsif members(to_integer(unsigned(low))) = '1' then
            flaw <= flaw or trouble_same_id;
          end if;
          joins := '1';
        elsif (lists and is_set) = '1' then
          second     <= not second;
          first_mask <= data;
          write_mask <= second;
          if second = '1' and data /= first_mask then
            flaw <= trouble_masks;
          end if;
        end if;
      end if;

      if done = '1' then
        forwarding  <= '0';
        first       <= '1';
        begins_list <= '0';
        if forwarding = '1' then
          if good = '1' and is_master = '0' and is_set = '0' then
            if phase(0) = '0' then
              send(entry);
            else
              send(mask, 2);
            end if;
          end if;
          ends   <= '1';
          poison <= not good;
        end if;

        if (good and elects and not first and not rests) = '1' then
          if is_set = '0' and phase /= electing then
            again := '1';
            why   := trouble_restart;
          end if;
          if low < id then
            claimed <= '0';
            if is_set = '1' then
              master    <= '0';
              master_id <= low;
              phase     <= counting;
              send_packet(passed);
            else
              passed_on <= (passed_on + 1) mod ghost_limit;
              if passed_on /= ghost_limit - 1 then
                send_packet(passed);
              end if;
            end if;
          elsif is_set = '1' then
            if low /= id then
              again := '1';
              why   := trouble_restart;
            elsif phase = electing and claimed = '1' and may_be_master then
              master      <= '1';
              master_id   <= id;
              own_address <= "0000";
              phase       <= counting;
              send_packet(head, 2);
            end if;
          elsif low /= id or phase /= electing then
            -- After MASTER_SET, the ids that were under way before it end here.
            if claimed = '0' or phase /= electing then
              says_set <= '0';
              send_packet(own_id);
            end if;
          elsif not may_be_master then
            trouble <= trouble_no_master;
          elsif claimed = '0' then
            claimed  <= '1';
            timer    <= (others => '0');
            says_set <= '1';
            send_packet(own_id);
          end if;
        elsif (good and lists and not first) = '1' then
          if flaw /= trouble_none or (is_set = '1' and (count /= nodes or (present or phase(0)) = '0')) then
            again := '1';
            why   := trouble_masks;
            if phase(0) = '0' then
              why := trouble_other_list when flaw = trouble_none else flaw;
            end if;
          elsif is_set = '1' and phase(0) = '0' then
            phase <= registering;
            if is_master = '1' then
              send_packet(head, 3);
            end if;
          elsif is_set = '1' then
            phase   <= goes;
            begins  <= '1';
            trouble <= trouble_none;
          end if;
        end if;
      end if;

      if (again and not rests) = '1' then
        restarted  <= '1';
        lists      <= '0';
        forwarding <= '0';
        claimed    <= '0';
        master     <= '0';
        phase      <= electing;
        timer      <= (others => '0');
        trouble    <= why;
      end if;

      -- What was under way would be a packet without its beginning.
      if restart = '1' then
        bytes <= 0;
        ends  <= '0';
      end if;

      if reset = '1' then
        phase      <= electing;
        rests      <= '1';
        timer      <= (others => '0');
        claimed    <= '0';
        master     <= '0';
        first      <= '1';
        lists      <= '0';
        forwarding <= '0';
        bytes      <= 0;
        ends       <= '0';
        passed_on  <= 0;
        own_address <= "0000";
        master_id  <= "0000";
        nodes      <= "0000";
        leave      := '1';
        trouble    <= trouble_none;
        begins     <= '0';
        restarted  <= '0';
        write_entry <= '0';
        write_mask <= '0';
      end if;
      for number in members'range loop
        members(number) <= (members(number) or (joins and to_bit(unsigned(low) = number))) and not leave;
      end loop;
    end if;
  end process;

end architecture;
