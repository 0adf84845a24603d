// SPDX-License-Identifier: BSD-3-Clause
// What a spec says of a component: where it is, its generics, its pins and its events.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace unitylink::device {

struct PinConfiguration {
  std::string name;
  bool input = false;
  std::uint32_t bits = 1;
};

struct GenericConfiguration {
  std::string name;
  std::int64_t value = 0;
  std::string text;  // of a generic that is a string
};

struct WireConfiguration {
  std::string name;
  bool input = false;
};

// What leads to an input of a component: an output of another one. Inputs and outputs are numbered apart.
struct ConnectionConfiguration {
  std::uint32_t input = 0;
  std::uint32_t component = 0;
  std::uint32_t output = 0;
};

// A word of a component in a node of a TosNet ring, and the word of the shared memory that it stands for.
struct CarriedWord {
  std::uint32_t offset = 0;   // in the component
  std::uint32_t address = 0;  // in the shared memory
  bool inward = false;        // the PC writes it
};

// A word of such a component that does not travel.
struct ConstantWord {
  std::uint32_t offset = 0;
  std::uint32_t value = 0;
  std::uint32_t safe = 0;  // while the ring does not run
};

struct ComponentConfiguration {
  std::string path;    // of the instance: "wheel[0]"
  std::string entity;  // "quadrature_encoder"
  std::uint32_t base = 0;
  std::uint32_t words = 1;
  std::uint32_t data_bits = 32;
  std::vector<GenericConfiguration> generics;  // with clock_hz, if the entity has it
  std::vector<PinConfiguration> pins;
  std::vector<std::optional<std::uint32_t>> event_groups;  // of each event: the group that it triggers

  std::vector<WireConfiguration> wires;
  std::vector<ConnectionConfiguration> connections;

  std::optional<std::uint32_t> node;  // of a ring: then it is on this node's bus, and not on that of the PC
  std::vector<CarriedWord> carried;
  std::vector<ConstantWord> constants;

  // The value of a generic, or `otherwise` if the spec gives none.
  [[nodiscard]] std::int64_t generic(const char* name, std::int64_t otherwise) const noexcept {
    for (const GenericConfiguration& one : generics) {
      if (one.name == name) {
        return one.value;
      }
    }
    return otherwise;
  }
  // The value of a generic that is a string.
  [[nodiscard]] std::string text(const char* name) const {
    for (const GenericConfiguration& one : generics) {
      if (one.name == name) {
        return one.text;
      }
    }
    return {};
  }
  [[nodiscard]] std::uint32_t bits(bool input) const noexcept {
    std::uint32_t sum = 0;
    for (const PinConfiguration& pin : pins) {
      sum += pin.input == input ? pin.bits : 0;
    }
    return sum;
  }
  [[nodiscard]] std::uint32_t count_wires(bool input) const noexcept {
    std::uint32_t count = 0;
    for (const WireConfiguration& wire : wires) {
      count += wire.input == input ? 1 : 0;
    }
    return count;
  }
  [[nodiscard]] std::uint32_t data_mask() const noexcept {
    return data_bits >= 32 ? 0xFFFFFFFFu : (1u << data_bits) - 1u;
  }
};

}  // namespace unitylink::device
