// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/local_line.hpp"

#include <algorithm>
#include <map>

namespace unitylink {
namespace {

struct OfferedLines {
  std::mutex mutex;
  std::map<int, std::weak_ptr<LocalLine>> by_descriptor;
};

OfferedLines& offered_lines() {
  static auto* const lines = new OfferedLines;  // never deleted, as RobotTime
  return *lines;
}

}  // namespace

LocalLine::LocalLine() {
  for (End& end : ends_) {
    end.bytes.reserve(room);  // pages that no byte reaches take no memory
  }
}

void LocalLine::offer(int descriptor, const std::shared_ptr<LocalLine>& line) {
  const std::scoped_lock lock(offered_lines().mutex);
  offered_lines().by_descriptor[descriptor] = line;
}

std::shared_ptr<LocalLine> LocalLine::claim(int descriptor) {
  const std::scoped_lock lock(offered_lines().mutex);
  const auto found = offered_lines().by_descriptor.extract(descriptor);
  return found.empty() ? nullptr : found.mapped().lock();
}

void LocalLine::tell(const End& end) noexcept {
  if (end.member != nullptr) {
    Lockstep::here().touch(*end.member);
  }
}

Transfer LocalLine::send(Side from, std::span<const std::uint8_t> bytes) noexcept {
  const std::scoped_lock lock(mutex_);
  End& to = ends_[other(from)];
  if (!to.open || !ends_[from].open) {
    return {0, Status::closed};
  }
  if (to.taken > 0 && bytes.size() > room - to.bytes.size()) {
    to.bytes.erase(to.bytes.begin(), to.bytes.begin() + static_cast<std::ptrdiff_t>(to.taken));
    to.taken = 0;
  }
  const std::size_t count = std::min(bytes.size(), room - to.bytes.size());
  to.bytes.insert(to.bytes.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
  if (count > 0) {
    tell(to);
  }
  return {count, Status::ok};
}

Transfer LocalLine::receive(Side at, std::span<std::uint8_t> into) noexcept {
  const std::scoped_lock lock(mutex_);
  End& end = ends_[at];
  const std::size_t count = std::min(into.size(), end.bytes.size() - end.taken);
  if (count == 0) {
    return {0, into.empty() || (end.open && ends_[other(at)].open) ? Status::ok : Status::closed};
  }
  std::copy_n(end.bytes.begin() + static_cast<std::ptrdiff_t>(end.taken), count, into.begin());
  end.taken += count;
  if (end.bytes.size() == room) {  // the other side may have waited for room
    tell(ends_[other(at)]);
  }
  if (end.taken == end.bytes.size()) {
    end.bytes.clear();
    end.taken = 0;
  }
  return {count, Status::ok};
}

void LocalLine::close(Side side) noexcept {
  const std::scoped_lock lock(mutex_);
  ends_[side].open = false;
  tell(ends_[other(side)]);
}

bool LocalLine::readable(Side at) noexcept {
  const std::scoped_lock lock(mutex_);
  return ends_[at].taken < ends_[at].bytes.size() || !ends_[at].open || !ends_[other(at)].open;
}

bool LocalLine::writable(Side from) noexcept {
  const std::scoped_lock lock(mutex_);
  const End& to = ends_[other(from)];
  return to.taken > 0 || to.bytes.size() < room || !to.open;
}

void LocalLine::listen(Side side, Lockstep::Member* member) noexcept {
  const std::scoped_lock lock(mutex_);
  ends_[side].member = member;
}

}  // namespace unitylink
