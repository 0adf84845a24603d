// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/model_pins.hpp"

#include <utility>

namespace unitylink::device {

ModelPins::ModelPins(const std::vector<ComponentConfiguration>& configurations, std::vector<Component*> models)
    : models_(std::move(models)) {
  for (std::uint32_t component = 0; component < models_.size(); ++component) {
    if (models_[component] != nullptr) {
      join(component, configurations[component]);
    }
  }
}

bool ModelPins::is_prompt(std::uint32_t component) const noexcept {
  return component < models_.size() && models_[component] != nullptr && models_[component]->is_heard();
}

bool ModelPins::put(std::uint32_t component, std::uint32_t pin, bool level, Clock at) {
  if (component >= models_.size() || models_[component] == nullptr || pin >= models_[component]->inputs()) {
    return false;
  }
  models_[component]->drive(pin, level, at);
  return true;
}

bool ModelPins::lend(std::uint32_t component, std::uint32_t pin, Modulator* source, Clock at) {
  return component < models_.size() && models_[component] != nullptr && pin < models_[component]->inputs() &&
         models_[component]->draw_bits(pin, source, at);
}

OutputPin* ModelPins::output(std::uint32_t component, std::uint32_t pin, Clock state) {
  if (component >= models_.size() || models_[component] == nullptr) {
    return nullptr;
  }
  advance_turns(state);
  return models_[component]->output_at(pin, state);
}

}  // namespace unitylink::device
