// SPDX-License-Identifier: BSD-3-Clause
// Sends messages of one kind, as many as there is room for, and checks the effect of each word.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "device/device.hpp"
#include "layer2_message/framed_engine.hpp"

namespace unitylink::faults {

enum class TrafficKind : std::uint8_t {
  posts,   // writes without an answer, in order
  writes,  // acknowledged writes
  reads,
};

[[nodiscard]] std::optional<TrafficKind> find_traffic(std::string_view name);

class Traffic {
 public:
  virtual ~Traffic() = default;
  // Gives the engine as much as it takes now, up to `words` in all.
  virtual void offer(std::uint64_t words, std::uint64_t now_ns) = 0;
  // The device's bus has written a word.
  virtual void on_write(std::uint32_t address, std::uint32_t value) = 0;
  // Words that got through: posts executed, requests answered.
  [[nodiscard]] virtual std::uint64_t through() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t wrong() const noexcept = 0;
};

// Each message carries `message_words`. The device's memory is filled with the words to be read.
[[nodiscard]] std::unique_ptr<Traffic> make_traffic(TrafficKind kind, std::uint32_t message_words, std::uint32_t window,
                                                    FramedEngine& engine, device::Device& device);

}  // namespace unitylink::faults
