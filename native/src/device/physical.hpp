// SPDX-License-Identifier: BSD-3-Clause
// The physical layer: a byte FIFO in each direction. With a baud rate there is also a line, which needs time for each
// byte.
//
// With a line, as for a UART, a byte that arrives at a full receive FIFO is lost (overrun). Without a line, as for USB
// or TCP, the FIFO takes only bytes for which it has room. The others wait at the host.
#pragma once

#include <algorithm>
#include <cstddef>

#include "device/configuration.hpp"
#include "device/ring.hpp"

namespace unitylink::device {

struct TimedByte {
  Clock at = 0;
  std::uint8_t byte = 0;
};

class PhysicalReceiver {
 public:
  static constexpr std::size_t large = 65536;

  explicit PhysicalReceiver(const DeviceConfiguration& configuration)
      : byte_clocks_(configuration.byte_clocks()),
        latency_(configuration.fifo_latency),
        line_(byte_clocks_ > 0 ? large : 0),
        fifo_(configuration.fifo > 0 ? configuration.fifo : large) {}

  [[nodiscard]] std::size_t room() const noexcept { return byte_clocks_ > 0 ? line_.free() : fifo_.free(); }
  [[nodiscard]] bool empty() const noexcept { return line_.empty() && fifo_.empty(); }

  // False if there is no room. Then the host keeps the byte.
  bool offer(std::uint8_t byte, Clock now) noexcept {
    if (byte_clocks_ == 0) {
      return fifo_.push({now, byte});
    }
    const Clock arrives = std::max(now, last_arrival_) + byte_clocks_;
    if (!line_.push({arrives, byte})) {
      return false;
    }
    last_arrival_ = arrives;
    return true;
  }

  [[nodiscard]] Clock next_arrival() const noexcept { return line_.empty() ? never : line_.front().at; }

  // Moves the byte that is due from the line into the FIFO. False if it is lost in an overrun.
  bool arrive() noexcept {
    const bool kept = fifo_.push(line_.front());
    line_.pop();
    return kept;
  }

  // When the oldest byte in the FIFO can be read.
  [[nodiscard]] Clock readable() const noexcept { return fifo_.empty() ? never : fifo_.front().at + latency_; }
  [[nodiscard]] std::uint8_t front() const noexcept { return fifo_.front().byte; }
  void pop() noexcept { fifo_.pop(); }
  void flush() noexcept { fifo_.clear(); }

 private:
  std::uint32_t byte_clocks_;
  std::uint32_t latency_;
  Ring<TimedByte> line_;
  Ring<TimedByte> fifo_;
  Clock last_arrival_ = 0;
};

class PhysicalTransmitter {
 public:
  explicit PhysicalTransmitter(const DeviceConfiguration& configuration)
      : byte_clocks_(configuration.byte_clocks()),
        latency_(configuration.fifo_latency),
        fifo_(configuration.fifo > 0 ? configuration.fifo : PhysicalReceiver::large),
        sent_(byte_clocks_ > 0 ? PhysicalReceiver::large : 0) {}

  [[nodiscard]] std::size_t room() const noexcept { return fifo_.free(); }
  void put(char character, Clock at) noexcept { fifo_.push({at + latency_, static_cast<std::uint8_t>(character)}); }

  // When the line has carried the oldest byte of the FIFO. `never` while the host does not read.
  [[nodiscard]] Clock next_departure() const noexcept {
    const bool idle = byte_clocks_ == 0 || fifo_.empty() || sent_.full();
    return idle ? never : std::max(fifo_.front().at, last_departure_) + byte_clocks_;
  }

  void depart() noexcept {
    last_departure_ = next_departure();
    sent_.push({last_departure_, fifo_.front().byte});
    fifo_.pop();
  }

  // Takes the oldest byte that the host may have at `now`. False if there is none.
  bool take(TimedByte& byte, Clock now) noexcept {
    Ring<TimedByte>& from = byte_clocks_ > 0 ? sent_ : fifo_;
    if (from.empty() || from.front().at > now) {
      return false;
    }
    byte = from.front();
    from.pop();
    return true;
  }

  // When the oldest byte is given to the host, with or without a line.
  [[nodiscard]] Clock next_output() const noexcept {
    const Ring<TimedByte>& from = byte_clocks_ > 0 ? sent_ : fifo_;
    return from.empty() ? never : from.front().at;
  }

 private:
  std::uint32_t byte_clocks_;
  std::uint32_t latency_;
  Ring<TimedByte> fifo_;
  Ring<TimedByte> sent_;
  Clock last_departure_ = 0;
};

}  // namespace unitylink::device
