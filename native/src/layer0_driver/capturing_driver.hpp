// SPDX-License-Identifier: BSD-3-Clause
// A driver that also records its bytes in a capture (`?trace=FILE` on any link URL).
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
    // taken before sending: another thread may receive the answer before send() returns
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
  // does not close the capture, because the next driver of the link continues it
  ~CapturingDriver() override = default;
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
  [[nodiscard]] LocalLine* local_line() noexcept override { return driver_->local_line(); }
  [[nodiscard]] std::string reason() const override { return driver_->reason(); }
  void messages_end_with(std::uint8_t end) noexcept override { driver_->messages_end_with(end); }
  [[nodiscard]] std::string warning() const override { return capture_->failure(); }

 private:
  std::unique_ptr<Driver> driver_;
  std::shared_ptr<Capture> capture_;  // shared by all drivers that one link opens in turn
};

}  // namespace unitylink
