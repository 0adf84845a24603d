// SPDX-License-Identifier: BSD-3-Clause
// The pins of the components of compiled gateware.
#pragma once

#include <cstdint>
#include <vector>

#include "device/component/pins.hpp"
#include "unitylink/rtl_model.h"

namespace unitylink::device {

// Where the pins of a component are among those of the model.
struct RtlPinPlaces {
  std::vector<std::uint32_t> inputs;
  std::vector<std::uint32_t> outputs;
};

// A level that is driven reaches the design one clock later, as each input of compiled gateware does.
class RtlPins final : public Pins {
 public:
  RtlPins(const unitylink_rtl* model, void* state, std::vector<RtlPinPlaces> places,
          const std::vector<ComponentConfiguration>& configurations);

  OutputPin* output(std::uint32_t component, std::uint32_t pin, Clock state) override;
  // After a clock: notes which outputs have changed.
  void look(Clock state);
  [[nodiscard]] bool exist() const noexcept { return !places_.empty(); }

 private:
  bool put(std::uint32_t component, std::uint32_t pin, bool level, Clock at) override;

  const unitylink_rtl* model_;
  void* state_;
  std::vector<RtlPinPlaces> places_;
  std::vector<OutputPin> outputs_;   // by their place in the model
  std::vector<std::uint32_t> seen_;  // 32 of them in a word
  std::vector<std::uint32_t> later_;
};

}  // namespace unitylink::device
