// SPDX-License-Identifier: BSD-3-Clause
// A link URL, taken apart: scheme, place and options. What the options mean is said where they are used.
//   serial:/dev/ttyUSB0?baud=3000000    tcp://host:port?crc=1    udp://host:port    fd:7
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "layer0_driver/schemes.hpp"
#include "layer0_driver/status.hpp"

namespace unitylink {

struct Url {
  std::string text;             // as given
  std::string scheme;           // what stands before the colon
  const Scheme* row = nullptr;  // of it
  std::string path;             // the device file, name or number; nothing where there are host and port
  std::string host;
  std::string port;
  std::vector<std::pair<std::string, std::string>> options;  // in the order given, each name once

  [[nodiscard]] const std::string* option(std::string_view name) const noexcept;
};

// Status::bad_url, with what was expected, when the text is not a link URL.
[[nodiscard]] Outcome parse_url(std::string_view text, Url& url);

// Status::bad_url: what is wrong with a URL that was taken apart.
[[nodiscard]] Outcome wrong_url(const Url& url, const std::string& why);

// A whole number, decimal or 0x…; false when it is none or above `maximum`.
[[nodiscard]] bool parse_number(std::string_view text, std::uint64_t maximum, std::uint64_t& value) noexcept;

// Seconds, from 1e-6 to 3600, as ns; false when the text is none.
[[nodiscard]] bool parse_seconds(std::string_view text, std::uint64_t& ns) noexcept;

}  // namespace unitylink
