// SPDX-License-Identifier: BSD-3-Clause
// Which protocol the next byte belongs to: docs/protocol.md, "One port, two protocols".
#pragma once

#include <cstdint>

#include "unitylink/protocol.hpp"

namespace unitylink::device {

class PortSplitter {
 public:
  enum class Side : std::uint8_t { classic, framed };

  // Where `byte` goes. A 00 goes to both when it cuts a classic message short: the classic side calls it an invalid character.
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
  State state_ = State::classic;  // after power-on people may type
};

}  // namespace unitylink::device
