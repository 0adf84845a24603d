// SPDX-License-Identifier: BSD-3-Clause
#include "device/framed/control_registers.hpp"

namespace unitylink::device {

namespace control = protocol::control;

std::uint32_t ControlRegisters::read(std::uint32_t address, Clock now) noexcept {
  const auto pair = [](std::uint32_t high, std::uint32_t low) { return high << 16 | low; };
  if (address >= counters_first && address <= counters_last) {
    return counter(address);
  }
  switch (address) {
    case control::magic: return protocol::control_value::magic;
    case control::version: return pair(protocol::frame::version, 0);
    case control::gateware_version: return configuration_.gateware_version;
    case control::build: return configuration_.build;
    case control::widths: return pair(8 * configuration_.address_bytes(), 8 * configuration_.data_bytes());
    case control::clock_hz: return configuration_.clock_hz;
    case control::base_hz: return configuration_.base_hz;
    case control::features: return configuration_.features();
    case control::request_credit: return configuration_.credit;
    case control::frame_limits: return pair(configuration_.request_max, configuration_.reply_max);
    case control::window: return pair(configuration_.window, configuration_.cache_bytes);
    case control::groups:
      return configuration_.publish_mode > 0 ? pair(configuration_.groups, configuration_.group_size) : 0;
    case control::exchanges: return pair(configuration_.exchanges, configuration_.exchange_size);
    case control::spec_hash_high: return static_cast<std::uint32_t>(configuration_.spec_hash >> 32);
    case control::spec_hash_low: return static_cast<std::uint32_t>(configuration_.spec_hash);
    case control::time_low: time_high_ = static_cast<std::uint32_t>(now >> 32); return static_cast<std::uint32_t>(now);
    case control::time_high: return time_high_;
    default: return 0;
  }
}

}  // namespace unitylink::device
