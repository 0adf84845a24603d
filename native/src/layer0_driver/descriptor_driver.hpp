// SPDX-License-Identifier: BSD-3-Clause
// What all drivers over a file descriptor share: non-blocking send and receive, and when such a pipe counts as gone.
#pragma once

#include <atomic>

#include "layer0_driver/driver.hpp"

namespace unitylink {

// Why the device file of the port `name` cannot be opened; `missing` and `forbidden` are the remedies for two of the
// reasons.
[[nodiscard]] Outcome refused_port(const std::string& name, int error, const char* missing, const char* forbidden);

class DescriptorDriver : public Driver {
 public:
  // Takes the descriptor over and makes it non-blocking. Where that fails the port is gone from the beginning: neither
  // may a call block, nor a socket that is not known as one end the program with SIGPIPE.
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
  std::atomic<int> error_ = 0;  // sender and receiver may both meet it
  bool usable_;
  bool socket_;    // a socket needs MSG_NOSIGNAL
  bool datagram_;  // an empty datagram is not the end of a stream
};

}  // namespace unitylink
