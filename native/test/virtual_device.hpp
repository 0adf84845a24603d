// SPDX-License-Identifier: BSD-3-Clause
// A classic device on a virtual clock, behind a wire that loses, damages and delays. Tests compare the engine's results
// with what this device has executed, so it is as simple as possible. It has 8-bit addresses and 32-bit words, and
// accepts only checked requests.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "decoder_trace.hpp"
#include "layer1_stream/crc8.hpp"

namespace unitylink::test {

struct Faults {
  double request = 0;  // chance of one fault in a message to the device
  double reply = 0;    // chance of one fault in a message from the device
  double stall = 0;    // chance that a reply, and all after it, is later than the timeout
  bool publishing = false;
};

class VirtualDevice {
 public:
  VirtualDevice(const Faults& faults, std::uint32_t seed) : faults_(faults), random_(seed) {}

  std::map<std::uint32_t, int> executed;  // number of executions of each written value
  bool silent = false;
  std::size_t most_buffered = 0;  // most bytes of complete requests that waited together

  static std::uint32_t value_at(std::uint32_t address) { return 0x9E3779B9u * (address + 1); }

  void receive(std::string_view bytes, std::uint64_t now_ns) {
    if (silent) {
      return;
    }
    std::size_t begin = 0;
    std::size_t lines = 0;
    for (std::size_t index = 0; index < bytes.size(); ++index) {
      if (bytes[index] == '\n') {
        input_ += damaged(std::string(bytes.substr(begin, index + 1 - begin)), faults_.request);
        begin = index + 1;
        ++lines;
      }
    }
    if (lines > 1) {
      most_buffered = std::max(most_buffered, bytes.size());
    }
    input_ += bytes.substr(begin);
    run(now_ns);
  }

  // Returns the bytes that have arrived at the host by now.
  std::string take(std::uint64_t now_ns) {
    std::string text;
    while (!output_.empty() && output_.front().first <= now_ns) {
      text += output_.front().second;
      output_.pop_front();
    }
    return text;
  }
  [[nodiscard]] std::uint64_t next_ns() const { return output_.empty() ? ~std::uint64_t{0} : output_.front().first; }
  void calm() { faults_ = {}; }

 private:
  bool chance(double probability) { return std::uniform_real_distribution<>(0, 1)(random_) < probability; }

  std::string damaged(std::string text, double probability) {
    if (!chance(probability)) {
      return text;
    }
    const std::size_t at = random_() % text.size();
    switch (random_() % 4) {
      case 0: text[at] = static_cast<char>(text[at] ^ (1 << random_() % 8)); break;
      case 1: text.erase(at, 1); break;
      case 2: text.insert(at, 1, text[at]); break;
      default: text.resize(at); break;  // truncated, so the line feed is lost, too
    }
    return text;
  }

  void send(const std::string& text, std::uint64_t now_ns) {
    const std::uint64_t delay = chance(faults_.stall) ? 170'000'000 : 20'000;
    const std::uint64_t earliest = output_.empty() ? 0 : output_.back().first;
    output_.emplace_back(std::max(now_ns + delay, earliest), damaged(text, faults_.reply));
  }

  static std::string message(char head, const std::string& letters, const std::string& data) {
    std::uint8_t sum = Crc8{}.of(bytes_of(letters));
    for (std::size_t index = 0; index + 1 < data.size(); index += 2) {
      sum = Crc8{}.update(sum, static_cast<std::uint8_t>(std::stoul(data.substr(index, 2), nullptr, 16)));
    }
    return head + letters + (data.empty() ? "" : ":" + data) + "*" + hex_of(std::span(&sum, 1)) + "\n";
  }

  static std::string word(std::uint32_t value) {
    const std::uint8_t bytes[] = {static_cast<std::uint8_t>(value >> 24), static_cast<std::uint8_t>(value >> 16),
                                  static_cast<std::uint8_t>(value >> 8), static_cast<std::uint8_t>(value)};
    return hex_of(bytes);
  }

  void datalink_error(const char* code, std::uint64_t now_ns) {
    send(std::string("?") + code + "\n", now_ns);
    message_.clear();
    input_.clear();  // like the 2012 gateware, it drops the requests that it has received after the bad one
  }

  void run(std::uint64_t now_ns) {
    while (!input_.empty()) {
      const char character = input_.front();
      input_.erase(0, 1);
      if (message_.empty()) {
        if (character == '$') {
          message_ = "$";
        } else if (character == '%' || character == '&') {
          datalink_error("f1", now_ns);
        }
      } else if (character == '\n') {
        finish(now_ns);
      } else if (character == '$' || character == '#' || character == '%' || character == '&') {
        datalink_error("f1", now_ns);
      } else {
        message_ += character;
      }
    }
  }

  void finish(std::uint64_t now_ns) {
    std::string text = message_;
    const std::size_t star = text.find('*');
    const std::size_t colon = text.find(':');
    const std::string letters = text.substr(1, std::min(star, colon) - 1);
    const std::string data = colon == std::string::npos || star == std::string::npos || colon > star
                                 ? ""
                                 : text.substr(colon + 1, star - colon - 1);
    for (const char digit : data) {
      if (std::string_view("0123456789ABCDEF").find(digit) == std::string_view::npos) {
        return datalink_error("f3", now_ns);
      }
    }
    if (data.size() % 2 != 0) {
      return datalink_error("f2", now_ns);
    }
    for (const char letter : letters) {
      if (letter < 'A' || letter > 'Z') {
        return datalink_error("f3", now_ns);
      }
    }
    const std::string whole = message('$', letters, data);
    std::string told = text.substr(1) + "\n";
    std::string expected = whole.substr(1);
    for (char& c : told) c = static_cast<char>(c >= 'a' && c <= 'f' ? c - 32 : c);
    for (char& c : expected) c = static_cast<char>(c >= 'a' && c <= 'f' ? c - 32 : c);
    if (star == std::string::npos || told != expected) {
      return datalink_error("f4", now_ns);
    }
    message_.clear();
    if (faults_.publishing) {
      send(message('&', "PUB", "0001" + word(7)), now_ns);
    }
    const auto byte = [&](std::size_t index) {
      return static_cast<std::uint32_t>(std::stoul(data.substr(2 * index, 2), nullptr, 16));
    };
    if (letters == "RLC") {
      send("$CNF:01,04,20,02,03e8,02,10,02*a7\n", now_ns);
    } else if (letters == "R" && data.size() == 2) {
      send(message('$', "S_R", word(value_at(byte(0)))), now_ns);
    } else if (letters == "RM" && data.size() >= 4) {
      std::string words;
      for (std::size_t index = 1; index < data.size() / 2; ++index) {
        words += word(value_at(byte(index)));
      }
      send(message('$', "S_RM", words), now_ns);
    } else if (letters == "W" && data.size() == 10) {
      executed[static_cast<std::uint32_t>(std::stoul(data.substr(2), nullptr, 16))] += 1;
      send("$S_W*f4\n", now_ns);
    } else {
      send("$?E_ICC\n", now_ns);
    }
  }

  Faults faults_;
  std::mt19937 random_;
  std::string input_;
  std::string message_;
  std::deque<std::pair<std::uint64_t, std::string>> output_;
};

}  // namespace unitylink::test
