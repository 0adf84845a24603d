// SPDX-License-Identifier: BSD-3-Clause
// Posts: writes without an answer, with one or several words each. They are kept until the device has confirmed them.
// So they can be sent again, unchanged, from a lost one on.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace unitylink {

struct Post {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};

// The counts are of posts of the session: confirmed <= sent <= made, except that `sent` goes back after a loss. On the
// wire they have 16 bits.
class PostQueue {
 public:
  static constexpr std::size_t capacity = 8192;  // words and posts: well below the 32767 that the protocol allows

  [[nodiscard]] bool fits(std::size_t words) const noexcept { return open_words() + words <= capacity; }
  [[nodiscard]] std::uint64_t made() const noexcept { return made_; }
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
  [[nodiscard]] std::uint64_t confirmed() const noexcept { return confirmed_; }
  [[nodiscard]] std::uint64_t told() const noexcept { return told_; }
  [[nodiscard]] std::uint64_t open_words() const noexcept { return words_ - begin(confirmed_); }
  // The number of words of a post that is not confirmed, and the words.
  [[nodiscard]] std::size_t words(std::uint64_t number) const noexcept {
    return static_cast<std::size_t>(begin(number + 1) - begin(number));
  }
  [[nodiscard]] const Post& word(std::uint64_t number, std::size_t index) const noexcept {
    return ring_[(begin(number) + index) % capacity];
  }
  // Whether a post is still stored, confirmed or not.
  [[nodiscard]] bool known(std::uint64_t number) const noexcept {
    return number < made_ && made_ - number <= capacity && words_ - begin(number) <= capacity;
  }

  // There must be room for them.
  void make(std::span<const Post> words) noexcept {
    begins_[made_++ % capacity] = words_;
    for (const Post& word : words) {
      ring_[words_++ % capacity] = word;
    }
  }
  // The next post was sent. There must be one.
  void send() noexcept {
    ++sent_;
    if (sent_ > reached_) {
      reached_ = sent_;
    }
  }
  [[nodiscard]] bool repeats() const noexcept { return sent_ < reached_; }  // the next one was sent before

  // The device has executed so many posts, given by the low 16 bits. False if that is impossible. Executed posts need
  // not be sent again. The count is used only when a second answer confirms it, because a damaged answer with a right
  // check would drop posts for ever.
  bool confirm(std::uint32_t count) noexcept {
    const std::uint64_t executed = confirmed_ + ((count - confirmed_) & 0xFFFF);
    if (executed > reached_) {
      return false;
    }
    confirmed_ = std::max(confirmed_, std::min(executed, std::exchange(told_, executed)));
    sent_ = std::max(sent_, confirmed_);
    return true;
  }
  // All posts that are not confirmed are sent again.
  void go_back() noexcept { sent_ = confirmed_; }
  // Starts another session. Returns how many words were not confirmed in this one.
  std::uint64_t restart() noexcept {
    const std::uint64_t lost = open_words();
    made_ = sent_ = reached_ = confirmed_ = told_ = words_ = 0;
    return lost;
  }

 private:
  // The position of the post's first word. For the next post to be made: of the next word.
  [[nodiscard]] std::uint64_t begin(std::uint64_t number) const noexcept {
    return number < made_ ? begins_[number % capacity] : words_;
  }

  std::uint64_t made_ = 0;
  std::uint64_t sent_ = 0;
  std::uint64_t reached_ = 0;  // the largest value of `sent`
  std::uint64_t confirmed_ = 0;
  std::uint64_t told_ = 0;   // executed, from the last answer
  std::uint64_t words_ = 0;  // number of words of all posts made
  std::array<Post, capacity> ring_;
  std::array<std::uint64_t, capacity> begins_;
};

}  // namespace unitylink
