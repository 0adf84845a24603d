// SPDX-License-Identifier: BSD-3-Clause
// A device that a board can serve: the twin, or gateware compiled by Verilator. Bytes and events in, bytes out, on the
// board's clock.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "device/bus.hpp"
#include "device/clock.hpp"
#include "device/component/pins.hpp"
#include "device/configuration.hpp"
#include "device/physical.hpp"

namespace unitylink::device {

class Tosnet;

constexpr std::uint8_t overrun = 4;  // the bit of receive_error() for a byte that was lost at a full receive FIFO

struct DeviceStatistics {
  std::uint64_t bytes_received = 0;  // taken by the datalink
  std::uint64_t bytes_sent = 0;      // given to the host
  std::uint64_t overruns = 0;        // bytes lost at a full receive FIFO
  std::uint64_t datalink_errors = 0;
};

// Not thread-safe. No wall clock.
class ServedDevice {
 public:
  virtual ~ServedDevice() = default;
  ServedDevice() = default;
  ServedDevice(const ServedDevice&) = delete;
  ServedDevice& operator=(const ServedDevice&) = delete;

  [[nodiscard]] virtual const DeviceConfiguration& configuration() const noexcept = 0;
  [[nodiscard]] virtual Clock clock() const noexcept = 0;

  // Takes one byte from the host, now. False: no room, and the host keeps it.
  virtual bool receive(std::uint8_t byte) noexcept = 0;
  [[nodiscard]] virtual std::size_t room() const noexcept = 0;
  [[nodiscard]] virtual bool input_empty() const noexcept = 0;
  // The physical layer reports errors: 1 parity, 2 framing, 4 overrun.
  virtual void receive_error(std::uint8_t bits) = 0;
  // Sets the event input of one group. A pulse without a clock in between counts once, like an edge.
  virtual void set_event(std::uint32_t group, bool high) = 0;

  // Runs everything that is due up to and at `clock`. It never goes back.
  virtual void run_until(Clock clock) = 0;
  // The same, but it ends when a byte has come out, or earlier.
  virtual void run_to_output(Clock limit) {
    run_until(std::min({limit, next_event(), next_output(), clock() + most_unseen()}));
  }
  // The most clocks to run at once, so that the board can serve its client in between.
  [[nodiscard]] virtual Clock most_at_once() const noexcept { return never; }
  // The most clocks to run before its output is looked at, if another part of the process waits for it in device time.
  [[nodiscard]] virtual Clock most_unseen() const noexcept { return never / 2; }
  // When something will happen, or must be checked, without input from outside.
  [[nodiscard]] virtual Clock next_event() const noexcept = 0;

  // Takes the oldest byte that was sent. False if there is none.
  virtual bool take(TimedByte& byte) noexcept = 0;
  [[nodiscard]] virtual Clock next_output() const noexcept = 0;

  // The FPGA's own side of the registers.
  virtual BusReply get(std::uint32_t address) = 0;
  virtual BusStatus set(std::uint32_t address, std::uint32_t value) = 0;
  virtual BusStatus preset(std::uint32_t, std::uint32_t) { return BusStatus::error; }  // as Bus::preset: the twin
  // As Bus::settles: the twin, whose words are seen at next_event() only.
  [[nodiscard]] virtual Clock settles(std::uint32_t) const noexcept { return never; }
  // Writes as the dead-man does: the twin. That of compiled gateware is its own.
  virtual BusStatus write(std::uint32_t, std::uint32_t) { return BusStatus::error; }
  [[nodiscard]] virtual Tosnet* tosnet() noexcept { return nullptr; }  // the network, if it is a model
  [[nodiscard]] virtual Pins& pins() noexcept = 0;                     // of the components

  [[nodiscard]] virtual const DeviceStatistics& statistics() const noexcept = 0;
  [[nodiscard]] virtual std::string failure() const { return {}; }  // why the device has stopped, if it has
};

}  // namespace unitylink::device
