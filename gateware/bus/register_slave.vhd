-- SPDX-License-Identifier: BSD-3-Clause
--
-- Registers on the Wishbone bus. The logic around it gives each address its meaning.
--
--   wishbone --> write_words(a)   the word last written to address a; written(a) is high in its first clock
--   wishbone <-- read_words(a)    the word that a read of address a gives (connect it to write_words(a) to read back);
--                                 was_read(a) is high with its ack
--
-- Generics  writable has one character for each address, address 0 first: "0110" is four words, of which 1 and 2 may be
--           written. '-' is a hole: there is no word at this address, and its ports are not used.
--           snapshot true: a read gives the words of the clock before cyc rose. So all words of a read-many or a
--           publish are of one moment, over all such slaves. A word that is written while cyc is high is live from then
--           on, until cyc falls. So the master reads back what it wrote.
-- Latency   ack or err one clock after strobe: 2 clocks per access.
-- Errors    err for an address that does not exist, for a write to one that is not writable, and for a write that does
--           not select all bytes by sel. A register is written whole or not at all. Such an access changes nothing.
-- Reset     write_words become `initial`, which has one word for each address, or zero where it has none. written stays
--           low.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.register_pkg.all;
  use work.width_pkg.all;
  use work.wishbone_pkg.all;

entity register_slave is
  generic (
    writable   : std_ulogic_vector       := "0110";
    data_width : positive range 8 to 32 := 32;
    snapshot   : boolean                := false;
    initial    : word_vector_t          := no_words
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic; -- synchronous
    wishbone_m2s : in  wishbone_m2s_t;
    wishbone_s2m : out wishbone_s2m_t;

    read_words  : in  word_vector_t(0 to writable'length - 1);
    write_words : out word_vector_t(0 to writable'length - 1);
    written     : out std_ulogic_vector(0 to writable'length - 1);
    was_read    : out std_ulogic_vector(0 to writable'length - 1)
  );
end entity;

architecture rtl of register_slave is

  constant words      : positive := writable'length;
  constant index_bits : positive := bits_for(words);

  -- The initial words, from address 0 on.
  function first_words return word_vector_t is
    variable found : word_vector_t(0 to words - 1) := (others => (others => '0'));
  begin
    if initial'length > 0 then
      found := initial;
    end if;
    return found;
  end function;

  constant first : word_vector_t(0 to words - 1) := first_words;

  -- GHDL 2.0 synthesises a constant of 64, 96, 128 ... bits as zero if its last 32 bits are zero. So there is one more
  -- bit.
  subtype flags_t is std_ulogic_vector(0 to words - 1 + boolean'pos(words mod 32 = 0));

  -- The addresses that have this character in `writable`.
  function having (character : std_ulogic) return flags_t is
    constant characters : std_ulogic_vector(0 to words - 1) := writable;
    variable found      : flags_t := (others => '0');
  begin
    for address in characters'range loop
      if characters(address) = character then
        found(address) := '1';
      end if;
    end loop;
    return found;
  end function;

  constant may_write : flags_t := having('1');
  constant is_hole   : flags_t := having('-');
  constant all_bytes : std_ulogic_vector(bytes_for(data_width) - 1 downto 0) := (others => '1');

  signal seen     : word_vector_t(0 to words - 1); -- the words for reads: live, or of the moment when cyc rose
  signal word     : std_ulogic_vector(data_width - 1 downto 0);
  signal asked    : std_ulogic;
  signal ack, err : std_ulogic;

begin

  asked <= wishbone_m2s.cyc and wishbone_m2s.stb and not ack and not err;

  live : if not snapshot generate
    seen <= read_words;
  end generate;

  frozen : if snapshot generate
    signal thawed : std_ulogic_vector(0 to words - 1) := (others => '0'); -- written since cyc rose
  begin
    process (clock) is
    begin
      if rising_edge(clock) then
        for address in read_words'range loop
          thawed(address) <= wishbone_m2s.cyc and may_write(address) and (thawed(address) or written(address));
          if wishbone_m2s.cyc = '0' or thawed(address) = '1' or written(address) = '1' then
            seen(address) <= read_words(address);
          end if;
        end loop;
      end if;
    end process;
  end generate;

  process (clock) is
    variable index : natural range 0 to words - 1;
    variable known : boolean;
  begin
    if rising_edge(clock) then
      ack      <= '0';
      err      <= '0';
      written  <= (written'range => '0');
      was_read <= (was_read'range => '0');

      index := 0;
      known := unsigned(wishbone_m2s.adr(wishbone_m2s.adr'high downto index_bits)) = 0 and
               unsigned('0' & wishbone_m2s.adr(index_bits - 1 downto 0)) < words; -- a bit that 2**index_bits needs
      if known then
        index := to_integer(unsigned(wishbone_m2s.adr(index_bits - 1 downto 0)));
        known := is_hole(index) = '0';
      end if;

      if asked = '1' then
        word <= seen(index)(data_width - 1 downto 0);
        if not known then
          err <= '1';
        elsif wishbone_m2s.we = '0' then
          ack             <= '1';
          was_read(index) <= '1';
        elsif may_write(index) = '1' and wishbone_m2s.sel(all_bytes'range) = all_bytes then
          ack                                        <= '1';
          write_words(index)(data_width - 1 downto 0) <= wishbone_m2s.dat(data_width - 1 downto 0);
          written(index)                             <= '1';
        else
          err <= '1';
        end if;
      end if;

      if reset = '1' then
        ack         <= '0';
        err         <= '0';
        written     <= (written'range => '0');
        was_read    <= (was_read'range => '0');
        for address in write_words'range loop  -- one word after the other: see flags_t
          write_words(address) <= first(address);
        end loop;
      end if;
    end if;
  end process;

  process (all) is
  begin
    wishbone_s2m                              <= wishbone_s2m_idle;
    wishbone_s2m.dat(data_width - 1 downto 0) <= word;
    wishbone_s2m.ack                          <= ack and wishbone_m2s.cyc and wishbone_m2s.stb;
    wishbone_s2m.err                          <= err and wishbone_m2s.cyc and wishbone_m2s.stb;
  end process;

end architecture;
