-- SPDX-License-Identifier: BSD-3-Clause
--
-- Executes requests on the bus, answers them, and publishes groups between them. One thing at a time.
--
-- Ports     request, data..., take, request_done: see request_buffer and request_stream. subscription: see
--           subscription_pkg. bii: see bii_pkg. token: valid/ready, what the speller makes a reply of.
-- Latency   The head of a reply goes out in the clock in which the request is valid, if nothing else is in hand. Clocks
--           in all, with a 2-clock bus and room for tokens, for AB address and DB data bytes: read 6 + AB + DB, write
--           6 + AB + DB, a word of a read-many 4 + AB or DB, a word of a publish 4 or DB: whichever is more.
-- Errors    The E_ codes of docs/classic-protocol.md section 4. A refused request changes nothing. An error in the middle
--           of a read-many or publish ends it there, and the bus is released.
-- Arbitration  Between messages only. publish_mode 2 prefers publishes, 1 requests; but whoever waits has its turn after
--           `turns_most` messages of the other, so that neither starves.
-- Pressure  token_ready stalls the machine wherever it wants to say something; nothing is lost.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.application_state_pkg.all;
use work.bii_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;
use work.width_pkg.all;

entity application is
  generic (
    address_width : positive range 1 to 32  := 8;
    data_width    : positive range 8 to 32  := 32;
    base_hz       : positive                := limits_base_hz_default_c;
    groups        : positive range 1 to 256 := 2;
    group_size    : positive range 1 to 255 := 16;
    most_words    : natural  range 0 to 255 := 32;  -- of a read-many; 0: there is no such command
    rate_bytes    : positive range 1 to 4   := 2;
    publish_mode  : natural  range 0 to 2   := 2;
    turns_most    : positive range 1 to 15  := 3    -- messages in a row of the preferred side while the other waits
  );
  port (
    clock                 : in  std_ulogic;
    reset                 : in  std_ulogic;
    request               : in  request_t;
    data                  : in  byte_t;
    data_valid            : in  std_ulogic := '1';  -- data is there; a request that is kept whole has it always
    data_ended            : in  std_ulogic := '0';  -- none will come any more
    take                  : out std_ulogic;
    request_done          : out std_ulogic;
    subscription_request  : out subscription_request_t;
    subscription_response : in  subscription_response_t;
    bii_request           : out bii_request_t;
    bii_response          : in  bii_response_t;
    token_valid           : out std_ulogic;
    token_ready           : in  std_ulogic;
    token_data            : out token_t
  );
end entity;

architecture rtl of application is

  constant address_bytes : positive := bytes_for(address_width);
  constant data_bytes    : positive := bytes_for(data_width);
  constant mask_bytes    : positive := maximum(limits_event_mask_bytes_min_c, (groups + 7) / 8);

  signal r, r_next : record_t := record_initial;

  -- The fields of CNF. A byte cannot hold 256 groups: it says 00 then.
  constant fields : fields_t := (
    high(address_bytes, 1), high(data_bytes, 1), high(most_words, 1), high(publish_mode, 1),
    high(base_hz, frequency_bytes(base_hz)), high(groups mod 256, 1), high(group_size, 1), high(rate_bytes, 1));

begin

  execute : process (all)
    variable v       : record_t;
    variable s       : subscription_request_t;
    variable free    : boolean;  -- the writer can be given a word
    variable quiet   : boolean;  -- the writer says nothing, so that the machine can
    variable publish : boolean;  -- the next message is one

    procedure write_word(word : std_ulogic_vector(31 downto 0); bytes : positive) is
    begin
      v.word      := word;
      v.word_left := bytes;
    end procedure;

    procedure say_text(text : text_t; following : state_t; bytes : natural := 0) is
    begin
      v.state     := say;
      v.text      := text;
      v.following := following;
      v.say_bytes := bytes;
    end procedure;

    procedure gather_bytes(bytes : positive; following : state_t) is
    begin
      v.state       := gather;
      v.following   := following;
      v.gather_left := bytes;
    end procedure;

    procedure begin_access(address : std_ulogic_vector(31 downto 0)) is
    begin
      v.state           := access_bus;
      v.bus_out.valid   := '1';
      v.bus_out.address := address;
    end procedure;

    -- The next word of a read-many or a publish.
    procedure next_word is
    begin
      if v.count = 0 then
        v.bus_out.block_hold := '0';
        v.state := tail;
      elsif r.serving = '0' then
        v.state := open_publish;
      else
        gather_bytes(address_bytes, open_block);
      end if;
    end procedure;

    procedure begin_request is
    begin
      v.remaining := request.length;
      case request.command is
        when unknown =>
          say_text(text_incomplete_command, tail);
        when read =>
          gather_bytes(address_bytes, open_read);
        when write =>
          gather_bytes(address_bytes, write_address);
        when read_configuration =>
          say_text(text_configuration, list_field);
        when enable_publishing | enable_checked_publishing =>
          s.enable := '1';
          v.checked_publish := '0';
          say_text(text_enable_publishing, tail);
          if request.command = enable_checked_publishing then
            v.checked_publish := '1';
            say_text(text_enable_checked_publishing, tail);
          end if;
        when disable_publishing =>
          s.disable := '1';
          say_text(text_disable_publishing, tail);
        when read_event_mask =>
          v.index := to_unsigned(mask_bytes - 1, 8);
          say_text(text_read_event_mask, list_mask);
        when write_event_mask =>
          v.index := to_unsigned(mask_bytes - 1, 8);
          if request.length < mask_bytes then
            say_text(text_missing_data, tail);
          else
            gather_bytes(1, store_mask);
          end if;
        when read_many =>
          gather_bytes(1, check_block);
        when write_group_addresses | write_group_rate | read_group =>
          gather_bytes(1, check_group);
      end case;
    end procedure;
  begin
    v := r;
    s := subscription_request_idle;
    s.group_number := r.group_number;
    s.index        := r.index;
    s.value        := r.argument;

    take         <= '0';
    request_done <= '0';
    token_valid  <= '0';
    token_data   <= token_tail & x"00";

    -- The writer: sends the bytes of a word, while the machine may already see to the next.
    quiet := r.word_left = 0;
    free  := r.word_left = 0 or (r.word_left = 1 and token_ready = '1');
    if not quiet then
      token_valid <= '1';
      token_data  <= token_byte & r.word(31 downto 24);
      if token_ready = '1' then
        v.word      := r.word(23 downto 0) & x"00";
        v.word_left := r.word_left - 1;
      end if;
    end if;

    case r.state is
      when idle =>
        publish := subscription_response.publish = '1';
        if publish and request.valid = '1' then
          publish := (publish_mode = 2) = (r.turns /= turns_most);
        end if;
        token_valid <= request.valid or subscription_response.publish;
        token_data  <= token_head & head_of(request);
        if publish then
          token_data <= token_head & head_of(r.checked_publish);
        end if;
        if token_ready = '1' and (request.valid = '1' or publish) then
          v.turns := 0;
          if request.valid = '1' and subscription_response.publish = '1' and r.turns /= turns_most then
            v.turns := r.turns + 1;
          end if;
          v.bus_out.write := '0';
          v.index         := (others => '0');
          v.serving       := '1';
          if publish then
            s.publish_take := '1';
            v.serving      := '0';
            v.group_number := subscription_response.publish_group;
            say_text(text_publish, publish_head);
          elsif request.error = '1' then
            v.state := error_code;
          else
            begin_request;
          end if;
        end if;

      when error_code =>
        write_word(request.code & x"000000", 1);
        v.state := tail;

      when gather =>
        if data_ended = '1' or r.remaining = 0 then
          v.bus_out.block_hold := '0';
          say_text(missing_text(r.following), tail);
        elsif data_valid = '1' then
          take        <= '1';
          v.argument  := r.argument(23 downto 0) & data;
          v.remaining := r.remaining - 1;
          v.gather_left := r.gather_left - 1;
          if r.gather_left = 1 then
            v.state := r.following;
          end if;
        end if;

      when say =>
        if quiet then
          token_valid <= '1';
          token_data  <= token(r.text);
          if token_ready = '1' then
            v.word_left := r.say_bytes;
            v.state     := r.following;
          end if;
        end if;

      when tail =>
        if quiet then
          token_valid <= '1';
          if token_ready = '1' then
            request_done <= r.serving;
            v.state      := idle;
          end if;
        end if;

      when open_read =>
        begin_access(r.argument);

      when write_address =>
        v.bus_out.address := r.argument;
        gather_bytes(data_bytes, open_write);

      when open_write =>
        v.bus_out.write := '1';
        v.bus_out.data  := r.argument;
        begin_access(r.bus_out.address);

      when check_block =>
        v.count := unsigned(r.argument(7 downto 0));
        if unsigned(r.argument(7 downto 0)) = 0 or unsigned(r.argument(7 downto 0)) > most_words then
          say_text(text_invalid_block_size, tail);
        elsif quiet then
          token_valid <= '1';
          token_data  <= token(text_read_many);
          if token_ready = '1' then
            next_word;
          end if;
        end if;

      when open_block =>
        v.count := r.count - 1;
        v.bus_out.block_hold := '1';
        begin_access(r.argument);

      when open_publish =>
        v.count := r.count - 1;
        v.index := r.index + 1;
        v.bus_out.block_hold := '1';
        begin_access(subscription_response.address);

      when access_bus =>
        if bii_response.done = '1' then
          v.bus_out.valid := '0';
          v.argument      := bii_response.data;
          if bii_response.status /= ok then
            v.bus_out.block_hold := '0';
            say_text(bus_error_text(bii_response.status, r.bus_out.write), tail);
          elsif r.bus_out.write = '1' then
            say_text(text_write, tail);
          elsif r.bus_out.block_hold = '0' then
            v.word := high(bii_response.data, data_bytes);
            say_text(text_read, tail, data_bytes);
          elsif free then
            write_word(high(bii_response.data, data_bytes), data_bytes);
            next_word;
          else
            v.state := block_word;
          end if;
        end if;

      when block_word =>
        if free then
          write_word(high(r.argument, data_bytes), data_bytes);
          next_word;
        end if;

      when list_field =>
        if free then
          if r.index = 4 then
            write_word(fields(to_integer(r.index(2 downto 0))), frequency_bytes(base_hz));
          else
            write_word(fields(to_integer(r.index(2 downto 0))), 1);
          end if;
          v.index := r.index + 1;
          if r.index = 7 then
            v.state := tail;
          else
            say_text(text_comma, list_field);
          end if;
        end if;

      when check_group =>
        v.group_number := unsigned(r.argument(7 downto 0));
        if unsigned(r.argument(7 downto 0)) >= groups then
          say_text(text_invalid_group, tail);
        elsif request.command = read_group then
          say_text(text_read_group, list_rate);
        elsif request.command = write_group_rate then
          gather_bytes(rate_bytes, write_rate);
        else
          gather_bytes(1, check_size);
        end if;

      when check_size =>
        v.count := unsigned(r.argument(7 downto 0));
        if unsigned(r.argument(7 downto 0)) = 0 or unsigned(r.argument(7 downto 0)) > group_size then
          say_text(text_invalid_group_size, tail);
        elsif r.remaining < unsigned(r.argument(7 downto 0)) * to_unsigned(address_bytes, 3) then
          say_text(text_missing_address, tail);  -- and the group stays as it was
        else
          gather_bytes(address_bytes, store_address);
        end if;

      when store_address =>
        s.write_address := '1';
        v.index := r.index + 1;
        if r.index + 1 = r.count then
          s.write_count := '1';
          say_text(text_write_group_addresses, tail);
        else
          gather_bytes(address_bytes, store_address);
        end if;

      when write_rate =>
        s.write_rate := '1';
        if subscription_response.done = '1' then
          say_text(text_write_group_rate, tail);
        end if;

      when list_rate =>
        if free and subscription_response.looked = '1' then
          write_word(high(subscription_response.rate, rate_bytes), rate_bytes);
          v.state := list_count;
        end if;

      when list_count =>
        if free then
          write_word(std_ulogic_vector(subscription_response.count) & x"000000", 1);
          v.count := subscription_response.count;
          v.state := tail;
          if subscription_response.count /= 0 then
            v.state := list_settle;
          end if;
        end if;

      when list_settle =>
        v.state := list_address;

      when list_address =>
        if free then
          write_word(high(subscription_response.address, address_bytes), address_bytes);
          v.index := r.index + 1;
          v.count := r.count - 1;
          v.state := list_settle;
          if r.count = 1 then
            v.state := tail;
          end if;
        end if;

      when store_mask =>
        s.write_mask := '1';
        v.index := r.index - 1;
        if r.index = 0 then
          say_text(text_write_event_mask, tail);
        else
          gather_bytes(1, store_mask);
        end if;

      when list_mask =>
        if free then
          write_word(subscription_response.mask & x"000000", 1);
          v.index := r.index - 1;
          if r.index = 0 then
            v.state := tail;
          end if;
        end if;

      when publish_head =>
        write_word(std_ulogic_vector(r.group_number) & std_ulogic_vector(subscription_response.count) & x"0000", 2);
        v.count := subscription_response.count;
        v.state := open_publish;
    end case;

    subscription_request <= s;
    r_next <= v;
  end process;

  bii_request <= r.bus_out;

  step : process (clock)
  begin
    if rising_edge(clock) then
      r <= r_next;
      if reset = '1' then
        r <= record_initial;
      end if;
    end if;
  end process;

end architecture;
