// SPDX-License-Identifier: BSD-3-Clause
// Frames that have arrived and are not yet executed: as many as the gateware's receiver keeps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "device/clock.hpp"

namespace unitylink::device {

class WaitingFrames {
 public:
  struct Waiting {
    std::uint8_t kind = 0;
    Clock at = 0;  // when it may be executed
    std::vector<std::uint8_t> payload;
  };

  // Each payload has at most so many bytes, and all together have at most `bytes_most`.
  WaitingFrames(std::size_t payload_most, std::size_t bytes_most) : ring_(most), bytes_most_(bytes_most - early) {
    for (Waiting& waiting : ring_) {
      waiting.payload.reserve(payload_most);
    }
  }

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  // True: no byte of another frame can be taken. The current frame may still end.
  [[nodiscard]] bool full() const noexcept { return count_ >= frames_most || bytes_ >= bytes_most_; }
  [[nodiscard]] const Waiting& front() const noexcept { return ring_[first_]; }

  void push(std::uint8_t kind, std::span<const std::uint8_t> payload, Clock at) {
    Waiting& waiting = ring_[(first_ + count_) % most];
    waiting.kind = kind;
    waiting.at = at;
    waiting.payload.assign(payload.begin(), payload.end());
    bytes_ += payload.size();
    ++count_;
  }
  void pop() noexcept {
    bytes_ -= front().payload.size();
    first_ = (first_ + 1) % most;
    --count_;
  }

 private:
  static constexpr std::size_t frames_most = 16;
  static constexpr std::size_t early = 4;  // the gateware stops taking bytes when only so many are free
  static constexpr std::size_t most = frames_most + 1;

  std::vector<Waiting> ring_;
  std::size_t bytes_most_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace unitylink::device
