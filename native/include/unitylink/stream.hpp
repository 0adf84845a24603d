// SPDX-License-Identifier: BSD-3-Clause
//
// What the gateware publishes, by poll or by callback. C++20; nothing here allocates after start().
#pragma once

#include <unitylink/stream.h>

#include <atomic>
#include <thread>

#include "unitylink/part.hpp"

namespace unitylink {

// One group of publishes. `Values` is a generated struct.
template <class Values>
class Stream {
 public:
  Stream(ul_objects& objects, const char* path, std::uint32_t divisor) noexcept {
    set_.path = path;
    stream_ = {&objects, &set_, divisor, room_.data(), 0, 0, false};
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { stop(); }

  // Lets the device publish. `ring` publishes are kept until they are polled.
  result<> start(std::uint32_t ring = 4096) {
    ul_failure failure{};
    if (ul_stream_start(&stream_, ring, &failure) != UL_OK) return Error(failure);
    return {};
  }
  // Calls `callback(time_s, values)` for each publish that has come, oldest first, in this thread. Does not wait. Gives
  // how many. The time is that of CLOCK_MONOTONIC.
  template <class Callback>
  result<std::size_t> poll(Callback&& callback) {
    for (std::size_t count = 0;; ++count) {
      double time_s = 0.0;
      bool come = false;
      Raws<Values> raws{};
      Values values{};
      ul_failure failure{};
      if (ul_stream_poll(&stream_, &time_s, raws.data(), &come, &failure) != UL_OK) return Error(failure);
      if (!come) return count;
      if (decode_all(*stream_.objects, 0, raws, values, failure) != UL_OK) return Error(failure);
      callback(time_s, static_cast<const Values&>(values));
    }
  }
  // Waits for a publish. False: none came in time.
  result<bool> wait(std::chrono::nanoseconds timeout) {
    bool come = false;
    ul_failure failure{};
    if (ul_stream_wait(&stream_, static_cast<std::uint64_t>(timeout.count()), &come, &failure) != UL_OK)
      return Error(failure);
    return come;
  }
  // Publishes that were overwritten before they were polled, or lost on the line.
  [[nodiscard]] std::uint64_t lost() const noexcept { return ul_stream_lost(&stream_); }
  void stop() noexcept { ul_stream_stop(&stream_); }

 private:
  ul_set set_ = Values::ul_values;
  std::array<std::uint32_t, 2 * Values::ul_values.words> room_{};
  ul_stream stream_{};
};

// Calls `callback(time_s, values)` for each publish in a thread of its own, until it is destroyed or the link ends.
// Meanwhile no other thread polls this stream.
template <class Values, class Callback>
class Listener {
 public:
  Listener(Stream<Values>& stream, Callback callback)
      : thread_([this, &stream, call = std::move(callback)]() mutable {
          while (!ended_) {
            const auto come = stream.wait(std::chrono::milliseconds(50));
            const auto polled = stream.poll(call);
            if (!come || !polled) {
              error_ = come ? polled.error() : come.error();
              ended_ = failed_ = true;
            }
          }
        }) {}
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() {
    ended_ = true;
    thread_.join();
  }
  // Whether the calls have ended by an error, which error() then tells.
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] const Error& error() const noexcept { return error_; }

 private:
  std::atomic<bool> ended_{false}, failed_{false};
  Error error_;
  std::thread thread_;  // last, because it uses the others
};

}  // namespace unitylink
