// SPDX-License-Identifier: BSD-3-Clause
// The state of one subscription. Only the files of Link use it.
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
        ring(request.addresses.size(), request.kept ? request.ring : 0) {}

  // Whether a listener can still get publishes.
  [[nodiscard]] bool heard() const noexcept { return open && ring.keeps(); }

  std::uint32_t id = 0;  // the group, plus 256 for each earlier subscription of this group
  std::vector<std::uint32_t> addresses;
  std::uint32_t divisor;
  bool on_event;
  bool open = false;
  bool closed_unheard = false;  // closed while the line was gone, so the device may still publish it
  PublishRing ring;             // kept after the end of the subscription, so that earlier publishes can be drained
};

}  // namespace unitylink
