// SPDX-License-Identifier: BSD-3-Clause
// The pins of the models of a twin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

// Ports called X_in, X_out and X_drive are one pin that goes both ways: an output that is driven is what is read.
class ModelPins final : public Pins {
 public:
  ModelPins(const std::vector<ComponentConfiguration>& configurations, std::vector<Component*> models);

  bool drive(std::uint32_t component, std::uint32_t pin, bool level, Clock at) override;
  OutputPin* output(std::uint32_t component, std::uint32_t pin, Clock state) override;

 private:
  struct TwoWay {
    std::uint32_t component;
    std::uint32_t input;
    OutputPin* out;
    OutputPin* driven;
    bool outside = false;  // what the outside gives
  };

  void find_two_way(std::uint32_t component, const ComponentConfiguration& configuration);
  void settle(const TwoWay& pin, Clock at);

  std::vector<Component*> models_;
  std::vector<std::unique_ptr<TwoWay>> two_way_;
};

}  // namespace unitylink::device
