-- SPDX-License-Identifier: BSD-3-Clause
--
-- The Unity-Link core without a bus: a protocol or both on byte streams, requests and publishes on the bus-independent
-- interface. `core` puts a Wishbone master behind it, `core_axi_lite` an AXI4-Lite one; yours may be another.
--
--   rx --> port_splitter --> classic, framed <--> application_switch <--> dead_man <--> bii
--   tx <-- port_joiner   <------+                        |
--                                              subscription_manager <-- events
--
-- Protocol  "classic", "framed" or "both"; with one of them alone, nothing of the other is there.
-- Ports     rx, tx: byte streams, valid/ready/data. tx_last: with the last byte of a message, tx_publish: with all bytes of a
--           publish. rx_error: one-clock pulses of the physical layer (bit 0 parity, 1 framing, 2 overrun).
--           events: one line a group, synchronous to the clock. bii: see bii_pkg; word addresses.
--           tripped: of the dead-man (dead_man), high from its trip until `arm` or reset; low where there is none.
-- Latency   From the last byte of a request to the first of its reply: 6 clocks. Then a byte a clock, as far as the bus and
--           the reply go: the figures are in docs/gateware/core.md and asserted in tests/gateware/test_cycles.py.
-- Errors    docs/classic-protocol.md section 4. An error takes nothing but its own message along.
-- Pressure  tx_ready stalls replies, then execution, then rx_ready; never the dead-man. Two requests are kept, in execution
--           and behind it.
-- Checksum  "none" also takes checked requests and EPC away.
-- Datalink  "lite" and "none" keep nothing: a request is executed while it comes in (docs/gateware/datalink.md).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;
use work.protocol_pkg.all;
use work.subscription_pkg.all;

entity core_bii is
  generic (
    address_width : positive range 1 to 32  := 8;
    data_width    : positive range 8 to 32  := 32;
    clock_hz      : positive                := limits_clock_hz_default_c;
    base_hz       : positive                := limits_base_hz_default_c;  -- of publishing
    groups        : positive range 1 to 256 := 2;
    group_size    : positive range 1 to 255 := 16;   -- addresses a group can have
    rate_bytes    : positive range 1 to 4   := 2;
    read_many     : natural  range 0 to 255 := 32;   -- most words of a read-many; 0: no such command
    publish_mode  : natural  range 0 to 2   := 2;    -- 0 none, 1 prefers requests, 2 prefers publishes
    configuration_command : boolean         := true; -- RLC exists
    datalink      : string                  := "full";  -- "full", "lite" or "none"
    checksum      : string                  := "crc8";  -- "crc8", "xor" or "none"; of the full datalink
    polynomial    : natural range 0 to 255  := to_integer(unsigned(crc8_polynomial_c));
    edge_events   : std_ulogic_vector(255 downto 0) := (others => '0');  -- bit g: event of group g by edge, else level
    protocol      : string                  := "classic";  -- "classic", "framed" or "both"; from here on, of framed:
    exchanges     : natural  range 0 to 4   := 2;    -- exchange groups; 0: there are none
    exchange_size : natural  range 0 to 60  := 16;   -- words in one, outputs and inputs
    lists         : boolean                 := true;
    deadman       : boolean                 := true;
    safe_values   : safe_values_t           := no_safe_values;  -- what the dead-man writes
    window        : positive range 2 to 128 := frame_window_default_c;  -- requests in flight, a power of two
    gateware_version : word32_t             := (others => '0');
    build         : word32_t                := (others => '0');
    spec_hash     : std_ulogic_vector(63 downto 0) := (others => '0')
  );
  port (
    clock        : in  std_ulogic;
    reset        : in  std_ulogic;
    rx_valid     : in  std_ulogic;
    rx_ready     : out std_ulogic;
    rx_data      : in  std_ulogic_vector(7 downto 0);
    rx_error     : in  std_ulogic_vector(2 downto 0) := "000";
    tx_valid     : out std_ulogic;
    tx_ready     : in  std_ulogic;
    tx_data      : out std_ulogic_vector(7 downto 0);
    tx_last      : out std_ulogic;
    tx_publish   : out std_ulogic;
    events       : in  std_ulogic_vector(groups - 1 downto 0) := (others => '0');
    tripped      : out std_ulogic;
    bii_request  : out bii_request_t;
    bii_response : in  bii_response_t
  );
end entity;

architecture rtl of core_bii is

  constant has_classic : boolean := protocol /= "framed";
  constant has_framed  : boolean := protocol /= "classic";
  constant both        : boolean := has_classic and has_framed;

  -- Of each side, where it is there.
  signal classic_valid, classic_ready, frame_valid, frame_ready : std_ulogic;
  signal classic_tx_valid, classic_tx_ready, classic_tx_last, classic_tx_publish : std_ulogic;
  signal frame_tx_valid, frame_tx_ready, frame_tx_last, frame_tx_publish         : std_ulogic;
  signal classic_tx_data, frame_tx_data : byte_t;
  signal classic_error        : std_ulogic_vector(2 downto 0);
  signal classic_busy, classic_may_begin              : std_ulogic;
  signal framed_busy, framed_wants, framed_may_begin  : std_ulogic;
  signal session_open         : std_ulogic;
  signal classic_subscription, framed_subscription, subscription_request : subscription_request_t;
  signal subscription_response : subscription_response_t;
  signal classic_bii, framed_bii : bii_request_t;
  signal classic_bii_response, framed_bii_response : bii_response_t;
  signal asked                : bii_request_t;   -- of the bus, by whichever side has it
  signal answered             : bii_response_t;
  signal dead_man_request     : dead_man_request_t;
  signal dead_man_response    : dead_man_response_t;

  function groups_of(mode : natural) return natural is
  begin
    if mode = 0 then
      return 0;
    end if;
    return groups;
  end function;

begin

  assert protocol = "classic" or protocol = "framed" or protocol = "both"
    report "core_bii: protocol must be classic, framed or both" severity failure;
  assert not both or datalink = "full"
    report "core_bii: with both protocols the classic datalink must be full" severity failure;

  classic_side : if has_classic generate
    classic : entity work.classic
      generic map (
        address_width => address_width, data_width => data_width, base_hz => base_hz, groups => groups,
        group_size => group_size, rate_bytes => rate_bytes, read_many => read_many, publish_mode => publish_mode,
        configuration_command => configuration_command, datalink => datalink, checksum => checksum,
        polynomial => polynomial)
      port map (
        clock => clock, reset => reset,
        rx_valid => classic_valid, rx_ready => classic_ready, rx_data => rx_data, rx_error => classic_error,
        tx_valid => classic_tx_valid, tx_ready => classic_tx_ready, tx_data => classic_tx_data,
        tx_last => classic_tx_last, tx_publish => classic_tx_publish,
        locked => session_open, may_begin => classic_may_begin, busy => classic_busy,
        subscription_request => classic_subscription, subscription_response => subscription_response,
        bii_request => classic_bii, bii_response => classic_bii_response);
  end generate;

  framed_side : if has_framed generate
    framed : entity work.framed
      generic map (
        address_width => address_width, data_width => data_width, clock_hz => clock_hz, base_hz => base_hz,
        groups => groups_of(publish_mode), group_size => group_size, rate_bytes => rate_bytes, exchanges => exchanges,
        exchange_size => exchange_size, lists => lists, deadman => deadman, window => window,
        classic => has_classic, gateware_version => gateware_version, build => build, spec_hash => spec_hash)
      port map (
        clock => clock, reset => reset,
        frame_valid => frame_valid, frame_ready => frame_ready, frame_data => rx_data, receive_overrun => rx_error(2),
        tx_valid => frame_tx_valid, tx_ready => frame_tx_ready, tx_data => frame_tx_data,
        tx_last => frame_tx_last, tx_publish => frame_tx_publish,
        session_open => session_open, may_begin => framed_may_begin, wants => framed_wants, busy => framed_busy,
        subscription_request => framed_subscription, subscription_response => subscription_response,
        dead_man_request => dead_man_request, dead_man_response => dead_man_response,
        bii_request => framed_bii, bii_response => framed_bii_response);
  end generate;

  frames_among_bytes : if has_framed generate
    port_splitter : entity work.port_splitter
      port map (
        clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => rx_ready, rx_data => rx_data,
        classic_valid => classic_valid, classic_ready => classic_ready,
        frame_valid => frame_valid, frame_ready => frame_ready);
  end generate;

  two_sides : if both generate
    -- A line that hurts is told as text only where text is spoken: never between the frames of a session.
    classic_error <= rx_error when session_open = '0' else "000";

    port_joiner : entity work.port_joiner
      port map (
        clock => clock, reset => reset,
        classic_valid => classic_tx_valid, classic_ready => classic_tx_ready, classic_data => classic_tx_data,
        classic_last => classic_tx_last, classic_publish => classic_tx_publish,
        frame_valid => frame_tx_valid, frame_ready => frame_tx_ready, frame_data => frame_tx_data,
        frame_last => frame_tx_last, frame_publish => frame_tx_publish,
        tx_valid => tx_valid, tx_ready => tx_ready, tx_data => tx_data, tx_last => tx_last, tx_publish => tx_publish);

    application_switch : entity work.application_switch
      port map (
        classic_busy => classic_busy, classic_may_begin => classic_may_begin,
        classic_subscription => classic_subscription, classic_bii => classic_bii,
        classic_bii_response => classic_bii_response,
        framed_busy => framed_busy, framed_wants => framed_wants, framed_may_begin => framed_may_begin,
        framed_subscription => framed_subscription, framed_bii => framed_bii,
        framed_bii_response => framed_bii_response,
        subscription_request => subscription_request, bii_request => asked, bii_response => answered);
  end generate;

  classic_alone : if not has_framed generate
    classic_error        <= rx_error;
    session_open         <= '0';
    classic_may_begin    <= '1';
    classic_valid        <= rx_valid;
    rx_ready             <= classic_ready;
    tx_valid             <= classic_tx_valid;
    classic_tx_ready     <= tx_ready;
    tx_data              <= classic_tx_data;
    tx_last              <= classic_tx_last;
    tx_publish           <= classic_tx_publish;
    subscription_request <= classic_subscription;
    asked                <= classic_bii;
    classic_bii_response <= answered;
  end generate;

  framed_alone : if not has_classic generate
    classic_ready        <= '1';  -- text is nobody's
    framed_may_begin     <= '1';
    tx_valid             <= frame_tx_valid;
    frame_tx_ready       <= tx_ready;
    tx_data              <= frame_tx_data;
    tx_last              <= frame_tx_last;
    tx_publish           <= frame_tx_publish;
    subscription_request <= framed_subscription;
    asked                <= framed_bii;
    framed_bii_response  <= answered;
  end generate;

  -- It stands behind the switch, so that the classic side has nothing to say about it either.
  watched : if has_framed and deadman generate
    dead_man : entity work.dead_man
      generic map (
        address_width => address_width, data_width => data_width, clock_hz => clock_hz, base_hz => base_hz,
        safe_values => safe_values)
      port map (
        clock => clock, reset => reset, request => dead_man_request, response => dead_man_response, tripped => tripped,
        asked => asked, answered => answered, bii_request => bii_request, bii_response => bii_response);
  else generate
    tripped           <= '0';
    dead_man_response <= dead_man_response_idle;
    bii_request       <= asked;
    answered          <= bii_response;
  end generate;

  publishing : if publish_mode > 0 generate
    subscription_manager : entity work.subscription_manager
      generic map (
        address_width => address_width, clock_hz => clock_hz, base_hz => base_hz, groups => groups,
        group_size => group_size, rate_bytes => rate_bytes, edge_events => edge_events)
      port map (
        clock => clock, reset => reset, events => events,
        request => subscription_request, response => subscription_response);
  end generate;

  silence : if publish_mode = 0 generate
    subscription_response <= subscription_response_idle;
  end generate;

end architecture;
