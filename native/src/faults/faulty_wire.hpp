// SPDX-License-Identifier: BSD-3-Clause
// One direction of a wire, on a virtual clock.
#pragma once

#include <cstdint>
#include <deque>
#include <random>
#include <span>
#include <string>

#include "faults/profile.hpp"

namespace unitylink::faults {

using Random = std::mt19937_64;
using Bytes = std::basic_string<std::uint8_t>;  // short messages need no allocation

class FaultyWire {
 public:
  static constexpr std::uint64_t never = ~std::uint64_t{0};

  // Messages end with `border`. A byte takes `byte_ns`, and everything is delayed by `delay_ns`.
  FaultyWire(Random& random, std::uint8_t border, std::uint64_t byte_ns, std::uint64_t delay_ns)
      : random_(random), border_(border), byte_ns_(byte_ns), delay_ns_(delay_ns) {}

  void set(const WireFaults& faults) noexcept { faults_ = faults; }
  [[nodiscard]] std::uint64_t faults() const noexcept { return count_; }

  // When the line has carried all bytes sent so far.
  [[nodiscard]] std::uint64_t free_ns() const noexcept { return free_ns_; }
  void send(std::span<const std::uint8_t> bytes, std::uint64_t now_ns);
  // The sender stops within a message.
  void break_off(std::uint64_t now_ns);

  [[nodiscard]] std::uint64_t next_ns() const noexcept { return arriving_.empty() ? never : arriving_.front().at_ns; }
  // Gives the bytes that have arrived by now to `receive`.
  template <class Receive>
  void take(std::uint64_t now_ns, Receive receive) {
    while (!arriving_.empty() && arriving_.front().at_ns <= now_ns) {
      const Bytes bytes = std::move(arriving_.front().bytes);
      arriving_.pop_front();
      receive(std::span<const std::uint8_t>(bytes));
    }
  }

 private:
  struct Arrival {
    std::uint64_t at_ns = 0;
    Bytes bytes;
  };

  [[nodiscard]] bool chance(double probability);
  [[nodiscard]] std::uint64_t below(std::uint64_t limit) { return random_() % limit; }
  void carry(const Bytes& message, std::uint64_t now_ns);
  void damage(Bytes& message);
  void deliver(Bytes message, std::uint64_t now_ns, std::uint64_t later_ns);

  Random& random_;
  std::uint8_t border_;
  std::uint64_t byte_ns_;
  std::uint64_t delay_ns_;
  WireFaults faults_;
  std::uint64_t count_ = 0;
  std::uint64_t free_ns_ = 0;
  std::uint64_t held_ns_ = 0;  // nothing arrives before this time
  Bytes open_;                 // a message whose end was not yet sent
  std::deque<Arrival> arriving_;
};

}  // namespace unitylink::faults
