// SPDX-License-Identifier: BSD-3-Clause
// A device that is half dead, or lies. It stands between the twin and the wire, and changes what passes. It never
// reports something as done that was not done.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "faults/profile.hpp"
#include "layer1_stream/frame_check.hpp"

namespace unitylink::faults {

class LyingPeer {
 public:
  using Bytes = std::basic_string<std::uint8_t>;

  LyingPeer(std::mt19937_64& random, bool framed) : random_(random), framed_(framed) {}

  void set(Peer peer) noexcept { peer_ = peer; }
  [[nodiscard]] std::uint64_t lies() const noexcept { return lies_; }

  // The bytes that are sent instead of the twin's next byte.
  [[nodiscard]] Bytes say(std::uint8_t byte);
  // The bytes that are sent because of the host's next byte, before the twin gets this byte.
  [[nodiscard]] Bytes heard(std::uint8_t byte);

 private:
  [[nodiscard]] bool ends(std::uint8_t byte) const noexcept;
  [[nodiscard]] Bytes instead(const Bytes& message);
  [[nodiscard]] Bytes instead_of_frame(const Bytes& message);
  [[nodiscard]] Bytes instead_of_line(const Bytes& message);
  [[nodiscard]] Bytes refusal(const Bytes& message, std::uint8_t status);
  [[nodiscard]] Bytes greeting();

  std::mt19937_64& random_;
  const bool framed_;
  Peer peer_ = Peer::honest;
  FrameKey key_;                        // key of the open session, because a false answer needs a right check
  Bytes open_;                          // a message whose end has not arrived
  bool passed_on_ = false;              // its first bytes were passed on already
  std::uint8_t heard_ = 0;              // the last byte from the host
  std::vector<std::uint8_t> greeting_;  // the payload of the twin's last HELLO answer
  std::uint64_t lies_ = 0;
};

}  // namespace unitylink::faults
