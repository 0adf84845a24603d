// SPDX-License-Identifier: BSD-3-Clause
// The generics of the gateware, and what stands around it on a virtual board.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "unitylink/protocol.hpp"

namespace unitylink::device {

enum class Checksum : std::uint8_t { none, crc8, exclusive_or };

// docs/gateware/datalink.md: full checks whole messages; lite checks nothing; none has data as bytes.
enum class Datalink : std::uint8_t { full, lite, none };

// Word addresses first..last, both included.
struct AddressRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

// A node of the TosNet network beside the PC's own.
struct TosnetNode {
  std::uint8_t id = 1;
  std::uint8_t registers = 0xFF;  // bit r: register r is enabled
};

struct TosnetConfiguration {
  bool present = false;
  std::uint32_t base = 0;
  std::uint8_t master_id = 1;               // the PC's own node
  std::uint8_t master_registers = 0xFF;
  std::uint32_t cycle_clocks = 5000;        // one network cycle: 100 us at 50 MHz
  std::uint32_t max_skipped_writes = 0;     // this many cycles without a commit halt the system; 0 = never
  std::vector<TosnetNode> nodes;
};

struct FifoConfiguration {
  std::uint32_t base = 0;
  std::uint32_t depth = 16;  // words each way
  std::optional<std::uint32_t> event_group = std::nullopt;  // whose event input the FIFO's event line drives; by edge
  std::uint32_t remind_clocks = 1u << 20;    // the event rises again when nothing has been taken for so long
};

struct DoubleBufferConfiguration {
  std::uint32_t base = 0;
  std::uint32_t size = 16;  // words in a bank
};

// What an output becomes when the dead-man trips.
struct SafeValue {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};

// docs/protocol.md
struct FramedConfiguration {
  bool present = true;
  std::uint32_t request_max = 250;  // longest payloads, in bytes
  std::uint32_t reply_max = 250;
  std::uint32_t window = protocol::frame::window_default;
  std::uint32_t cache_bytes = protocol::frame::cache_bytes_default;
  std::uint32_t exchanges = 4;
  std::uint32_t exchange_size = 64;
  std::uint16_t nonce = 0;          // of the last HELLO answer before: it outlives a reset
  std::uint32_t gateware_version = 0;
  std::uint32_t build = 0;
  std::uint64_t spec_hash = 0;
  std::vector<SafeValue> safe_values;
};

struct DeviceConfiguration {
  std::uint32_t address_bits = 8;
  std::uint32_t data_bits = 32;
  std::uint32_t clock_hz = protocol::limits::clock_hz_default;
  std::uint32_t base_hz = protocol::limits::base_hz_default;
  std::uint32_t groups = 2;
  std::uint32_t group_size = 16;
  std::uint32_t read_many = 32;   // largest read-many; 0 = no such command
  std::uint32_t rate_bytes = 2;
  std::uint32_t publish_mode = 2; // 0 none, 1 requests first, 2 publishing first
  bool configuration_command = true;
  bool classic = true;            // else the port knows frames only
  Datalink datalink = Datalink::full;
  Checksum checksum = Checksum::crc8;  // of the full datalink
  std::uint8_t polynomial = protocol::crc8::polynomial;
  std::vector<std::uint8_t> edge_events;  // bit g of byte g/8: the event input of group g is edge-triggered, else level

  std::uint32_t byte_clocks = 0;      // clock cycles per byte on the line each way; 0 = no line: flow-controlled bytes
  std::uint32_t receive_fifo = 0;     // bytes; 0 = large
  std::uint32_t transmit_fifo = 0;    // bytes; 0 = large
  std::uint32_t fifo_latency = 0;     // clock cycles through each physical FIFO; the 2012 library's takes 2
  bool honour_flush = false;          // a datalink error empties the receive FIFO, as the 2012 UART does

  bool bench_memory = false;          // memory starts as the recordings' bench has it, not as zero
  std::vector<AddressRange> bus_error_ranges;  // answered with a bus error
  std::vector<AddressRange> silent_ranges;     // not answered at all
  TosnetConfiguration tosnet;
  std::vector<FifoConfiguration> fifos;
  std::vector<DoubleBufferConfiguration> double_buffers;
  FramedConfiguration framed;

  [[nodiscard]] std::uint32_t address_bytes() const noexcept { return (address_bits + 7) / 8; }
  [[nodiscard]] std::uint32_t data_bytes() const noexcept { return (data_bits + 7) / 8; }
  [[nodiscard]] std::uint32_t mask_bytes() const noexcept;
  [[nodiscard]] bool has_checksum() const noexcept { return datalink == Datalink::full && checksum != Checksum::none; }
  [[nodiscard]] std::uint32_t address_mask() const noexcept;
  [[nodiscard]] std::uint32_t data_mask() const noexcept;
  [[nodiscard]] bool edge_event(std::uint32_t group) const noexcept {
    return group / 8 < edge_events.size() && (edge_events[group / 8] >> (group % 8) & 1u) != 0;
  }
  // What HELLO tells of the framed side.
  [[nodiscard]] std::uint32_t features() const noexcept;
  [[nodiscard]] std::uint32_t request_credit() const noexcept;
  // Entries a received message may have: head, letters, colon, data bytes and tail.
  [[nodiscard]] std::uint32_t message_entries() const noexcept;
  // What is wrong with these values and what to do, or "" when nothing is.
  [[nodiscard]] std::string problem() const;
};

}  // namespace unitylink::device
