// SPDX-License-Identifier: BSD-3-Clause
// The base of all drivers on a file descriptor: it sends and receives without blocking, and decides when the port is
// gone.
#pragma once

#include <atomic>

#include "layer0_driver/driver.hpp"

namespace unitylink {

// The error of a device file that cannot be opened. `name` is the port. `missing` and `forbidden` are the remedies if
// it does not exist, or may not be used.
[[nodiscard]] Outcome refused_port(const std::string& name, int error, const char* missing, const char* forbidden);

class DescriptorDriver : public Driver {
 public:
  // Takes ownership of the descriptor and makes it non-blocking. If that fails, the port counts as gone, because a call
  // could block. It also counts as gone if nobody knows whether it is a socket, because a broken socket could end the
  // program with SIGPIPE.
  explicit DescriptorDriver(int descriptor) noexcept;
  ~DescriptorDriver() override;

  [[nodiscard]] Transfer send(std::span<const std::uint8_t> bytes) noexcept override;
  [[nodiscard]] Transfer receive(std::span<std::uint8_t> room) noexcept override;
  void close() noexcept override;
  void disown() noexcept override { DescriptorDriver::close(); }
  [[nodiscard]] int descriptor() const noexcept override { return descriptor_; }
  [[nodiscard]] std::string reason() const override;

 protected:
  [[nodiscard]] virtual Transfer failed(int error) noexcept;

 private:
  int descriptor_;
  std::atomic<int> error_ = 0;  // atomic: the sending and the receiving thread may both set it
  bool usable_;
  bool socket_;    // a socket needs MSG_NOSIGNAL
  bool datagram_;  // an empty datagram is not the end of a stream
};

}  // namespace unitylink
