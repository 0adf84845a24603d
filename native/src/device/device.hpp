// SPDX-License-Identifier: BSD-3-Clause
// The twin of the classic gateware: bytes and events in, bytes out, on a clock the caller owns.
#pragma once

#include <cstdint>

#include "device/address_map.hpp"
#include "device/application.hpp"
#include "device/clock.hpp"
#include "device/configuration.hpp"
#include "device/datalink_receiver.hpp"
#include "device/datalink_transmitter.hpp"
#include "device/physical.hpp"
#include "device/subscription_manager.hpp"

namespace unitylink::device {

struct DeviceStatistics {
  std::uint64_t bytes_received = 0;   // taken by the datalink
  std::uint64_t bytes_sent = 0;       // given to the host
  std::uint64_t overruns = 0;         // bytes lost at a full receive FIFO
  std::uint64_t datalink_errors = 0;
};

// Sans-IO: no thread, no socket, no wall clock. Not thread-safe. Memory pages apart, nothing is allocated after
// construction.
//
//   Device device(configuration);
//   for (char c : std::string_view("#R:12\n")) device.receive(static_cast<std::uint8_t>(c));
//   device.run_until(100);
//   TimedByte byte; while (device.take(byte)) ...
class Device {
 public:
  // `configuration.problem()` must be empty.
  explicit Device(const DeviceConfiguration& configuration);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  [[nodiscard]] const DeviceConfiguration& configuration() const noexcept { return configuration_; }
  [[nodiscard]] Clock clock() const noexcept { return clock_; }

  // One byte from the host, now. False: no room, the host keeps it.
  bool receive(std::uint8_t byte) noexcept;
  [[nodiscard]] std::size_t room() const noexcept { return input_.room(); }
  [[nodiscard]] bool input_empty() const noexcept { return input_.empty(); }
  // The physical layer reports errors: 1 parity, 2 framing, 4 overrun. Only a full datalink listens.
  void receive_error(std::uint8_t bits);
  // The event input of one group, or of groups 0..31 at once.
  void set_event(std::uint32_t group, bool high);
  void set_events(std::uint32_t mask);

  // Everything due up to and at `clock`; never goes back.
  void run_until(Clock clock);
  // When something will happen if nothing comes from outside.
  [[nodiscard]] Clock next_event() const noexcept;
  // When the datalink last took or sent a byte.
  [[nodiscard]] Clock last_activity() const noexcept { return last_activity_; }

  // The oldest byte that has left the device; false when there is none.
  bool take(TimedByte& byte) noexcept;
  [[nodiscard]] Clock next_output() const noexcept { return output_.next_output(); }

  // The FPGA's own side of the registers.
  [[nodiscard]] AddressMap& bus() noexcept { return bus_; }
  [[nodiscard]] const DeviceStatistics& statistics() const noexcept { return statistics_; }

 private:
  [[nodiscard]] Clock receiver_clock() const noexcept;
  void take_byte();
  void report(std::uint8_t code, Clock at);

  DeviceConfiguration configuration_;
  AddressMap bus_;
  PhysicalReceiver input_;
  PhysicalTransmitter output_;
  DatalinkReceiver receiver_;
  DatalinkTransmitter transmitter_;
  SubscriptionManager subscriptions_;
  Application application_;
  Clock clock_ = 0;
  Clock receiver_ready_ = 0;
  Clock last_activity_ = 0;
  DeviceStatistics statistics_;
};

}  // namespace unitylink::device
