-- SPDX-License-Identifier: BSD-3-Clause
--
-- Components in a node of a TosNet ring: it carries words between the ring and their registers.
--
--   write_words --> tosnet_carrier --> wishbone --> registers of the components, at write_addresses
--   read_words  <--                <--          <-- at read_addresses
--
-- Writing   The first `constants` of write_words are no words of the ring. They are written after a reset and after
--           each change of `running`. The others are written then and after each `exchange`, all in their order.
-- Reading   Without a pause, in blocks: cyc is high from the first to the last word. So a component that keeps one
--           moment in a block gives words of one moment. read_words change together, at the end of a block.
-- Latency   With accesses of 2 clocks, a block of reads takes 2 * reads + 1 clocks. A word is in its register at most
--           2 * (reads + writes) + 1 clocks after its `exchange`, or after the change of `running`.
-- Errors    A register that answers err is passed over. A write to it has no effect, and a read gives zero. One that
--           never answers stops the carrier.
-- Reset     read_words are zero.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.register_pkg.all;
  use work.wishbone_pkg.all;

entity tosnet_carrier is
  generic (
    write_addresses : integer_vector; -- on the bus of the node, one for each word
    read_addresses  : integer_vector;
    constants       : natural := 0
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    running      : in  std_ulogic; -- of tosnet_slave_node
    exchange     : in  std_ulogic; -- write_words are new
    write_words  : in  word_vector_t(0 to write_addresses'length - 1);
    read_words   : out word_vector_t(0 to read_addresses'length - 1);
    wishbone_m2s : out wishbone_m2s_t;
    wishbone_s2m : in  wishbone_s2m_t
  );
end entity;

architecture rtl of tosnet_carrier is

  constant writes    : natural := write_addresses'length;
  constant reads     : natural := read_addresses'length;
  constant words     : natural := writes + reads;
  constant write_map : integer_vector(0 to writes - 1) := write_addresses;
  constant read_map  : integer_vector(0 to reads - 1)  := read_addresses;

  signal place       : natural range 0 to words := writes; -- the word that is carried: writes first
  signal busy        : std_ulogic := '0';                  -- in a block of accesses
  signal begins      : std_ulogic := '1';                  -- all words are to be written
  signal renews      : std_ulogic := '0';                  -- those of the ring are
  signal ran         : std_ulogic := '0';
  signal address     : std_ulogic_vector(31 downto 0) := (others => '0');
  signal word        : word_t := (others => '0');          -- stands still during an access
  signal block_words : word_vector_t(0 to reads - 1) := (others => (others => '0'));
  signal answered    : std_ulogic;

begin

  answered     <= wishbone_s2m.ack or wishbone_s2m.err;
  wishbone_m2s <= (cyc => busy, stb => busy, we => to_bit(place < writes), adr => address, dat => word, sel => "1111");

  process (clock) is
    variable following : natural range 0 to words; -- the next word
    variable goes_on   : std_ulogic;
    variable taken     : word_vector_t(block_words'range);
  begin
    if rising_edge(clock) then
      ran       <= running;
      begins    <= begins or (running xor ran);
      renews    <= renews or exchange;
      following := place;
      goes_on   := '0';

      if busy = '0' then
        -- The next block: what is to be written, or else a look at the registers.
        following := writes;
        if begins = '1' then
          following := 0;
        elsif renews = '1' then
          following := constants;
        end if;
        goes_on := to_bit(following < writes or reads > 0);
        begins  <= running xor ran;
        renews  <= exchange;
      elsif answered = '1' then
        taken := block_words;
        for one in read_map'range loop
          if place = writes + one then
            taken(one) := wishbone_s2m.dat and (31 downto 0 => wishbone_s2m.ack);
          end if;
        end loop;
        block_words <= taken;
        if place = words - 1 then
          read_words <= taken;
        end if;
        if place = writes - 1 or place = words - 1 then
          busy <= '0';
        else
          following := place + 1;
          goes_on   := '1';
        end if;
      end if;

      if goes_on = '1' then
        busy  <= '1';
        place <= following;
        for one in write_map'range loop
          if following = one then
            address <= std_ulogic_vector(to_unsigned(write_map(one), 32));
            word    <= write_words(one);
          end if;
        end loop;
        for one in read_map'range loop
          if following = writes + one then
            address <= std_ulogic_vector(to_unsigned(read_map(one), 32));
          end if;
        end loop;
      end if;

      if reset = '1' then
        place       <= writes;
        busy        <= '0';
        begins      <= '1';
        renews      <= '0';
        ran         <= '0';
        block_words <= (others => (others => '0'));
        read_words  <= (others => (others => '0'));
      end if;
    end if;
  end process;

end architecture;
