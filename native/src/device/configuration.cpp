// SPDX-License-Identifier: BSD-3-Clause
#include "device/configuration.hpp"

#include <algorithm>
#include <bit>

#include "layer1_stream/frame_check.hpp"

namespace unitylink::device {

namespace {

constexpr std::uint32_t ones(std::uint32_t bits) noexcept { return bits >= 32 ? 0xFFFFFFFFu : (1u << bits) - 1u; }

struct Slave {
  std::string name;
  std::uint64_t first;
  std::uint64_t size;
};

}  // namespace

std::uint32_t DeviceConfiguration::mask_bytes() const noexcept {
  return std::max(protocol::limits::event_mask_bytes_min, (groups + 7) / 8);
}

std::uint32_t DeviceConfiguration::address_mask() const noexcept { return ones(address_bits); }

std::uint32_t DeviceConfiguration::data_mask() const noexcept { return ones(data_bits); }

std::uint32_t DeviceConfiguration::features() const noexcept {
  namespace value = protocol::control_value;
  return (has_classic() ? value::feature_classic : 0) | (publish_mode > 0 ? value::feature_publishing : 0) |
         (lists ? value::feature_lists : 0) | (exchanges > 0 ? value::feature_exchanges : 0) |
         (deadman ? value::feature_deadman : 0) | (long_frames ? value::feature_long_frames : 0);
}

std::uint32_t DeviceConfiguration::message_entries() const noexcept {
  const std::uint32_t address = address_bytes();
  std::uint32_t longest = std::max(4 + address + 3, 7 + address + data_bytes());
  if (read_many > 0) {
    longest = std::max(longest, 9 + address * read_many);
  }
  if (publish_mode > 0) {
    longest = std::max({longest, 10 + group_size * address, 8 + rate_bytes, 7 + mask_bytes()});
  }
  return std::bit_ceil(longest) + 1;
}

std::string DeviceConfiguration::problem() const {
  std::string wrong;
  each_limit(*this, [&wrong](const char* name, std::uint32_t value, SettingLimits limits) {
    if (wrong.empty() && (value < limits.least || value > limits.most)) {
      wrong = std::string(name) + " is " + std::to_string(value) + "; choose " + std::to_string(limits.least) + " to " +
              std::to_string(limits.most);
    }
  });
  if (!wrong.empty()) {
    return wrong;
  }
  const std::uint32_t payload_max = long_frames ? std::uint32_t{frame_payload_max} : protocol::frame::short_payload_max;
  if (std::max(request_max, reply_max) > payload_max) {
    return "request_max and reply_max are " + std::to_string(request_max) + " and " + std::to_string(reply_max) +
           "; choose at most " + std::to_string(payload_max);
  }
  if (!std::has_single_bit(window)) {
    return "window is " + std::to_string(window) + "; choose a power of two";
  }
  if (published_2012 && has_framed()) {
    return "gateware of 2012 speaks the classic protocol only; choose protocol classic";
  }
  std::vector<Slave> slaves;
  if (tosnet.present) {
    slaves.push_back({"tosnet", tosnet.base, std::uint64_t{1} << protocol::tosnet::address_bits});
    if (data_bits != 32) {
      return "data_bits is " + std::to_string(data_bits) + "; TosNet has words of 32 bits";
    }
    if (tosnet.cycle_clocks == 0) {
      return "tosnet.cycle_clocks is 0; choose the length of a network cycle in clock cycles";
    }
    if (tosnet.rings < 1 || tosnet.rings > 2) {
      return "tosnet.rings is " + std::to_string(tosnet.rings) + "; choose 1 or 2";
    }
    std::uint32_t seen = 1u << (tosnet.master_id & 15u);
    if (tosnet.master_id > 15) {
      return "tosnet.master_id is " + std::to_string(tosnet.master_id) + "; choose 0 to 15";
    }
    for (const TosnetNode& node : tosnet.nodes) {
      if (node.id < 1 || node.id > 15 || (seen >> node.id & 1u) != 0) {
        return "tosnet node id " + std::to_string(node.id) + "; ids are 1 to 15 and each stands once";
      }
      seen |= 1u << node.id;
    }
    if (tosnet.event_group && !(*tosnet.event_group < groups && edge_event(*tosnet.event_group))) {
      return "the event_group of tosnet is " + std::to_string(*tosnet.event_group) +
             "; choose one of the board's groups and list it in edge_events";
    }
  }
  for (const FifoConfiguration& queue : fifos) {
    if (queue.depth == 0) {
      return "a fifo of depth 0; choose at least 1 word";
    }
    if (queue.event_group && !(*queue.event_group < groups && edge_event(*queue.event_group))) {
      return "a fifo's event_group is " + std::to_string(*queue.event_group) +
             "; choose one of the board's groups and list it in edge_events: a level would ask once too often";
    }
    if (queue.remind_clocks < 4) {
      return "a fifo's remind_clocks is " + std::to_string(queue.remind_clocks) + "; choose at least 4";
    }
    slaves.push_back({"fifo", queue.base, 3});
  }
  for (const DoubleBufferConfiguration& buffer : double_buffers) {
    if (buffer.size == 0) {
      return "a double buffer of size 0; choose at least 1 word";
    }
    slaves.push_back({"double buffer", buffer.base, std::uint64_t{buffer.size} + 1});
  }
  for (const ComponentConfiguration& one : components) {
    if (!one.node) {
      slaves.push_back({one.path, one.base, one.words});
    }
  }
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    if (slaves[i].first + slaves[i].size - 1 > address_mask()) {
      return slaves[i].name + " at " + std::to_string(slaves[i].first) + " does not fit " +
             std::to_string(address_bits) + " address bits; give more address bits";
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (slaves[i].first < slaves[j].first + slaves[j].size && slaves[j].first < slaves[i].first + slaves[i].size) {
        return slaves[j].name + " and " + slaves[i].name + " overlap; move one of them";
      }
    }
  }
  return {};
}

}  // namespace unitylink::device
