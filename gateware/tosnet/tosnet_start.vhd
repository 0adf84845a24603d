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
-- Reset        Electing, after 100 clocks.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;
  use work.tosnet_ring_pkg.all;
  use work.tosnet_wire_pkg.all;

entity tosnet_start is
  generic (
    may_be_master   : boolean                := true;
    most_nodes      : positive range 2 to 15 := 15;
    election_clocks : positive               := 4800 -- from an id to the next one that a node sends by itself
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

  type phase_t is (resting, electing, counting, registering, goes);

  -- A byte to send: the byte that has come; a command with an id or count; an entry of a list; the mask of registers.
  type source_t is (passed, with_id, with_argument, with_zero, with_count, entry, mask);


  constant ghost_limit : positive := 32;
  constant reset_clocks : positive := 100;

  signal phase      : phase_t;
  signal claimed    : std_ulogic; -- this node has said that it is the master
  signal timer      : natural range 0 to maximum(election_clocks, reset_clocks);
  signal passed_on  : natural range 0 to ghost_limit - 1;

  signal first      : std_ulogic; -- the next byte is the packet's first
  signal command    : natural range 0 to 15;
  signal argument   : std_ulogic_vector(3 downto 0);
  signal index      : unsigned(3 downto 0) := "0000";
  signal count      : unsigned(4 downto 0); -- entries that have come
  signal second     : std_ulogic;           -- the second mask of a node is next
  signal first_mask : byte_t;
  signal forwarding : std_ulogic;
  signal flaw       : trouble_t;            -- of the list that comes

  -- What is sent next: up to three bytes, and the end of the packet. The bytes that follow the first are an entry after
  -- a count, and masks otherwise.
  signal source       : source_t;
  signal high         : natural range 0 to 15; -- the command
  signal bytes        : natural range 0 to 3;
  signal byte         : byte_t;
  signal ends, poison : std_ulogic;

  function command_of (byte : byte_t) return natural is
  begin
    return to_integer(unsigned(byte(7 downto 4)));
  end function;

begin

  running     <= to_bit(phase = goes);
  item_valid  <= to_bit(bytes > 0) or ends;
  item_data   <= '0' & byte when bytes > 0 else item_end(8 downto 1) & poison;
  write_index <= index;

  -- What has come stands still until the next symbol.
  with source select byte <=
    data                                                     when passed,
    halves(high, id)                                         when with_id,
    halves(high, argument)                                   when with_argument,
    halves(high, "0000")                                     when with_zero,
    halves(high, std_ulogic_vector(own_address + 1))         when with_count,
    std_ulogic_vector(own_address) & id                      when entry,
    registers                                                when mask;

  process (clock) is
    variable ids      : std_ulogic_vector(15 downto 0);
    variable again    : boolean;   -- electing begins again
    variable why      : trouble_t;
    variable mark     : natural range 0 to 15;

    -- The next event is at least ten clocks away, so all has been sent by then.
    procedure send (what : source_t; command : natural := 0; count : positive := 1) is
    begin
      source <= what;
      high   <= command;
      bytes  <= count;
    end procedure;

    procedure send_packet (what : source_t; command : natural; count : positive := 1) is
    begin
      send(what, command, count);
      ends   <= '1';
      poison <= '0';
    end procedure;

  begin
    if rising_edge(clock) then
      write_entry <= '0';
      write_mask <= '0';
      begins     <= '0';
      restarted  <= '0';
      ids        := members;
      again      := restart = '1';
      why        := cause;

      if bytes > 0 then
        bytes  <= bytes - 1;
        source <= entry when source = with_count else mask;
      elsif ends = '1' then
        ends <= '0';
      end if;

      -- What a node sends by itself.
      if timer > 0 then
        timer <= timer - 1;
      elsif phase = resting then
        phase <= electing;
      elsif phase = electing and first = '1' and item_valid = '0' then
        timer <= election_clocks;
        if claimed = '1' then
          send_packet(with_id, tosnet_wire_master_set_c);
        else
          send_packet(with_id, tosnet_wire_master_discovery_c);
        end if;
      end if;

      if valid = '1' and first = '1' then
        first    <= '0';
        command  <= command_of(data);
        argument <= data(3 downto 0);
        index    <= "0000";
        count    <= "00000";
        second   <= '0';
        flaw     <= trouble_none;
        case command_of(data) is
          when tosnet_wire_network_discovery_c =>
            if phase = counting and is_master = '1' then
              forwarding <= '1';
              send(with_argument, tosnet_wire_network_set_c);
            elsif phase = counting and unsigned(data(3 downto 0)) < most_nodes then
              forwarding  <= '1';
              own_address <= unsigned(data(3 downto 0));
              send(with_count, tosnet_wire_network_discovery_c);
            elsif phase = counting then
              flaw <= trouble_too_many;
            end if;
          when tosnet_wire_network_set_c =>
            nodes      <= unsigned(data(3 downto 0));
            ids        := (others => '0');
            forwarding <= not is_master and to_bit(phase = counting);
            if is_master = '0' and phase = counting then
              send(passed);
            end if;
            if unsigned(data(3 downto 0)) > most_nodes then
              flaw <= trouble_too_many;
            end if;
          when tosnet_wire_register_discovery_c =>
            forwarding <= to_bit(phase = registering);
            if phase = registering and is_master = '1' then
              send(with_zero, tosnet_wire_register_set_c);
            elsif phase = registering then
              send(passed);
            end if;
          when tosnet_wire_register_set_c =>
            forwarding <= not is_master and to_bit(phase = registering);
            if is_master = '0' and phase = registering then
              send(passed);
            end if;
          when others =>
            null;
        end case;
      elsif valid = '1' then
        if forwarding = '1' then
          send(passed);
        end if;
        write_data <= data;
        mark       := to_integer(unsigned(data(3 downto 0)));
        index      <= count(3 downto 0);
        if command = tosnet_wire_network_set_c and phase = counting then
          write_entry <= '1';
          count    <= count + 1;
          if unsigned(data(7 downto 4)) /= count or (count = own_address and data(3 downto 0) /= id) then
            flaw <= trouble_other_list;
          elsif ids(mark) = '1' then
            flaw <= trouble_same_id;
          end if;
          ids(mark) := '1';
        elsif command = tosnet_wire_register_set_c and phase = registering then
          second     <= not second;
          first_mask <= data;
          if second = '1' then
            write_mask <= '1';
            count      <= count + 1;
            if data /= first_mask then
              flaw <= trouble_masks;
            end if;
          end if;
        end if;
      end if;

      if done = '1' then
        forwarding <= '0';
        first      <= '1';
        if forwarding = '1' then
          if good = '1' and is_master = '0' and command = tosnet_wire_network_discovery_c then
            send(entry);
          elsif good = '1' and is_master = '0' and command = tosnet_wire_register_discovery_c then
            send(mask, count => 2);
          end if;
          ends   <= '1';
          poison <= not good;
        end if;

        if good = '1' and phase /= resting and first = '0' then
          case command is

            when tosnet_wire_master_discovery_c =>
              if phase /= electing then
                again := true;
                why   := trouble_restart;
              end if;
              if argument < id then
                claimed <= '0';
                if passed_on = ghost_limit - 1 then
                  passed_on <= 0;
                else
                  passed_on <= passed_on + 1;
                  send_packet(with_argument, tosnet_wire_master_discovery_c);
                end if;
              elsif argument > id or phase /= electing then
                -- After MASTER_SET, the ids that were under way before it end here.
                if claimed = '0' or phase /= electing then
                  send_packet(with_id, tosnet_wire_master_discovery_c);
                end if;
              elsif not may_be_master then
                trouble <= trouble_no_master;
              elsif claimed = '0' then
                claimed <= '1';
                timer   <= election_clocks;
                send_packet(with_id, tosnet_wire_master_set_c);
              end if;

            when tosnet_wire_master_set_c =>
              if argument < id then
                is_master <= '0';
                master_id <= argument;
                claimed   <= '0';
                phase     <= counting;
                send_packet(with_argument, tosnet_wire_master_set_c);
              elsif argument > id then
                again := true;
                why   := trouble_restart;
              elsif phase = electing and claimed = '1' then
                is_master   <= to_bit(may_be_master);
                master_id   <= id;
                own_address <= "0000";
                phase       <= counting;
                send_packet(with_count, tosnet_wire_network_discovery_c, 2);
              end if;

            when tosnet_wire_network_discovery_c =>
              if flaw /= trouble_none then
                again := true;
                why   := flaw;
              end if;

            when tosnet_wire_network_set_c =>
              if phase = counting then
                if flaw /= trouble_none or count /= nodes or count <= own_address then
                  again := true;
                  why   := trouble_other_list when flaw = trouble_none else flaw;
                else
                  phase <= registering;
                  if is_master = '1' then
                    send_packet(with_zero, tosnet_wire_register_discovery_c, 3);
                  end if;
                end if;
              end if;

            when tosnet_wire_register_set_c =>
              if phase = registering then
                if flaw /= trouble_none or count /= nodes then
                  again := true;
                  why   := trouble_masks;
                else
                  phase   <= goes;
                  begins  <= '1';
                  trouble <= trouble_none;
                end if;
              end if;

            when others =>
              null;
          end case;
        end if;
      end if;


      if again and phase /= resting then
        restarted <= '1';
        claimed   <= '0';
        is_master <= '0';
        phase     <= electing;
        timer     <= election_clocks;
        trouble   <= why;
      end if;
      members <= ids;
      if reset = '1' then
        phase      <= resting;
        timer      <= reset_clocks;
        claimed    <= '0';
        is_master  <= '0';
        first      <= '1';
        forwarding <= '0';
        bytes      <= 0;
        ends       <= '0';
        passed_on  <= 0;
        own_address <= "0000";
        master_id  <= "0000";
        nodes      <= "0000";
        members    <= (others => '0');
        trouble    <= trouble_none;
        begins     <= '0';
        restarted  <= '0';
        write_entry <= '0';
        write_mask <= '0';
      end if;
    end if;
  end process;

end architecture;
