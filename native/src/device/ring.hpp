// SPDX-License-Identifier: BSD-3-Clause
// A first-in first-out buffer with a fixed capacity, like a hardware FIFO.
#pragma once

#include <cstddef>
#include <vector>

namespace unitylink::device {

template <typename Item>
class Ring {
 public:
  explicit Ring(std::size_t capacity) : items_(capacity) {}

  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] bool full() const noexcept { return size_ == items_.size(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t free() const noexcept { return items_.size() - size_; }
  [[nodiscard]] const Item& front() const noexcept { return items_[first_]; }

  // False if it is full. Then the item is not kept.
  bool push(const Item& item) noexcept {
    if (full()) {
      return false;
    }
    const std::size_t place = first_ + size_;
    items_[place < items_.size() ? place : place - items_.size()] = item;
    ++size_;
    return true;
  }

  void pop() noexcept {
    first_ = first_ + 1 == items_.size() ? 0 : first_ + 1;
    --size_;
  }

  void clear() noexcept { size_ = 0; }

 private:
  std::vector<Item> items_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace unitylink::device
