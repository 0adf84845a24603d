// SPDX-License-Identifier: BSD-3-Clause
#include "server/fan_out.hpp"

#include <algorithm>
#include <utility>

#include "server/unlocked.hpp"

namespace unitylink::server {

Outcome FanOut::add(const Reader& reader, Definition definition) {
  const auto found = std::ranges::find(groups_, definition, &Group::definition);
  if (found != groups_.end()) {
    found->readers.push_back(reader);
    return {};
  }
  return open({.definition = std::move(definition), .subscription = 0, .readers = {reader}}, 1);
}

Outcome FanOut::listen(Definition definition, std::size_t ring, std::uint32_t& subscription) {
  const auto found = std::ranges::find_if(
      groups_, [&definition](const Group& group) { return group.definition == definition && !group.heard; });
  if (found != groups_.end()) {
    Outcome outcome = link_.keep_publishes(found->subscription, ring);
    found->heard = outcome.ok();
    subscription = found->subscription;
    return outcome;
  }
  Outcome outcome = open({.definition = std::move(definition), .subscription = 0, .readers = {}, .heard = true}, ring);
  if (outcome.ok()) {
    subscription = groups_.back().subscription;
  }
  return outcome;
}

Outcome FanOut::hush(std::uint32_t subscription) {
  for (Group& group : groups_) {
    if (group.subscription == subscription && group.heard) {
      group.heard = false;
      if (!group.readers.empty()) {
        link_.keep_no_more(subscription);
      }
    }
  }
  return close_unread();
}

Outcome FanOut::open(Group group, std::size_t ring) {
  const SubscriptionRequest request{.addresses = group.definition.addresses,
                                    .divisor = group.definition.divisor,
                                    .on_event = group.definition.on_event,
                                    .verify = false,  // who asks has done so, if he wants
                                    .ring = ring,
                                    .kept = group.heard,
                                    .group = group.definition.group};
  Outcome outcome = while_unlocked(mutex_, link_, [&] { return link_.subscribe(request, group.subscription); });
  if (outcome.ok()) {
    groups_.push_back(std::move(group));
  }
  return outcome;
}

void FanOut::remove(const Reader& reader) {
  for (Group& group : groups_) {
    std::erase(group.readers, reader);
  }
  static_cast<void>(close_unread());
}

void FanOut::remove(const Session& session) {
  for (Group& group : groups_) {
    std::erase_if(group.readers, [&session](const Reader& reader) { return reader.session == &session; });
  }
  static_cast<void>(close_unread());
}

Outcome FanOut::close_unread() {
  Outcome outcome;
  const auto unread = [](const Group& group) { return group.readers.empty() && !group.heard; };
  for (auto found = std::ranges::find_if(groups_, unread); found != groups_.end();
       found = std::ranges::find_if(groups_, unread)) {
    const std::uint32_t subscription = found->subscription;
    groups_.erase(found);  // first, because others may come here meanwhile
    if (Outcome closed = while_unlocked(mutex_, link_, [&] { return link_.unsubscribe(subscription); }); !closed.ok()) {
      outcome = std::move(closed);
    }
  }
  return outcome;
}

std::span<const FanOut::Reader> FanOut::readers(std::uint32_t group) const noexcept {
  for (const Group& known : groups_) {
    if (Link::group_of(known.subscription) == group) {
      return known.readers;
    }
  }
  return {};
}

}  // namespace unitylink::server
