// SPDX-License-Identifier: BSD-3-Clause
// For each operation: its letters, and the number of data bytes in its request and its reply.
#pragma once

#include <cstddef>
#include <string_view>

#include "layer1_stream/configuration.hpp"
#include "layer2_message/exchange.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

struct Letters {
  std::string_view command;
  std::string_view reply;
};

[[nodiscard]] constexpr Letters letters_of(Operation operation) noexcept {
  namespace command = protocol::command;
  namespace reply = protocol::reply;
  switch (operation) {
    case Operation::resynchronise: return {command::read_configuration, reply::read_configuration};
    case Operation::empty_message: return {"", ""};
    case Operation::read: return {command::read, reply::read};
    case Operation::read_many: return {command::read_many, reply::read_many};
    case Operation::write: return {command::write, reply::write};
    case Operation::write_group_addresses: return {command::write_group_addresses, reply::write_group_addresses};
    case Operation::write_group_rate: return {command::write_group_rate, reply::write_group_rate};
    case Operation::read_group: return {command::read_group, reply::read_group};
    case Operation::enable_publishing: return {command::enable_publishing, reply::enable_publishing};
    case Operation::enable_checked_publishing:
      return {command::enable_checked_publishing, reply::enable_checked_publishing};
    case Operation::disable_publishing: return {command::disable_publishing, reply::disable_publishing};
    case Operation::write_event_mask: return {command::write_event_mask, reply::write_event_mask};
    case Operation::read_event_mask: return {command::read_event_mask, reply::read_event_mask};
    default: break;  // an operation of the framed protocol
  }
  return {};
}

[[nodiscard]] constexpr std::size_t event_mask_bytes(std::uint32_t groups) noexcept {
  const std::size_t needed = (std::size_t{groups} + 7) / 8;
  return needed > protocol::limits::event_mask_bytes_min ? needed : protocol::limits::event_mask_bytes_min;
}

[[nodiscard]] constexpr std::size_t request_data_bytes(const Exchange& exchange,
                                                       const Configuration& configuration) noexcept {
  switch (exchange.operation) {
    case Operation::read: return configuration.address_bytes;
    case Operation::read_many: return 1 + exchange.addresses.size() * configuration.address_bytes;
    case Operation::write: return configuration.address_bytes + configuration.data_bytes;
    case Operation::write_group_addresses: return 2 + exchange.addresses.size() * configuration.address_bytes;
    case Operation::write_group_rate: return 1 + configuration.rate_bytes;
    case Operation::read_group: return 1;
    case Operation::write_event_mask: return exchange.mask.size();
    default: return 0;
  }
}

// The number of data bytes in the reply; the largest, if the device decides it (read_group).
[[nodiscard]] constexpr std::size_t reply_data_bytes(const Exchange& exchange,
                                                     const Configuration& configuration) noexcept {
  switch (exchange.operation) {
    case Operation::read: return configuration.data_bytes;
    case Operation::read_many: return exchange.addresses.size() * configuration.data_bytes;
    case Operation::read_group:
      return configuration.rate_bytes + 1 + std::size_t{configuration.group_size} * configuration.address_bytes;
    case Operation::read_event_mask: return event_mask_bytes(configuration.groups);
    default: return 0;
  }
}

}  // namespace unitylink
