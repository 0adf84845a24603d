-- SPDX-License-Identifier: BSD-3-Clause
--
-- Requests as frame_receiver passes them on, for the proof of frame_application. A frame stands until it is done. Its
-- bytes are taken one after the other. Which frame comes, and when, is for the solver to choose.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bit_pkg.all;
use work.frame_pkg.all;
use work.protocol_pkg.all;

entity frame_arrivals is
  port (
    clk, reset, begun : in std_ulogic;
    arrives       : in  std_ulogic;               -- a frame arrives, if none is waiting
    entry_in      : in  entry_t;
    chained_in    : in  std_ulogic;
    barrier_in    : in  std_ulogic;
    length_in     : in  unsigned(3 downto 0);     -- length of its payload
    data          : in  byte_t;                   -- the next byte of the payload
    in_session    : in  std_ulogic;
    take, rewind, done : in std_ulogic;
    take_more     : in  unsigned(7 downto 0);     -- bytes that are taken at once, less 1
    request       : out frame_request_t;
    length, taken : out unsigned(3 downto 0) := (others => '0')
  );
end entity;

architecture properties of frame_arrivals is

  signal stands, chained, barrier : std_ulogic := '0';
  signal entry    : entry_t := (others => '0');
  signal few      : std_ulogic;                   -- fewer bytes are left than would be taken
  signal is_frame : std_ulogic;                   -- what arrives may

begin

  default clock is rising_edge(clk);

  request.valid   <= stands;
  request.entry   <= entry;
  request.chained <= chained;
  request.barrier <= barrier;
  request.data    <= data;
  request.left    <= resize(length - taken, 8);
  request.length  <= resize(length, 8);
  request.missing <= few;

  few <= to_bit(length - taken <= take_more);

  is_frame <= to_bit(unsigned(entry_in) < entry_trip and unsigned(entry_in) > 1 and unsigned(entry_in) /= 15 and
                     (unsigned(entry_in) > 15 or in_session = '1') and
                     (unsigned(entry_in) < entry_check or length_in = 0));

  stand : process (clk) is
  begin
    if rising_edge(clk) then
      if done = '1' or rewind = '1' then
        taken <= (others => '0');
      elsif take = '1' and few = '0' then
        taken <= taken + take_more(3 downto 0) + 1;
      end if;
      if stands = '0' or done = '1' then
        stands  <= arrives;
        taken   <= (others => '0');
        entry   <= entry_in;
        chained <= chained_in;
        barrier <= barrier_in;
        length  <= length_in;
      end if;
      if reset = '1' then
        stands <= '0';
      end if;
    end if;
  end process;

  -- The receiver passes on only what it may. Requests come only in a session, and dropped frames have no payload.
  frames_are_frames : assume always begun = '1' and arrives = '1' -> is_frame = '1';

end architecture;
