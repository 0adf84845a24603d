// SPDX-License-Identifier: BSD-3-Clause
// What the device is asked to publish, and for whom it is kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace unitylink {

struct SubscriptionRequest {
  std::span<const std::uint32_t> addresses;
  std::uint32_t divisor = 0;  // publish every `divisor` base periods; 0: not by time
  bool on_event = false;      // publish at an event of the group's event input
  bool verify = true;  // read each address once first: 2012 gateware repeats a publish for ever if one never answers
  std::size_t ring = 4096;  // publishes kept until they are drained
  bool kept = true;         // false: only a tap gets them
  // the group of the gateware, if a certain event line is needed; else any
  std::optional<std::uint32_t> group = std::nullopt;
};

}  // namespace unitylink
