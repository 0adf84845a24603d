// SPDX-License-Identifier: BSD-3-Clause
// Gateware compiled by Verilator, with the twin's physical layer in front of its byte streams.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "device/component/rtl_pins.hpp"
#include "device/served_device.hpp"
#include "unitylink/rtl_model.h"

namespace unitylink::device {

// The file is not a model, or is the model of another design. The message names it.
class RtlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The addresses of a model's words, and the places of its pins. Their place in the list is their place in the model.
struct RtlWords {
  std::vector<std::uint32_t> read;   // addresses that the PC reads: `set` writes them, `get` gives the value set
  std::vector<std::uint32_t> write;  // addresses that the PC writes: `get` reads them
  std::vector<RtlPinPlaces> pins;    // of each component; empty: they cannot be reached
};

// Unlike the twin, it does not know what comes next. So every clock is run, and next_event() is only a time to look
// again. After a failed assertion of the gateware it stops, and failure() names the assertion.
class RtlDevice final : public ServedDevice {
 public:
  // Throws RtlError.
  RtlDevice(const std::string& library, RtlWords words, const DeviceConfiguration& configuration);

  [[nodiscard]] const DeviceConfiguration& configuration() const noexcept override { return configuration_; }
  [[nodiscard]] Clock clock() const noexcept override { return clock_; }
  bool receive(std::uint8_t byte) noexcept override { return input_.offer(byte, clock_); }
  [[nodiscard]] std::size_t room() const noexcept override { return input_.room(); }
  [[nodiscard]] bool input_empty() const noexcept override { return input_.empty(); }
  void receive_error(std::uint8_t bits) override { error_ = static_cast<std::uint8_t>(error_ | (bits & 7u)); }
  void set_event(std::uint32_t group, bool high) override;
  void run_until(Clock clock) override;
  [[nodiscard]] Clock most_at_once() const noexcept override;
  [[nodiscard]] Clock most_unseen() const noexcept override;
  [[nodiscard]] Clock next_event() const noexcept override;
  bool take(TimedByte& byte) noexcept override;
  [[nodiscard]] Clock next_output() const noexcept override { return output_.next_output(); }
  BusReply get(std::uint32_t address) override;
  [[nodiscard]] Pins& pins() noexcept override { return outside_; }
  BusStatus set(std::uint32_t address, std::uint32_t value) override;
  [[nodiscard]] const DeviceStatistics& statistics() const noexcept override { return statistics_; }
  [[nodiscard]] std::string failure() const override;

  // Resets the gateware. The FIFOs in front of it lose their bytes, and its clock continues.
  void reset();
  // Reports each change of a word that the PC writes, except by a reset. This costs time at each clock.
  void observe(std::function<void(std::uint32_t address, std::uint32_t value)> on_change);

 private:
  // A word whose bits the PC clears by writing ones (W1C). In a real design the user's logic clears them.
  struct Flags {
    std::uint32_t read;
    std::uint32_t write;
  };

  void step();
  void give(std::uint32_t index, std::uint32_t value);
  void hold_reset();
  void remember();
  void look();
  [[nodiscard]] bool has_failed() const noexcept;

  DeviceConfiguration configuration_;
  const unitylink_rtl* model_;
  std::unique_ptr<void, void (*)(void*)> state_;
  const std::uint32_t* words_ = nullptr;  // within the model: the words that the PC writes
  std::unordered_map<std::uint32_t, std::uint32_t> read_index_;
  std::unordered_map<std::uint32_t, std::uint32_t> write_index_;
  std::vector<std::uint32_t> given_;  // values given to `set`, by index
  std::vector<Flags> flags_;
  std::vector<std::uint32_t> write_addresses_;
  std::function<void(std::uint32_t, std::uint32_t)> on_change_;
  std::vector<std::uint32_t> seen_;  // with an observer: the words that the PC writes
  PhysicalReceiver input_;
  PhysicalTransmitter output_;
  unitylink_rtl_pins pins_{};
  std::vector<std::uint32_t> rising_;   // groups whose event line the model has not yet seen high
  std::vector<std::uint32_t> falling_;  // those of the rising groups whose line falls after the next clock
  std::uint8_t error_ = 0;
  Clock clock_ = 0;
  DeviceStatistics statistics_;
  RtlPins outside_;
};

}  // namespace unitylink::device
