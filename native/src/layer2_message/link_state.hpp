// SPDX-License-Identifier: BSD-3-Clause
// What a link keeps about one subscription; private to the link's own files.
#pragma once

#include <vector>

#include "layer2_message/link.hpp"
#include "layer2_message/publish_ring.hpp"

namespace unitylink {

struct Link::Subscription {
  Subscription(const SubscriptionRequest& request)
      : addresses(request.addresses.begin(), request.addresses.end()),
        divisor(request.divisor),
        on_event(request.on_event),
        ring(request.addresses.size(), request.ring) {}

  std::uint32_t id = 0;  // its group, plus 256 for each earlier subscription of the group
  std::vector<std::uint32_t> addresses;
  std::uint32_t divisor;
  bool on_event;
  bool open = false;
  bool closed_unheard = false;  // closed while the line was gone: the device may be setting it up
  PublishRing ring;             // outlives the subscription, so that earlier publishes can still be fetched
};

}  // namespace unitylink
