// SPDX-License-Identifier: BSD-3-Clause
// Which slave answers at which address. It is the bus as the application layer sees it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "device/bus.hpp"
#include "device/component/component.hpp"
#include "device/configuration.hpp"
#include "device/node_parts.hpp"
#include "device/tosnet.hpp"

namespace unitylink::device {

class AddressMap final : public Bus {
 public:
  // `sink` gets the changes of the slaves' event lines.
  AddressMap(const DeviceConfiguration& configuration, const EventSink& sink);

  BusReply read(std::uint32_t address, Clock now) override;
  BusStatus write(std::uint32_t address, std::uint32_t value, Clock now) override;
  void block(bool held, Clock now) override;
  BusReply get(std::uint32_t address, Clock now) override;
  BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) override;
  BusStatus preset(std::uint32_t address, std::uint32_t value, Clock now) override;

  void observe(std::function<void(std::uint32_t address, std::uint32_t value)> observer) {
    observer_ = std::move(observer);
  }

  [[nodiscard]] Clock settles(std::uint32_t address) const noexcept override;
  [[nodiscard]] Clock next_clock() const noexcept override;
  void advance(Clock now) override;

  [[nodiscard]] Tosnet* tosnet() const noexcept { return tosnet_; }
  // Called before a component is asked, so that its pins are up to date.
  void before_components(std::function<void(Clock now)> update) { before_components_ = std::move(update); }
  // The models of the components, in the order of the configuration; nullptr where there is none.
  [[nodiscard]] const std::vector<Component*>& components() const noexcept { return components_; }

 private:
  struct Region {
    AddressRange range;
    std::unique_ptr<Bus> slave;
    bool is_component = false;  // it knows itself which words are flags and strobes
  };

  [[nodiscard]] Region& region(std::uint32_t address, Clock now);
  [[nodiscard]] BusStatus refusal(std::uint32_t address) const noexcept;

  std::vector<AddressRange> errors_;
  std::vector<AddressRange> silent_;
  std::vector<std::uint32_t> flags_;
  std::vector<std::uint32_t> strobes_;
  std::vector<Region> regions_;  // the last one is the memory at all other addresses
  std::vector<Bus*> timed_;      // slaves that act without an access
  std::function<void(std::uint32_t, std::uint32_t)> observer_;
  Tosnet* tosnet_ = nullptr;
  std::vector<Component*> components_;
  NodeParts node_parts_;
  std::function<void(Clock)> before_components_;
  std::uint32_t address_mask_;
  std::uint32_t data_mask_;
};

}  // namespace unitylink::device
