// SPDX-License-Identifier: BSD-3-Clause
// The components in the nodes of a TosNet ring. In each cycle, words travel between their registers and the shared
// memory, as `tosnet_carrier` of the gateware has it. While the ring is broken, they have their safe values.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "device/component/component.hpp"
#include "device/tosnet.hpp"

namespace unitylink::device {

class NodeParts {
 public:
  // Takes a component. Its configuration has a node.
  void add(const ComponentConfiguration& configuration, std::unique_ptr<Component> model) {
    const std::uint32_t node = configuration.node.value_or(0);
    parts_.push_back({node, configuration.carried, configuration.constants, std::move(model)});
  }
  [[nodiscard]] bool empty() const noexcept { return parts_.empty(); }

  // A cycle has ended, or since `now` another set of nodes is commanded.
  void exchange(Tosnet& tosnet, Clock now) {
    for (Part& part : parts_) {
      const bool online = tosnet.is_commanded(part.node);
      if (!part.begun || part.online != online) {
        part.begun = true;
        part.online = online;
        for (const ConstantWord& word : part.constants) {
          part.model->write(word.offset, online ? word.value : word.safe, now);
        }
      }
      for (const CarriedWord& word : part.carried) {
        if (word.inward) {
          part.model->write(word.offset, tosnet.get(word.address, now).value, now);
        } else {
          tosnet.set(word.address, part.model->get(word.offset, now).value, now);
        }
      }
    }
  }

 private:
  struct Part {
    std::uint32_t node;
    std::vector<CarriedWord> carried;
    std::vector<ConstantWord> constants;
    std::unique_ptr<Component> model;
    bool begun = false;
    bool online = false;
  };

  std::vector<Part> parts_;
};

}  // namespace unitylink::device
