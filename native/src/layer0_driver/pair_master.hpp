// SPDX-License-Identifier: BSD-3-Clause
// The master of an RS-485 pair. Its thread gives each node its turn, and moves bytes between the node and the socket
// pair of the node's link.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/driver.hpp"

namespace unitylink::pair_bus {

struct Settings {
  unsigned node = 0;
  std::string baud;  // the text of the URL
  std::uint64_t poll_ns = 0;
  std::uint64_t silence_ns = 0;
};

class Master {
 public:
  // The master of the port that the URL names. Links to other nodes of the same port share it.
  [[nodiscard]] static Outcome of(const Url& url, const Settings& settings, std::shared_ptr<Master>& shared);
  // For a forked child: the thread and the port belong to the parent.
  static void disown(std::shared_ptr<Master> shared);
  Master(std::unique_ptr<Driver> port, std::string baud);
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;
  ~Master();

  // Adds a node. `far` is the far end of its socket pair. busy: the node has a link already.
  [[nodiscard]] Outcome join(const Settings& settings, Descriptor far);
  void leave(unsigned node);
  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept { return port_->byte_time_ns(); }
  [[nodiscard]] std::string reason() const;  // why the port is gone; empty: it is not

 private:
  using Clock = std::chrono::steady_clock;
  struct Node;

  void serve() noexcept;
  [[nodiscard]] bool give_turn(Node& node);
  [[nodiscard]] bool say(const std::vector<std::uint8_t>& bytes);
  void fail(const std::string& why) noexcept;
  void give_turns();
  void pause(Clock::time_point until);

  std::unique_ptr<Driver> port_;
  const std::string baud_;
  Descriptor wake_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // guards all below
  std::map<unsigned, std::shared_ptr<Node>> nodes_;
  std::string why_;
  std::thread thread_;
};

}  // namespace unitylink::pair_bus
