// SPDX-License-Identifier: BSD-3-Clause
// What a device is built with, and what stands around it on a virtual board.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "unitylink/protocol.hpp"
#include "unitylink/settings.hpp"

namespace unitylink::device {

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

// The settings (protocol/protocol.toml), what stands around the core, and what the spec's tables say.
struct DeviceConfiguration : Settings {
  std::uint16_t offers = 0;           // HELLO answers before: their count outlives a reset
  std::uint64_t offer_secret = 0;     // 0: their nonces count, as the gateware's do; else nobody can tell the next (session_offer.hpp)
  std::vector<SafeValue> safe_words;
  std::vector<std::uint32_t> flag_words;    // in rising order: what the PC writes clears these bits (W1C)
  std::vector<std::uint32_t> strobe_words;  // in rising order: what the PC writes is a PULSE, and not what it reads there
  std::vector<AddressRange> bus_error_ranges;  // answered with a bus error
  std::vector<AddressRange> silent_ranges;     // not answered at all
  TosnetConfiguration tosnet;
  std::vector<FifoConfiguration> fifos;
  std::vector<DoubleBufferConfiguration> double_buffers;

  [[nodiscard]] bool has_classic() const noexcept { return protocol != Protocol::framed; }
  [[nodiscard]] bool has_framed() const noexcept { return protocol != Protocol::classic; }
  // Clock cycles of a byte on the line: start, eight data and stop bit; 0: no line, bytes are flow-controlled.
  [[nodiscard]] std::uint32_t byte_clocks() const noexcept {
    return baud_hz > 0 ? static_cast<std::uint32_t>(std::uint64_t{clock_hz} * 10 / baud_hz) : 0;
  }
  [[nodiscard]] std::uint32_t address_bytes() const noexcept { return (address_bits + 7) / 8; }
  [[nodiscard]] std::uint32_t data_bytes() const noexcept { return (data_bits + 7) / 8; }
  [[nodiscard]] std::uint32_t mask_bytes() const noexcept;
  [[nodiscard]] bool has_checksum() const noexcept { return datalink == Datalink::full && checksum != Checksum::none; }
  [[nodiscard]] std::uint32_t address_mask() const noexcept;
  [[nodiscard]] std::uint32_t data_mask() const noexcept;
  [[nodiscard]] bool edge_event(std::uint32_t group) const noexcept { return group < edge_events.size() && edge_events[group]; }
  // What HELLO tells of the framed side.
  [[nodiscard]] std::uint32_t features() const noexcept;
  // Entries a received message may have: head, letters, colon, data bytes and tail.
  [[nodiscard]] std::uint32_t message_entries() const noexcept;
  // What is wrong with these values and what to do, or "" when nothing is.
  [[nodiscard]] std::string problem() const;
};

}  // namespace unitylink::device
