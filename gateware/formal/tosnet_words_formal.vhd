-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of tosnet_words with two rings: a set of words is never torn, whatever comes in which order. In each
-- packet the second word is the inverse of the first one. So words of two packets are seen.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.register_pkg.all;
use work.tosnet_pkg.all;
use work.tosnet_ring_pkg.all;

entity tosnet_words_formal is
  port (
    clk       : in std_ulogic;
    reset     : in std_ulogic;
    running   : in std_ulogic_vector(0 to 1);
    is_master : in std_ulogic;
    sends     : in std_ulogic_vector(0 to 1);
    strobe    : in std_ulogic_vector(0 to 1);
    fresh     : in std_ulogic_vector(0 to 1);
    comes     : in std_ulogic_vector(0 to 1);
    which     : in std_ulogic_vector(0 to 1); -- '1': the second word comes
    next_word : in word_vector_t(0 to 1);     -- of the next packet of each ring
    given     : in word_t                     -- what the user writes
  );
end entity;

architecture properties of tosnet_words_formal is

  constant first_read   : natural := 16#84#;
  constant second_read  : natural := 16#85#; -- with bit 0
  constant first_write  : natural := 16#80#;
  constant apart_clocks : positive := 3;
  constant safe_word    : word_t := x"0000A5A5"; -- of the second word

  signal begun       : std_ulogic := '0';
  signal in_packet   : word_vector_t(0 to 1) := (others => (others => '0'));
  signal from_nodes  : from_node_vector_t(0 to 1);
  signal send_words  : word_vector_t(0 to 1);
  signal read_words  : word_vector_t(0 to 1);
  signal write_words : word_vector_t(0 to 1);
  signal exchange, missing : std_ulogic;
  signal was_words   : word_vector_t(0 to 1);
  signal was_off, was_reset : std_ulogic := '1'; -- no ring ran in the clock before; it was a reset
  signal was_fresh   : std_ulogic := '0';
  signal one_set     : std_ulogic := '0'; -- read_words are those of an exchange
  signal sampled     : std_ulogic := '0'; -- words to send have been sampled
  signal known       : std_ulogic := '0'; -- ... one clock ago
  signal quiet       : natural range 0 to apart_clocks := 0; -- clocks after an exchange

begin

  default clock is rising_edge(clk);

  dut : entity work.tosnet_words
    generic map (
      read_addresses => (first_read, second_read), write_addresses => (first_write, first_write + 1),
      safe_addresses => (0 => second_read), safe_values => (0 => safe_word), rings => 2,
      apart_clocks => apart_clocks)
    port map (
      clock => clk, reset => reset, from_nodes => from_nodes, send_words => send_words, exchange => exchange,
      missing => missing, lacks => open, read_words => read_words, write_words => write_words);

  write_words <= (given, not given);

  rings : for ring in 0 to 1 generate
    signal second : std_ulogic;
  begin
    second   <= which(ring);
    from_nodes(ring).running          <= running(ring);
    from_nodes(ring).is_master        <= is_master;
    from_nodes(ring).sends            <= sends(ring);
    from_nodes(ring).strobe           <= strobe(ring);
    from_nodes(ring).strobe_fresh     <= fresh(ring);
    from_nodes(ring).received_valid   <= comes(ring);
    from_nodes(ring).received_address <= std_ulogic_vector(to_unsigned(first_read, 10) or (9 downto 1 => '0') & second);
    from_nodes(ring).received_word    <= in_packet(ring) xor (31 downto 0 => second);
    from_nodes(ring).send_address     <= std_ulogic_vector(to_unsigned(first_write + ring, 10));
  end generate;

  process (clk) is
  begin
    if rising_edge(clk) then
      begun     <= '1';
      was_words <= read_words;
      was_off   <= not (or running);
      was_reset <= reset;
      was_fresh <= (strobe(0) and fresh(0)) or (strobe(1) and fresh(1));
      for ring in 0 to 1 loop
        if strobe(ring) = '1' then
          in_packet(ring) <= next_word(ring);
        end if;
      end loop;
      if (reset or not (or running)) = '1' then
        one_set <= '0';
      elsif exchange = '1' then
        one_set <= '1';
      end if;
      sampled <= not reset and (sampled or not (or running));
      known   <= sampled and not reset;
      if exchange = '1' then
        quiet <= apart_clocks;
      elsif quiet > 0 then
        quiet <= quiet - 1;
      end if;
      if reset = '1' then
        quiet <= 0;
      end if;
    end if;
  end process;

  -- A proof begins with a reset.
  reset_first : assume always begun = '1' or reset = '1';

  -- After a reset, a node begins its ring anew.
  begins_anew : assume always was_reset = '1' -> running = "00";

  -- Both words are of one packet.
  never_torn : assert always begun = '1' and (exchange = '1' or one_set = '1') and was_off = '0' and was_reset = '0'
               -> read_words(1) = not read_words(0);

  -- They change only in an exchange, or when all rings stop.
  only_exchange : assert always begun = '1' and exchange = '0' and was_off = '0' and was_reset = '0'
                  -> read_words = was_words;

  -- An exchange needs a fresh strobe.
  only_fresh : assert always begun = '1' and exchange = '1' -> was_fresh = '1';

  -- Two strobes of one cycle are one exchange.
  once_a_cycle : assert always begun = '1' and quiet > 0 -> exchange = '0';

  -- A safe value is there from the clock in which no ring runs any more.
  safe : assert always begun = '1' and was_off = '1' -> read_words(1) = safe_word;

  -- What is missing is told: after the start of the ring, nothing is there.
  told : assert always begun = '1' and was_off = '1' -> missing = '1';

  -- What both rings send is of one moment.
  sent_at_once : assert always begun = '1' and known = '1' -> send_words(1) = not send_words(0);

  -- An exchange from each ring, and one behind the other, can happen.
  exchange_of_first  : cover {exchange = '1' and prev(strobe(1)) = '0' and one_set = '0'};
  -- It can be the other one, too.
  exchange_of_second : cover {exchange = '1' and prev(strobe(0)) = '0' and one_set = '1'};
  -- A word that was written is sent.
  sent : cover {known = '1' and send_words(0) = x"12345678"};

end architecture;
