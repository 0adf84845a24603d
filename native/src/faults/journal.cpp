// SPDX-License-Identifier: BSD-3-Clause
#include "faults/journal.hpp"

#include <algorithm>
#include <cstdio>

namespace unitylink::faults {
namespace {

constexpr std::size_t past_kept = 4096;

}  // namespace

void Journal::accuse_write(const char* what, std::uint32_t address, std::uint32_t value, bool damage) {
  char text[160];
  std::snprintf(text, sizeof text, "%s: %08x at %04x", what, value, address);
  accuse(text, damage);
}

void Journal::on_write(std::uint32_t address, std::uint32_t value) {
  truth_[address - first_] = value;
  const auto same = [address, value](const Wish& wish) { return wish.value == value && wish.address == address; };
  const auto wished = std::find_if(wishes_.begin(), wishes_.end(), same);
  if (wished != wishes_.end()) {
    if (++wished->times > 1) {
      accuse_write("executed twice", address, value);
    }
    if (std::any_of(wished + 1, wishes_.end(), [](const Wish& later) { return later.times > 0; }) &&
        wished->times == 1) {
      accuse_write("executed after a later one", address, value);
    }
    return;
  }
  disturbed_ = true;
  const auto past = std::find_if(past_.rbegin(), past_.rend(), same);
  if (past == past_.rend()) {
    accuse_write("executed, but nobody asked for it", address, value, true);
  } else if (++past->times > 1) {
    accuse_write("executed twice, the second time after its outcome was reported", address, value);
  } else if (!past->unknown) {
    accuse_write("executed after it was reported as not executed", address, value);
  } else if (told_[address - first_] > past->number) {
    accuse_write("executed late, undoing a later write", address, value);
  }
}

void Journal::settle(Told told, const char* status) {
  Wish wish = wishes_.front();
  wishes_.pop_front();
  if (told == Told::executed && wish.times == 0) {
    accuse_write("reported as executed, but it was not", wish.address, wish.value, true);
  } else if (told == Told::not_executed && wish.times > 0) {
    accuse_write((std::string("reported as not executed, but it was (") + status + ")").c_str(), wish.address,
                 wish.value);
  }
  if (told == Told::executed) {
    told_[wish.address - first_] = wish.number;
  }
  wish.unknown = told == Told::unknown;
  past_.push_back(wish);
  if (past_.size() > past_kept) {
    past_.pop_front();
  }
}

}  // namespace unitylink::faults
