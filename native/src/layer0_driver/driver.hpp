// SPDX-License-Identifier: BSD-3-Clause
// Layer 0: a byte pipe to the device. Non-blocking; whoever uses it waits on descriptor() with poll().
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "layer0_driver/robot_time.hpp"
#include "layer0_driver/status.hpp"
#include "layer0_driver/url.hpp"

namespace unitylink {

// What one send or receive did. Status ok with count 0: nothing could be moved now, wait for the descriptor.
struct Transfer {
  std::size_t count = 0;
  Status status = Status::ok;
};

class MappedMemory;

// Not thread-safe by itself, but one thread may send while another receives.
class Driver {
 public:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  [[nodiscard]] virtual Transfer send(std::span<const std::uint8_t> bytes) noexcept = 0;
  [[nodiscard]] virtual Transfer receive(std::span<std::uint8_t> room) noexcept = 0;
  virtual void close() noexcept = 0;
  // Closes without a word to the other side: another process goes on using the port.
  virtual void disown() noexcept = 0;

  // To poll for POLLIN and POLLOUT; -1 once closed.
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  // How long one byte takes on the wire, 0 where that does not limit (tcp, udp, pseudo-terminals).
  [[nodiscard]] virtual std::uint64_t byte_time_ns() const noexcept { return 0; }
  // What tells the time at the other end: the real one, or that of the virtual boards of this process. It outlives the
  // driver.
  using TimeSource = std::uint64_t (*)() noexcept;
  [[nodiscard]] virtual TimeSource time_source() const noexcept { return &real_ns; }
  // Messages end with this byte from now on: a driver whose chip gathers bytes hands on what it has when one comes.
  virtual void messages_end_with(std::uint8_t) noexcept {}
  // Why the last transfer said closed, in the operating system's words.
  [[nodiscard]] virtual std::string reason() const = 0;
  // The registers themselves, where they are memory of this machine and no bytes are sent; nullptr: a byte pipe.
  [[nodiscard]] virtual MappedMemory* memory() noexcept { return nullptr; }
  // What did not go as wished although the transfers did; empty: nothing.
  [[nodiscard]] virtual std::string warning() const { return {}; }
};

// Opens the bytes of what the URL names, by the row of its scheme; bad_url where there are none. `timeout_ns` bounds a
// connection.
[[nodiscard]] Outcome open_driver(const Url& url, std::uint64_t timeout_ns, std::unique_ptr<Driver>& driver);

class Capture;

// Opens one place again and again; what goes over the wire lands in one capture.
class DriverSource {
 public:
  DriverSource(Url url, std::uint64_t timeout_ns);
  ~DriverSource();

  // The driver of before must be gone. A connection that is being made ends with closed as soon as `cancelled`, a
  // descriptor, is readable; -1: never.
  [[nodiscard]] Outcome open(std::unique_ptr<Driver>& driver, int cancelled = -1);
  // Nothing is opened any more: the capture is whole.
  void close() noexcept;
  void disown() noexcept;
  [[nodiscard]] const Url& url() const noexcept { return url_; }

 private:
  const Url url_;
  const std::uint64_t timeout_ns_;
  std::shared_ptr<Capture> capture_;
};

}  // namespace unitylink
