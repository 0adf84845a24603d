// SPDX-License-Identifier: BSD-3-Clause
#include "device/subscription_manager.hpp"

#include <algorithm>

namespace unitylink::device {

SubscriptionManager::SubscriptionManager(const DeviceConfiguration& configuration)
    : groups_(configuration.groups),
      published_2012_(configuration.published_2012),
      period_(std::max<Clock>(1, configuration.clock_hz / configuration.base_hz)) {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].addresses.resize(configuration.group_size);
    groups_[g].edge = configuration.edge_event(static_cast<std::uint32_t>(g));
  }
}

std::span<const std::uint32_t> SubscriptionManager::addresses(std::uint32_t group) const noexcept {
  return std::span(groups_[group].addresses).first(groups_[group].count);
}

std::span<const std::uint32_t> SubscriptionManager::published(std::uint32_t group) const noexcept {
  const bool rubbish = published_2012_ && groups_[group].count == 0;
  return rubbish ? std::span<const std::uint32_t>(groups_[group].addresses) : addresses(group);
}

void SubscriptionManager::set_addresses(std::uint32_t group, std::span<const std::uint32_t> addresses, Clock now) {
  set_part(group, static_cast<std::uint32_t>(addresses.size()), addresses, now);
}

void SubscriptionManager::set_part(std::uint32_t group, std::uint32_t count, std::span<const std::uint32_t> addresses,
                                   Clock now) {
  count_strobes(now);
  std::copy(addresses.begin(), addresses.end(), groups_[group].addresses.begin());
  groups_[group].count = count;
  plan(now);
}

void SubscriptionManager::set_rate(std::uint32_t group, std::uint32_t rate, Clock now) {
  count_strobes(now);
  Group& chosen = groups_[group];
  chosen.rate = rate;
  if (rate == 0 && !published_2012_) {  // 2012 gateware still publishes a request that was made before
    chosen.due = false;
  }
  if (chosen.strobes >= rate) {
    chosen.strobes = 0;
  }
  plan(now);
}

void SubscriptionManager::clear(Clock now) {
  for (Group& group : groups_) {
    group.count = 0;
    group.rate = group.strobes = 0;
    group.due = group.event = group.event_enabled = false;
  }
  disable(now);
}

void SubscriptionManager::enable(Clock now) {
  if (!enabled_) {
    enabled_ = true;
    next_strobe_ = now;  // publishing starts with a strobe
  }
  plan(now);
}

void SubscriptionManager::disable(Clock now) {
  count_strobes(now);
  enabled_ = false;
  next_strobe_ = never;
  plan(now);
}

void SubscriptionManager::enable_event(std::uint32_t group, bool enabled, Clock now) {
  Group& chosen = groups_[group];
  chosen.event_enabled = enabled;
  chosen.event = chosen.event || (enabled && chosen.input && !chosen.edge);
  plan(now);
}

void SubscriptionManager::enable_events(std::span<const std::uint8_t> mask, Clock now) {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    enable_event(static_cast<std::uint32_t>(g), (mask[g / 8] >> (g % 8) & 1u) != 0, now);
  }
}

void SubscriptionManager::set_input(std::uint32_t group, bool high, Clock now) {
  Group& chosen = groups_[group];
  // A level counts in every clock in which it is high, also in the last one. An edge counts only where it rises.
  if (chosen.event_enabled && (chosen.edge ? high && !chosen.input : high || chosen.input)) {
    chosen.event = true;
  }
  chosen.input = high;
  plan(now);
}

bool SubscriptionManager::requests(const Group& group) const noexcept {
  // An empty group has nothing to publish, whatever its rate or event says.
  return has_words(group) && (group.due || group.event || (group.input && group.event_enabled && !group.edge));
}

void SubscriptionManager::count_strobes(Clock now) {
  if (next_strobe_ > now) {
    return;
  }
  const Clock passed = (now - next_strobe_) / period_ + 1;
  next_strobe_ += passed * period_;
  for (Group& group : groups_) {
    if (group.rate == 0 || !has_words(group)) {
      continue;
    }
    const Clock strobes = group.strobes + passed;
    const Clock dues = strobes / group.rate;
    overruns_ += static_cast<std::uint32_t>(dues > 0 ? dues - (group.due ? 0 : 1) : 0);
    group.due = group.due || dues > 0;
    group.strobes = static_cast<std::uint32_t>(strobes % group.rate);
  }
}

void SubscriptionManager::plan(Clock now) {
  next_due_ = never;
  if (!enabled_) {
    pending_at_ = never;
    return;
  }
  bool pending = false;
  for (const Group& group : groups_) {
    pending = pending || requests(group);
    if (group.rate > 0 && has_words(group) && !group.due) {
      next_due_ = std::min(next_due_, next_strobe_ + (group.rate - group.strobes - 1) * period_);
    }
  }
  if (!pending) {
    pending_at_ = never;
  } else if (pending_at_ == never) {
    pending_at_ = now + timing::publish_decision;
  }
}

void SubscriptionManager::ask_again(std::uint32_t group, Clock now) {
  groups_[group].due = true;
  plan(now);
}

void SubscriptionManager::advance(Clock now) {
  count_strobes(now);
  plan(now);
}

std::optional<std::uint32_t> SubscriptionManager::serve(Clock now) {
  advance(now);
  const auto count = static_cast<std::uint32_t>(groups_.size());
  // Descending and cyclic, from the one served last: the request farthest from it is served.
  for (std::uint32_t step = 1; step <= count; ++step) {
    const std::uint32_t candidate = (last_served_ + count - step) % count;
    Group& group = groups_[candidate];
    if (!requests(group)) {
      continue;
    }
    (group.due ? group.due : group.event) = false;  // a rate is served before an event of the same group
    last_served_ = candidate;
    plan(now);
    return candidate;
  }
  return std::nullopt;
}

}  // namespace unitylink::device
