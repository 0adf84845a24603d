// SPDX-License-Identifier: BSD-3-Clause
#include "device/datalink_transmitter.hpp"

#include <algorithm>

#include "layer1_stream/hex.hpp"

namespace unitylink::device {

namespace bytes = protocol::bytes;

namespace {

constexpr std::size_t characters_most = 4;  // a tail with its checksum, or a whole error line

}  // namespace

DatalinkTransmitter::DatalinkTransmitter(const DeviceConfiguration& configuration, PhysicalTransmitter& physical)
    : physical_(physical),
      digits_(configuration.datalink != Datalink::none),
      checksum_(configuration.checksum == Checksum::crc8 ? Crc8(static_cast<std::uint8_t>(configuration.polynomial))
                                                         : Crc8::exclusive_or()) {}

Clock DatalinkTransmitter::word_clock() const noexcept {
  return words_.empty() ? never : std::max(words_.front().at + timing::transmit_latency, free_at_);
}

// A code waits until no message is being sent and none is in the FIFO.
Clock DatalinkTransmitter::error_clock() const noexcept {
  if (errors_.empty() || in_message_) {
    return never;
  }
  const Clock at = std::max(errors_.front().at, free_at_);
  return !words_.empty() && words_.front().at < at ? never : at;
}

Clock DatalinkTransmitter::next_clock() const noexcept {
  return physical_.room() < characters_most ? never : std::min(word_clock(), error_clock());
}

void DatalinkTransmitter::step() noexcept { error_clock() < word_clock() ? send_error() : send_word(); }

void DatalinkTransmitter::character(char c) noexcept {
  physical_.put(c, free_at_);
  free_at_ += timing::transmit_character;
}

void DatalinkTransmitter::hex(std::uint8_t byte) noexcept {
  if (!digits_) {
    character(static_cast<char>(byte));
    return;
  }
  character(lower_digits[byte >> 4]);
  character(lower_digits[byte & 15u]);
}

void DatalinkTransmitter::send_error() noexcept {
  free_at_ = error_clock();
  character(bytes::error_mark);
  hex(errors_.front().code);
  character(bytes::line_feed);
  errors_.pop();
}

void DatalinkTransmitter::send_word() noexcept {
  const Word word = words_.front();
  free_at_ = word_clock();
  place_free_at_ = free_at_ - 1;
  words_.pop();
  switch (word.kind) {
    case Word::Kind::head:
      in_message_ = true;
      checked_ = word.value == static_cast<std::uint8_t>(bytes::checked_head) ||
                 word.value == static_cast<std::uint8_t>(bytes::checked_publish);
      sum_ = protocol::crc8::initial;
      character(static_cast<char>(word.value));
      break;
    case Word::Kind::letter:
      sum_ = checksum_.update(sum_, word.value);
      character(static_cast<char>(word.value));
      break;
    case Word::Kind::mark: character(static_cast<char>(word.value)); break;
    case Word::Kind::data:
      sum_ = checksum_.update(sum_, word.value);
      hex(word.value);
      break;
    case Word::Kind::error_mark:
      checked_ = false;  // a message that ends with an error never has a checksum
      character(bytes::error_mark);
      break;
    case Word::Kind::tail:
      if (checked_) {
        character(bytes::checksum_mark);
        hex(sum_);
      }
      character(bytes::line_feed);
      in_message_ = false;
      break;
  }
}

}  // namespace unitylink::device
