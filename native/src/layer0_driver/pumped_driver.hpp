// SPDX-License-Identifier: BSD-3-Clause
// What drivers share whose port cannot be polled: threads move bytes between it and one end of a socket pair, and the
// link waits at the other end as at any port. What the link does not fetch stays in the socket, and the threads wait.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "layer0_driver/descriptor_driver.hpp"

namespace unitylink {

struct SocketPair {
  int near = -1;  // the link's
  int far = -1;   // the threads'
};

// closed where there is none to be had.
[[nodiscard]] Outcome make_socket_pair(SocketPair& pair);

// Who derives from it calls close() in its destructor, before what its threads use is gone.
class PumpedDriver : public DescriptorDriver {
 public:
  void close() noexcept override;
  void disown() noexcept override;  // a forked child: the threads and the port are the parent's
  [[nodiscard]] std::string reason() const override;

 protected:
  explicit PumpedDriver(const SocketPair& pair) noexcept : DescriptorDriver(pair.near), far_(pair.far) {}

  void start(std::function<void()> pump) { pumps_.emplace_back(std::move(pump)); }
  // Threads have no more to do: the link was closed, or the port has gone.
  [[nodiscard]] bool running() const noexcept { return !stop_ && !gone_; }
  // The port has gone; reason() is `why` from now on.
  void ended(const std::string& why);
  void hand_on(std::span<const std::uint8_t> bytes);
  // What the link wants sent, as soon as there is anything; 0 after `patience_ns`, or as soon as `other` can be read.
  [[nodiscard]] std::size_t fetch(std::span<std::uint8_t> room, std::uint64_t patience_ns, int other = -1);
  // The threads have ended, or are the parent's (`ours` is false): the port is let go.
  virtual void let_go(bool ours) noexcept = 0;

 private:
  int far_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> gone_ = false;
  mutable std::mutex mutex_;
  std::string why_;
  std::vector<std::thread> pumps_;
};

}  // namespace unitylink
