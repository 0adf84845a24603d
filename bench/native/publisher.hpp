// SPDX-License-Identifier: BSD-3-Clause
// A classic device with only what a host needs to subscribe. Its publishes can be checked: each word is the number of
// the message, so a lost, doubled or swapped one is detected.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "layer1_stream/crc8.hpp"
#include "layer1_stream/hex.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink::bench {

class Publisher {
 public:
  static constexpr std::size_t line_bytes = 21;  // &PUB:ggnnxxxxxxxx*hh and the line feed

  explicit Publisher(std::uint32_t base_hz) : base_hz_(base_hz) {}

  // For a new client, nothing is subscribed.
  void reset() { *this = Publisher(base_hz_); }

  // Takes bytes of requests in chunks of any size, and appends the replies.
  void receive(std::string_view bytes, std::string& out) {
    for (const char byte : bytes) {
      const bool head = byte == protocol::bytes::plain_head || byte == protocol::bytes::checked_head;
      if (line_.empty() && !head) {
        continue;  // bytes outside a message are skipped up to the next head
      }
      if (byte == protocol::bytes::line_feed || byte == protocol::bytes::carriage_return) {
        answer(out);
        line_.clear();
      } else {
        line_.push_back(byte);
      }
    }
  }

  [[nodiscard]] static std::size_t publish_bytes() { return line_bytes; }
  [[nodiscard]] bool publishing() const { return enabled_ && group_ < groups; }

  // Appends `count` publishes of one word each.
  void publish(std::size_t count, std::string& out) {
    std::array<char, line_bytes> message{};
    for (; count > 0; --count, ++sequence_) {
      std::array<std::uint8_t, 9> covered{'P',
                                          'U',
                                          'B',
                                          static_cast<std::uint8_t>(group_),
                                          1,
                                          static_cast<std::uint8_t>(sequence_ >> 24),
                                          static_cast<std::uint8_t>(sequence_ >> 16),
                                          static_cast<std::uint8_t>(sequence_ >> 8),
                                          static_cast<std::uint8_t>(sequence_)};
      char* at = message.data();
      *at++ = checked_ ? protocol::bytes::checked_publish : protocol::bytes::plain_publish;
      for (const char letter : protocol::reply::publish) {
        *at++ = letter;
      }
      *at++ = protocol::bytes::data_mark;
      for (std::size_t i = 3; i < covered.size(); ++i) {
        at = hex(covered[i], at);
      }
      if (checked_) {
        *at++ = protocol::bytes::checksum_mark;
        at = hex(crc_.of(covered), at);
      }
      *at++ = protocol::bytes::line_feed;
      out.append(message.data(), at);
    }
  }

 private:
  static constexpr std::size_t groups = 16;
  static constexpr std::size_t group_size = 32;
  static constexpr std::size_t address_bytes = 2;
  static constexpr std::size_t rate_bytes = 2;
  using Bytes = std::vector<std::uint8_t>;

  static char* hex(std::uint8_t byte, char* at) {
    *at++ = lower_digits[byte >> 4];
    *at++ = lower_digits[byte & 15];
    return at;
  }

  void send(std::string_view letters, const Bytes& data, bool separated, std::string& out) const {
    out.push_back(line_.front());
    out.append(letters);
    std::uint8_t sum = protocol::crc8::initial;
    for (const char letter : letters) {
      sum = crc_.update(sum, static_cast<std::uint8_t>(letter));
    }
    char mark = protocol::bytes::data_mark;
    for (std::size_t i = 0; i < data.size(); ++i) {
      // commas separate the fields of CNF; bytes 4 to 6 are one field, the base frequency
      if (i == 0 || (separated && i != 5 && i != 6)) {
        out.push_back(mark);
        mark = protocol::bytes::field_separator;
      }
      std::array<char, 2> digits{};
      hex(data[i], digits.data());
      out.append(digits.data(), digits.size());
      sum = crc_.update(sum, data[i]);
    }
    if (line_.front() == protocol::bytes::checked_head) {
      std::array<char, 2> digits{};
      hex(sum, digits.data());
      out.push_back(protocol::bytes::checksum_mark);
      out.append(digits.data(), digits.size());
    }
    out.push_back(protocol::bytes::line_feed);
  }

  void datalink_error(std::uint8_t code, std::string& out) const {
    std::array<char, 2> digits{};
    hex(code, digits.data());
    out.push_back(protocol::bytes::error_mark);
    out.append(digits.data(), digits.size());
    out.push_back(protocol::bytes::line_feed);
  }

  void application_error(std::string_view code, std::string& out) const {
    out.push_back(line_.front());
    out.push_back(protocol::bytes::error_mark);
    out.append(code);
    out.push_back(protocol::bytes::line_feed);
  }

  // Checks the sum, splits the line into letters and data bytes, and executes the request.
  void answer(std::string& out) {
    const std::string_view body = std::string_view(line_).substr(1);
    std::string letters;
    Bytes data;
    std::uint8_t sum = protocol::crc8::initial;
    std::uint8_t high = not_a_digit;
    bool in_data = false;
    for (const char byte : body) {
      if (byte == protocol::bytes::data_mark || byte == protocol::bytes::checksum_mark) {
        in_data = true;
      } else if (!in_data) {
        letters.push_back(byte);
        sum = crc_.update(sum, static_cast<std::uint8_t>(byte));
      } else if (const auto digit = digit_value(byte); digit == not_a_digit) {
        return datalink_error(protocol::datalink_error::invalid_character, out);
      } else if (high == not_a_digit) {
        high = digit;
      } else {
        data.push_back(static_cast<std::uint8_t>(high << 4 | digit));
        sum = crc_.update(sum, data.back());
        high = not_a_digit;
      }
    }
    if (high != not_a_digit) {
      return datalink_error(protocol::datalink_error::odd_digits, out);
    }
    if (line_.front() == protocol::bytes::checked_head) {
      if (sum != 0) {
        return datalink_error(protocol::datalink_error::checksum, out);
      }
      if (!data.empty()) {
        data.pop_back();
      }
    }
    execute(letters, data, out);
  }

  void execute(std::string_view letters, const Bytes& data, std::string& out) {
    namespace command = protocol::command;
    namespace reply = protocol::reply;
    namespace error = protocol::application_error;
    const bool of_group = letters == command::write_group_addresses || letters == command::write_group_rate ||
                          letters == command::read_group;
    if (of_group && data.empty()) {
      application_error(error::missing_data, out);
    } else if (of_group && data[0] >= groups) {
      application_error(error::invalid_group, out);
    } else if (letters == command::read_configuration) {
      const auto base = [this](int shift) { return static_cast<std::uint8_t>(base_hz_ >> shift); };
      send(reply::read_configuration,
           {address_bytes, 4, 0, 2, base(16), base(8), base(0), groups, group_size, rate_bytes}, true, out);
    } else if (letters == command::read) {
      data.size() < address_bytes ? application_error(error::missing_address, out)
                                  : send(reply::read, {0, 0, 0, 0}, false, out);
    } else if (letters == command::write_group_addresses) {
      if (data.size() < 2 || data.size() < 2 + address_bytes * data[1]) {
        application_error(error::missing_address, out);
      } else if (data[1] != 1) {
        application_error(error::invalid_group_size, out);  // this stream has one word in each message
      } else {
        addresses_[data[0]].assign(data.begin() + 1, data.begin() + 2 + address_bytes);
        send(reply::write_group_addresses, {}, false, out);
      }
    } else if (letters == command::write_group_rate) {
      if (data.size() < 1 + rate_bytes) {
        return application_error(error::missing_data, out);
      }
      const bool on = (data[1] | data[2]) != 0 && !addresses_[data[0]].empty();
      group_ = on ? data[0] : group_ == data[0] ? groups : group_;
      rates_[data[0]] = {data[1], data[2]};
      send(reply::write_group_rate, {}, false, out);
    } else if (letters == command::read_group) {
      Bytes answer{rates_[data[0]][0], rates_[data[0]][1]};
      answer.insert(answer.end(), addresses_[data[0]].begin(), addresses_[data[0]].end());
      if (addresses_[data[0]].empty()) {
        answer.push_back(0);
      }
      send(reply::read_group, answer, false, out);
    } else if (letters == command::enable_publishing || letters == command::enable_checked_publishing) {
      checked_ = letters == command::enable_checked_publishing;
      enabled_ = true;
      send(checked_ ? reply::enable_checked_publishing : reply::enable_publishing, {}, false, out);
    } else if (letters == command::disable_publishing) {
      enabled_ = false;
      send(reply::disable_publishing, {}, false, out);
    } else if (letters == command::write_event_mask) {
      send(reply::write_event_mask, {}, false, out);
    } else {
      application_error(error::incomplete_command, out);
    }
  }

  std::uint32_t base_hz_;
  Crc8 crc_{};
  std::string line_;
  std::array<Bytes, groups> addresses_{};  // count and addresses as received; empty if never written
  std::array<std::array<std::uint8_t, rate_bytes>, groups> rates_{};
  std::size_t group_ = groups;  // the group that is published
  std::uint32_t sequence_ = 0;
  bool enabled_ = false;
  bool checked_ = false;
};

}  // namespace unitylink::bench
