// SPDX-License-Identifier: BSD-3-Clause
// What one client may do.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace unitylink::server {

// Addresses as ranges, rising and apart.
class Addresses {
 public:
  struct Range {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
  };

  Addresses() = default;
  explicit Addresses(std::vector<Range> ranges) : ranges_(std::move(ranges)) {}
  [[nodiscard]] bool empty() const noexcept { return ranges_.empty(); }
  [[nodiscard]] bool has(std::uint32_t address) const noexcept {
    const auto found = std::partition_point(ranges_.begin(), ranges_.end(),
                                            [address](const Range& range) { return range.last < address; });
    return found != ranges_.end() && found->first <= address;
  }

 private:
  std::vector<Range> ranges_;
};

struct Grant {
  Addresses reads;
  Addresses writes;  // if it gets the write lease
  Addresses leased;  // those of them whose write lease it has
  bool arm = false;  // it may let outputs be written again after the dead-man has tripped
};

}  // namespace unitylink::server
