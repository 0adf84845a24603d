// SPDX-License-Identifier: BSD-3-Clause
// Turns words of the application and datalink error codes into bytes. The two never mix within a message.
#pragma once

#include "device/configuration.hpp"
#include "device/message.hpp"
#include "device/physical.hpp"
#include "device/ring.hpp"
#include "layer1_stream/crc8.hpp"

namespace unitylink::device {

class DatalinkTransmitter {
 public:
  DatalinkTransmitter(const DeviceConfiguration& configuration, PhysicalTransmitter& physical);

  [[nodiscard]] bool full() const noexcept { return words_.full(); }
  void push(Word word) noexcept { words_.push(word); }
  // True: no message is being sent, and no error code waits.
  [[nodiscard]] bool idle() const noexcept { return words_.empty() && errors_.empty() && !in_message_; }
  // From when the newest free place in a full FIFO can be used.
  [[nodiscard]] Clock place_free_at() const noexcept { return place_free_at_; }

  [[nodiscard]] bool errors_full() const noexcept { return errors_.full(); }
  void report(std::uint8_t code, Clock at) noexcept { errors_.push({at + timing::error_latency, code}); }

  // When the next character is sent. `never` if there is none, or if the physical FIFO has no room.
  [[nodiscard]] Clock next_clock() const noexcept;
  void step() noexcept;

 private:
  struct ErrorCode {
    Clock at = 0;
    std::uint8_t code = 0;
  };

  [[nodiscard]] Clock word_clock() const noexcept;
  [[nodiscard]] Clock error_clock() const noexcept;
  void character(char c) noexcept;
  void hex(std::uint8_t byte) noexcept;
  void send_word() noexcept;
  void send_error() noexcept;

  PhysicalTransmitter& physical_;
  bool digits_;  // true: a byte is sent as two digits; false: as one byte
  Crc8 checksum_;
  Ring<Word> words_{timing::transmit_words};
  Ring<ErrorCode> errors_{timing::error_codes};
  Clock free_at_ = 0;
  Clock place_free_at_ = 0;
  bool in_message_ = false;
  bool checked_ = false;
  std::uint8_t sum_ = 0;
};

}  // namespace unitylink::device
