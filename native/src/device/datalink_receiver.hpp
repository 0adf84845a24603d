// SPDX-License-Identifier: BSD-3-Clause
// Turns bytes into messages: the ASCII decoder, its checks and its error codes. The smaller datalinks use only parts of
// it.
#pragma once

#include <array>

#include "device/configuration.hpp"
#include "device/message.hpp"
#include "layer1_stream/crc8.hpp"

namespace unitylink::device {

class DatalinkReceiver {
 public:
  explicit DatalinkReceiver(const DeviceConfiguration& configuration);

  struct Taken {
    Clock next = 0;          // when the next byte can be taken
    std::uint8_t error = 0;  // datalink error code, 0 for none
    Clock error_at = 0;      // when the code is given to the transmitter
  };

  // There are two message buffers: while one is executed, the other is filled. No byte can be taken when both are full.
  [[nodiscard]] bool stalled() const noexcept { return complete_ == messages_.size(); }
  Taken take(std::uint8_t byte, Clock now);
  // Drops the message that is being received. Bytes up to the next head are skipped.
  void abandon() noexcept { receiving_ = false; }

  [[nodiscard]] bool has_message() const noexcept { return complete_ > 0; }
  [[nodiscard]] const Message& message() const noexcept { return messages_[first_]; }
  // Call it when the current message is done. Its buffer can be filled from `at` on.
  void release(Clock at) noexcept;
  // When the next byte between messages can be taken. Without meaning while stalled.
  [[nodiscard]] Clock room_at() const noexcept { return receiving_ ? 0 : messages_[first_ ^ complete_].free_at; }

 private:
  Taken fail(std::uint8_t code, Clock now, Clock delay = 0) noexcept;
  Taken begin(bool checked, Clock now) noexcept;
  Taken finish(Clock now) noexcept;
  Taken digit(std::uint8_t value, Clock now);
  Taken take_checked(std::uint8_t byte, Clock now);
  Taken take_unchecked(std::uint8_t byte, Clock now);
  void take_data(std::uint8_t byte, Clock now);
  void hand_on(Clock now) noexcept;
  bool stored() noexcept;  // counts one more entry of the message buffer; false if it is full

  const DeviceConfiguration& configuration_;
  Crc8 checksum_;
  std::uint32_t entries_most_;
  std::array<Message, 2> messages_;
  std::size_t first_ = 0;
  std::size_t complete_ = 0;

  bool receiving_ = false;
  // lite: a character was not a digit; the message that was passed on stays open until the next head
  bool broken_ = false;
  bool star_ = false;
  bool half_ = false;  // the first digit of a pair has come
  std::uint8_t first_digit_ = 0;
  std::uint8_t sum_ = 0;
  std::uint32_t checksum_bytes_ = 0;
  std::uint32_t entries_ = 0;
};

}  // namespace unitylink::device
