// SPDX-License-Identifier: BSD-3-Clause
// The requests that a gateware knows, and their lengths.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "device/configuration.hpp"

namespace unitylink::device {

[[nodiscard]] inline bool has_command(const DeviceConfiguration& configuration, std::string_view letters) noexcept {
  namespace command = protocol::command;
  if (letters == command::read_configuration) {
    return configuration.configuration_command;
  }
  if (letters == command::read_many) {
    return configuration.read_many > 0;
  }
  if (letters == command::read || letters == command::write) {
    return true;
  }
  return configuration.publish_mode > 0 &&
         (letters != command::enable_checked_publishing || configuration.has_checksum());
}

// The number of bytes after the colon of a request, as far as the received bytes say.
[[nodiscard]] inline std::size_t data_bytes_needed(const DeviceConfiguration& configuration, std::string_view letters,
                                                   std::span<const std::uint8_t> data) noexcept {
  namespace command = protocol::command;
  const std::size_t address = configuration.address_bytes();
  if (!has_command(configuration, letters)) {
    return 0;
  }
  if (letters == command::read) {
    return address;
  }
  if (letters == command::write) {
    return address + configuration.data_bytes();
  }
  if (letters == command::read_many) {
    return data.empty() ? 1 : 1 + data[0] * address;
  }
  if (letters == command::write_group_addresses) {
    return data.size() < 2 ? 2 : 2 + data[1] * address;
  }
  if (letters == command::write_group_rate) {
    return 1 + configuration.rate_bytes;
  }
  if (letters == command::read_group) {
    return 1;
  }
  return letters == command::write_event_mask ? configuration.mask_bytes() : 0;
}

}  // namespace unitylink::device
