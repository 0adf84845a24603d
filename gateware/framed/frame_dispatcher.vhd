-- SPDX-License-Identifier: BSD-3-Clause
--
-- Chooses what the framed application does next: an event of the core, a publish, or the next frame.
--
-- Ports     entry: see frame_pkg; valid while `pending`. begins: the entry is taken. receive_overrun, publish_overrun:
--           one-clock pulses, each kept until it is taken. tripped: the dead-man has tripped, and the trip is not yet
--           counted. room: the transmitter takes a whole payload.
-- Latency   None.
-- Errors    None. An overrun of the line that comes while another one waits is merged with it. Up to 15 overruns of
--           publishes wait.
-- Arbitration  In this order: half_turn, overruns, tripped, publishes, frames.
-- Pressure  A publish begins only if there is room for all of it. While a due publish has no room, posts and dropped
--           frames may begin, because they send nothing. Other frames need the room too, so the publish goes before
--           them.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

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
    begins          : in  std_ulogic;
    pending         : out std_ulogic;
    entry           : out entry_t
  );
end entity;

architecture rtl of frame_dispatcher is

  signal receive_overran : std_ulogic := '0';
  signal publish_overruns : unsigned(3 downto 0) := (others => '0');  -- not yet taken
  signal choice : entry_t;
  signal says_nothing : std_ulogic;  -- the frame gets no answer

begin

  entry <= choice;

  silence : process (all)
  begin
    says_nothing <= '0';
    case to_integer(unsigned(frame_entry)) is
      when request_kind_post_c mod 16 | request_kind_post_list_c mod 16 | entry_check | entry_long | entry_kind =>
        says_nothing <= '1';
      when others => null;
    end case;
  end process;

  choose : process (all)
  begin
    pending <= '1';
    choice  <= frame_entry;
    if turned = '1' then
      choice <= std_ulogic_vector(to_unsigned(entry_half_turn, 5));
    elsif receive_overran = '1' then
      choice <= std_ulogic_vector(to_unsigned(entry_receive_overrun, 5));
    elsif publishing and publish_overruns /= 0 then
      choice <= std_ulogic_vector(to_unsigned(entry_publish_overrun, 5));
    elsif deadman and tripped = '1' then
      choice <= std_ulogic_vector(to_unsigned(entry_trip, 5));
    elsif publishing and publish = '1' and room = '1' then
      choice <= std_ulogic_vector(to_unsigned(entry_publish, 5));
    elsif publishing and publish = '1' then
      pending <= frame_valid and says_nothing;
    else
      pending <= frame_valid;
    end if;
  end process;

  note : process (clock)
  begin
    if rising_edge(clock) then
      receive_overran <= receive_overran or receive_overrun;
      if publish_overrun = '1' and not (begins = '1' and unsigned(choice) = entry_publish_overrun) then
        if publish_overruns /= 15 then
          publish_overruns <= publish_overruns + 1;
        end if;
      elsif publish_overrun = '0' and begins = '1' and unsigned(choice) = entry_publish_overrun then
        publish_overruns <= publish_overruns - 1;
      end if;
      if begins = '1' then
        if unsigned(choice) = entry_receive_overrun then
          receive_overran <= receive_overrun;
        end if;
      end if;
      if reset = '1' then
        receive_overran  <= '0';
        publish_overruns <= (others => '0');
      end if;
    end if;
  end process;

end architecture;
