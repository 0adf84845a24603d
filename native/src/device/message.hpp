// SPDX-License-Identifier: BSD-3-Clause
// The data between the datalink and the application layer: received messages in one direction, single words in the
// other.
#pragma once

#include <cstdint>
#include <vector>

#include "device/clock.hpp"

namespace unitylink::device {

// A request. After a full datalink, its form and checksum are right.
struct Message {
  bool checked = false;
  bool colon = false;
  bool open = false;          // a lite datalink passes it on before its end
  Clock ready_at = 0;         // when the application may start
  Clock free_at = 0;          // when the buffer may be filled again
  std::vector<char> letters;  // upper case
  std::vector<std::uint8_t> data;
};

struct Word {
  enum class Kind : std::uint8_t { head, letter, mark, data, error_mark, tail };
  Kind kind = Kind::head;
  std::uint8_t value = 0;  // the character, or the data byte
  Clock at = 0;            // when it entered the transmit FIFO
};

}  // namespace unitylink::device
