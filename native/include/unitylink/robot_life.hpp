// SPDX-License-Identifier: BSD-3-Clause
//
// Checks that the threads of a node work. If they do, it says so to the link, which keeps the gateware's dead-man from
// tripping.
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

// The signs of life of one thread. It calls beat() before work that must end, and rest() before it waits for an event.
class Sign {
 public:
  Sign(const char* what, double most_s) : what_(what), most_s_(most_s) {}
  void beat() noexcept { since_s_ = now_s(); }
  void rest() noexcept { since_s_ = 0.0; }
  // Why the thread counts as dead. Empty: it works, or it need not give a sign now.
  std::string trouble() const {
    const double since_s = since_s_, for_s = now_s() - since_s;
    if (since_s == 0.0 || for_s <= most_s_) return "";
    char text[96];
    std::snprintf(text, sizeof text, "%s has not moved on for %.1f s now", what_, for_s);
    return text;
  }

 private:
  const char* what_;
  const double most_s_;
  std::atomic<double> since_s_{0.0};
};

// A separate thread watches all signs. While none is late, it tells the link that the program works. It calls
// `hangs(why)` when a sign is late, and with "" when no sign is late any more.
class Life {
 public:
  static constexpr double patience_s = 1.0;  // the longest silence of a thread, and of this watch
  // the same for a thread that waits for the device; the link ends such a wait earlier
  static constexpr double device_s = 10.0;

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

  // Adds a thread to be watched. Call it before start().
  Sign& expect(const char* what, double most_s) { return signs_.emplace_back(what, most_s); }
  void start() {
    thread_ = std::thread([this] { look(); });
  }

  // From now on this link gets the signs. nullptr: there is none.
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
