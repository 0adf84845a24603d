// SPDX-License-Identifier: BSD-3-Clause
// The receiver of the datalinks lite and none, which check nothing (docs/gateware/datalink.md).
#include "device/characters.hpp"
#include "device/datalink_receiver.hpp"
#include "device/requests.hpp"
#include "layer1_stream/hex.hpp"

namespace unitylink::device {

namespace bytes = protocol::bytes;

namespace {

constexpr std::size_t letters_most = 4;  // no command has more than three

}  // namespace

// Gives the current message to the application. It may still be incomplete.
void DatalinkReceiver::hand_on(Clock now) noexcept {
  messages_[first_ ^ complete_].ready_at = now + timing::message_ready;
  receiving_ = false;
  ++complete_;
}

void DatalinkReceiver::take_data(std::uint8_t byte, Clock now) {
  Message& message = messages_[first_ ^ complete_];
  if (entries_++ < entries_most_) {  // no request uses more
    message.data.push_back(byte);
  }
  const std::string_view letters(message.letters.data(), message.letters.size());
  if (configuration_.datalink == Datalink::none &&
      entries_ >= data_bytes_needed(configuration_, letters, message.data)) {
    hand_on(now);
  }
}

DatalinkReceiver::Taken DatalinkReceiver::take_unchecked(std::uint8_t byte, Clock now) {
  const char c = static_cast<char>(byte);
  const bool digits = configuration_.datalink == Datalink::lite;
  const Taken taken{now + timing::receive_character};
  Message& message = messages_[first_ ^ complete_];
  if (broken_) {
    if (is_head(c)) {  // this head ends the open message, but does not begin another
      broken_ = false;
      for (Message& handed_on : messages_) {
        handed_on.ready_at = handed_on.open ? now : handed_on.ready_at;
        handed_on.open = false;
      }
    }
  } else if (c == bytes::plain_head && !(receiving_ && message.colon)) {
    begin(false, now);
  } else if (!receiving_) {
    if (digits && is_head(c)) {
      return fail(protocol::datalink_error::format, now);
    }
  } else if (!message.colon) {
    if (is_end(c)) {
      hand_on(now);
    } else if (c == bytes::data_mark) {
      message.colon = true;
      entries_ = 0;  // counts data bytes from here
      const std::string_view letters(message.letters.data(), message.letters.size());
      if (!digits && data_bytes_needed(configuration_, letters, {}) == 0) {
        hand_on(now);
      }
    } else if (is_letter(c)) {
      if (message.letters.size() < letters_most) {
        message.letters.push_back(static_cast<char>(c & ~0x20));
      }
    } else if (!is_separator(c)) {
      receiving_ = false;
    }
  } else if (!digits) {
    take_data(byte, now);
  } else if (is_end(c) || is_head(c)) {
    hand_on(now);
  } else if (const std::uint8_t value = digit_value(c); value != not_a_digit) {
    if (half_) {
      take_data(static_cast<std::uint8_t>(first_digit_ << 4 | value), now);
    }
    half_ = !half_;
    first_digit_ = value;
  } else if (!is_separator(c)) {
    message.open = broken_ = true;
    hand_on(now);
  }
  return taken;
}

}  // namespace unitylink::device
