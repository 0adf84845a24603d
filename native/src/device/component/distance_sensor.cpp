// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/distance_sensor.hpp"

namespace unitylink::device {

namespace {

constexpr double trigger_us = 10;  // a shorter one is not seen
constexpr double burst_us = 450;   // from the trigger to the echo
constexpr double nothing_us = 38'000;

}  // namespace

DistanceSensor::DistanceSensor(Pins& pins, std::uint32_t component, const DistanceLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines) {
  pins.output(component, lines.trigger, now)->watch([this](bool level, Clock state) { edge(level, state); });
}

void DistanceSensor::edge(bool level, Clock state) {
  if (level) {
    lasted("cycle", rose_, state);
    rose_ = state;
    return;
  }
  lasted("trigger", rose_, state);
  const auto length = static_cast<double>(state - rose_);
  if (!plugged || state < rests_ || length < trigger_us * lines_.us) {
    return;
  }
  ++registers[4];
  const double echo_us = number(0, 4);
  const auto begins = state + static_cast<Clock>(burst_us * lines_.us);
  rests_ = begins + static_cast<Clock>((echo_us > 0 ? echo_us : nothing_us) * lines_.us);
  pins_.drive_at(component_, lines_.echo, true, begins);
  pins_.drive_at(component_, lines_.echo, false, rests_);
}

}  // namespace unitylink::device
