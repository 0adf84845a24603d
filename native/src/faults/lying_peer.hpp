// SPDX-License-Identifier: BSD-3-Clause
// A device that is half dead, or lies: it stands behind the twin's mouth and passes on what it likes. It never says that something was done
// which was not.
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

  // What goes out in place of the twin's next byte.
  [[nodiscard]] Bytes say(std::uint8_t byte);
  // What goes out because of the host's next byte, before the twin has it.
  [[nodiscard]] Bytes heard(std::uint8_t byte);

 private:
  [[nodiscard]] bool ends(std::uint8_t byte) const noexcept;
  [[nodiscard]] Bytes instead(const Bytes& message);
  [[nodiscard]] Bytes instead_of_frame(const Bytes& message);
  [[nodiscard]] Bytes instead_of_line(const Bytes& message);
  [[nodiscard]] Bytes refusal(const Bytes& message);
  [[nodiscard]] Bytes greeting();

  std::mt19937_64& random_;
  const bool framed_;
  Peer peer_ = Peer::honest;
  FrameKey key_;                        // of the session that is open: a lie must have the right check to be one
  Bytes open_;                          // a message whose end has not come
  bool passed_on_ = false;              // its bytes so far
  std::uint8_t heard_ = 0;              // the last byte of the host's
  std::vector<std::uint8_t> greeting_;  // the payload of the twin's last HELLO answer
  std::uint64_t lies_ = 0;
};

}  // namespace unitylink::faults
