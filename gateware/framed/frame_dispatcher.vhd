-- SPDX-License-Identifier: BSD-3-Clause
--
-- Chooses what the framed application does next: an event of the core, a publish, or the next frame.
--
-- Ports     asks: the program asks for work. wants: there is some. choice: what it is now, an entry of frame_pkg.
--           READ, WRITE, POST and POST_LIST have one each. All other requests have entry_unknown.
--           pending: there was some in the clock before, and the program asked for it. begins: what was chosen then is
--           taken. counted: it is the trip.
--           receive_overrun, publish_overrun: one-clock pulses, each kept until it is taken. tripped: the dead-man has
--           tripped, and the trip is not yet counted. room: the transmitter takes a whole payload.
-- Latency   None to `choice`, and one clock to `pending`.
-- Errors    None. An overrun of the line that comes while another one waits is merged with it. Up to 15 overruns of
--           publishes wait.
-- Arbitration  In this order: half_turn, overruns, tripped, publishes, frames.
-- Pressure  A publish begins only if there is room for all of it. While a due publish has no room, posts and dropped
--           frames may begin, because they send nothing. Other frames need the room too, so the publish goes before
--           them.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_dispatcher is
  generic (
    publishing : boolean := true;  -- there are publishes
    deadman    : boolean := true   -- there is a dead-man
  );
  port (
    clock           : in  std_ulogic;
    reset           : in  std_ulogic;
    turned          : in  std_ulogic;
    tripped         : in  std_ulogic;
    publish         : in  std_ulogic;
    room            : in  std_ulogic;
    receive_overrun : in  std_ulogic;
    publish_overrun : in  std_ulogic;
    frame_valid     : in  std_ulogic;
    frame_entry     : in  entry_t;
    asks            : in  std_ulogic;
    begins          : in  std_ulogic;
    wants           : out std_ulogic;
    choice          : out entry_t;
    pending         : out std_ulogic;
    counted         : out std_ulogic
  );
end entity;

architecture rtl of frame_dispatcher is

  signal receive_overran : std_ulogic := '0';
  signal publish_overruns : unsigned(3 downto 0) := (others => '0');  -- not yet taken
  signal due    : std_ulogic;
  signal chosen : entry_t;  -- in this clock
  signal place  : entry_t;  -- of the frame
  signal line_overran, overran, counts : std_ulogic := '0';  -- what was chosen in the clock before
  signal says_nothing : std_ulogic;  -- the frame gets no answer

begin

  wants   <= due;
  choice  <= chosen;
  counted <= begins and counts;

  silence : process (all)
  begin
    says_nothing <= '0';
    case to_integer(unsigned(frame_entry)) is
      when request_kind_post_c mod 16 | request_kind_post_list_c mod 16 | entry_check | entry_long | entry_kind =>
        says_nothing <= '1';
      when others => null;
    end case;
  end process;

  -- The program has one place for all requests that it looks at byte by byte.
  find_place : process (all)
  begin
    place <= frame_entry;
    case to_integer(unsigned(frame_entry)) is
      when request_kind_read_c mod 16 | request_kind_write_c mod 16 | request_kind_post_c mod 16 |
          request_kind_post_list_c mod 16 => null;
      when others =>
        if frame_entry(4) = '0' then
          place <= std_ulogic_vector(to_unsigned(entry_unknown, 5));
        end if;
    end case;
  end process;

  choose : process (all)
  begin
    due    <= '1';
    chosen <= place;
    if turned = '1' then
      chosen <= std_ulogic_vector(to_unsigned(entry_half_turn, 5));
    elsif receive_overran = '1' then
      chosen <= std_ulogic_vector(to_unsigned(entry_receive_overrun, 5));
    elsif publishing and publish_overruns /= 0 then
      chosen <= std_ulogic_vector(to_unsigned(entry_publish_overrun, 5));
    elsif deadman and tripped = '1' then
      chosen <= std_ulogic_vector(to_unsigned(entry_trip, 5));
    elsif publishing and publish = '1' and room = '1' then
      chosen <= std_ulogic_vector(to_unsigned(entry_publish, 5));
    elsif publishing and publish = '1' then
      due <= frame_valid and says_nothing;
    else
      due <= frame_valid;
    end if;
  end process;

  note : process (clock)
  begin
    if rising_edge(clock) then
      pending <= asks and due and not begins;
      line_overran <= to_bit(unsigned(chosen) = entry_receive_overrun);
      overran      <= to_bit(unsigned(chosen) = entry_publish_overrun and publishing);
      counts       <= to_bit(unsigned(chosen) = entry_trip and deadman);
      receive_overran <= receive_overran or receive_overrun;
      if publish_overrun = '1' and not (begins = '1' and overran = '1') then
        if publish_overruns /= 15 then
          publish_overruns <= publish_overruns + 1;
        end if;
      elsif publish_overrun = '0' and begins = '1' and overran = '1' then
        publish_overruns <= publish_overruns - 1;
      end if;
      if begins = '1' and line_overran = '1' then
        receive_overran <= receive_overrun;
      end if;
      if reset = '1' then
        pending          <= '0';
        receive_overran   <= '0';
        publish_overruns <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
