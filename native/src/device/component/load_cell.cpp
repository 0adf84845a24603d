// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/load_cell.hpp"

#include <algorithm>

namespace unitylink::device {

namespace {

constexpr std::uint32_t bits = 24;
constexpr double power_down_us = 60;
constexpr std::uint32_t settling = 4;  // conversions behind a reset

}  // namespace

LoadCell::LoadCell(Pins& pins, std::uint32_t component, const LoadCellLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines) {
  pins.output(component, lines.sck, now)->watch([this](bool level, Clock state) { edge(level, state); });
}

void LoadCell::edge(bool level, Clock state) {
  if (!level) {
    lasted("sck_high", rose_, state);
    if (rose_ != never && static_cast<double>(state - rose_) > power_down_us * lines_.us) {
      input_ = 0;
      pins_.drive_at(component_, lines_.dout, true, state);
      convert(state, settling);
    }
    return;
  }
  rose_ = state;
  if (!plugged) {
    return;
  }
  if (pulses_ > bits && state >= ready_) {
    pulses_ = 0;
    shift_ = number(4 * input_, 3);
  }
  ++pulses_;
  if (pulses_ <= bits) {
    pins_.drive_at(component_, lines_.dout, (shift_ >> (bits - pulses_) & 1u) != 0, state + 1);
  } else {
    pins_.drive_at(component_, lines_.dout, true, state + 1);
    input_ = std::min(pulses_ - bits - 1, 2u);
    if (pulses_ == bits + 1) {  // more pulses only choose the input of the next one
      ++registers[16];
      convert(state, 1);
    }
  }
}

void LoadCell::convert(Clock from, std::uint32_t conversions) {
  pulses_ = bits + 1;
  ready_ = plugged ? from + Clock{conversions} * std::max(number(12, 4), 1u) : never;
  if (plugged) {
    pins_.drive_at(component_, lines_.dout, false, ready_);
  }
}

}  // namespace unitylink::device
