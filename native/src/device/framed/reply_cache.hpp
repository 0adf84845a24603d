// SPDX-License-Identifier: BSD-3-Clause
// One place for each id of the window: what was last executed there, and its answer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace unitylink::device {

class ReplyCache {
 public:
  enum class Verdict : std::uint8_t { fresh, repeated, stale };

  struct Place {
    std::uint16_t id = 0;
    std::uint8_t status = 0;
    bool empty = true;  // nothing was executed here
    bool kept = false;  // `reply` is the answer; false: the answer was too long
    std::vector<std::uint8_t> reply;
  };

  // `window` is a power of two.
  ReplyCache(std::uint32_t window, std::uint32_t bytes) : places_(window), bytes_(bytes) {
    for (Place& place : places_) {
      place.reply.reserve(bytes);
    }
    clear();
  }

  void clear() noexcept {
    for (std::size_t index = 0; index < places_.size(); ++index) {
      places_[index].id = static_cast<std::uint16_t>(index - places_.size());
      places_[index].empty = true;
    }
  }

  [[nodiscard]] const Place& place(std::uint16_t id) const noexcept { return places_[id & (places_.size() - 1)]; }

  [[nodiscard]] Verdict verdict(std::uint16_t id) const noexcept {
    const auto distance = static_cast<std::uint16_t>(id - place(id).id);
    if (distance == 0) {
      return place(id).empty ? Verdict::stale : Verdict::repeated;
    }
    return distance < 0x8000 ? Verdict::fresh : Verdict::stale;
  }

  // Whether the request with this id was executed: its place holds this id or a later one.
  [[nodiscard]] bool executed(std::uint16_t id) const noexcept {
    return static_cast<std::uint16_t>(place(id).id - id) < 0x8000;
  }

  void keep(std::uint16_t id, std::uint8_t status, std::span<const std::uint8_t> reply) {
    Place& chosen = places_[id & (places_.size() - 1)];
    chosen.id = id;
    chosen.empty = false;
    chosen.status = status;
    chosen.kept = reply.size() <= bytes_;
    if (chosen.kept) {
      chosen.reply.assign(reply.begin(), reply.end());
    }
  }

 private:
  std::vector<Place> places_;
  std::size_t bytes_;
};

}  // namespace unitylink::device
