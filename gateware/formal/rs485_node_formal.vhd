-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of a node on an RS-485 pair. Any characters and errors come on the line, the core sends anything, and the
-- transmitter takes characters at any time. A bit is 2 clocks here.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.physical_pkg.all;

entity rs485_node_formal is
  port (
    clk        : in std_ulogic;
    reset      : in std_ulogic;
    node       : in std_ulogic_vector(5 downto 0);
    line_valid : in std_ulogic;
    line_data  : in std_ulogic_vector(7 downto 0);
    line_error : in receive_error_t;
    rx_ready   : in std_ulogic;
    send_valid : in std_ulogic;
    send_data  : in std_ulogic_vector(7 downto 0);
    send_last  : in std_ulogic;
    out_ready  : in std_ulogic
  );
end entity;

architecture properties of rs485_node_formal is

  constant bit_clocks      : positive := 2;
  constant turn_bytes      : positive := 2;
  constant turnaround_bits : positive := 3;
  constant silence_bits    : positive := 3;
  constant answer_clocks   : positive := (turnaround_bits - 1) * bit_clocks + 3; -- from the poll to drive
  constant silence_clocks  : positive := (silence_bits - 1) * bit_clocks;        -- shortest, until a message is cut off

  subtype byte_t is std_ulogic_vector(7 downto 0);

  type phase_t is (
    head_border, head_node, head_check, head_end,
    messages,
    tail_node, -- after the border of a message that was cut off
    tail_check, tail_end,
    over
  );

  signal drive, line_ready, rx_valid   : std_ulogic;
  signal send_ready, out_valid         : std_ulogic;
  signal out_data                      : byte_t;
  signal begun                         : std_ulogic := '0'; -- the reset of power-up is over
  signal node_before                   : std_ulogic_vector(5 downto 0);
  signal drive_before, reset_before    : std_ulogic := '0';
  signal ready_before, free_before     : std_ulogic := '0';

  -- The last three characters, newest first. A character with an error counts as no byte.
  signal first, second, third          : byte_t := x"00";
  signal whole_1, whole_2, whole_3     : std_ulogic := '0';
  signal hears, token, ours, poll, sel : std_ulogic;
  signal selected, in_frame            : std_ulogic := '0';

  signal asked                         : std_ulogic := '0';
  signal since_poll                    : natural range 0 to answer_clocks + 1 := 0;
  signal driven                        : natural range 0 to bit_clocks := 0;     -- clocks that the pair has been driven
  signal phase                         : phase_t := head_border;
  signal due                           : byte_t; -- the expected character, if it is not a byte of the core
  signal takes, says                   : std_ulogic;
  signal inside                        : std_ulogic := '0';                      -- a message is under way
  signal said                          : natural range 0 to turn_bytes := 0;
  signal silent                        : natural range 0 to silence_clocks := 0; -- clocks without a byte of the message
  signal free                          : natural range 0 to bit_clocks + 2 := 0; -- clocks since the last character

begin

  default clock is rising_edge(clk);

  dut : entity work.rs485_node
    generic map (
      bit_clocks => bit_clocks, turn_bytes => turn_bytes, turnaround_bits => turnaround_bits,
      silence_bits => silence_bits)
    port map (
      clock => clk, reset => reset, node => node, drive => drive,
      line_valid => line_valid, line_ready => line_ready, line_data => line_data, line_error => line_error,
      rx_valid => rx_valid, rx_ready => rx_ready,
      send_valid => send_valid, send_ready => send_ready, send_data => send_data, send_last => send_last,
      out_valid => out_valid, out_ready => out_ready, out_data => out_data);

  -- A token ends with this character. It is border, first byte, its check, border.
  hears <= line_valid and line_ready and not drive;
  token <= '1' when line_valid = '1' and drive = '0' and line_error = no_receive_error and line_data = x"00" and
           whole_1 = '1' and whole_2 = '1' and whole_3 = '1' and third = x"00" and second(7) = '0' and
           second /= x"00" and first = token_check(second) else '0';
  ours  <= '1' when second(5 downto 0) = node else '0';
  poll  <= token and ours and second(6);
  sel   <= token and ours and not second(6);

  with phase select due <=
    "00" & node                       when head_node,
    token_check("00" & node)          when head_check,
    "0" & (not inside) & "000000"     when messages,
    x"40"                             when tail_node,
    token_check(x"40")                when tail_check,
    x"00"                             when others;

  takes <= out_valid and out_ready;
  says  <= send_valid and send_ready;

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun        <= '1';
      node_before  <= node;
      drive_before <= drive;
      reset_before <= reset;
      ready_before <= out_ready;
      free_before  <= out_ready and not out_valid;

      if hears = '1' then
        first    <= line_data;
        second   <= first;
        third    <= second;
        whole_1  <= nor line_error;
        whole_2  <= whole_1;
        whole_3  <= whole_2;
        in_frame <= rx_valid and (nor line_error) and (or line_data);
        if token = '1' then
          selected <= sel;
        end if;
      end if;

      if since_poll <= answer_clocks then
        since_poll <= since_poll + 1;
      end if;
      if hears = '1' and poll = '1' and asked = '0' then
        asked      <= '1';
        since_poll <= 1;
      end if;
      if drive = '1' then
        asked    <= '0';
        selected <= '0';
        in_frame <= '0';
        first    <= x"00"; -- the end of the turn is a border
        whole_1  <= '1';
        whole_2  <= '0';
      end if;

      if drive = '0' then
        driven <= 0;
        phase  <= head_border;
        inside <= '0';
        said   <= 0;
        free   <= 0;
      elsif driven < bit_clocks then
        driven <= driven + 1;
      end if;
      if silent < silence_clocks then
        silent <= silent + 1;
      end if;
      if says = '1' then
        silent <= 0;
        inside <= not send_last;
        if said < turn_bytes then
          said <= said + 1;
        end if;
      end if;
      if takes = '1' then
        case phase is
          when head_border => phase <= head_node;
          when head_node   => phase <= head_check;
          when head_check  => phase <= head_end;
          when head_end    => phase <= messages;
          when messages    =>
            if says = '0' and inside = '1' then
              phase <= tail_node;
            elsif says = '0' then
              phase <= tail_check;
            end if;
          when tail_node   => phase <= tail_check;
          when tail_check  => phase <= tail_end;
          when tail_end    => phase <= over;
          when over        => phase <= over;
        end case;
      end if;
      if phase /= over or out_ready = '0' then
        free <= 0;
      elsif free < bit_clocks + 2 then
        free <= free + 1;
      end if;

      if reset = '1' then
        asked    <= '0';
        selected <= '0';
        in_frame <= '0';
        first    <= x"00";
        whole_1  <= '1';
        whole_2  <= '0';
        driven   <= 0;
        phase    <= head_border;
        inside   <= '0';
        said     <= 0;
        free     <= 0;
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The number of a node stays the same. 0 is the master's.
  number_stands : assume always node /= "000000" and (begun = '0' or node = node_before);

  -- A transmitter that is ready stays ready until it gets a character. Then it is busy for at least one clock.
  transmitter_sends : assume always begun = '1' -> (free_before = '0' or out_ready = '1') and
                      (ready_before = '0' or free_before = '1' or out_ready = '0');

  -- The node drives the pair only after a poll of this node. It waits long enough for the other side to release the
  -- pair.
  never_unasked : assert always begun = '1' and drive = '1' and drive_before = '0' ->
                  asked = '1' and since_poll = answer_clocks;

  -- A poll is always answered.
  always_answers : assert always begun = '1' and asked = '1' and since_poll = answer_clocks and reset_before = '0' ->
                   drive = '1';

  -- It sends only while it drives. The first start bit comes one clock after its character is given, and one bit after
  -- the driving begins.
  speaks_while_driving : assert always begun = '1' and out_valid = '1' -> drive = '1' and driven >= bit_clocks - 1;

  -- The messages stand between a select of this node and a poll of node 0. A message that is cut off ends with a
  -- border. Nothing follows the poll.
  frames_are_framed : assert always begun = '1' and takes = '1' and says = '0' -> phase /= over and out_data = due;

  -- No byte of the core is lost, doubled or changed. It is sent in the clock in which it is taken, among the messages.
  bytes_are_kept : assert always begun = '1' and says = '1' ->
                   takes = '1' and phase = messages and out_data = send_data;

  -- No message begins once `turn_bytes` bytes were sent.
  turn_is_short : assert always begun = '1' and says = '1' and inside = '0' -> said < turn_bytes;

  -- A message is cut off only if the core was silent within it for `silence_clocks`.
  patient : assert always begun = '1' and takes = '1' and says = '0' and phase = messages and inside = '1' ->
            silent = silence_clocks;

  -- The pair is released exactly one bit after the last character.
  lets_go : assert always begun = '1' and reset_before = '0' ->
            (drive = '1' or drive_before = '0' or free = bit_clocks + 1) and (drive = '0' or free <= bit_clocks);

  -- The core gets only what follows a select of this node. It gets no frames of other nodes, and no echo.
  own_frames_only : assert always begun = '1' and rx_valid = '1' -> drive = '0' and (selected = '1' or sel = '1');

  -- The core gets every character of its frames. No character is taken before there is room.
  none_left_out : assert always begun = '1' and line_valid = '1' and drive = '0' and in_frame = '1' ->
                  rx_valid = '1' and line_ready = rx_ready;

  -- A turn has one message.
  turn_seen : cover {begun = '1' and phase = over and drive = '0' and drive_before = '1' and said = 1};
  -- A message is cut off.
  broken_seen : cover {begun = '1' and phase = tail_node};
  -- A character for this node comes.
  ours_seen : cover {begun = '1' and in_frame = '1'};

end architecture;
