// SPDX-License-Identifier: BSD-3-Clause
// The publishes of one group that are not fetched yet: k words and a host time each. When it is full, the newest
// replace the oldest. A ring without room keeps none.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace unitylink {

// Publishes that were drained: the first `count` of the times, and `words` values for each.
struct Drained {
  std::size_t count = 0;
  std::size_t words = 0;
  std::uint64_t before = 0;  // publishes of the subscription that were lost, in the ring or on the line, so far
  std::vector<double> times_s;
  std::vector<std::uint32_t> values;
};

// Not thread-safe: the link's mutex guards it. It allocates all its memory at construction.
class PublishRing {
 public:
  PublishRing(std::size_t words, std::size_t capacity)
      : words_(words), capacity_(capacity), keeps_(capacity != 0), times_(capacity), values_(words * capacity) {}

  [[nodiscard]] std::size_t words() const noexcept { return words_; }
  [[nodiscard]] bool keeps() const noexcept { return keeps_; }
  void keep_no_more() noexcept { keeps_ = false; }  // push() must not be called then; what is there can be drained
  [[nodiscard]] std::size_t size() const noexcept { return static_cast<std::size_t>(head_ - tail_); }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  [[nodiscard]] std::uint64_t received() const noexcept { return head_; }

  // Publishes lost on the way: gaps in their sequence, if they have one.
  [[nodiscard]] std::uint64_t missing() const noexcept { return missing_; }
  void miss(std::uint64_t count) noexcept { missing_ += count; }
  // Publishes that were never made: polls that came too late.
  void lose(std::uint64_t count) noexcept { lost_ += count; }

  // False if an older publish was lost for it. `values` must have words() words.
  bool push(std::uint64_t time_ns, std::span<const std::uint32_t> values) noexcept {
    std::copy(values.begin(), values.end(), slot(time_ns));
    return pushed();
  }

  // The same for words of `width` bytes each, most significant first.
  bool push(std::uint64_t time_ns, std::span<const std::uint8_t> data, std::size_t width) noexcept {
    std::uint32_t* word = slot(time_ns);
    for (const std::uint8_t* at = data.data(); at != data.data() + data.size(); at += width, ++word) {
      if (width == 4) {
        *word = std::uint32_t{at[0]} << 24 | std::uint32_t{at[1]} << 16 | std::uint32_t{at[2]} << 8 | at[3];
      } else {
        *word = 0;
        for (std::size_t byte = 0; byte < width; ++byte) {
          *word = *word << 8 | at[byte];
        }
      }
    }
    return pushed();
  }

  // Moves the oldest publishes out, as many as fit into `times_s`. `values` has room for words() times that. Returns
  // how many.
  std::size_t drain(std::span<double> times_s, std::span<std::uint32_t> values) noexcept {
    const std::size_t count = std::min(times_s.size(), size());
    std::size_t slot = static_cast<std::size_t>(tail_ % capacity_);
    for (std::size_t index = 0; index < count; ++index) {
      times_s[index] = static_cast<double>(times_[slot]) * 1e-9;
      std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(slot * words_), words_,
                  values.begin() + static_cast<std::ptrdiff_t>(index * words_));
      slot = slot + 1 == capacity_ ? 0 : slot + 1;
    }
    tail_ += count;
    return count;
  }

 private:
  std::uint32_t* slot(std::uint64_t time_ns) noexcept {
    const std::size_t slot = next_;
    next_ = next_ + 1 == capacity_ ? 0 : next_ + 1;
    times_[slot] = time_ns;
    return values_.data() + slot * words_;
  }
  bool pushed() noexcept {
    ++head_;
    if (head_ - tail_ <= capacity_) {
      return true;
    }
    ++tail_;
    ++lost_;
    return false;
  }

  std::size_t words_;
  std::size_t capacity_;
  bool keeps_;
  std::vector<std::uint64_t> times_;
  std::vector<std::uint32_t> values_;
  std::size_t next_ = 0;    // slot of the next push, head_ % capacity_
  std::uint64_t head_ = 0;  // ever pushed
  std::uint64_t tail_ = 0;  // ever drained or lost
  std::uint64_t lost_ = 0;
  std::uint64_t missing_ = 0;
};

}  // namespace unitylink
