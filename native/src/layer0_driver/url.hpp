// SPDX-License-Identifier: BSD-3-Clause
// The parts of a link URL: scheme, place and options. The meaning of an option is explained where it is used.
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
  std::string scheme;           // the word before the colon
  const Scheme* row = nullptr;  // the row of this scheme
  std::string path;             // the device file, name or number; with a host, the name behind it
  std::string host;
  std::string port;
  std::vector<std::pair<std::string, std::string>> options;  // in the order of the URL; no name twice

  [[nodiscard]] const std::string* option(std::string_view name) const noexcept;
};

// Splits `text` into its parts. If it is not a link URL, the error is bad_url, and says what is expected.
[[nodiscard]] Outcome parse_url(std::string_view text, Url& url);

// The error bad_url for a URL whose parts are known. `why` says what is wrong.
[[nodiscard]] Outcome wrong_url(const Url& url, const std::string& why);

// Reads a whole number, decimal or 0x…. False: it is not a number, or is above `maximum`.
[[nodiscard]] bool parse_number(std::string_view text, std::uint64_t maximum, std::uint64_t& value) noexcept;

// Reads a time in seconds, from 1e-6 to 3600, and gives it in ns. False: it is not such a time.
[[nodiscard]] bool parse_seconds(std::string_view text, std::uint64_t& ns) noexcept;

}  // namespace unitylink
