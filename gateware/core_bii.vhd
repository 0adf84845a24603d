-- SPDX-License-Identifier: BSD-3-Clause
--
-- The Unity-Link core without a bus: one protocol or both on byte streams, requests and publishes on the
-- bus-independent interface. `core` adds a Wishbone master, and `core_axi_lite` an AXI4-Lite one. You may add another.
--
--   rx --> port_splitter --> classic, framed <--> application_switch <--> dead_man <--> bii
--   tx <-- port_joiner   <------+                        |
--                                              subscription_manager <-- events
--
-- Settings  docs/settings.md; core_settings(NAME => VALUE, ...) makes them. A protocol that is not chosen uses no
--           logic.
-- Ports     rx, tx: byte streams, valid/ready/data. tx_last: with the last byte of a message. tx_publish: with all
--           bytes of a publish. rx_error: one-clock pulses of the physical layer (bit 0 parity, 1 framing, 2 overrun).
--           events: one line for each group, synchronous to the clock. bii: see bii_pkg; word addresses.
--           tripped: from the dead-man (dead_man), high from its trip until `arm` or reset; low if there is no
--           dead-man.
-- Latency   From the last byte of a request to the first byte of its reply: 6 clocks. Then one byte per clock, as far
--           as the bus and the reply allow. The figures are in docs/gateware/core.md, and tests/gateware/test_cycles.py
--           checks them.
-- Errors    docs/classic-protocol.md section 4. An error affects only its own message.
-- Pressure  tx_ready stalls replies, then execution, then rx_ready, but never the dead-man. Two requests are kept: the
--           one in execution and the next one.
-- Checksum  "none" also removes checked requests and EPC.
-- Datalink  "lite" and "none" keep nothing: a request is executed while it comes in (docs/gateware/datalink.md).

library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;

use work.bii_pkg.all;
use work.dead_man_pkg.all;
use work.frame_layout_pkg.all;
use work.protocol_pkg.all;
use work.engine_pkg.all;
use work.settings_pkg.all;
use work.subscription_pkg.all;

entity core_bii is
  generic (
    settings    : settings_t    := core_settings;  -- docs/settings.md
    engine      : engine_t      := engine_fast;    -- of the framed protocol: docs/gateware/framed_small.md
    safe_values : safe_values_t := no_safe_values  -- the values that the dead-man writes
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
    events       : in  std_ulogic_vector(settings.groups - 1 downto 0) := (others => '0');
    tripped      : out std_ulogic;
    bii_request  : out bii_request_t;
    bii_response : in  bii_response_t
  );
end entity;

architecture rtl of core_bii is

  constant has_classic : boolean := settings.protocol /= protocol_framed;
  constant has_framed  : boolean := settings.protocol /= protocol_classic;
  constant both        : boolean := has_classic and has_framed;

  -- The streams of each side, if it exists.
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
  signal asked                : bii_request_t;   -- the request to the bus, from the side that has it
  signal answered             : bii_response_t;
  signal dead_man_request     : dead_man_request_t;
  signal dead_man_response    : dead_man_response_t;

begin

  assert not both or settings.datalink = datalink_full
    report "core_bii: with both protocols the classic datalink must be full" severity failure;

  classic_side : if has_classic generate
    classic : entity work.classic
      generic map (settings => settings)
      port map (
        clock => clock, reset => reset,
        rx_valid => classic_valid, rx_ready => classic_ready, rx_data => rx_data, rx_error => classic_error,
        tx_valid => classic_tx_valid, tx_ready => classic_tx_ready, tx_data => classic_tx_data,
        tx_last => classic_tx_last, tx_publish => classic_tx_publish,
        locked => session_open, may_begin => classic_may_begin, busy => classic_busy,
        subscription_request => classic_subscription, subscription_response => subscription_response,
        bii_request => classic_bii, bii_response => classic_bii_response);
  end generate;

  framed_side : if has_framed and engine = engine_fast generate
    framed : entity work.framed
      generic map (settings => settings)
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

  small_side : if has_framed and engine = engine_small generate
    assert not has_classic
      report "core_bii: the small engine has frames alone; set protocol to framed" severity failure;
    session_open        <= '0';
    framed_subscription <= subscription_request_idle;

    framed_small : entity work.framed_small
      generic map (settings => settings)
      port map (
        clock => clock, reset => reset,
        frame_valid => frame_valid, frame_ready => frame_ready, frame_data => rx_data, receive_overrun => rx_error(2),
        tx_valid => frame_tx_valid, tx_ready => frame_tx_ready, tx_data => frame_tx_data, tx_last => frame_tx_last,
        tx_publish => frame_tx_publish, events => events,
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
    -- Errors of the line are reported as text only while text is used, and never between the frames of a session.
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
    classic_ready        <= '1';  -- there is no receiver of text
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

  -- The dead-man stands after the switch, so that it also controls the classic side.
  watched : if has_framed and settings.deadman generate
    dead_man : entity work.dead_man
      generic map (
        address_width => settings.address_bits, data_width => settings.data_bits, clock_hz => settings.clock_hz,
        base_hz => settings.base_hz, safe_values => safe_values)
      port map (
        clock => clock, reset => reset, request => dead_man_request, response => dead_man_response, tripped => tripped,
        asked => asked, answered => answered, bii_request => bii_request, bii_response => bii_response);
  else generate
    tripped           <= '0';
    dead_man_response <= dead_man_response_idle;
    bii_request       <= asked;
    answered          <= bii_response;
  end generate;

  -- The small engine publishes by itself.
  publishing : if settings.publish_mode > 0 and engine = engine_fast generate
    subscription_manager : entity work.subscription_manager
      generic map (
        address_width => settings.address_bits, clock_hz => settings.clock_hz, base_hz => settings.base_hz,
        groups => settings.groups, group_size => settings.group_size, rate_bytes => settings.rate_bytes,
        edge_events => settings.edge_events)
      port map (
        clock => clock, reset => reset, events => events,
        request => subscription_request, response => subscription_response);
  end generate;

  silence : if settings.publish_mode = 0 or engine = engine_small generate
    subscription_response <= subscription_response_idle;
  end generate;

end architecture;
