// SPDX-License-Identifier: BSD-3-Clause
#include "server/fan_out.hpp"

#include <algorithm>
#include <utility>

namespace unitylink::server {

Outcome FanOut::add(const Reader& reader, Definition definition) {
  const auto found = std::ranges::find(groups_, definition, &Group::definition);
  if (found != groups_.end()) {
    found->readers.push_back(reader);
    return {};
  }
  Group group{.definition = std::move(definition), .subscription = 0, .readers = {reader}};
  link_.leave();
  Outcome outcome = link_.subscribe({.addresses = group.definition.addresses,
                                     .divisor = group.definition.divisor,
                                     .on_event = group.definition.event.has_value(),
                                     .verify = false,  // the client has done so, if it wants
                                     .ring = 1,
                                     .group = group.definition.event},
                                    group.subscription);
  if (outcome.ok()) {
    groups_.push_back(std::move(group));
  }
  return outcome;
}

void FanOut::remove(const Reader& reader) {
  for (Group& group : groups_) {
    std::erase(group.readers, reader);
  }
  close_unread();
}

void FanOut::remove(const Session& session) {
  for (Group& group : groups_) {
    std::erase_if(group.readers, [&session](const Reader& reader) { return reader.session == &session; });
  }
  close_unread();
}

void FanOut::close_unread() {
  for (auto group = groups_.begin(); group != groups_.end();) {
    if (!group->readers.empty()) {
      ++group;
      continue;
    }
    link_.leave();
    static_cast<void>(link_.unsubscribe(group->subscription));
    group = groups_.erase(group);
  }
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
