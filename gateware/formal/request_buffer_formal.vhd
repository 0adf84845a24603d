-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of request_buffer, for messages of fewer than 7 entries. Any one message is followed from its start until
-- it is done, and z3 chooses which, and which of its data bytes. The events are as the proof of the receiver says, and
-- the takes as that of the application says.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.application_pkg.all;
use work.bit_pkg.all;
use work.datalink_pkg.all;
use work.protocol_pkg.all;

entity request_buffer_formal is
  port (
    clk          : in std_ulogic;
    reset        : in std_ulogic;
    happens      : in std_ulogic_vector(2 downto 0);  -- which event
    data         : in byte_t;
    checked      : in std_ulogic;
    mark         : in std_ulogic;                    -- follow the message that begins
    place        : in unsigned(1 downto 0);          -- … and this byte of it
    take         : in std_ulogic;
    rewind       : in std_ulogic;
    request_done : in std_ulogic
  );
end entity;

architecture properties of request_buffer_formal is

  constant message_entries : positive := 7;

  subtype code_t is natural range 0 to 31;           -- of a letter: A and a are 1

  signal receive : receive_t;
  signal room    : std_ulogic;
  signal request : request_t;

  signal begun   : std_ulogic := '0';

  -- The message that comes in.
  signal inside    : std_ulogic := '0';
  signal colon_met : std_ulogic := '0';
  signal entries   : natural range 0 to message_entries := 0;
  signal grows     : std_ulogic;                     -- by an entry
  signal in_order  : boolean;                        -- the event may come here
  signal is_letter : boolean;                        -- `data` is a letter of the alphabet

  signal requests  : natural range 0 to 3 := 0;      -- whole ones that are not done
  signal waited    : std_ulogic := '0';              -- a request has been there for a clock, and is not on offer

  -- The request on offer.
  signal takes : natural range 0 to message_entries + 1 := 0;  -- since it is on offer, or since the rewind

  -- The message that is followed.
  type stage_t is (none, comes, waits);
  signal stage     : stage_t := none;
  signal ahead     : natural range 0 to 2 := 0;      -- whole requests before it
  signal is_error  : std_ulogic;
  signal code      : byte_t;
  signal is_checked : std_ulogic;
  signal letters   : natural range 0 to 4;           -- 4 means four or more
  signal first, second, third : code_t;
  signal has_colon : std_ulogic;
  signal bytes     : natural range 0 to message_entries;
  signal here      : unsigned(1 downto 0);           -- the byte that is followed
  signal byte_here : byte_t;
  signal shown     : std_ulogic;                     -- it is the request on offer
  signal expected  : natural range 0 to 31;          -- its command

  function code_of(letter : character) return code_t is
  begin
    return character'pos(letter) mod 32;
  end function;

begin

  default clock is rising_edge(clk);

  dut : entity work.request_buffer
    generic map (message_entries => message_entries, has_publishing => false)
    port map (
      clock => clk, reset => reset, receive => receive, room => room, request => request, take => take,
      rewind => rewind, request_done => request_done);

  name : process (all) is
  begin
    receive.checked <= checked;
    receive.data    <= data;
    case happens is
      when "001"  => receive.event <= start;
      when "010"  => receive.event <= letter;
      when "011"  => receive.event <= colon;
      when "100"  => receive.event <= byte;
      when "101"  => receive.event <= good;
      when "110"  => receive.event <= bad;
      when others => receive.event <= nothing;
    end case;
  end process;

  count : process (clk) is
    variable whole : natural range 0 to 3;           -- requests without the one that comes in
  begin
    if rising_edge(clk) then
      begun <= '1';
      case receive.event is
        when start =>
          inside    <= '1';
          colon_met <= '0';
          entries   <= 1;
        when letter | colon | byte =>
          colon_met <= colon_met or to_bit(receive.event = colon);
          if entries < message_entries then
            entries <= entries + 1;
          end if;
        when good | bad =>
          inside <= '0';
        when nothing =>
          null;
      end case;

      whole := requests;
      if request_done = '1' and requests > 0 then
        whole := requests - 1;
      end if;
      waited   <= to_bit(whole > 0);
      requests <= whole;
      if (receive.event = good or receive.event = bad) and whole < 3 then
        requests <= whole + 1;
      end if;

      if request_done = '1' or rewind = '1' then
        takes <= 0;
      elsif take = '1' and takes <= message_entries then
        takes <= takes + 1;
      end if;
      if reset = '1' then
        inside   <= '0';
        requests <= 0;
        waited   <= '0';
        takes    <= 0;
      end if;
    end if;
  end process;

  follow : process (clk) is
  begin
    if rising_edge(clk) then
      if stage = waits and request_done = '1' then
        if ahead = 0 then
          stage <= none;
        else
          ahead <= ahead - 1;
        end if;
      end if;
      if stage = none and mark = '1' and receive.event = start then
        stage      <= comes;
        is_checked <= checked;
        letters    <= 0;
        has_colon  <= '0';
        bytes      <= 0;
        here       <= place;
      elsif stage = comes then
        case receive.event is
          when letter =>
            case letters is
              when 0 => first <= to_integer(unsigned(data(4 downto 0)));
              when 1 => second <= to_integer(unsigned(data(4 downto 0)));
              when 2 => third <= to_integer(unsigned(data(4 downto 0)));
              when others => null;
            end case;
            if letters < 4 then
              letters <= letters + 1;
            end if;
          when colon =>
            has_colon <= '1';
          when byte =>
            if bytes = to_integer(here) then
              byte_here <= data;
            end if;
            if bytes < message_entries then
              bytes <= bytes + 1;
            end if;
          when good | bad =>
            stage    <= waits;
            is_error <= to_bit(receive.event = bad);
            code     <= data;
            ahead    <= 0;
            if requests > 0 and request_done = '0' then
              ahead <= 1;
            end if;
          when others =>
            null;
        end case;
      elsif stage = none and mark = '1' and receive.event = bad then
        stage    <= waits;
        is_error <= '1';
        code     <= data;
        ahead    <= 0;
        if requests > 0 and request_done = '0' then
          ahead <= 1;
        end if;
      end if;
      if reset = '1' then
        stage <= none;
      end if;
    end if;
  end process;

  shown <= to_bit(stage = waits and ahead = 0) and request.valid;

  grows    <= to_bit(receive.event = letter or receive.event = colon or receive.event = byte);
  in_order <= (inside = '1' or (grows = '0' and receive.event /= good)) and
              (inside = '0' or receive.event /= start) and
              (colon_met = '0' or (receive.event /= letter and receive.event /= colon)) and
              (colon_met = '1' or receive.event /= byte);
  is_letter <= unsigned(data(4 downto 0)) >= 1 and unsigned(data(4 downto 0)) <= 26;

  understand : process (all) is
  begin
    expected <= command_unknown;
    if has_colon = '1' and letters = 1 and first = code_of('R') then
      expected <= command_read;
    elsif has_colon = '1' and letters = 1 and first = code_of('W') then
      expected <= command_write;
    elsif has_colon = '1' and letters = 2 and first = code_of('R') and second = code_of('M') then
      expected <= command_read_many;
    elsif letters >= 3 and first = code_of('R') and second = code_of('L') and third = code_of('C') then
      expected <= command_read_configuration;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- A message is a start, letters, a colon, bytes, and one end. An error may also come alone.
  message_in_order : assume always in_order;

  -- Without room no message begins, and no error comes outside a message.
  needs_room : assume always inside = '1' or room = '1' or (receive.event /= start and receive.event /= bad);

  -- A message has fewer entries than `message_entries`.
  never_too_long : assume always entries < message_entries - 1 or grows = '0';

  -- A letter is one of the alphabet.
  letter_is_one : assume always receive.event /= letter or is_letter;

  -- Only a request on offer is taken from, rewound and done.
  asked_of_one : assume always request.valid = '1' or (take or rewind or request_done) = '0';

  -- Behind the last byte at most one more is taken.
  taken_once_more : assume always take = '0' or shown = '0' or is_error = '1' or takes <= bytes + 1;

  -- There is room for a message exactly while fewer than two requests are kept, also for an error.
  room_is_true : assert always begun = '1' and inside = '0' -> room = to_bit(requests < 2);

  -- There are never more than two requests.
  two_at_most : assert always begun = '1' -> requests <= 2;

  -- A request is on offer only if a message has ended, and each once.
  none_of_nothing : assert always begun = '1' and request.valid = '1' -> requests > 0;

  -- A request is on offer two clocks after the end of its message, or at once behind another one.
  in_time : assert always begun = '1' and waited = '1' -> request.valid = '1';

  -- A bad message is an error with its own code, in the place of its message, until it is done or taken.
  error_is_told : assert always shown = '1' and takes = 0 and is_error = '1' ->
                  request.error = '1' and request.data = code;

  -- A good message is none, and says whether it had a checksum.
  good_is_none : assert always shown = '1' and takes = 0 and is_error = '0' ->
                 request.error = '0' and request.checked = is_checked;

  -- The command is the one that the letters spell, small or capital.
  command_is_spelled : assert always shown = '1' and takes = 0 and is_error = '0' and expected /= command_unknown ->
                       to_integer(unsigned(request.command)) = expected;

  -- Other letters give no command.
  others_are_unknown : assert always shown = '1' and takes = 0 and is_error = '0' and expected = command_unknown ->
                       (to_integer(unsigned(request.command)) = command_unknown or
                             to_integer(unsigned(request.command)) >= command_spelling);

  -- After the first take, each data byte is given in its place: the one that came there.
  bytes_in_order : assert always shown = '1' and is_error = '0' and to_integer(here) < bytes and
                                 takes = to_integer(here) + 1 ->
                   request.data = byte_here;

  -- `missing` says that all data bytes are taken, and no more.
  missing_is_true : assert always shown = '1' and is_error = '0' and takes > 0 and takes <= bytes + 1 ->
                    request.missing = to_bit(takes = bytes + 1);

  -- A reset drops all requests.
  reset_is_empty : assert always reset = '1' -> next (request.valid = '0');

  -- A request is executed while another one waits.
  two_seen : cover {requests = 2 and shown = '1' and takes = 2};

  -- A request is read a second time.
  rewound_seen : cover {shown = '1' and takes = 2 and rewind = '1'};

end architecture;
