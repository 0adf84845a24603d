// SPDX-License-Identifier: BSD-3-Clause
#include "device/datalink_receiver.hpp"

#include <algorithm>

#include "device/characters.hpp"
#include "layer1_stream/hex.hpp"

namespace unitylink::device {

namespace bytes = protocol::bytes;
namespace datalink_error = protocol::datalink_error;

DatalinkReceiver::DatalinkReceiver(const DeviceConfiguration& configuration)
    : configuration_(configuration),
      checksum_(configuration.checksum == Checksum::crc8 ? Crc8(static_cast<std::uint8_t>(configuration.polynomial))
                                                         : Crc8::exclusive_or()),
      entries_most_(configuration.message_entries()) {
  for (Message& message : messages_) {
    message.letters.reserve(entries_most_);
    message.data.reserve(entries_most_);
  }
}

void DatalinkReceiver::release(Clock at) noexcept {
  messages_[first_].free_at = at;
  first_ ^= 1u;
  --complete_;
  messages_[first_].ready_at = std::max(messages_[first_].ready_at, at);
}

DatalinkReceiver::Taken DatalinkReceiver::fail(std::uint8_t code, Clock now, Clock delay) noexcept {
  receiving_ = false;
  const bool misplaced = code == datalink_error::format || code == datalink_error::odd_digits;
  return {now + (misplaced ? timing::receive_misplaced : timing::receive_invalid), code, now + delay};
}

bool DatalinkReceiver::stored() noexcept { return ++entries_ < entries_most_; }

DatalinkReceiver::Taken DatalinkReceiver::begin(bool checked, Clock now) noexcept {
  Message& message = messages_[first_ ^ complete_];
  message.checked = checked;
  message.colon = false;
  message.open = false;
  message.letters.clear();
  message.data.clear();
  receiving_ = true;
  star_ = half_ = false;
  sum_ = protocol::crc8::initial;
  checksum_bytes_ = 0;
  entries_ = 1;
  return {now + timing::receive_character};
}

DatalinkReceiver::Taken DatalinkReceiver::finish(Clock now) noexcept {
  Message& message = messages_[first_ ^ complete_];
  Clock delay = timing::message_ready;
  if (message.checked && configuration_.published_2012) {  // it checks only that the remainder is 0
    if (sum_ != 0 || configuration_.checksum == Checksum::none) {
      return fail(datalink_error::checksum, now, timing::receive_first_digit);
    }
    delay += timing::checksum_verdict;
  } else if (message.checked) {
    // Exactly one checksum byte after a star. The only exception is the empty message with an empty checksum, `$*`.
    const bool empty = checksum_bytes_ == 0 && message.letters.empty() && message.data.empty();
    if (!star_ || sum_ != 0 || (checksum_bytes_ != 1 && !empty)) {
      return fail(datalink_error::checksum, now, timing::receive_first_digit);
    }
    delay += timing::checksum_verdict;
  }
  message.ready_at = now + delay;
  receiving_ = false;
  ++complete_;
  return {now + timing::receive_character + delay - timing::message_ready};
}

DatalinkReceiver::Taken DatalinkReceiver::digit(std::uint8_t value, Clock now) {
  if (!half_) {
    half_ = true;
    first_digit_ = value;
    return {now + timing::receive_first_digit};
  }
  half_ = false;
  Message& message = messages_[first_ ^ complete_];
  const auto byte = static_cast<std::uint8_t>(first_digit_ << 4 | value);
  sum_ = checksum_.update(sum_, byte);
  if (star_) {
    checksum_bytes_ += checksum_bytes_ < 2 ? 1u : 0u;
  } else {
    if (!stored()) {
      return fail(datalink_error::message_too_long, now, timing::receive_first_digit);
    }
    message.data.push_back(byte);
  }
  return {now + timing::receive_second_digit};
}

DatalinkReceiver::Taken DatalinkReceiver::take(std::uint8_t byte, Clock now) {
  return configuration_.datalink == Datalink::full ? take_checked(byte, now) : take_unchecked(byte, now);
}

DatalinkReceiver::Taken DatalinkReceiver::take_checked(std::uint8_t byte, Clock now) {
  const char c = static_cast<char>(byte);
  if (!receiving_) {
    if (c == bytes::checked_head && configuration_.checksum == Checksum::none && !configuration_.published_2012) {
      return fail(datalink_error::format, now);
    }
    if (c == bytes::plain_head || c == bytes::checked_head) {
      return begin(c == bytes::checked_head, now);
    }
    return is_head(c) ? fail(datalink_error::format, now) : Taken{now + timing::receive_skipped};
  }
  Message& message = messages_[first_ ^ complete_];
  if (half_ && digit_value(c) == not_a_digit) {
    const bool framing = is_head(c) || is_end(c) || c == bytes::data_mark || c == bytes::checksum_mark;
    return fail(framing ? datalink_error::odd_digits : datalink_error::invalid_character, now);
  }
  if (is_end(c)) {
    return finish(now);
  }
  if (is_separator(c)) {
    return {now + timing::receive_separator};
  }
  if (is_head(c) || (c == bytes::data_mark && (message.colon || star_)) ||
      (c == bytes::checksum_mark && (!message.checked || star_))) {
    return fail(datalink_error::format, now);
  }
  if (c == bytes::checksum_mark) {
    star_ = true;
    return {now + timing::receive_character};
  }
  if (c == bytes::data_mark) {
    message.colon = true;
    return stored() ? Taken{now + timing::receive_character}
                    : fail(datalink_error::message_too_long, now, timing::receive_first_digit);
  }
  if (message.colon || star_) {
    const std::uint8_t value = digit_value(c);
    return value == not_a_digit ? fail(datalink_error::invalid_character, now) : digit(value, now);
  }
  if (!is_letter(c)) {
    return fail(datalink_error::invalid_character, now);
  }
  if (!stored()) {
    return fail(datalink_error::message_too_long, now, timing::receive_first_digit);
  }
  // over the letter as sent, because upper and lower case have different checksums
  sum_ = checksum_.update(sum_, byte);
  message.letters.push_back(static_cast<char>(c & ~0x20));
  return {now + timing::receive_character};
}

}  // namespace unitylink::device
