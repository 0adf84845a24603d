// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/rtl_pins.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace unitylink::device {

RtlPins::RtlPins(const unitylink_rtl* model, void* state, std::vector<RtlPinPlaces> places,
                 const std::vector<ComponentConfiguration>& configurations)
    : model_(model),
      state_(state),
      places_(std::move(places)),
      outputs_(model->output_pins),
      seen_((model->output_pins + 31) / 32) {
  for (std::uint32_t component = 0; component < std::min(places_.size(), configurations.size()); ++component) {
    join(component, configurations[component]);
  }
}

bool RtlPins::put(std::uint32_t component, std::uint32_t pin, bool level, Clock) {
  if (component >= places_.size() || pin >= places_[component].inputs.size()) {
    return false;
  }
  model_->set_pin(state_, places_[component].inputs[pin], level ? 1 : 0);
  return true;
}

OutputPin* RtlPins::output(std::uint32_t component, std::uint32_t pin, Clock) {
  if (component >= places_.size() || pin >= places_[component].outputs.size()) {
    return nullptr;
  }
  return &outputs_[places_[component].outputs[pin]];
}

// Pins that are counted come last, so that a direction that changes with its step counts.
void RtlPins::look(Clock state) {
  later_.clear();
  for (std::uint32_t word = 0; word < seen_.size(); ++word) {
    const std::uint32_t now = model_->get_pins(state_, word);
    std::uint32_t changed = now ^ std::exchange(seen_[word], now);
    for (; changed != 0; changed &= changed - 1) {
      const std::uint32_t pin = word * 32 + static_cast<std::uint32_t>(std::countr_zero(changed));
      if (outputs_[pin].is_counted()) {
        later_.push_back(pin);
      } else {
        outputs_[pin].change((now >> pin % 32 & 1u) != 0, state);
      }
    }
  }
  for (const std::uint32_t pin : later_) {
    outputs_[pin].change((seen_[pin / 32] >> pin % 32 & 1u) != 0, state);
  }
}

}  // namespace unitylink::device
