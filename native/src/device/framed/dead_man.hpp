// SPDX-License-Identifier: BSD-3-Clause
// Makes the outputs safe after so many silent ticks of the base frequency. It stands in front of the bus, as in the
// gateware. From its trip on, no write of an application reaches the bus until it is armed.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/bus.hpp"
#include "device/clock.hpp"
#include "device/configuration.hpp"

namespace unitylink::device {

class DeadMan final : public Bus {
 public:
  DeadMan(const DeviceConfiguration& configuration, Bus& bus) noexcept
      : configuration_(configuration),
        bus_(bus),
        period_(std::max<Clock>(1, configuration.clock_hz / configuration.base_hz)) {}

  [[nodiscard]] std::uint32_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] bool running() const noexcept { return ticks_ > 0; }
  [[nodiscard]] bool tripped() const noexcept { return tripped_; }
  // True: it tripped in the session that is still open, so this session may not arm it.
  [[nodiscard]] bool tripped_in_session() const noexcept { return tripped_in_session_; }

  void begin_session() noexcept {
    ticks_ = 0;
    tripped_in_session_ = false;
    fed_at_ = never;
  }
  void set(std::uint32_t ticks, Clock now) noexcept {
    ticks_ = ticks;
    feed(now);
  }
  void arm() noexcept { tripped_ = missed_ = false; }
  // Call it when an intact frame of the session has arrived.
  void feed(Clock now) noexcept { fed_at_ = now; }

  void trip(Clock now) {
    tripped_ = tripped_in_session_ = true;
    ticks_ = 0;
    make_safe(now);
  }

  // Writes every output that has a safe value. If one was not answered, all are written again at the next tick. A value
  // that is refused is not repeated.
  void make_safe(Clock now) {
    missed_ = false;
    for (const SafeValue& safe : configuration_.safe_words) {
      const BusStatus status = bus_.write(safe.address & configuration_.address_mask(), safe.value, now);
      missed_ = missed_ || status == BusStatus::silent;
    }
    again_at_ = (now / period_ + 1) * period_;
  }

  // The tick at which it trips if nothing comes, or at which it repeats the safe values.
  [[nodiscard]] Clock due() const noexcept {
    return running() ? (fed_at_ / period_ + ticks_) * period_ : missed_ ? again_at_ : never;
  }

  // The bus for the applications.
  BusReply read(std::uint32_t address, Clock now) override { return bus_.read(address, now); }
  BusStatus write(std::uint32_t address, std::uint32_t value, Clock now) override {
    return tripped_ ? BusStatus::denied : bus_.write(address, value, now);
  }
  void block(bool held, Clock now) override { bus_.block(held, now); }
  BusReply get(std::uint32_t address, Clock now) override { return bus_.get(address, now); }
  BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) override {
    return bus_.set(address, value, now);
  }

 private:
  const DeviceConfiguration& configuration_;
  Bus& bus_;
  Clock period_;
  std::uint32_t ticks_ = 0;
  Clock fed_at_ = never;
  bool tripped_ = false;
  bool tripped_in_session_ = false;
  bool missed_ = false;  // a safe value had no answer
  Clock again_at_ = never;
};

}  // namespace unitylink::device
