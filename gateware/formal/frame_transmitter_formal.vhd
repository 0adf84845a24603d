-- SPDX-License-Identifier: BSD-3-Clause
--
-- Properties of the framed protocol's transmitter, on any payloads and any stalls: its output consists of whole frames.
-- The check is computed again here, bit by bit.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.frame_pkg.all;
use work.one_thing_pkg.all;
use work.protocol_pkg.all;
use work.serial_crc_pkg.all;

entity frame_transmitter_formal is
  port (
    clk      : in std_ulogic;
    reset    : in std_ulogic;
    epoch    : in crc16_t;
    put      : in std_ulogic;
    kind     : in std_ulogic;
    restart  : in std_ulogic;
    finish   : in std_ulogic;
    data     : in byte_t;
    tx_ready : in std_ulogic
  );
end entity;

architecture properties of frame_transmitter_formal is

  signal begun : std_ulogic := '0';  -- the reset of power-up is over
  signal reply : frame_reply_t;
  signal ready, idle, tx_valid, tx_last, tx_publish : std_ulogic;
  signal tx_data, data_before : byte_t;
  signal epoch_before : crc16_t;
  signal stalled      : std_ulogic := '0';  -- a byte was offered and not taken
  signal given        : std_ulogic := '0';  -- the kind of the payload in hand was sent
  signal goes         : std_ulogic;

  -- The outgoing frame.
  signal bytes        : natural range 0 to 4 := 0;
  signal last_1, last_2, last_3 : byte_t;
  signal crc          : crc16_t;             -- of all bytes but the last three
  signal checked      : std_ulogic;          -- the last three bytes are their check

begin

  default clock is rising_edge(clk);

  reply <= (put => put, kind => kind, restart => restart, finish => finish, data => data);

  dut : entity work.frame_transmitter
    port map (
      clock => clk, reset => reset, epoch => epoch, reply => reply, ready => ready, idle => idle, tx_valid => tx_valid,
      tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

  goes <= tx_valid and tx_ready;

  checked <= '1' when bytes = 4 and last_3 = '1' & crc(6 downto 0) and last_2 = '1' & crc(13 downto 7) and
                      last_1 = "100000" & crc(15 downto 14) else '0';

  watch : process (clk) is
  begin
    if rising_edge(clk) then
      begun        <= '1';
      epoch_before <= epoch;
      data_before  <= tx_data;
      stalled      <= tx_valid and not tx_ready;
      if ready = '1' and finish = '1' then
        given <= '0';
      elsif ready = '1' and kind = '1' then
        given <= '1';
      end if;
      if goes = '1' then
        last_1 <= tx_data;
        last_2 <= last_1;
        last_3 <= last_2;
        if bytes < 4 then
          bytes <= bytes + 1;
        end if;
        if bytes = 0 then
          crc <= epoch;
          if tx_data = x"D0" or tx_data = x"D1" or tx_data = x"D3" then
            crc <= x"FFFF";
          end if;
        elsif bytes > 2 then
          crc <= serial_crc(crc, last_3);
        end if;
        if tx_last = '1' then
          bytes <= 0;
        end if;
      end if;
      if reset = '1' then
        bytes   <= 0;
        stalled <= '0';
        given   <= '0';
      end if;
    end if;
  end process;

  -- The design is reset at power-up, and may be reset at any later clock.
  reset_first : assume always begun = '1' or reset = '1';

  -- The program does one thing at a time. It gives the kind once for each payload, and waits while the transmitter is
  -- not ready.
  one_thing_at_a_time : assume always one_thing(reply, given, ready);

  -- The epoch changes only while nothing is being sent.
  epoch_stands : assume always begun = '1' -> epoch = epoch_before or reset = '1' or (idle = '1' and given = '0');

  -- The byte 00 ends a frame, and stands nowhere else in it.
  zero_ends : assert always begun = '1' and tx_valid = '1' -> (tx_data = x"00" and tx_last = '1') or
              (tx_data /= x"00" and tx_last = '0');

  -- A frame begins with a kind that a device may send.
  kind_first : assert always begun = '1' and tx_valid = '1' and bytes = 0 -> tx_data(7 downto 5) = "110";

  -- A frame ends with the check of all bytes before it. The check starts from the epoch of the session, or from FFFF
  -- outside a session.
  check_is_right : assert always begun = '1' and tx_valid = '1' and tx_last = '1' -> checked = '1';

  -- A byte on offer stays the same until it is taken.
  offer_stands : assert always begun = '1' and stalled = '1' and reset = '0' ->
                 tx_valid = '1' and tx_data = data_before;

  -- A whole frame is sent.
  frame_seen : cover {begun = '1' and goes = '1' and tx_last = '1'};

end architecture;
