// SPDX-License-Identifier: BSD-3-Clause
// The twin of the gateware: bytes and events in, bytes out, on a clock that the caller owns.
#pragma once

#include <cstdint>

#include "device/address_map.hpp"
#include "device/application.hpp"
#include "device/bus_master_2012.hpp"
#include "device/clock.hpp"
#include "device/component/model_pins.hpp"
#include "device/configuration.hpp"
#include "device/datalink_receiver.hpp"
#include "device/datalink_transmitter.hpp"
#include "device/framed/dead_man.hpp"
#include "device/framed/framed_application.hpp"
#include "device/framed/port_splitter.hpp"
#include "device/physical.hpp"
#include "device/served_device.hpp"
#include "device/subscription_manager.hpp"

namespace unitylink::device {

// Sans-IO: no thread, no socket, no wall clock. Not thread-safe. After construction it allocates only pages of memory.
//
//   Device device(configuration);
//   for (char c : std::string_view("#R:12\n")) device.receive(static_cast<std::uint8_t>(c));
//   device.run_until(100);
//   TimedByte byte; while (device.take(byte)) ...
class Device final : public ServedDevice {
 public:
  // `configuration.problem()` must be empty.
  explicit Device(const DeviceConfiguration& configuration);

  [[nodiscard]] const DeviceConfiguration& configuration() const noexcept override { return configuration_; }
  [[nodiscard]] Clock clock() const noexcept override { return clock_; }

  bool receive(std::uint8_t byte) noexcept override;
  [[nodiscard]] std::size_t room() const noexcept override { return input_.room(); }
  [[nodiscard]] bool input_empty() const noexcept override { return input_.empty(); }
  void receive_error(std::uint8_t bits) override;  // only a full datalink uses them
  void set_event(std::uint32_t group, bool high) override;
  void set_events(std::uint32_t mask);  // the event inputs of groups 0..31 at once

  void run_until(Clock clock) override { run(clock, false); }
  void run_to_output(Clock limit) override { run(limit, true); }
  [[nodiscard]] Clock next_event() const noexcept override;
  // When the datalink last took or sent a byte.
  [[nodiscard]] Clock last_activity() const noexcept { return last_activity_; }

  bool take(TimedByte& byte) noexcept override;
  [[nodiscard]] Clock next_output() const noexcept override { return output_.next_output(); }

  [[nodiscard]] std::uint16_t offers() const noexcept { return framed_.offers(); }
  [[nodiscard]] AddressMap& bus() noexcept { return bus_; }
  BusReply get(std::uint32_t address) override { return bus_.get(address, clock_); }
  BusStatus set(std::uint32_t address, std::uint32_t value) override { return bus_.set(address, value, clock_); }
  [[nodiscard]] Clock settles(std::uint32_t address) const noexcept override { return bus_.settles(address); }
  BusStatus preset(std::uint32_t address, std::uint32_t value) override { return bus_.preset(address, value, clock_); }
  BusStatus write(std::uint32_t address, std::uint32_t value) override { return bus_.write(address, value, clock_); }
  [[nodiscard]] Tosnet* tosnet() noexcept override { return bus_.tosnet(); }
  [[nodiscard]] Pins& pins() noexcept override { return pins_; }
  [[nodiscard]] const DeviceStatistics& statistics() const noexcept override { return statistics_; }

 private:
  [[nodiscard]] Clock receiver_clock() const noexcept;
  [[nodiscard]] Clock application_clock() const noexcept;
  [[nodiscard]] Clock transmitter_clock() const noexcept;
  [[nodiscard]] Clock framed_clock() const noexcept;
  [[nodiscard]] bool classic_idle() const noexcept { return application_.idle() && transmitter_.idle(); }
  [[nodiscard]] Clock next_beside_frames() const noexcept;
  void run(Clock clock, bool to_output);
  void take_bytes(Clock limit);
  void report(std::uint8_t code, Clock at);
  void swallow(const DatalinkReceiver::Taken& failed);

  DeviceConfiguration configuration_;
  AddressMap bus_;
  ModelPins pins_;
  DeadMan dead_man_;  // in front of the bus
  BusMaster2012 master_2012_;
  PhysicalReceiver input_;
  PhysicalTransmitter output_;
  DatalinkReceiver receiver_;
  DatalinkTransmitter transmitter_;
  SubscriptionManager subscriptions_;
  Application application_;
  PortSplitter splitter_;
  FramedApplication framed_;
  Clock clock_ = 0;
  Clock receiver_ready_ = 0;
  Clock last_activity_ = 0;
  std::uint8_t unheard_errors_ = 0;  // bits of physical errors that the gateware of 2012 has not read yet
  DeviceStatistics statistics_;
};

}  // namespace unitylink::device
