-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the application layer without publishing. Addresses and data have 8 bits, and read-many reads at most
-- two words. z3 sends any requests, one after the other, with any number of data bytes. The bus answers within two
-- clocks, in any way.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bii_pkg.all;
use work.bit_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;

entity application_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    arrives    : in std_ulogic;                    -- a request arrives, if none is waiting
    command    : in command_t;                     -- the command of the request
    error      : in std_ulogic;                    -- the item is a datalink error instead
    checked    : in std_ulogic;
    bytes      : in natural range 0 to 3;          -- number of its data bytes
    data       : in byte_t;                        -- the next data byte
    response   : in bii_response_t;
    word_ready : in std_ulogic
  );
end entity;

architecture properties of application_formal is

  constant steps_most : positive := 21;  -- steps of any request, without those in which datalink or bus make it wait

  signal request  : request_t;
  signal stands   : std_ulogic := '0';
  signal take, rewind, request_done : std_ulogic;
  signal subscription_request       : subscription_request_t;
  signal bii                        : bii_request_t;
  signal word_valid                 : std_ulogic;
  signal word                       : word_t;

  signal begun   : std_ulogic := '0';
  signal left    : natural range 0 to 3 := 0;      -- data bytes not taken yet
  signal opened  : std_ulogic := '0';              -- the command has been taken
  signal had     : natural range 0 to 3 := 0;      -- data bytes of the request
  signal beyond  : std_ulogic := '0';              -- a byte was taken that was missing
  signal waited  : natural range 0 to 2 := 0;      -- clocks of this access so far

  signal said      : std_ulogic;                   -- a word is sent
  signal kind      : std_ulogic_vector(2 downto 0);
  signal talking   : std_ulogic := '0';            -- a reply has begun and is not over
  signal spoken    : natural range 0 to 2 := 0;    -- words of the reply so far; 2 means two or more
  signal refusing  : std_ulogic := '0';            -- the reply has an error mark
  signal accesses  : natural range 0 to 3 := 0;    -- accesses of this request; 3 means three or more
  signal troubled  : std_ulogic := '0';            -- one of the accesses failed
  signal steps     : natural range 0 to steps_most + 1 := 0;

  signal reads, writes, reads_many, tells, known : std_ulogic;  -- kind of the request in hand

begin

  default clock is rising_edge(clk);

  dut : entity work.application
    generic map (address_width => 8, data_width => 8, most_words => 2, rate_bytes => 1, publish_mode => 0)
    port map (
      clock => clk, reset => reset, request => request, take => take, rewind => rewind, request_done => request_done,
      subscription_request => subscription_request, subscription_response => subscription_response_idle,
      bii_request => bii, bii_response => response,
      word_valid => word_valid, word_ready => word_ready, word_data => word);

  bus_side : entity work.bii_user_view port map (clk => clk, reset => reset, request => bii, response => response);

  request.valid <= stands;
  request.ready <= '1';

  said       <= word_valid and word_ready;
  kind       <= word(10 downto 8);
  reads      <= to_bit(unsigned(request.command) = command_read) and not request.error;
  writes     <= to_bit(unsigned(request.command) = command_write) and not request.error;
  reads_many <= to_bit(unsigned(request.command) = command_read_many) and not request.error;
  tells      <= to_bit(unsigned(request.command) = command_read_configuration) and not request.error;
  known      <= reads or writes or reads_many or tells;

  -- Requests as request_buffer passes them on.
  requests : process (clk) is
  begin
    if rising_edge(clk) then
      begun <= '1';
      if stands = '0' and arrives = '1' then
        stands          <= '1';
        request.error   <= error;
        request.checked <= checked;
        request.command <= command;
        request.data    <= data;
        request.missing <= to_bit(bytes = 0);
        left            <= bytes;
        had             <= bytes;
        opened          <= '0';
        beyond          <= '0';
      elsif take = '1' then
        opened       <= '1';
        beyond       <= beyond or (opened and to_bit(left = 0));
        request.data <= data;
        if opened = '1' and left > 0 then
          left            <= left - 1;
          request.missing <= to_bit(left = 1);
        end if;
      end if;
      if request_done = '1' or reset = '1' then
        stands <= '0';
      end if;
    end if;
  end process;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      waited <= 0;
      if bii.valid = '1' and response.done = '0' and waited < 2 then
        waited <= waited + 1;
      end if;
      if bii.valid = '1' and response.done = '1' then
        if accesses < 3 then
          accesses <= accesses + 1;
        end if;
        if response.status /= ok then
          troubled <= '1';
        end if;
      end if;
      if said = '1' then
        if spoken < 2 then
          spoken <= spoken + 1;
        end if;
        if kind = word_head then
          talking <= '1';
        elsif kind = word_tail then
          talking <= '0';
        elsif kind = word_error then
          refusing <= '1';
        end if;
      end if;
      if request.valid = '1' and word_ready = '1' and bii.valid = '0' and steps <= steps_most then
        steps <= steps + 1;
      end if;
      if request_done = '1' or reset = '1' then
        spoken   <= 0;
        refusing <= '0';
        accesses <= 0;
        troubled <= '0';
        steps    <= 0;
      end if;
      if reset = '1' then
        talking <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A command is one that the recogniser gives. Datalink errors and publishes come on other ways.
  command_is_one : assume always unsigned(command) < command_spelling;

  -- The bus answers within two clocks.
  bus_answers : assume always bii.valid = '0' or response.done = '1' or waited < 2;

  -- Behind the last byte at most one more is taken. The proof of request_buffer assumes this.
  taken_once_more : assert always begun = '0' or take = '0' or request.error = '1' or beyond = '0';

  -- A reply has one head, then its other words, then one tail.
  head_first : assert always begun = '0' or said = '0' or (kind = word_head) = (talking = '0');

  -- There is no reply without a request.
  no_reply_unasked : assert always begun = '0' or word_valid = '0' or request.valid = '1';

  -- A request is done with the last word of its reply, and at no other time.
  done_with_the_tail : assert always begun = '0' or request_done = (said and to_bit(kind = word_tail));

  -- Every request is answered within a fixed number of steps, whatever it asks and however many bytes it has.
  always_answers : assert always begun = '0' or steps <= steps_most;

  -- No bus cycle is opened for an unknown command, a datalink error, or a request about the core itself.
  no_bus_unless_asked : assert always begun = '0' or bii.valid = '0' or reads = '1' or writes = '1' or reads_many = '1';

  -- No bus cycle is opened for a request with too few bytes for its first access.
  no_bus_with_bytes_missing : assert always begun = '0' or bii.valid = '0' or
                              (reads = '1' and had >= 1) or (writes = '1' and had >= 2) or
                              (reads_many = '1' and had >= 2);

  -- A read makes one access, a write makes one, and a read-many makes one for each word that it may read.
  accesses_counted : assert always begun = '0' or
                     ((bii.valid = '0' or bii.write = writes) and
                      (reads_many = '1' or bii.valid = '0' or accesses = 0) and
                      (bii.valid = '0' or accesses < 2));

  -- The reply to an unknown command has an error mark right after the head.
  unknown_is_refused : assert always begun = '0' or said = '0' or request.error = '1' or known = '1' or spoken /= 1 or
                       kind = word_error;

  -- The reply has an error mark if the read or write fails or lacks bytes. It has none if the access succeeds.
  failures_are_told : assert always begun = '0' or request_done = '0' or (reads = '0' and writes = '0') or
                      refusing = (troubled or to_bit(had < 1) or to_bit(writes = '1' and had < 2));

  -- A reply without an error mark means that the access was made.
  success_is_real : assert always begun = '0' or request_done = '0' or (reads = '0' and writes = '0') or
                    refusing = '1' or accesses = 1;

  -- The reply to a datalink error has a question mark as its head.
  error_is_told : assert always begun = '0' or said = '0' or spoken /= 0 or
                  (request.error = '1') = (word(7 downto 0) = x"3F");

  -- A reset releases the bus at once.
  reset_is_idle : assert always reset = '1' -> next (bii.valid = '0' and bii.block_hold = '0');

  -- A read is answered.
  read_seen : cover {request_done = '1' and reads = '1' and refusing = '0'};

  -- A write fails on the bus.
  failure_seen : cover {request_done = '1' and writes = '1' and troubled = '1'};

  -- Two words are read.
  two_words_seen : cover {request_done = '1' and reads_many = '1' and accesses = 2 and refusing = '0'};

end architecture;
