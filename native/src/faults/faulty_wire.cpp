// SPDX-License-Identifier: BSD-3-Clause
#include "faults/faulty_wire.hpp"

#include <algorithm>

namespace unitylink::faults {

bool FaultyWire::chance(double probability) {
  if (probability <= 0) {
    return false;
  }
  const bool hit = static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
  count_ += hit ? 1 : 0;
  return hit;
}

void FaultyWire::send(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) {
  for (const std::uint8_t byte : bytes) {
    open_.push_back(byte);
    if (byte == border_) {
      carry(open_, now_ns);
      open_.clear();
    }
  }
}

void FaultyWire::break_off(std::uint64_t now_ns) {
  if (!open_.empty()) {
    carry(open_, now_ns);
    open_.clear();
  }
}

void FaultyWire::carry(const Bytes& message, std::uint64_t now_ns) {
  free_ns_ = std::max(free_ns_, now_ns) + byte_ns_ * message.size();
  if (!faults_.any()) {
    deliver(message, free_ns_, 0);
    return;
  }
  const int copies = chance(faults_.lose) ? 0 : chance(faults_.repeat) ? 2 : 1;
  for (int copy = 0; copy < copies; ++copy) {
    Bytes carried = message;
    if (chance(faults_.cut)) {
      carried.resize(below(carried.size()));
    }
    damage(carried);
    if (chance(faults_.late)) {
      held_ns_ = std::max(held_ns_, free_ns_ + below(faults_.late_ns + 1));
    }
    deliver(std::move(carried), free_ns_, chance(faults_.overtake) ? below(faults_.late_ns + 1) : 0);
  }
}

void FaultyWire::damage(Bytes& message) {
  // One random number decides whether anything happens to a whole message, so that quiet wires are quick.
  const double each =
      faults_.flip + faults_.burst + faults_.lose_byte + faults_.double_byte + faults_.swap_bytes + faults_.insert_byte;
  if (each <= 0) {
    return;
  }
  std::geometric_distribution<std::size_t> distance(std::min(each, 0.999));
  for (std::size_t at = distance(random_); at < message.size(); at += 1 + distance(random_)) {
    ++count_;
    double which = static_cast<double>(random_() >> 11) * 0x1p-53 * each;
    const auto drawn = [&which](double rate) {
      const bool hit = which < rate;
      which -= rate;
      return hit;
    };
    if (drawn(faults_.flip)) {
      for (std::uint64_t bits = 1 + below(3); bits > 0; --bits) {
        message[at] = static_cast<std::uint8_t>(message[at] ^ (1u << below(8)));
      }
    } else if (drawn(faults_.burst)) {
      const std::size_t last = std::min(8 * message.size() - 1, 8 * at + 4 + below(61));
      for (std::size_t bit = 8 * at; bit <= last; ++bit) {
        const bool end = bit == 8 * at || bit == last;
        message[bit / 8] = static_cast<std::uint8_t>(message[bit / 8] ^ ((end ? 1u : below(2)) << bit % 8));
      }
    } else if (drawn(faults_.lose_byte)) {
      message.erase(at, 1);
    } else if (drawn(faults_.double_byte)) {
      message.insert(at, 1, message[at]);
    } else if (drawn(faults_.swap_bytes)) {
      if (at + 1 < message.size()) {
        std::swap(message[at], message[at + 1]);
      }
    } else {
      message.insert(at, 1, static_cast<std::uint8_t>(below(256)));
    }
  }
}

void FaultyWire::deliver(Bytes message, std::uint64_t now_ns, std::uint64_t later_ns) {
  if (message.empty()) {
    return;
  }
  const std::uint64_t at_ns = std::max(now_ns + delay_ns_, held_ns_) + later_ns;
  auto place = arriving_.end();
  while (place != arriving_.begin() && std::prev(place)->at_ns > at_ns) {
    --place;
  }
  arriving_.insert(place, {at_ns, std::move(message)});
}

}  // namespace unitylink::faults
