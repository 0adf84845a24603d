// SPDX-License-Identifier: BSD-3-Clause
// Decides to which protocol the next byte belongs (docs/protocol.md, "One port, two protocols").
#pragma once

#include <cstdint>

#include "unitylink/protocol.hpp"

namespace unitylink::device {

class PortSplitter {
 public:
  enum class Side : std::uint8_t { classic, framed };

  // Returns where `byte` goes. A 00 that cuts a classic message short goes to both sides. The classic side treats it as
  // an invalid character.
  Side route(std::uint8_t byte) noexcept {
    if (byte == protocol::frame::delimiter) {
      const Side side = state_ == State::classic ? Side::classic : Side::framed;
      state_ = State::border;
      return side;
    }
    if (state_ == State::border) {
      state_ = byte < kinds_first ? State::classic : State::frame;
    }
    return state_ == State::classic ? Side::classic : Side::framed;
  }

 private:
  static constexpr std::uint8_t kinds_first = 0x80;

  enum class State : std::uint8_t { classic, border, frame };
  State state_ = State::classic;  // after power-on a person may type classic text
};

}  // namespace unitylink::device
