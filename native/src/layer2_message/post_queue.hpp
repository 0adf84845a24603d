// SPDX-License-Identifier: BSD-3-Clause
// Posts: writes without an answer. They are kept until the device has confirmed them, so that they can be sent again from where one was lost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace unitylink {

struct Post {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};

// Counts are of the session: confirmed <= sent <= made, except that after a loss `sent` goes back. On the wire they have 16 bits.
class PostQueue {
 public:
  static constexpr std::size_t capacity = 8192;  // well below the 32767 that the protocol allows

  [[nodiscard]] bool full() const noexcept { return made_ - confirmed_ >= capacity; }
  [[nodiscard]] std::uint64_t made() const noexcept { return made_; }
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
  [[nodiscard]] std::uint64_t confirmed() const noexcept { return confirmed_; }
  [[nodiscard]] const Post& at(std::uint64_t number) const noexcept { return posts_[number % capacity]; }

  void make(const Post& post) noexcept { posts_[made_++ % capacity] = post; }
  // The next one to send; there must be one.
  [[nodiscard]] const Post& next() const noexcept { return at(sent_); }
  void send() noexcept {
    ++sent_;
    if (sent_ > reached_) {
      reached_ = sent_;
    }
  }
  [[nodiscard]] bool repeats() const noexcept { return sent_ < reached_; }  // the next one has been sent before

  // The device has executed so many, told by its low 16 bits; false when that cannot be. What it has had need not be sent again.
  bool confirm(std::uint32_t count) noexcept {
    const std::uint64_t executed = confirmed_ + ((count - confirmed_) & 0xFFFF);
    if (executed > reached_) {
      return false;
    }
    confirmed_ = executed;
    sent_ = sent_ < executed ? executed : sent_;
    return true;
  }
  // Sends all that is not confirmed again.
  void go_back() noexcept { sent_ = confirmed_; }
  // Another session: returns how many were not confirmed in this one.
  std::uint64_t restart() noexcept {
    const std::uint64_t lost = made_ - confirmed_;
    made_ = sent_ = reached_ = confirmed_ = 0;
    return lost;
  }

 private:
  std::uint64_t made_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t reached_ = 0;    // the most that `sent` has been
  std::uint64_t confirmed_ = 0;
  std::array<Post, capacity> posts_;
};

}  // namespace unitylink
