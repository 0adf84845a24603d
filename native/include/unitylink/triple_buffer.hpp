// SPDX-License-Identifier: BSD-3-Clause
//
// Passes vectors from one thread to another. The reader gets only the newest one. Neither thread ever waits or
// allocates, and a vector is never seen half written.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <vector>

namespace unitylink {

template <typename T>
class TripleBuffer {
 public:
  explicit TripleBuffer(std::size_t size)
      : buffers_{{std::vector<T>(size), std::vector<T>(size), std::vector<T>(size)}} {}

  // For the writer: fill it, then call publish().
  std::vector<T>& back() noexcept { return buffers_[back_]; }
  void publish() noexcept { back_ = middle_.exchange(back_ | fresh, std::memory_order_acq_rel) & index; }

  // For the reader: true if there was a newer vector. front() is this vector from then on.
  bool update() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index;
    return true;
  }
  const std::vector<T>& front() const noexcept { return buffers_[front_]; }

 private:
  static constexpr unsigned fresh = 4, index = 3;
  std::array<std::vector<T>, 3> buffers_;
  std::atomic<unsigned> middle_{1};
  unsigned back_ = 0, front_ = 2;
};

}  // namespace unitylink
