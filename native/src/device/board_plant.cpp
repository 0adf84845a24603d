// SPDX-License-Identifier: BSD-3-Clause
// The steps of a board's plant. Those of plain words are left out where nobody can see them.
#include <algorithm>
#include <cmath>
#include <utility>

#include "device/board.hpp"

namespace unitylink::device {

void Board::set_plant(PlantHook hook) {
  const auto lock = enter();
  plant_ = std::move(hook);
  words_.reset();
  leaves_out_ = false;
  begin_plant(plant_.period_s);
  if (!plant_.step) {
    plant_next_ = never;
  }
}

void Board::set_plant(double period_s, WordPlant words) {
  const auto lock = enter();
  plant_ = {};
  words_ = std::move(words);
  settle_ = words_->settles(*device_);
  leaves_out_ = settle_ != never;
  begin_plant(period_s);
}

void Board::begin_plant(double period_s) {
  plant_period_ = std::max<Clock>(1, static_cast<Clock>(std::llround(period_s * configuration().clock_hz)));
  plant_next_ = 0;
}

void Board::step_plant(std::unique_lock<std::mutex>& lock, Clock until) {
  if (words_) {
    step_words(until);
    return;
  }
  while (plant_next_ <= until && !stop_) {
    device_->run_until(plant_next_);
    flush();
    const double time_s = static_cast<double>(plant_next_ + plant_offset_) / configuration().clock_hz;
    plant_next_ += plant_period_;
    plant_steps_now_ = true;
    lock.unlock();
    const bool goes_on = plant_.step(time_s);
    come_back(lock);
    plant_steps_now_ = false;
    ++statistics_.plant_steps;
    if (!goes_on) {
      plant_next_ = never;
    }
    tell_due();
  }
}

// Words need no call without the lock.
void Board::step_words(Clock until) {
  for (go_on_to(seen_step(until)); plant_next_ <= until; go_on_to(seen_step(until))) {
    device_->run_until(plant_next_);
    words_->step(*device_, static_cast<double>(plant_next_ + plant_offset_) / configuration().clock_hz);
    plant_next_ += plant_period_;
    ++statistics_.plant_steps;
  }
}

// If the device runs to `until`, the clock of the first step that can be seen at its next event, or then if this is
// earlier. No word is looked at before, except by a caller, for whom enter() has made the steps up to now.
Clock Board::seen_step(Clock until) const noexcept {
  const Clock event = device_->next_event();
  if (!leaves_out_ || std::min(event, until) <= plant_next_) {
    return plant_next_;
  }
  const Clock seen = event <= until ? event - 1 : until;  // a step at the clock of an event comes behind it
  const Clock last = (seen - plant_next_) / plant_period_;
  const Clock settling = (settle_ + plant_period_ - 1) / plant_period_;
  return plant_next_ + (last - std::min(last, settling)) * plant_period_;
}

// Leaves out the steps before this one.
void Board::go_on_to(Clock step) noexcept {
  statistics_.plant_steps += (step - plant_next_) / plant_period_;
  plant_next_ = step;
}

// Runs the device, but not past a step of the plant that must be called without the lock.
void Board::run_to_plant(Clock until) {
  if (leaves_out_) {
    step_words(until);
  }
  device_->run_until(std::min(until, plant_next_));
}

Board::PlantPhase Board::plant_phase() {
  const auto lock = enter();
  return plant_next_ == never ? PlantPhase{} : PlantPhase{plant_next_ + plant_offset_, plant_next_ - device_->clock()};
}

void Board::hold_plant() {
  const auto lock = enter();
  plant_next_ = never;
}

void Board::release_plant(const PlantPhase& phase) {
  const auto lock = enter();
  if ((plant_.step || words_) && phase.clock != never) {
    plant_next_ = device_->clock() + phase.wait;
    plant_offset_ = phase.clock - plant_next_;
    wake();
  }
}

}  // namespace unitylink::device
