// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/pair_token.hpp"

namespace unitylink::pair_bus {
namespace {

constexpr std::size_t message_bytes_most = 1u << 16;  // longer input is not a message

}  // namespace

bool Answer::take(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != border) {
      if (message_.size() < message_bytes_most) {
        message_.push_back(byte);
      }
    } else if (!message_.empty()) {
      const bool ended = end_message();
      message_.clear();
      if (ended) {
        return true;
      }
    }
  }
  return false;
}

bool Answer::end_message() {
  if ((message_[0] & protocol::rs485::check_bit) != 0) {
    const bool from_device = (message_[0] & protocol::frame::device_bit) != 0;
    if (selected_ && from_device && message_.size() < message_bytes_most) {
      frames_.insert(frames_.end(), message_.begin(), message_.end());
      frames_.push_back(border);
    }
    return false;
  }
  selected_ = false;
  if (message_.size() != 2 || message_[1] != token_check(message_[0])) {
    return false;
  }
  const bool poll = (message_[0] & protocol::rs485::poll_bit) != 0;
  const unsigned node = message_[0] & protocol::rs485::nodes_max;
  if (poll) {
    // another number: this is the echo of our own poll, and so was all before it
    spoke_ = spoke_ && node == master_number;
    return node == master_number;
  }
  selected_ = spoke_ = node == node_;
  return false;
}

}  // namespace unitylink::pair_bus
