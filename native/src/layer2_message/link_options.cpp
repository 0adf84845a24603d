// SPDX-License-Identifier: BSD-3-Clause
#include "layer2_message/link_options.hpp"

#include <algorithm>
#include <charconv>
#include <string>

#include "unitylink/settings.hpp"

namespace unitylink {
namespace {

using Overrides = std::optional<std::uint32_t> LinkOptions::*;

struct Override {
  const char* name;
  Overrides field;
  SettingLimits limits;
};

constexpr Override overrides[] = {
    {"address_bytes", &LinkOptions::address_bytes, {1, limits_of::address_bits.most / 8}},
    {"data_bytes", &LinkOptions::data_bytes, {1, limits_of::data_bits.most / 8}},
    {"read_many", &LinkOptions::read_many, limits_of::read_many},
    {"publish_mode", &LinkOptions::publish_mode, limits_of::publish_mode},
    {"base_hz", &LinkOptions::base_hz, limits_of::base_hz},
    {"groups", &LinkOptions::groups, limits_of::groups},
    {"group_size", &LinkOptions::group_size, limits_of::group_size},
    {"rate_bytes", &LinkOptions::rate_bytes, limits_of::rate_bytes},
};

// longer would take processor time from the program that should reply
constexpr std::uint64_t spin_most_ns = 10'000'000;

// `plant`, `root`, `board` and `spec` are read in simulate/simulated.py, which makes virtual boards.
constexpr const char* of_every_link =
    "protocol, timeout, attempts, deadman, spec_hash, fifo, crc, polynomial, window, publish_crc, gateware, reconnect, "
    "wait, spin, trace, "
    "address_bytes, data_bytes, read_many, base_hz, groups, group_size, rate_bytes, publish_mode, plant and root (sim, "
    "rtl, bit), board and spec (bit)";

// The options of a scheme as a part of a sentence. `last` is the word before the last one.
std::string listed(const Scheme& scheme, const char* last) {
  const std::vector<std::string_view> names = scheme.option_names();
  std::string words;
  for (const std::string_view& option : names) {
    words += (words.empty() ? "" : &option == &names.back() ? last : ", ") + std::string(option);
  }
  return words;
}

std::string known_options() {
  std::string known = std::string("known are ") + of_every_link;
  for (const Scheme* scheme : schemes()) {
    known += scheme->options.empty() ? "" : ", " + listed(*scheme, " and ") + " (" + std::string(scheme->name) + ")";
  }
  return known;
}

Outcome wrong(const Url& url, const std::string& name, const std::string& value, const std::string& expected) {
  return wrong_url(url, name + "=" + value + " is not " + expected);
}

bool number_in(const std::string& text, std::uint64_t minimum, std::uint64_t maximum, std::uint32_t& value) noexcept {
  std::uint64_t number = 0;
  if (!parse_number(text, maximum, number) || number < minimum) {
    return false;
  }
  value = static_cast<std::uint32_t>(number);
  return true;
}

bool fifo(const std::string& text, EngineSettings& engine) noexcept {
  const std::size_t comma = text.find(',');
  const std::string receive = text.substr(0, comma);
  const std::string transmit = comma == std::string::npos ? receive : text.substr(comma + 1);
  return number_in(receive, 1, 1u << 24, engine.receive_fifo_bytes) &&
         number_in(transmit, 1, 1u << 24, engine.transmit_fifo_bytes);
}

Outcome parse_option(const Url& url, const std::string& name, const std::string& value, LinkOptions& options) {
  std::uint32_t number = 0;
  if (name == "timeout") {
    return parse_seconds(value, options.engine.timeout_ns)
               ? Outcome{}
               : wrong(url, name, value, "a time in seconds from 1e-6 to 3600");
  }
  if (name == "attempts") {
    return number_in(value, 1, 1000, options.attempts) ? Outcome{} : wrong(url, name, value, "a count from 1 to 1000");
  }
  if (name == "fifo") {
    return fifo(value, options.engine) ? Outcome{}
                                       : wrong(url, name, value, "a size in bytes, or two: RX,TX of the device");
  }
  if (name == "window") {
    return number_in(value, 1, 65536, options.engine.window) ? Outcome{}
                                                             : wrong(url, name, value, "a count from 1 to 65536");
  }
  if (name == "polynomial") {
    if (value == "xor") {
      options.engine.sum = Crc8::exclusive_or();
      return {};
    }
    if (value == "none") {
      options.engine.checksums = false;
      return {};
    }
    if (!number_in(value, 1, 255, number)) {
      return wrong(url, name, value, "a CRC-8 polynomial such as 0x07, or xor, or none: the gateware has no checksums");
    }
    options.engine.sum = Crc8(static_cast<std::uint8_t>(number));
    return {};
  }
  if (name == "crc" || name == "publish_crc" || name == "reconnect") {
    if (!number_in(value, 0, 1, number)) {
      return wrong(url, name, value, "0 or 1");
    }
    (name == "crc" ? options.checked : name == "reconnect" ? options.reconnect : options.publish_checked) = number == 1;
    return {};
  }
  if (name == "wait") {
    return parse_seconds(value, options.wait_ns) ? Outcome{}
                                                 : wrong(url, name, value, "a time in seconds from 1e-6 to 3600");
  }
  if (name == "spin") {
    if (value == "0") {
      options.spin_ns = 0;
      return {};
    }
    return parse_seconds(value, options.spin_ns) && options.spin_ns <= spin_most_ns
               ? Outcome{}
               : wrong(url, name, value, "0, or a time in seconds from 1e-6 to 0.01");
  }
  if (name == "protocol") {
    if (value != "auto" && value != "classic" && value != "framed") {
      return wrong(url, name, value, "auto, classic or framed");
    }
    options.protocol = value == "auto"      ? Protocol::automatic
                       : value == "classic" ? Protocol::classic
                                            : Protocol::framed;
    return {};
  }
  if (name == "deadman") {
    std::uint64_t ns = 0;
    if (!parse_seconds(value, ns)) {
      return wrong(url, name, value, "a time in seconds from 1e-6 to 3600");
    }
    options.deadman_s = static_cast<double>(ns) * 1e-9;
    return {};
  }
  if (name == "spec_hash") {
    if (value == "any") {
      options.any_spec = true;
      return {};
    }
    std::uint64_t hash = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), hash, 16);
    if (value.empty() || error != std::errc{} || stop != value.data() + value.size()) {
      return wrong(url, name, value, "a hash of at most 16 hex digits, or any");
    }
    options.spec_hash = hash;
    return {};
  }
  if (name == "gateware") {
    if (value != "auto" && value != "2012" && value != "corrected") {
      return wrong(url, name, value, "auto, 2012 or corrected");
    }
    options.gateware = value == "auto"   ? Gateware::automatic
                       : value == "2012" ? Gateware::published_2012
                                         : Gateware::corrected;
    return {};
  }
  for (const Override& entry : overrides) {
    if (name == entry.name) {
      if (!number_in(value, entry.limits.least, entry.limits.most, number)) {
        return wrong(
            url, name, value,
            "a number from " + std::to_string(entry.limits.least) + " to " + std::to_string(entry.limits.most));
      }
      options.*entry.field = number;
      return {};
    }
  }
  if (name == "trace" || url.row->takes(name)) {
    return {};  // it belongs to the driver
  }
  return wrong_url(url, "no option '" + name + "'; " + known_options());
}

// The error for the first option that a scheme without a protocol does not have.
Outcome refused_option(const Url& url) {
  for (const auto& [name, value] : url.options) {
    if (!url.row->takes(name)) {
      return wrong_url(
          url, name + " means nothing to mapped memory, which has no protocol; there are: " + listed(*url.row, ", "));
    }
  }
  return {};
}

}  // namespace

Outcome parse_options(const Url& url, LinkOptions& options) {
  options.engine.checked_long = url.row->loses_order;
  if (url.row->framed_only) {
    options.protocol = Protocol::framed;
  }
  if (!url.row->stream) {  // its own options are read when it is opened
    return refused_option(url);
  }
  for (const auto& [name, value] : url.options) {
    if (Outcome outcome = parse_option(url, name, value, options); !outcome.ok()) {
      return outcome;
    }
  }
  if (options.reconnect && url.row->once) {
    return wrong_url(
        url, "a descriptor cannot be opened again once it is gone; reconnect=1 is for the schemes that name a place");
  }
  if (options.wait_ns > 0 && !options.reconnect) {
    return wrong_url(url, "wait= is for a line that comes back; add reconnect=1");
  }
  if (!options.engine.checksums && options.protocol == Protocol::framed) {
    return wrong_url(url, "polynomial=none is for gateware of the classic protocol; frames always have a checksum");
  }
  if (!options.engine.checksums && options.checked) {
    return wrong_url(
        url, "crc=1 asks for the checksums that polynomial=none says the gateware has not; leave one of them out");
  }
  if (url.row->framed_only && options.protocol != Protocol::framed) {
    return wrong_url(url, url.scheme + ": carries the framed protocol only; leave protocol= out");
  }
  return {};
}

Outcome settle_configuration(const LinkOptions& options, const std::optional<Configuration>& reported,
                             Configuration& configuration) {
  if (reported) {
    configuration = *reported;
    const std::uint64_t told[] = {configuration.address_bytes, configuration.data_bytes, configuration.read_many,
                                  configuration.publish_mode,  configuration.base_hz,    configuration.groups,
                                  configuration.group_size,    configuration.rate_bytes};
    for (std::size_t index = 0; index < std::size(overrides); ++index) {
      const auto& given = options.*overrides[index].field;
      if (given && *given != told[index]) {
        return {Status::mismatch, std::string("the URL says ") + overrides[index].name + "=" + std::to_string(*given) +
                                      ", the device reports " + std::to_string(told[index]) +
                                      "; is this the right device?"};
      }
    }
    return {};
  }
  if (!options.address_bytes || !options.data_bytes) {
    return {Status::mismatch,
            "the device does not report its configuration (it has no RLC command); add ?address_bytes=…&data_bytes=… "
            "to the URL, and "
            "read_many= publish_mode= base_hz= groups= group_size= rate_bytes= for what the gateware has beyond single "
            "reads and writes"};
  }
  const bool publishing = options.groups.has_value() || options.publish_mode.value_or(0) > 0;
  configuration = {
      .address_bytes = *options.address_bytes,
      .data_bytes = *options.data_bytes,
      .read_many = options.read_many.value_or(0),
      .publish_mode = options.publish_mode.value_or(publishing ? 2 : 0),
      .base_hz = options.base_hz.value_or(protocol::limits::base_hz_default),
      .groups = options.groups.value_or(publishing ? 1 : 0),
      .group_size = options.group_size.value_or(publishing ? 4 : 0),
      .rate_bytes = options.rate_bytes.value_or(2),
      .discovered = false,
  };
  return {};
}

}  // namespace unitylink
