// SPDX-License-Identifier: BSD-3-Clause
//
// The set-points of a robot on their way from the thread that sets them to the one that writes them. The newest win.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "unitylink/triple_buffer.hpp"

namespace unitylink {

// next() and publish() are for one thread, the others for another. None of them waits, and the first two never
// allocate.
class Wanted {
 public:
  explicit Wanted(std::size_t values) : setting_(values), passed_(values), written_(values) {}

  // Sets a value. It is passed on by publish(), together with those set before.
  void next(std::uint16_t value, std::uint64_t raw) noexcept {
    setting_[value].raw = raw;
    ++setting_[value].version;
  }
  void publish() noexcept {
    std::copy(setting_.begin(), setting_.end(), passed_.back().begin());
    passed_.publish();
  }

  // Is there anything newer than at the last call?
  bool update() noexcept { return passed_.update(); }
  // Drops the values that are still to be written.
  void forget() {
    passed_.update();
    const auto& now = passed_.front();
    for (std::size_t i = 0; i < now.size(); ++i) written_[i] = now[i].version;
  }
  // Calls work(value, raw) for each value that has been set since the last call or forget(). Returns the values.
  template <typename Work>
  std::vector<std::uint16_t> take(Work&& work) {
    std::vector<std::uint16_t> changed;
    const auto& now = passed_.front();
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (now[i].version == written_[i]) continue;
      written_[i] = now[i].version;
      work(i, now[i].raw);
      changed.push_back(static_cast<std::uint16_t>(i));
    }
    return changed;
  }

 private:
  struct Point {
    std::uint64_t raw = 0;
    std::uint64_t version = 0;  // counts how often it was set
  };
  std::vector<Point> setting_;
  TripleBuffer<Point> passed_;
  std::vector<std::uint64_t> written_;  // the versions that were written, or forgotten
};

}  // namespace unitylink
