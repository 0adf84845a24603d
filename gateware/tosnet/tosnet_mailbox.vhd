-- SPDX-License-Identifier: BSD-3-Clause
--
-- The asynchronous channel at one node: messages of up to 12 bytes, to and from the slot of the DATA packet.
--
--   words from the user --> one message a slot        a message that came --> its words to the user
--
-- Words     Four bytes, the first in bits 31-24. `last` is the index of the last byte that is valid. A message is
--           up to three words to the same node, all but the last one full.
-- Sending   send_begin opens the message that waits. Then send_data is its next byte after each send_step, and zero
--           after its end. send_count is the number of its bytes that have been sent.
-- Taking    take_valid shifts a byte in. After 12 of them, take_keep gives the words of the first take_count bytes to
--           the user. Without it they are forgotten.
-- Pressure  A message that comes while the user has not taken the one before is dropped: `lost` is high for one clock.
-- Latency   A word of a message that came: one clock after take_keep.
-- Reset     Drops what it has.

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use work.bit_pkg.all;
  use work.protocol_pkg.all;

entity tosnet_mailbox is
  port (
    clock : in std_ulogic;
    reset : in std_ulogic; -- synchronous

    to_ring_valid   : in  std_ulogic;
    to_ring_ready   : out std_ulogic;
    to_ring_data    : in  std_ulogic_vector(31 downto 0);
    to_ring_last    : in  std_ulogic_vector(1 downto 0);
    to_ring_id      : in  std_ulogic_vector(3 downto 0);
    from_ring_valid : out std_ulogic;
    from_ring_ready : in  std_ulogic;
    from_ring_data  : out std_ulogic_vector(31 downto 0);
    from_ring_last  : out std_ulogic_vector(1 downto 0);
    from_ring_id    : out std_ulogic_vector(3 downto 0);
    lost            : out std_ulogic;

    send_begin : in  std_ulogic;
    send_step  : in  std_ulogic;
    send_data  : out byte_t;
    send_count : out unsigned(3 downto 0);
    take_valid : in  std_ulogic;
    take_data  : in  byte_t;
    take_keep  : in  std_ulogic;
    take_count : in  unsigned(3 downto 0); -- 0 to 12
    take_id    : in  std_ulogic_vector(3 downto 0)
  );
end entity;

architecture rtl of tosnet_mailbox is

  signal open_message : std_ulogic; -- the message that is sent has more bytes
  signal target       : std_ulogic_vector(3 downto 0);
  signal lane         : unsigned(1 downto 0) := "00";
  signal word_ends    : std_ulogic;
  signal continues    : std_ulogic; -- a full word has ended; the next one may belong to the message

  signal came  : std_ulogic_vector(95 downto 0); -- the first byte is on top
  signal kept  : std_ulogic_vector(95 downto 0);
  signal bytes : unsigned(3 downto 0) := "0000"; -- of `kept` that are not given yet

begin

  with lane select send_data <=
    to_ring_data(31 downto 24) and (7 downto 0 => open_message) when "00",
    to_ring_data(23 downto 16) and (7 downto 0 => open_message) when "01",
    to_ring_data(15 downto 8)  and (7 downto 0 => open_message) when "10",
    to_ring_data(7 downto 0)   and (7 downto 0 => open_message) when others;

  word_ends     <= to_bit(lane = unsigned(to_ring_last)) when (open_message and send_step) = '1' else '0';
  to_ring_ready <= word_ends;

  sending : process (clock) is
  begin
    if rising_edge(clock) then
      continues <= '0';
      if send_begin = '1' then
        open_message <= to_ring_valid;
        target       <= to_ring_id;
        lane         <= "00";
        send_count   <= "0000";
      elsif send_step = '1' then
        lane <= lane + 1;
        if open_message = '1' then
          send_count <= send_count + 1;
          if word_ends = '1' then
            open_message <= '0';
            continues    <= to_bit(to_ring_last = "11");
          end if;
        end if;
      elsif continues = '1' then
        -- The next word needs two clocks to come out of the user's queue; a byte has at least four.
        continues <= not to_ring_valid;
        if to_ring_valid = '1' and to_ring_id = target then
          open_message <= '1';
        end if;
      end if;
      if reset = '1' then
        open_message <= '0';
        continues    <= '0';
      end if;
    end if;
  end process;

  from_ring_valid <= to_bit(bytes /= 0);
  from_ring_data  <= kept(95 downto 64);
  from_ring_last  <= "11" when bytes > 4 else std_ulogic_vector(bytes(1 downto 0) - 1);

  taking : process (clock) is
  begin
    if rising_edge(clock) then
      lost <= '0';
      if take_valid = '1' then
        came <= came(87 downto 0) & take_data;
      end if;
      if from_ring_valid = '1' and from_ring_ready = '1' then
        kept <= kept(63 downto 0) & x"00000000";
        if bytes > 4 then
          bytes <= bytes - 4;
        else
          bytes <= "0000";
        end if;
      end if;
      if take_keep = '1' then
        if bytes = 0 then
          kept         <= came;
          bytes        <= take_count;
          from_ring_id <= take_id;
        else
          lost <= '1';
        end if;
      end if;
      if reset = '1' then
        bytes <= "0000";
        lost  <= '0';
      end if;
    end if;
  end process;

end architecture;
