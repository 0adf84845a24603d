// SPDX-License-Identifier: BSD-3-Clause
#include "device/tosnet.hpp"

#include <algorithm>
#include <utility>

namespace unitylink::device {

namespace map = protocol::tosnet;

namespace {

constexpr std::uint32_t bit(bool set, std::uint32_t position) noexcept { return (set ? 1u : 0u) << position; }

// Destination and number of valid bytes of an asynchronous word, in the form of the status and control registers.
constexpr std::uint32_t place(const AsyncWord& word) noexcept {
  return static_cast<std::uint32_t>(word.last) << 4 | word.node;
}

}  // namespace

Tosnet::Tosnet(const TosnetConfiguration& configuration, EventSink sink)
    : configuration_(configuration), sink_(std::move(sink)) {}

Clock Tosnet::next_clock() const noexcept {
  return configuration_.event_group || exchanged_ ? (cycles_ + 1) * configuration_.cycle_clocks : never;
}

void Tosnet::advance(Clock now) {
  const Clock cycles = now / configuration_.cycle_clocks;
  if (cycles <= cycles_) {
    return;
  }
  const Clock passed = cycles - cycles_;
  cycles_ = cycles;
  if (!online_) {
    return;
  }
  packets_ += static_cast<std::uint32_t>(passed);
  damaged_ = false;
  Clock idle = passed;
  if (commit_pending_) {
    write_bank_ ^= 1u;
    commit_pending_ = false;
    skipped_ = 0;
    --idle;
  }
  if (configuration_.max_skipped_writes > 0) {
    skipped_ = static_cast<std::uint32_t>(std::min<Clock>(skipped_ + idle, 0xFFFFFFFFu));
    halted_ = halted_ || skipped_ > configuration_.max_skipped_writes;
  }
  exchange(now);
  to_nodes_.travel(passed);
  from_nodes_.travel(passed);
  stale_ = held_;
  if (!held_) {
    show();
  }
  if (configuration_.event_group && sink_) {  // several cycles at once are one edge, as in the gateware
    sink_(*configuration_.event_group, true, now);
    sink_(*configuration_.event_group, false, now);
  }
}

void Tosnet::show() {
  constexpr std::size_t node_words = std::size_t{1} << map::node_shift;
  shown_bank_ = write_bank_ ^ 1u;
  for (std::size_t id = 0; id < seen_.size() / node_words; ++id) {
    if ((absent_ >> id & 1u) == 0) {
      std::copy_n(outputs_.begin() + static_cast<std::ptrdiff_t>(id * node_words), node_words,
                  seen_.begin() + static_cast<std::ptrdiff_t>(id * node_words));
    }
  }
}

void Tosnet::restart() {
  ++resets_;
  halted_ = false;
  skipped_ = 0;
}

bool Tosnet::writable(std::uint32_t address) const noexcept {
  return (address >> map::in_bit & 1u) != 0 || address >> map::node_shift == configuration_.master_id;
}

std::uint32_t Tosnet::status() const noexcept {
  return bit(online_, map::status_online_bit) | bit(online_, map::status_master_bit) |
         bit(damaged_, map::status_packet_error_bit) | bit(halted_, map::status_system_halt_bit) |
         (configuration_.rings > 1 ? rings_down_ << (map::status_node_id_shift + 4) : 0u) |
         static_cast<std::uint32_t>(configuration_.master_id) << map::status_node_id_shift |
         0u << map::status_node_address_shift |  // the master is first in the ring
         bit(read_refused_, map::status_read_error_bit) | bit(write_refused_, map::status_write_error_bit) |
         bit(commit_aborted_, map::status_commit_aborted_bit) | bit((cycles_ & 1u) != 0, map::status_read_pointer_bit) |
         bit(write_bank_ != 0, map::status_write_pointer_bit) | bit(held_, map::status_read_frozen_bit) |
         bit(commit_pending_, map::status_commit_pending_bit);
}

std::uint32_t Tosnet::network_register(std::uint32_t index) const noexcept {
  const auto entry = [index](std::uint32_t id, std::uint32_t enabled) {
    return enabled << 16 | enabled << 8 | index << 4 | id;
  };
  if (index == 0) {
    return entry(configuration_.master_id, configuration_.master_registers);
  }
  std::uint32_t place = 0;
  for (const TosnetNode& node : configuration_.nodes) {
    if ((absent_ >> node.id & 1u) == 0 && ++place == index) {
      return entry(node.id, node.registers);
    }
  }
  return 0;  // the list ends where the stored address is not the index
}

BusReply Tosnet::read(std::uint32_t address, Clock now) {
  advance(now);
  if (address < map::memory_words) {
    read_refused_ = false;
    return {BusStatus::ok, writable(address) ? banks_[shown_bank_][address] : seen_[address]};
  }
  if (address >= map::network_registers && address < map::network_registers + 16) {
    return {BusStatus::ok, network_register(address - map::network_registers)};
  }
  switch (address) {
    case map::status: return {BusStatus::ok, status()};
    case map::packet_counter: return {BusStatus::ok, packets_};
    case map::reset_counter: return {BusStatus::ok, resets_};
    case map::error_counter: return {BusStatus::ok, errors_};
    case map::async_tx_status: return {BusStatus::ok, bit(to_nodes_.full(), 6) | place(async_control_)};
    case map::async_rx_status: {
      const bool arrived = from_nodes_.arrived();
      return {BusStatus::ok, arrived ? bit(true, 6) | place(from_nodes_.front()) : bit(true, 7)};
    }
    case map::async_rx_data:
      if (from_nodes_.arrived()) {
        return {BusStatus::ok, from_nodes_.take().data};
      }
      break;
    default: break;
  }
  read_refused_ = true;
  return {BusStatus::error, 0};
}

BusStatus Tosnet::write(std::uint32_t address, std::uint32_t value, Clock now) {
  advance(now);
  if (address < map::memory_words && writable(address)) {
    write_refused_ = false;
    if (commit_pending_) {
      commit_pending_ = false;
      commit_aborted_ = true;
    }
    banks_[write_bank_][address] = value;
    return BusStatus::ok;
  }
  switch (address) {
    case map::status:
      commit_pending_ = true;
      commit_aborted_ = false;
      return BusStatus::ok;
    case map::async_tx_control:
      async_control_.last = static_cast<std::uint8_t>(value >> 4 & 3u);
      async_control_.node = static_cast<std::uint8_t>(value & 15u);
      return BusStatus::ok;
    case map::async_tx_data:
      if (to_nodes_.put({value, async_control_.last, async_control_.node})) {
        return BusStatus::ok;
      }
      break;
    default: break;
  }
  write_refused_ = true;
  return BusStatus::error;
}

void Tosnet::block(bool held, Clock now) {
  advance(now);
  held_ = held;
  if (stale_ && !held) {
    stale_ = false;
    show();
  }
}

BusReply Tosnet::get(std::uint32_t address, Clock now) {
  advance(now);
  if (address >= map::memory_words) {
    return address == map::status ? BusReply{BusStatus::ok, status()} : BusReply{BusStatus::error, 0};
  }
  if (!is_commanded(address >> map::node_shift)) {
    for (const SafeValue& safe : configuration_.node_safe) {
      if (safe.address == address) {
        return {BusStatus::ok, safe.value};
      }
    }
  }
  return {BusStatus::ok, writable(address) ? banks_[write_bank_ ^ 1u][address] : outputs_[address]};
}

BusStatus Tosnet::set(std::uint32_t address, std::uint32_t value, Clock now) {
  advance(now);
  if (address >= map::memory_words || writable(address)) {
    return BusStatus::error;
  }
  outputs_[address] = value;
  return BusStatus::ok;
}

BusStatus Tosnet::preset(std::uint32_t address, std::uint32_t value, Clock now) {
  if (address >= map::memory_words || !writable(address)) {
    seen_[address % map::memory_words] = value;
    return set(address, value, now);
  }
  banks_[0][address] = banks_[1][address] = value;
  return BusStatus::ok;
}

Clock Tosnet::settles(std::uint32_t address) const noexcept {
  return address < map::memory_words ? configuration_.cycle_clocks : never;
}

void Tosnet::exchange(Clock now) {
  if (exchanged_) {
    exchanged_(now);
  }
}

void Tosnet::set_online(bool online, Clock now) { set_rings_down(online ? 0 : all_rings(), now); }

bool Tosnet::set_ring(std::uint32_t ring, bool whole, Clock now) {
  if (ring >= configuration_.rings) {
    return false;
  }
  set_rings_down(whole ? rings_down_ & ~(1u << ring) : rings_down_ | 1u << ring, now);
  return true;
}

void Tosnet::set_rings_down(std::uint32_t down, Clock now) {
  advance(now);
  rings_down_ = down;
  const bool online = down != all_rings();
  if (online == online_) {
    return;
  }
  if (online) {
    restart();
  }
  online_ = online;
  exchange(now);
}

bool Tosnet::set_node(std::uint32_t id, bool present, Clock now) {
  advance(now);
  const auto& nodes = configuration_.nodes;
  if (std::none_of(nodes.begin(), nodes.end(), [id](const TosnetNode& node) { return node.id == id; })) {
    return false;
  }
  const std::uint32_t absent = present ? absent_ & ~(1u << id) : absent_ | 1u << id;
  if (absent != absent_) {
    absent_ = absent;
    restart();
    exchange(now);
  }
  return true;
}

void Tosnet::damage_cycle(Clock now) {
  advance(now);
  ++errors_;
  damaged_ = true;
}

bool Tosnet::async_take(AsyncWord& word, Clock now) {
  advance(now);
  if (!to_nodes_.arrived()) {
    return false;
  }
  word = to_nodes_.take();
  return true;
}

bool Tosnet::async_give(const AsyncWord& word, Clock now) {
  advance(now);
  return from_nodes_.put(word);
}

}  // namespace unitylink::device
