// SPDX-License-Identifier: BSD-3-Clause
// A board in steps: its work is done by the thread that waits at a link (lockstep.hpp).
#include <algorithm>
#include <utility>

#include "device/board.hpp"
#include "device/board_time.hpp"

namespace unitylink::device {

namespace {

constexpr std::size_t output_most = 1024;

}  // namespace

// When the device does something by itself, or something comes out of it.
Clock Board::next_clock() const noexcept {
  const Clock next = std::min(device_->next_event(), plant_due());
  return output_blocked_ ? next : std::min(next, device_->next_output());
}

std::uint64_t Board::due_ns() noexcept {
  const std::scoped_lock lock(mutex_);
  const Clock next = next_clock();
  // rounded up: at the nanosecond before it, the clock has not come, and nothing would be done
  return next == never ? RobotTime::idle : start_ns_ + nanoseconds_up(next, configuration().clock_hz);
}

void Board::take_in() noexcept {
  const std::scoped_lock lock(mutex_);
  bool more = !stop_;
  if (more) {
    run_to_plant(clock_now());
  }
  while (more) {
    if (endpoint_->admit(at_rest_)) {
      ++statistics_.clients;
      forget_output();
    }
    if (output_blocked_) {
      flush();
    }
    more = feed();
  }
}

// Another one than its own work wants to know, or to change, its state.
void Board::catch_up() {
  Lockstep::here().touch(*this);
  const std::uint64_t now_ns = RobotTime::here().now_ns();
  if (now_ns != caught_up_ns_ && !stop_) {
    caught_up_ns_ = now_ns;
    run_to_plant(clock_now());
  }
}

void Board::work(std::uint64_t until_ns) noexcept {
  std::unique_lock lock(mutex_);
  const Clock until = whole_clocks(until_ns - start_ns_, configuration().clock_hz);
  bool whole = false;
  do {
    const Clock step = seen_step(until);
    const Clock stop = std::min(step, until);
    if (output_blocked_) {
      device_->run_until(std::min(stop, std::max(device_->clock(), device_->next_event())));
    } else {
      device_->run_to_output(stop);
    }
    RobotTime::here().step_to(start_ns_ + nanoseconds_up(device_->clock(), configuration().clock_hz));
    if (step <= device_->clock()) {
      go_on_to(step);
      step_plant(lock, device_->clock());
      if (!leaves_out_) {
        break;  // it may have moved something at other boards
      }
    }
    whole = gather() && (at_rest_ || output_.size() >= output_most);  // a message goes out as a whole, in one call
  } while (!whole && device_->clock() < until);
  if (!stop_) {  // the plant may have closed its own board
    flush();
  }
}

bool Board::begin_anew(std::unique_ptr<ServedDevice> device) {
  const auto lock = enter();
  if (!in_steps_ || stop_ || plant_steps_now_) {
    return false;
  }
  endpoint_->dismiss();
  forget_output();
  device_ = std::move(device);
  statistics_ = {};
  plant_next_ = never;
  plant_offset_ = 0;
  slip_ = 0;
  linger_until_ = 0;
  fed_ = false;
  start_ns_ = caught_up_ns_ = RobotTime::here().now_ns();
  return true;
}

BusStatus Board::preset(std::uint32_t address, std::uint32_t value) {
  const auto lock = enter();
  return device_->preset(address, value);
}

BusStatus Board::write(std::uint32_t address, std::uint32_t value) {
  const auto lock = enter();
  const BusStatus status = device_->write(address, value);
  wake();
  return status;
}

}  // namespace unitylink::device
