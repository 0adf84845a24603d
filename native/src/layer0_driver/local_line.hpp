// SPDX-License-Identifier: BSD-3-Clause
// A line in memory between a virtual board and a link of this process, for time in steps. No byte needs a call of the
// system. Whoever gets something, or room to send, is touched (lockstep.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "layer0_driver/driver.hpp"
#include "layer0_driver/lockstep.hpp"

namespace unitylink {

class LocalLine {
 public:
  enum Side : std::uint8_t { link, board };
  static constexpr std::size_t room = 65536;  // for bytes on their way, in each direction

  LocalLine();

  // A link takes the line by the number of a descriptor, as in fd:7. claim() is nullptr if it stands for no line.
  static void offer(int descriptor, const std::shared_ptr<LocalLine>& line);
  [[nodiscard]] static std::shared_ptr<LocalLine> claim(int descriptor);

  // As in Driver. closed: the other side has closed the line, and nothing of it is left to receive.
  [[nodiscard]] Transfer send(Side from, std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] Transfer receive(Side at, std::span<std::uint8_t> into) noexcept;
  void close(Side side) noexcept;
  // Whether receive() gives something, or says that the line is closed.
  [[nodiscard]] bool readable(Side at) noexcept;
  // Whether send() takes something, after it has taken nothing.
  [[nodiscard]] bool writable(Side from) noexcept;
  // Who is touched. nullptr: nobody.
  void listen(Side side, Lockstep::Member* member) noexcept;

 private:
  struct End {                        // of one side
    std::vector<std::uint8_t> bytes;  // for it
    std::size_t taken = 0;            // of them
    bool open = true;
    Lockstep::Member* member = nullptr;
  };
  [[nodiscard]] static Side other(Side side) noexcept { return side == link ? board : link; }
  static void tell(const End& end) noexcept;

  std::mutex mutex_;
  std::array<End, 2> ends_;
};

}  // namespace unitylink
