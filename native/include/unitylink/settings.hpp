// SPDX-License-Identifier: BSD-3-Clause
// What a device is built with (docs/settings.md).
// Generated from protocol/protocol.toml by protocol/generate.py; edit there.
#pragma once

#include <bitset>
#include <cstdint>
#include <string_view>

namespace unitylink {

// Of a number, both ends included.
struct SettingLimits {
  std::uint32_t least;
  std::uint32_t most;
};

namespace limits_of {
inline constexpr SettingLimits address_bits{1, 32};
inline constexpr SettingLimits data_bits{8, 32};
inline constexpr SettingLimits clock_hz{1000, 1000000000};
inline constexpr SettingLimits base_hz{1, 1000000000};
inline constexpr SettingLimits groups{1, 256};
inline constexpr SettingLimits group_size{1, 255};
inline constexpr SettingLimits rate_bytes{1, 4};
inline constexpr SettingLimits read_many{0, 255};
inline constexpr SettingLimits publish_mode{0, 2};
inline constexpr SettingLimits polynomial{0, 255};
inline constexpr SettingLimits exchanges{0, 4};
inline constexpr SettingLimits exchange_size{1, 122};
inline constexpr SettingLimits window{2, 128};
inline constexpr SettingLimits timeout_clocks{1, 1000000};
inline constexpr SettingLimits request_max{16, 4072};
inline constexpr SettingLimits reply_max{16, 4072};
inline constexpr SettingLimits credit{64, 65535};
inline constexpr SettingLimits cache_bytes{8, 255};
inline constexpr SettingLimits fifo{0, 1048576};
inline constexpr SettingLimits baud_hz{0, 1000000000};
inline constexpr SettingLimits fifo_latency{0, 1000};
inline constexpr SettingLimits node{1, 63};
}  // namespace limits_of

namespace device {

enum class Protocol : std::uint8_t { both, framed, classic };
enum class Datalink : std::uint8_t { full, lite, none };
enum class Checksum : std::uint8_t { crc8, exclusive_or, none };

struct Settings {
  std::uint32_t address_bits = 8;  // bits: width of a word's address
  std::uint32_t data_bits = 32;  // bits: width of a data word
  std::uint32_t clock_hz = 50000000;  // Hz: frequency of the clock
  std::uint32_t base_hz = 1000;  // Hz: base frequency of publishing; two strobes are at least groups + 5 clocks apart
  std::uint32_t groups = 16;  // groups: number of publish groups
  std::uint32_t group_size = 32;  // words: most addresses of a publish group
  std::uint32_t rate_bytes = 2;  // bytes: width of a group's divisor
  std::uint32_t read_many = 255;  // words: most words of a classic read-many; 0: there is no such command
  std::uint32_t publish_mode = 2;  // 0 no publishing, 1 prefers requests, 2 prefers publishes
  bool configuration_command = true;  // the classic command RLC exists
  Protocol protocol = Protocol::both;  // protocols that the device speaks; the design contains no other
  // classic datalink; lite and none check nothing; none sends data as bytes, not as digits
  Datalink datalink = Datalink::full;
  Checksum checksum = Checksum::crc8;  // checksum of the full datalink
  std::uint32_t polynomial = 7;  // polynomial of crc8
  std::bitset<256> edge_events;  // groups whose event is an edge of their event input; for the others it is a level
  std::uint32_t exchanges = 2;  // groups: number of exchange groups of the framed protocol; 0: there are none
  // words: words of an exchange group, in and out; at most 122, 81, 61 or 49 with 1 to 4 address bytes
  std::uint32_t exchange_size = 30;
  bool lists = true;  // the requests LIST and POST_LIST exist
  bool deadman = true;  // the dead-man exists
  // requests: most requests in flight; a power of two, and the number of places in the reply cache
  std::uint32_t window = 64;
  std::uint32_t gateware_version = 65536;  // version that the device reports
  std::uint32_t build = 0;  // number of the build that the device reports
  std::uint64_t spec_hash = 0;  // hash of all that the spec says about the wire; 0: the device reports none
  std::uint32_t request_max = 250;  // bytes: longest payload of a framed request; gateware has the default
  std::uint32_t reply_max = 250;  // bytes: longest payload of a framed reply or publish; gateware has the default
  std::uint32_t credit = 512;  // bytes: most bytes of framed requests without an answer; gateware has the default
  std::uint32_t cache_bytes = 16;  // bytes: most bytes of a reply that is kept for a repeat; gateware has the default
  bool long_frames = false;  // payloads of more than 250 bytes are allowed; gateware has the default
  bool published_2012 = false;  // behaves like the gateware of 2012, with its defects; classic protocol only
  bool bench_memory = false;  // memory starts with the values in the recordings of the 2012 gateware, not with zeros
  std::uint32_t fifo = 0;  // bytes: size of the buffer of the physical layer, in each direction, at least 4; 0: large
  // baud: baud rate of a serial line; 0: there is no line, and bytes are flow-controlled as over USB
  std::uint32_t baud_hz = 0;
  std::uint32_t fifo_latency = 0;  // clocks: delay of a byte in each of these buffers
  bool honour_flush = false;  // a datalink error empties the receive buffer, as in the UART of 2012
};

// Calls visit(name, field) for each of them.
template <class Visit>
void each_setting(Settings& settings, Visit&& visit) {
  visit("address_bits", settings.address_bits);
  visit("data_bits", settings.data_bits);
  visit("clock_hz", settings.clock_hz);
  visit("base_hz", settings.base_hz);
  visit("groups", settings.groups);
  visit("group_size", settings.group_size);
  visit("rate_bytes", settings.rate_bytes);
  visit("read_many", settings.read_many);
  visit("publish_mode", settings.publish_mode);
  visit("configuration_command", settings.configuration_command);
  visit("protocol", settings.protocol);
  visit("datalink", settings.datalink);
  visit("checksum", settings.checksum);
  visit("polynomial", settings.polynomial);
  visit("edge_events", settings.edge_events);
  visit("exchanges", settings.exchanges);
  visit("exchange_size", settings.exchange_size);
  visit("lists", settings.lists);
  visit("deadman", settings.deadman);
  visit("window", settings.window);
  visit("gateware_version", settings.gateware_version);
  visit("build", settings.build);
  visit("spec_hash", settings.spec_hash);
  visit("request_max", settings.request_max);
  visit("reply_max", settings.reply_max);
  visit("credit", settings.credit);
  visit("cache_bytes", settings.cache_bytes);
  visit("long_frames", settings.long_frames);
  visit("published_2012", settings.published_2012);
  visit("bench_memory", settings.bench_memory);
  visit("fifo", settings.fifo);
  visit("baud_hz", settings.baud_hz);
  visit("fifo_latency", settings.fifo_latency);
  visit("honour_flush", settings.honour_flush);
}

// Calls judge(name, value, limits) for each that is a count.
template <class Judge>
void each_limit(const Settings& settings, Judge&& judge) {
  judge("address_bits", settings.address_bits, limits_of::address_bits);
  judge("data_bits", settings.data_bits, limits_of::data_bits);
  judge("clock_hz", settings.clock_hz, limits_of::clock_hz);
  judge("base_hz", settings.base_hz, limits_of::base_hz);
  judge("groups", settings.groups, limits_of::groups);
  judge("group_size", settings.group_size, limits_of::group_size);
  judge("rate_bytes", settings.rate_bytes, limits_of::rate_bytes);
  judge("read_many", settings.read_many, limits_of::read_many);
  judge("publish_mode", settings.publish_mode, limits_of::publish_mode);
  judge("polynomial", settings.polynomial, limits_of::polynomial);
  judge("exchanges", settings.exchanges, limits_of::exchanges);
  judge("exchange_size", settings.exchange_size, limits_of::exchange_size);
  judge("window", settings.window, limits_of::window);
  judge("request_max", settings.request_max, limits_of::request_max);
  judge("reply_max", settings.reply_max, limits_of::reply_max);
  judge("credit", settings.credit, limits_of::credit);
  judge("cache_bytes", settings.cache_bytes, limits_of::cache_bytes);
  judge("fifo", settings.fifo, limits_of::fifo);
  judge("baud_hz", settings.baud_hz, limits_of::baud_hz);
  judge("fifo_latency", settings.fifo_latency, limits_of::fifo_latency);
}

[[nodiscard]] constexpr bool choose(std::string_view text, Protocol& chosen) noexcept {
  if (text == "both") {
    chosen = Protocol::both;
    return true;
  }
  if (text == "framed") {
    chosen = Protocol::framed;
    return true;
  }
  if (text == "classic") {
    chosen = Protocol::classic;
    return true;
  }
  return false;
}

[[nodiscard]] constexpr bool choose(std::string_view text, Datalink& chosen) noexcept {
  if (text == "full") {
    chosen = Datalink::full;
    return true;
  }
  if (text == "lite") {
    chosen = Datalink::lite;
    return true;
  }
  if (text == "none") {
    chosen = Datalink::none;
    return true;
  }
  return false;
}

[[nodiscard]] constexpr bool choose(std::string_view text, Checksum& chosen) noexcept {
  if (text == "crc8") {
    chosen = Checksum::crc8;
    return true;
  }
  if (text == "xor") {
    chosen = Checksum::exclusive_or;
    return true;
  }
  if (text == "none") {
    chosen = Checksum::none;
    return true;
  }
  return false;
}

}  // namespace device
}  // namespace unitylink
