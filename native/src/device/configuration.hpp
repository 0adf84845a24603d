// SPDX-License-Identifier: BSD-3-Clause
// The settings of a device, and the parts around it on a virtual board.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/component/component_configuration.hpp"
#include "unitylink/protocol.hpp"
#include "unitylink/settings.hpp"

namespace unitylink::device {

// Word addresses first..last, both included.
struct AddressRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

// A node of the TosNet network other than the PC's own.
struct TosnetNode {
  std::uint8_t id = 1;
  std::uint8_t registers = 0xFF;  // bit r: register r is enabled
};

// The value of an output after a trip of the dead-man.
struct SafeValue {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};

struct TosnetConfiguration {
  bool present = false;
  std::uint32_t base = 0;
  std::uint8_t master_id = 1;  // the PC's own node
  std::uint8_t master_registers = 0xFF;
  std::uint32_t cycle_clocks = 5000;     // one network cycle: 100 us at 50 MHz
  std::uint32_t max_skipped_writes = 0;  // after so many cycles without a commit the system halts; 0: never
  std::uint8_t rings = 1;                // that carry the same words; the network runs while one of them does
  std::vector<TosnetNode> nodes;
  std::vector<SafeValue> node_safe;  // what nodes of a ring see there while it is broken
  // the group whose event input each cycle drives; its edge counts
  std::optional<std::uint32_t> event_group = std::nullopt;
};

struct FifoConfiguration {
  std::uint32_t base = 0;
  std::uint32_t depth = 16;  // words in each direction
  // the group whose event input is the FIFO's event line; its edge counts
  std::optional<std::uint32_t> event_group = std::nullopt;
  std::uint32_t remind_clocks = 1u << 20;  // the event rises again if nothing was taken for so long
};

struct DoubleBufferConfiguration {
  std::uint32_t base = 0;
  std::uint32_t size = 16;  // words in a bank
};

// The settings (protocol/protocol.toml), the parts around the core, and the tables of the spec.
struct DeviceConfiguration : Settings {
  std::uint16_t offers = 0;  // number of earlier HELLO answers; a reset keeps it
  // 0: the nonces count, as in the gateware; otherwise nobody can guess the next one (session_offer.hpp)
  std::uint64_t offer_secret = 0;
  std::vector<SafeValue> safe_words;
  std::vector<std::uint32_t> flag_words;  // addresses in rising order: a write of the PC clears these bits (W1C)
  // addresses in rising order: a write of the PC is a PULSE, and does not change what the PC reads there
  std::vector<std::uint32_t> strobe_words;
  std::vector<AddressRange> bus_error_ranges;  // answered with a bus error
  std::vector<AddressRange> silent_ranges;     // not answered at all
  TosnetConfiguration tosnet;
  std::vector<FifoConfiguration> fifos;
  std::vector<DoubleBufferConfiguration> double_buffers;
  std::vector<ComponentConfiguration> components;  // of the spec; those without a model are plain words

  [[nodiscard]] bool has_classic() const noexcept { return protocol != Protocol::framed; }
  [[nodiscard]] bool has_framed() const noexcept { return protocol != Protocol::classic; }
  // Clock cycles of a byte on the line (start, eight data and stop bit). 0: there is no line, and bytes are
  // flow-controlled.
  [[nodiscard]] std::uint32_t byte_clocks() const noexcept {
    return baud_hz > 0 ? static_cast<std::uint32_t>(std::uint64_t{clock_hz} * 10 / baud_hz) : 0;
  }
  [[nodiscard]] std::uint32_t address_bytes() const noexcept { return (address_bits + 7) / 8; }
  [[nodiscard]] std::uint32_t data_bytes() const noexcept { return (data_bits + 7) / 8; }
  [[nodiscard]] std::uint32_t mask_bytes() const noexcept;
  [[nodiscard]] bool has_checksum() const noexcept { return datalink == Datalink::full && checksum != Checksum::none; }
  [[nodiscard]] std::uint32_t address_mask() const noexcept;
  [[nodiscard]] std::uint32_t data_mask() const noexcept;
  [[nodiscard]] bool edge_event(std::uint32_t group) const noexcept {
    return group < edge_events.size() && edge_events[group];
  }
  // The features that HELLO reports for the framed side.
  [[nodiscard]] std::uint32_t features() const noexcept;
  // The most entries of a received message: head, letters, colon, data bytes and tail.
  [[nodiscard]] std::uint32_t message_entries() const noexcept;
  // What is wrong with these values and the remedy, or "".
  [[nodiscard]] std::string problem() const;
};

}  // namespace unitylink::device
