// SPDX-License-Identifier: BSD-3-Clause
// The bytes between the device of a board and its client.
#include <algorithm>
#include <array>

#include "device/board.hpp"
#include "device/board_time.hpp"

namespace unitylink::device {

namespace {

// time to answer a client that sends nothing more but still reads
constexpr std::uint64_t linger_ns = 500'000'000;

}  // namespace

// Gives the device bytes from the client. True: there may be more now.
bool Board::feed() {
  fed_ = false;
  std::array<std::uint8_t, 4096> bytes;
  const std::size_t room = std::min(bytes.size(), device_->room());
  full_ = room == 0;
  if ((endpoint_->client() < 0 && !endpoint_->has_client()) || room == 0) {
    return false;
  }
  const bool lingered = endpoint_->ended();
  const Endpoint::Transfer taken = endpoint_->receive(std::span(bytes).first(room));
  if (taken.result == Endpoint::Result::gone) {
    forget_output();
  }
  if (endpoint_->ended() && (!lingered || !device_->input_empty())) {
    linger_until_ = clock_now() + whole_clocks(linger_ns, configuration().clock_hz);
  } else if (lingered && clock_now() >= linger_until_ && !output_blocked_) {
    endpoint_->dismiss();
    forget_output();
  }
  if (taken.result != Endpoint::Result::done) {
    return false;
  }
  run_to_plant(within_reach(clock_now()));
  for (const std::uint8_t byte : std::span(bytes).first(taken.bytes)) {
    device_->receive(byte);
  }
  fed_ = true;
  return taken.bytes == room;
}

// Drops the output for a client that has left, because it is not for the next one.
void Board::forget_output() {
  output_.clear();
  output_sent_ = 0;
  output_blocked_ = false;
  at_rest_ = true;
}

// Takes what has left the device. False: there is nothing to send.
bool Board::gather() {
  if (output_sent_ == output_.size()) {
    output_.clear();
    output_sent_ = 0;
  }
  TimedByte byte;
  while (output_.size() < chunk_bytes && device_->take(byte)) {
    output_.push_back(byte.byte);
  }
  if (output_.empty()) {
    return false;
  }
  at_rest_ = output_.back() == '\n' || output_.back() == protocol::frame::delimiter;
  return true;
}

void Board::flush() {
  for (;;) {
    if (output_sent_ == output_.size() && !gather()) {
      return;
    }
    if (!endpoint_->has_client()) {
      statistics_.bytes_dropped += output_.size() - output_sent_;
      output_sent_ = output_.size();
      continue;
    }
    const Endpoint::Transfer sent = endpoint_->send(std::span<const std::uint8_t>(output_).subspan(output_sent_));
    output_blocked_ = sent.result == Endpoint::Result::nothing;
    if (output_blocked_) {
      return;
    }
    output_sent_ += sent.bytes;  // 0 if the client has left; the next round drops the rest
  }
}

}  // namespace unitylink::device
