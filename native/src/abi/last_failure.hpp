// SPDX-License-Identifier: BSD-3-Clause
// The last failure of a thread. It allocates nothing, because there may be no memory. It also has no destructor: to
// register one the C library needs memory, and without memory it ends the program.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "layer2_message/failure.hpp"
#include "unitylink.h"

namespace unitylink {

class LastFailure {
 public:
  static constexpr std::size_t text_bytes_max = 2047;  // a longer text ends with "..."

  void keep(const Outcome& outcome) noexcept {
    keep(static_cast<ul_status>(outcome.status), outcome.text);
    error_.has_address = outcome.has_address ? 1 : 0;
    error_.address = outcome.address;
    error_.index = outcome.index;
    error_.attempts = outcome.attempts;
    error_.elapsed_ns = outcome.elapsed_ns;
  }
  void keep(ul_status status, std::string_view text) noexcept {
    error_ = {};
    error_.status = status;
    constexpr std::string_view more = "...";
    std::size_t bytes = text.size();
    if (bytes > text_bytes_max) {
      bytes = text_bytes_max - more.size();
      // a UTF-8 character must not be cut in the middle
      while (bytes > 0 && (static_cast<std::uint8_t>(text[bytes]) & 0xC0) == 0x80) {
        --bytes;
      }
    }
    char* end = std::copy_n(text.data(), bytes, text_.data());
    if (bytes < text.size()) {
      end = std::copy(more.begin(), more.end(), end);
    }
    *end = 0;
  }

  [[nodiscard]] const ul_error& error() const noexcept { return error_; }
  [[nodiscard]] const char* text() const noexcept { return text_.data(); }

 private:
  ul_error error_{};
  std::array<char, text_bytes_max + 1> text_{};
};

}  // namespace unitylink
