// SPDX-License-Identifier: BSD-3-Clause
// The base of drivers whose port cannot be polled. Threads move bytes between the port and the far end of a socket
// pair. The link waits at the near end, as at any other port. If the link does not fetch its bytes, the socket becomes
// full, and the threads wait.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/descriptor_driver.hpp"

namespace unitylink {

struct SocketPair {
  Descriptor near;  // the link's
  Descriptor far;   // the threads'
};

// The error is closed, with the reason of the operating system.
[[nodiscard]] Outcome make_socket_pair(SocketPair& pair);

// A derived class must call close() in its destructor, because its threads use its members.
class PumpedDriver : public DescriptorDriver {
 public:
  void close() noexcept override;
  void disown() noexcept override;  // for a forked child: the threads and the port belong to the parent
  [[nodiscard]] std::string reason() const override;

 protected:
  explicit PumpedDriver(SocketPair pair) noexcept : DescriptorDriver(pair.near.release()), far_(std::move(pair.far)) {}

  // Starts a thread. Without memory or threads it throws. So call it when the driver has an owner, which closes it.
  void start(std::function<void()> pump);
  // False: the link was closed or the port is gone, so the threads must end.
  [[nodiscard]] bool running() const noexcept { return !stop_ && !gone_; }
  // A thread calls this when the port is gone. From now on reason() returns both texts.
  void ended(std::string_view what, std::string_view why = {}) noexcept;
  // Gives bytes from the port to the link, and waits until the link has room for them.
  void hand_on(std::span<const std::uint8_t> bytes);
  // Waits for bytes that the link wants to send, and returns their number. Returns 0 after `patience_ns`, or when the
  // descriptor `other` becomes readable.
  [[nodiscard]] std::size_t fetch(std::span<std::uint8_t> room, std::uint64_t patience_ns, int other = -1);
  // Releases the port after the threads have ended. `ours` is false in a forked child: threads and port belong to the
  // parent.
  virtual void let_go(bool ours) noexcept = 0;

 private:
  Descriptor far_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> gone_ = false;
  mutable std::mutex mutex_;
  std::string why_;
  std::vector<std::thread> pumps_;
};

}  // namespace unitylink
