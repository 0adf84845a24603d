// SPDX-License-Identifier: BSD-3-Clause
// The master of an RS-485 pair: a thread that gives each node its turn and moves bytes between them and the nodes'
// socket pairs.
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
  std::string baud;  // as the URL has it
  std::uint64_t poll_ns = 0;
  std::uint64_t silence_ns = 0;
};

class Master {
 public:
  // The master of the port that the URL names, which other links may have already.
  [[nodiscard]] static Outcome of(const Url& url, const Settings& settings, std::shared_ptr<Master>& shared);
  // In a forked child: neither thread nor port are its own.
  static void disown(std::shared_ptr<Master> shared);
  Master(std::unique_ptr<Driver> port, std::string baud);
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;
  ~Master();

  // `descriptor` is the far end of the node's socket pair, and the master's from then on; busy where the node has a
  // link.
  [[nodiscard]] Outcome join(const Settings& settings, int descriptor);
  void leave(unsigned node);
  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept { return port_->byte_time_ns(); }
  [[nodiscard]] std::string reason() const;  // why the port has gone; empty while it has not

 private:
  using Clock = std::chrono::steady_clock;
  struct Node;

  void serve() noexcept;
  [[nodiscard]] bool give_turn(Node& node);
  [[nodiscard]] bool say(const std::vector<std::uint8_t>& bytes);
  void fail(const std::string& why);
  void pause(Clock::time_point until);

  std::unique_ptr<Driver> port_;
  const std::string baud_;
  Descriptor wake_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // all below
  std::map<unsigned, std::shared_ptr<Node>> nodes_;
  std::string why_;
  std::thread thread_;
};

}  // namespace unitylink::pair_bus
