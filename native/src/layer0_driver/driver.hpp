// SPDX-License-Identifier: BSD-3-Clause
// Layer 0: a byte pipe to the device. No call blocks. The user waits on descriptor() with poll().
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

// The result of one send or receive. Status ok with count 0 means that nothing could be moved now: wait for the
// descriptor.
struct Transfer {
  std::size_t count = 0;
  Status status = Status::ok;
};

class LocalLine;
class MappedMemory;

// Not thread-safe, except that one thread may send while another receives.
class Driver {
 public:
  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  [[nodiscard]] virtual Transfer send(std::span<const std::uint8_t> bytes) noexcept = 0;
  [[nodiscard]] virtual Transfer receive(std::span<std::uint8_t> room) noexcept = 0;
  virtual void close() noexcept = 0;
  // Closes without a message to the other side, because another process still uses the port.
  virtual void disown() noexcept = 0;

  // To poll for POLLIN and POLLOUT; -1 once closed, and with a local_line().
  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  // The time of one byte on the wire; 0 if the wire does not limit the speed (tcp, udp, pseudo-terminals).
  [[nodiscard]] virtual std::uint64_t byte_time_ns() const noexcept { return 0; }
  // The clock of the other end: real time, or the time of the virtual boards of this process. It may be used after the
  // driver is gone.
  using TimeSource = std::uint64_t (*)() noexcept;
  [[nodiscard]] virtual TimeSource time_source() const noexcept { return &real_ns; }
  // From now on messages end with this byte. A driver whose chip collects bytes makes it deliver them at once after
  // such a byte.
  virtual void messages_end_with(std::uint8_t) noexcept {}
  // Why the last transfer had the status closed, in the words of the operating system.
  [[nodiscard]] virtual std::string reason() const = 0;
  // The registers, if they are memory of this machine and no bytes are sent. nullptr: this is a byte pipe.
  [[nodiscard]] virtual MappedMemory* memory() noexcept { return nullptr; }
  // The line, if it is memory of this process and nothing can be polled. nullptr: there is a descriptor.
  [[nodiscard]] virtual LocalLine* local_line() noexcept { return nullptr; }
  // A problem that does not stop the transfers, such as a trace that ended. Empty: none.
  [[nodiscard]] virtual std::string warning() const { return {}; }
};

// Opens the driver that the URL names, by the row of its scheme. bad_url: its scheme has no bytes. `timeout_ns` limits
// the time for a connection.
[[nodiscard]] Outcome open_driver(const Url& url, std::uint64_t timeout_ns, std::unique_ptr<Driver>& driver);

class Capture;

// Opens the port of one link, as often as necessary. All its bytes go into one capture.
class DriverSource {
 public:
  DriverSource(Url url, std::uint64_t timeout_ns);
  ~DriverSource();

  // The earlier driver must be gone. `cancelled` is a descriptor: when it becomes readable, a connection in progress
  // ends with the status closed. -1: never.
  [[nodiscard]] Outcome open(std::unique_ptr<Driver>& driver, int cancelled = -1);
  // Nothing is opened after this. Completes the capture.
  void close() noexcept;
  void disown() noexcept;
  [[nodiscard]] const Url& url() const noexcept { return url_; }

 private:
  const Url url_;
  const std::uint64_t timeout_ns_;
  std::shared_ptr<Capture> capture_;
};

}  // namespace unitylink
