// SPDX-License-Identifier: BSD-3-Clause
//
// Whether a node's threads work: what the link is told, and with it the gateware's dead-man.
#pragma once

#include <unitylink.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "unitylink/robot_outputs.hpp"

namespace unitylink {

// What one thread shows of itself: beat() when it does something that has to end, rest() when it waits for something to come.
class Sign {
 public:
  Sign(const char* what, double most_s) : what_(what), most_s_(most_s) {}
  void beat() noexcept { since_s_ = now_s(); }
  void rest() noexcept { since_s_ = 0.0; }
  // Why it has to be taken for dead; empty: it works, or nothing is expected of it.
  std::string trouble() const {
    const double since_s = since_s_, for_s = now_s() - since_s;
    if (since_s == 0.0 || for_s <= most_s_) return "";
    char text[96];
    std::snprintf(text, sizeof text, "%s stands still, for %.1f s now", what_, for_s);
    return text;
  }

 private:
  const char* what_;
  const double most_s_;
  std::atomic<double> since_s_{0.0};
};

// While all signs are fresh the link hears, from a thread that waits for nothing else, that the program works. `hangs(why)` is called when one
// is not, and with "" when all are again.
class Life {
 public:
  static constexpr double patience_s = 1.0;  // with a thread that shows nothing of itself
  static constexpr double device_s = 10.0;   // with one that waits for the device: the link ends that by itself, and sooner

  explicit Life(std::function<void(const std::string&)> hangs) : hangs_(std::move(hangs)) {}
  Life(const Life&) = delete;
  Life& operator=(const Life&) = delete;
  ~Life() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
    }
    stopped_.notify_all();
    thread_.join();
  }

  // All before start().
  Sign& expect(const char* what, double most_s) { return signs_.emplace_back(what, most_s); }
  void start() { thread_ = std::thread([this] { look(); }); }

  // The link that is to be told, from now on; nullptr: none.
  ul_status serve(ul_link* link) {
    const std::lock_guard<std::mutex> lock(mutex_);
    link_ = link;
    return link == nullptr ? UL_OK : ul_watch_program(link, static_cast<std::uint64_t>(1e9 * patience_s));
  }

 private:
  void look() {
    bool known = false;
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopped_.wait_for(lock, std::chrono::milliseconds(50), [this] { return stop_; })) {
      std::string trouble;
      for (const Sign& sign : signs_) {
        if (trouble.empty()) trouble = sign.trouble();
      }
      if (trouble.empty() && link_ != nullptr) ul_alive(link_);
      if (trouble.empty() == known) {
        known = !known;
        lock.unlock();
        hangs_(trouble);
        lock.lock();
      }
    }
  }

  const std::function<void(const std::string&)> hangs_;
  std::deque<Sign> signs_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  ul_link* link_ = nullptr;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace unitylink
