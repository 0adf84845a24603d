// SPDX-License-Identifier: BSD-3-Clause
// The publish groups: their addresses, rates and events. It chooses the group that publishes next.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "device/configuration.hpp"
#include "device/clock.hpp"

namespace unitylink::device {

// Requests of one group are merged and never queue: there is one flag per cause. After publishing was disabled, rates
// continue from the same point. Publishes that were pending come as soon as it is enabled again.
class SubscriptionManager {
 public:
  explicit SubscriptionManager(const DeviceConfiguration& configuration);

  [[nodiscard]] std::span<const std::uint32_t> addresses(std::uint32_t group) const noexcept;
  // The addresses that a publish of the group reads. For an empty group in gateware of 2012, all its places.
  [[nodiscard]] std::span<const std::uint32_t> published(std::uint32_t group) const noexcept;
  [[nodiscard]] std::uint32_t rate(std::uint32_t group) const noexcept { return groups_[group].rate; }
  void set_addresses(std::uint32_t group, std::span<const std::uint32_t> addresses, Clock now);
  // Gateware of 2012: the group gets `count` addresses, but only the first have come. The others keep their old values.
  void set_part(std::uint32_t group, std::uint32_t count, std::span<const std::uint32_t> addresses, Clock now);
  void set_rate(std::uint32_t group, std::uint32_t rate, Clock now);

  // Removes all addresses, rates and events, and disables everything.
  void clear(Clock now);

  void enable(Clock now);
  void disable(Clock now);

  // Bit g % 8 of byte g / 8 belongs to group g.
  void enable_events(std::span<const std::uint8_t> mask, Clock now);
  void enable_event(std::uint32_t group, bool enabled, Clock now);
  [[nodiscard]] bool event_enabled(std::uint32_t group) const noexcept { return groups_[group].event_enabled; }
  void set_input(std::uint32_t group, bool high, Clock now);

  // When a group that is due can be served. advance() must have counted the strobes up to `now` before.
  [[nodiscard]] Clock pending_at() const noexcept { return pending_at_; }
  // When advance() has something to do.
  [[nodiscard]] Clock next_clock() const noexcept { return next_due_; }
  void advance(Clock now);
  // The group that is served now. Its request is removed. None if no group is pending.
  std::optional<std::uint32_t> serve(Clock now);
  void ask_again(std::uint32_t group, Clock now);
  // Ticks of a group that came before its earlier publish was served.
  [[nodiscard]] std::uint32_t overruns() const noexcept { return overruns_; }

 private:
  struct Group {
    std::vector<std::uint32_t> addresses;  // all places
    std::size_t count = 0;                 // places in use
    std::uint32_t rate = 0;
    std::uint32_t strobes = 0;
    bool due = false;
    bool event = false;
    bool event_enabled = false;
    bool input = false;
    bool edge = false;
  };

  [[nodiscard]] bool requests(const Group& group) const noexcept;
  [[nodiscard]] bool has_words(const Group& group) const noexcept { return group.count > 0 || published_2012_; }
  void count_strobes(Clock now);
  void plan(Clock now);

  std::vector<Group> groups_;
  bool published_2012_;
  Clock period_;
  std::uint32_t last_served_ = 0;
  std::uint32_t overruns_ = 0;
  bool enabled_ = false;
  Clock next_strobe_ = never;
  Clock next_due_ = never;
  Clock pending_at_ = never;
};

}  // namespace unitylink::device
