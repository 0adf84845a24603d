// SPDX-License-Identifier: BSD-3-Clause
// The pins of the models of a twin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class ModelPins final : public Pins {
 public:
  ModelPins(const std::vector<ComponentConfiguration>& configurations, std::vector<Component*> models);
  OutputPin* output(std::uint32_t component, std::uint32_t pin, Clock state) override;

 private:
  [[nodiscard]] bool is_prompt(std::uint32_t component) const noexcept override;
  bool put(std::uint32_t component, std::uint32_t pin, bool level, Clock at) override;
  bool lend(std::uint32_t component, std::uint32_t pin, Modulator* source, Clock at) override;

  std::vector<Component*> models_;
};

}  // namespace unitylink::device
