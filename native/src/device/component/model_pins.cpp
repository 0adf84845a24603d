// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/model_pins.hpp"

#include <utility>

namespace unitylink::device {

namespace {

struct Place {
  std::uint32_t first = 0;
  std::uint32_t bits = 0;
};

// Where the pins of a port are among the inputs, or among the outputs.
Place place_of(const ComponentConfiguration& configuration, const std::string& port, bool input) {
  std::uint32_t first = 0;
  for (const PinConfiguration& pin : configuration.pins) {
    if (pin.input == input) {
      if (pin.name == port) {
        return {first, pin.bits};
      }
      first += pin.bits;
    }
  }
  return {};
}

}  // namespace

ModelPins::ModelPins(const std::vector<ComponentConfiguration>& configurations, std::vector<Component*> models)
    : models_(std::move(models)) {
  for (std::uint32_t component = 0; component < models_.size(); ++component) {
    if (models_[component] != nullptr) {
      find_two_way(component, configurations[component]);
    }
  }
}

void ModelPins::find_two_way(std::uint32_t component, const ComponentConfiguration& configuration) {
  for (const PinConfiguration& pin : configuration.pins) {
    if (!pin.input || !pin.name.ends_with("_in")) {
      continue;
    }
    const std::string name = pin.name.substr(0, pin.name.size() - 3);
    const Place input = place_of(configuration, pin.name, true);
    const Place out = place_of(configuration, name + "_out", false);
    const Place drive = place_of(configuration, name + "_drive", false);
    if (out.bits != input.bits || drive.bits != input.bits) {
      continue;
    }
    std::vector<OutputPin>& outputs = models_[component]->outputs();
    for (std::uint32_t bit = 0; bit < input.bits; ++bit) {
      two_way_.push_back(std::make_unique<TwoWay>(
          TwoWay{component, input.first + bit, &outputs[out.first + bit], &outputs[drive.first + bit]}));
      const auto settles = [this, pin = two_way_.back().get()](bool, Clock state) { settle(*pin, state); };
      outputs[out.first + bit].watch(settles);
      outputs[drive.first + bit].watch(settles);
    }
  }
}

void ModelPins::settle(const TwoWay& pin, Clock at) {
  models_[pin.component]->drive(pin.input, pin.driven->level() ? pin.out->level() : pin.outside, at);
}

bool ModelPins::drive(std::uint32_t component, std::uint32_t pin, bool level, Clock at) {
  if (component >= models_.size() || models_[component] == nullptr || pin >= models_[component]->inputs()) {
    return false;
  }
  for (const auto& one : two_way_) {
    if (one->component == component && one->input == pin) {
      one->outside = level;
      settle(*one, at);
      return true;
    }
  }
  models_[component]->drive(pin, level, at);
  return true;
}

OutputPin* ModelPins::output(std::uint32_t component, std::uint32_t pin, Clock state) {
  if (component >= models_.size() || models_[component] == nullptr) {
    return nullptr;
  }
  models_[component]->advance(state);
  std::vector<OutputPin>& outputs = models_[component]->outputs();
  return pin < outputs.size() ? &outputs[pin] : nullptr;
}

}  // namespace unitylink::device
