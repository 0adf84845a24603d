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

}  // namespace unitylink::protocol
