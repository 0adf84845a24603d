// SPDX-License-Identifier: BSD-3-Clause
// The events of a decoder as text, so that tests can compare and print them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "layer1_stream/classic_decoder.hpp"

namespace unitylink::test {

inline std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline std::string hex_of(std::span<const std::uint8_t> data) {
  std::string text;
  for (const std::uint8_t byte : data) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

struct Trace {
  std::string text;
  std::size_t garbage = 0;
  void on_message(const Message& message) {
    static constexpr const char* names[] = {"reply", "error", "datalink", "busy", "checksum", "malformed"};
    text += names[static_cast<int>(message.kind)];
    text += std::string(" ") + (message.head == 0 ? '-' : message.head) + " " + std::string(message.letters) + " " +
            hex_of(message.data) + std::string(message.fields) + " " + std::string(message.error) + " " +
            std::to_string(message.code) + "\n";
  }
  void on_publish(const Publish& publish) {
    text += "publish " + std::to_string(publish.group) + " " + std::to_string(publish.count) +
            (publish.checked ? " checked" : " plain");
    for (const std::uint32_t word : publish.words) {
      text += " " + std::to_string(word);
    }
    text += "\n";
  }
  void on_garbage(std::size_t bytes) {
    garbage += bytes;
    text += "garbage " + std::to_string(bytes) + "\n";
  }
};

}  // namespace unitylink::test
