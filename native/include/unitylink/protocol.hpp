// SPDX-License-Identifier: BSD-3-Clause
// The constants of the wire protocols. Generated from protocol/protocol.toml by protocol/generate.py; edit there.
#pragma once

#include <cstdint>
#include <string_view>

namespace unitylink::protocol {

namespace version {
inline constexpr std::string_view name = "unity-link";
inline constexpr std::uint32_t classic_version = 1;
}  // namespace version

namespace bytes {
inline constexpr char plain_head = 0x23;
inline constexpr char checked_head = 0x24;
inline constexpr char plain_publish = 0x25;
inline constexpr char checked_publish = 0x26;
inline constexpr char error_mark = 0x3F;
inline constexpr char data_mark = 0x3A;
inline constexpr char checksum_mark = 0x2A;
inline constexpr char line_feed = 0x0A;
inline constexpr char carriage_return = 0x0D;
inline constexpr char field_separator = 0x2C;
}  // namespace bytes

namespace crc8 {
inline constexpr std::uint8_t polynomial = 0x07;
inline constexpr std::uint8_t initial = 0x00;
inline constexpr std::uint8_t check = 0xF4;
}  // namespace crc8

namespace command {
inline constexpr std::string_view read = "R";
inline constexpr std::string_view read_many = "RM";
inline constexpr std::string_view write = "W";
inline constexpr std::string_view read_configuration = "RLC";
inline constexpr std::string_view write_group_addresses = "WSA";
inline constexpr std::string_view write_group_rate = "WSR";
inline constexpr std::string_view read_group = "RSI";
inline constexpr std::string_view enable_publishing = "EPS";
inline constexpr std::string_view enable_checked_publishing = "EPC";
inline constexpr std::string_view disable_publishing = "DPS";
inline constexpr std::string_view write_event_mask = "WIC";
inline constexpr std::string_view read_event_mask = "RIC";
}  // namespace command

namespace reply {
inline constexpr std::string_view read = "S_R";
inline constexpr std::string_view read_many = "S_RM";
inline constexpr std::string_view write = "S_W";
inline constexpr std::string_view read_configuration = "CNF";
inline constexpr std::string_view write_group_addresses = "S_WSA";
inline constexpr std::string_view write_group_rate = "S_WSR";
inline constexpr std::string_view read_group = "S_RSI";
inline constexpr std::string_view enable_publishing = "S_EPS";
inline constexpr std::string_view enable_checked_publishing = "S_EPC";
inline constexpr std::string_view disable_publishing = "S_DPS";
inline constexpr std::string_view write_event_mask = "S_WIC";
inline constexpr std::string_view read_event_mask = "S_RIC";
inline constexpr std::string_view publish = "PUB";
}  // namespace reply

namespace application_error {
inline constexpr std::string_view incomplete_command = "E_ICC";  // unknown or unfinished command
inline constexpr std::string_view missing_address = "E_MAB";  // address bytes missing
inline constexpr std::string_view missing_data = "E_MDB";  // data, group, rate or mask bytes missing
inline constexpr std::string_view invalid_block_size = "E_IBS";  // read-many count 0 or too large
inline constexpr std::string_view invalid_group_size = "E_ILA";  // address count of a group 0 or too large
inline constexpr std::string_view invalid_group = "E_ISG";  // no such subscription group
inline constexpr std::string_view bus_error_read = "E_FBR";  // bus error on read
inline constexpr std::string_view bus_error_write = "E_FBW";  // bus error on write
inline constexpr std::string_view bus_timeout = "E_BAT";  // nothing on the bus answered
inline constexpr std::string_view publish_vanished = "E_IPR";  // a publish request vanished
}  // namespace application_error

namespace datalink_error {
inline constexpr std::uint8_t message_too_long = 0xF0;  // message too long for the receive buffer
inline constexpr std::uint8_t format = 0xF1;  // framing character where none may stand
inline constexpr std::uint8_t odd_digits = 0xF2;  // odd number of hex digits
inline constexpr std::uint8_t invalid_character = 0xF3;  // invalid character
inline constexpr std::uint8_t checksum = 0xF4;  // checksum wrong or missing
inline constexpr std::uint8_t physical = 0xF5;  // plus 1 parity, 2 framing, 4 overrun: error of the physical layer
}  // namespace datalink_error

namespace limits {
inline constexpr std::uint32_t address_bits_max = 32;
inline constexpr std::uint32_t data_bits_min = 8;
inline constexpr std::uint32_t data_bits_max = 32;
inline constexpr std::uint32_t read_many_max = 255;
inline constexpr std::uint32_t groups_max = 256;
inline constexpr std::uint32_t exchanges_max = 256;
inline constexpr std::uint32_t group_size_max = 255;
inline constexpr std::uint32_t rate_bytes_max = 4;
inline constexpr std::uint32_t groups_2012 = 16;
inline constexpr std::uint32_t group_size_2012 = 32;
inline constexpr std::uint32_t fifo_bytes_default = 16;
inline constexpr std::uint32_t event_mask_bytes_min = 2;
inline constexpr std::uint32_t bus_timeout_clocks = 100;
inline constexpr std::uint32_t clock_hz_default = 50000000;
inline constexpr std::uint32_t base_hz_default = 1000;
}  // namespace limits

namespace latency {
inline constexpr std::uint32_t tick = 11;
inline constexpr std::uint32_t read = 9;
inline constexpr std::uint32_t read_many = 9;
inline constexpr std::uint32_t read_many_word = 3;
inline constexpr std::uint32_t group_addresses = 17;
inline constexpr std::uint32_t group_address = 3;
inline constexpr std::uint32_t read_group = 18;
inline constexpr std::uint32_t read_group_address = 2;
inline constexpr std::uint32_t other = 34;
inline constexpr std::uint32_t publish = 12;
inline constexpr std::uint32_t publish_word = 4;
inline constexpr std::uint32_t publish_words_before = 7;
inline constexpr std::uint32_t turns_most = 3;
}  // namespace latency

namespace framed_latency {
inline constexpr std::uint32_t tick = 19;
inline constexpr std::uint32_t list = 92;
inline constexpr std::uint32_t list_check = 25;
inline constexpr std::uint32_t list_read = 55;
inline constexpr std::uint32_t list_change = 68;
inline constexpr std::uint32_t define_group = 102;
inline constexpr std::uint32_t define_group_address = 6;
inline constexpr std::uint32_t define_exchange = 92;
inline constexpr std::uint32_t define_exchange_word = 18;
inline constexpr std::uint32_t other = 356;
inline constexpr std::uint32_t publish = 22;
inline constexpr std::uint32_t publish_word = 5;
inline constexpr std::uint32_t payload_max = 250;
inline constexpr std::uint32_t frame_bytes = 6;
}  // namespace framed_latency

namespace small_engine {
inline constexpr std::uint32_t request_max = 32;
inline constexpr std::uint32_t reply_max = 76;
inline constexpr std::uint32_t credit = 96;
inline constexpr std::uint32_t cache_bytes = 8;
inline constexpr std::uint32_t window_max = 8;
inline constexpr std::uint32_t byte_clocks_min = 43;
inline constexpr std::uint32_t groups_max = 6;
inline constexpr std::uint32_t group_address_bytes = 23;
inline constexpr std::uint32_t rate_bytes = 2;
inline constexpr std::uint32_t publish_byte_clocks_min = 90;
inline constexpr std::uint32_t publish_period_min = 3000;
}  // namespace small_engine

namespace small_latency {
inline constexpr std::uint32_t tick = 208;
inline constexpr std::uint32_t tick_group = 32;
inline constexpr std::uint32_t tick_address_byte = 6;
inline constexpr std::uint32_t tick_jitter = 120;
inline constexpr std::uint32_t scan = 60;
inline constexpr std::uint32_t request = 3700;
inline constexpr std::uint32_t check = 1300;
inline constexpr std::uint32_t publish = 540;
inline constexpr std::uint32_t publish_word = 66;
inline constexpr std::uint32_t publish_data_byte = 50;
inline constexpr std::uint32_t publish_address_byte = 6;
}  // namespace small_latency

namespace tosnet {
inline constexpr std::uint32_t address_bits = 11;
inline constexpr std::uint32_t memory_words = 1024;
inline constexpr std::uint32_t node_shift = 6;
inline constexpr std::uint32_t register_shift = 3;
inline constexpr std::uint32_t in_bit = 2;
inline constexpr std::uint32_t status = 1024;
inline constexpr std::uint32_t packet_counter = 1025;
inline constexpr std::uint32_t reset_counter = 1026;
inline constexpr std::uint32_t error_counter = 1027;
inline constexpr std::uint32_t network_registers = 1280;
inline constexpr std::uint32_t async_tx_status = 1536;
inline constexpr std::uint32_t async_tx_control = 1537;
inline constexpr std::uint32_t async_tx_data = 1538;
inline constexpr std::uint32_t async_rx_status = 1792;
inline constexpr std::uint32_t async_rx_data = 1794;
inline constexpr std::uint32_t status_online_bit = 31;
inline constexpr std::uint32_t status_master_bit = 30;
inline constexpr std::uint32_t status_packet_error_bit = 29;
inline constexpr std::uint32_t status_system_halt_bit = 28;
inline constexpr std::uint32_t status_network_sync_bit = 27;
inline constexpr std::uint32_t status_node_id_shift = 20;
inline constexpr std::uint32_t status_node_address_shift = 16;
inline constexpr std::uint32_t status_read_error_bit = 8;
inline constexpr std::uint32_t status_write_error_bit = 7;
inline constexpr std::uint32_t status_commit_aborted_bit = 5;
inline constexpr std::uint32_t status_read_pointer_bit = 3;
inline constexpr std::uint32_t status_write_pointer_bit = 2;
inline constexpr std::uint32_t status_read_frozen_bit = 1;
inline constexpr std::uint32_t status_commit_pending_bit = 0;
}  // namespace tosnet

namespace tosnet_ring {
inline constexpr std::uint32_t nodes_max = 15;
inline constexpr std::uint32_t baud_hz = 12500000;
inline constexpr std::uint32_t byte_bits = 10;
inline constexpr std::uint32_t rest_bytes = 18;
inline constexpr std::uint32_t register_bytes = 32;
inline constexpr std::uint32_t hop_bits = 75;
inline constexpr std::uint32_t watchdog_us = 13107;
}  // namespace tosnet_ring

namespace tosnet_wire {
inline constexpr std::uint32_t idle = 60;
inline constexpr std::uint32_t begin = 188;
inline constexpr std::uint32_t first_seed = 85;
inline constexpr std::uint32_t crc_polynomial = 101;
inline constexpr std::uint32_t crc_check = 223;
inline constexpr std::uint32_t wide_crc_polynomial = 4129;
inline constexpr std::uint32_t wide_crc_check = 12739;
inline constexpr std::uint32_t master_discovery = 2;
inline constexpr std::uint32_t master_set = 3;
inline constexpr std::uint32_t network_discovery = 4;
inline constexpr std::uint32_t network_set = 5;
inline constexpr std::uint32_t register_discovery = 6;
inline constexpr std::uint32_t register_set = 7;
inline constexpr std::uint32_t data = 10;
inline constexpr std::uint32_t message_from_master = 9;
inline constexpr std::uint32_t no_message_from_master = 1;
inline constexpr std::uint32_t message_from_node = 10;
inline constexpr std::uint32_t no_message_from_node = 2;
inline constexpr std::uint32_t message_bytes = 12;
}  // namespace tosnet_wire

namespace frame {
inline constexpr std::uint32_t version = 1;
inline constexpr std::uint32_t delimiter = 0;
inline constexpr std::uint32_t device_bit = 64;
inline constexpr std::uint32_t chained_bit = 16;
inline constexpr std::uint32_t barrier_bit = 32;
inline constexpr std::uint32_t operation_mask = 15;
inline constexpr std::uint32_t crc16_polynomial = 33800;
inline constexpr std::uint32_t crc16_check = 28561;
inline constexpr std::uint32_t crc16_bytes = 3;
inline constexpr std::uint32_t crc32_polynomial = 2197175160;
inline constexpr std::uint32_t crc32_check = 486108540;
inline constexpr std::uint32_t crc32_bytes = 5;
inline constexpr std::uint32_t short_max = 256;
inline constexpr std::uint32_t short_payload_max = 250;
inline constexpr std::uint32_t open_epoch = 65535;
inline constexpr std::uint32_t checked_long_flag = 1;
inline constexpr std::uint32_t atomic_flag = 1;
inline constexpr std::uint32_t event_flag = 1;
inline constexpr std::uint32_t window_default = 64;
inline constexpr std::uint32_t cache_bytes_default = 16;
inline constexpr std::uint32_t posts_max = 32767;
}  // namespace frame

namespace rs485 {
inline constexpr std::uint32_t nodes_max = 63;
inline constexpr std::uint32_t poll_bit = 64;
inline constexpr std::uint32_t check_bit = 128;
inline constexpr std::uint32_t check_polynomial = 69;
}  // namespace rs485

namespace request_kind {
inline constexpr std::uint32_t hello = 128;
inline constexpr std::uint32_t open = 129;
inline constexpr std::uint32_t read = 130;
inline constexpr std::uint32_t write = 131;
inline constexpr std::uint32_t post = 132;
inline constexpr std::uint32_t list = 133;
inline constexpr std::uint32_t post_list = 134;
inline constexpr std::uint32_t exchange = 135;
inline constexpr std::uint32_t read_control = 136;
inline constexpr std::uint32_t write_control = 137;
inline constexpr std::uint32_t define_group = 138;
inline constexpr std::uint32_t define_exchange = 139;
inline constexpr std::uint32_t sync = 140;
inline constexpr std::uint32_t close = 141;
}  // namespace request_kind

namespace device_kind {
inline constexpr std::uint32_t reply = 192;
inline constexpr std::uint32_t hello = 208;
inline constexpr std::uint32_t open = 209;
inline constexpr std::uint32_t publish = 210;
inline constexpr std::uint32_t closed = 211;
}  // namespace device_kind

namespace list_operation {
inline constexpr std::uint32_t read = 1;
inline constexpr std::uint32_t read_up = 2;
inline constexpr std::uint32_t read_fifo = 3;
inline constexpr std::uint32_t write = 17;
inline constexpr std::uint32_t write_up = 18;
inline constexpr std::uint32_t write_fifo = 19;
inline constexpr std::uint32_t write_masked = 20;
inline constexpr std::uint32_t add = 21;
}  // namespace list_operation

namespace reply_status {
inline constexpr std::uint32_t ok = 0;
inline constexpr std::uint32_t bus_error = 1;
inline constexpr std::uint32_t bus_timeout = 2;
inline constexpr std::uint32_t bad_address = 3;
inline constexpr std::uint32_t denied = 4;
inline constexpr std::uint32_t busy = 5;
inline constexpr std::uint32_t invalid = 6;
inline constexpr std::uint32_t too_long = 7;
inline constexpr std::uint32_t order = 8;
inline constexpr std::uint32_t behind = 9;
inline constexpr std::uint32_t no_group = 10;
}  // namespace reply_status

namespace control {
inline constexpr std::uint32_t magic = 0;
inline constexpr std::uint32_t version = 1;
inline constexpr std::uint32_t gateware_version = 2;
inline constexpr std::uint32_t build = 3;
inline constexpr std::uint32_t widths = 4;
inline constexpr std::uint32_t clock_hz = 5;
inline constexpr std::uint32_t base_hz = 6;
inline constexpr std::uint32_t features = 7;
inline constexpr std::uint32_t request_credit = 8;
inline constexpr std::uint32_t frame_limits = 9;
inline constexpr std::uint32_t window = 10;
inline constexpr std::uint32_t groups = 11;
inline constexpr std::uint32_t exchanges = 12;
inline constexpr std::uint32_t spec_hash_high = 13;
inline constexpr std::uint32_t spec_hash_low = 14;
inline constexpr std::uint32_t frames = 32;
inline constexpr std::uint32_t discarded_check = 33;
inline constexpr std::uint32_t discarded_kind = 34;
inline constexpr std::uint32_t discarded_session = 35;
inline constexpr std::uint32_t discarded_stale = 36;
inline constexpr std::uint32_t discarded_long = 37;
inline constexpr std::uint32_t duplicates = 38;
inline constexpr std::uint32_t posts = 39;
inline constexpr std::uint32_t posts_ahead = 40;
inline constexpr std::uint32_t posts_old = 41;
inline constexpr std::uint32_t post_errors = 42;
inline constexpr std::uint32_t bus_errors = 43;
inline constexpr std::uint32_t bus_timeouts = 44;
inline constexpr std::uint32_t publishes = 45;
inline constexpr std::uint32_t publish_overruns = 46;
inline constexpr std::uint32_t receive_overruns = 47;
inline constexpr std::uint32_t refused = 48;
inline constexpr std::uint32_t deadman_trips = 49;
inline constexpr std::uint32_t time_low = 64;
inline constexpr std::uint32_t time_high = 65;
inline constexpr std::uint32_t deadman_ticks = 66;
inline constexpr std::uint32_t arm = 67;
inline constexpr std::uint32_t publish = 68;
}  // namespace control

namespace control_value {
inline constexpr std::uint32_t magic = 1431062098;
inline constexpr std::uint32_t feature_classic = 1;
inline constexpr std::uint32_t feature_publishing = 2;
inline constexpr std::uint32_t feature_lists = 4;
inline constexpr std::uint32_t feature_exchanges = 8;
inline constexpr std::uint32_t feature_deadman = 16;
inline constexpr std::uint32_t feature_long_frames = 32;
}  // namespace control_value

namespace serve {
inline constexpr std::uint32_t version = 1;
inline constexpr std::string_view greeting = "unitylink-serve";
inline constexpr std::string_view asking = "ask";
inline constexpr std::uint32_t question_max = 512;
inline constexpr std::string_view admitted = "admitted";
inline constexpr std::string_view refused = "refused";
inline constexpr std::uint32_t login_max = 512;
inline constexpr std::uint32_t not_allowed = 11;
inline constexpr std::uint32_t lease_held = 12;
inline constexpr std::uint32_t stopped_since = 13;
inline constexpr std::uint32_t feature_dated_arm = 32768;
inline constexpr std::uint32_t dated_arm = 32768;
}  // namespace serve

}  // namespace unitylink::protocol
