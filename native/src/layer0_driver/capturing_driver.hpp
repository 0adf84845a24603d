// SPDX-License-Identifier: BSD-3-Clause
// A driver whose bytes are written to a capture on their way (`?trace=FILE` on any link URL).
#pragma once

#include <memory>
#include <utility>

#include "layer0_driver/capture.hpp"
#include "layer0_driver/driver.hpp"

namespace unitylink {

class CapturingDriver final : public Driver {
 public:
  CapturingDriver(std::unique_ptr<Driver> driver, std::shared_ptr<Capture> capture) noexcept
      : driver_(std::move(driver)), capture_(std::move(capture)) {}

  Transfer send(std::span<const std::uint8_t> bytes) noexcept override {
    // before: another thread may have the answer before this one goes on
    const std::uint64_t time_ns = Capture::now_ns();
    const Transfer transfer = driver_->send(bytes);
    capture_->add(time_ns, Capture::Direction::sent, bytes.first(transfer.count));
    return transfer;
  }
  Transfer receive(std::span<std::uint8_t> room) noexcept override {
    const Transfer transfer = driver_->receive(room);
    capture_->add(Capture::now_ns(), Capture::Direction::received, room.first(transfer.count));
    return transfer;
  }
  ~CapturingDriver() override = default;  // the next driver goes on with the capture
  void close() noexcept override {
    driver_->close();
    capture_->close();
  }
  void disown() noexcept override {
    driver_->disown();
    capture_->disown();
  }
  [[nodiscard]] int descriptor() const noexcept override { return driver_->descriptor(); }
  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return driver_->byte_time_ns(); }
  [[nodiscard]] TimeSource time_source() const noexcept override { return driver_->time_source(); }
  [[nodiscard]] std::string reason() const override { return driver_->reason(); }
  void messages_end_with(std::uint8_t end) noexcept override { driver_->messages_end_with(end); }
  [[nodiscard]] std::string warning() const override { return capture_->failure(); }

 private:
  std::unique_ptr<Driver> driver_;
  std::shared_ptr<Capture> capture_;  // of all drivers that have been opened for one link
};

}  // namespace unitylink
