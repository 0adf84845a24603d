// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/pins.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "device/component/bus_servo.hpp"
#include "device/component/distance_sensor.hpp"
#include "device/component/i2c_registers.hpp"
#include "device/component/load_cell.hpp"
#include "device/component/serial_encoder.hpp"
#include "device/component/speed_controller.hpp"
#include "device/component/spi_registers.hpp"
#include "device/component/spi_words.hpp"
#include "device/component/thermometer.hpp"

namespace unitylink::device {

namespace {

struct Place {
  std::uint32_t first = 0;
  std::uint32_t bits = 0;
};

// Where the pins of a port are among the inputs, or among the outputs.
Place place_of(const ComponentConfiguration& configuration, const std::string& port, bool input) {
  std::uint32_t first = 0;
  for (const PinConfiguration& pin : configuration.pins) {
    if (pin.input == input) {
      if (pin.name == port) {
        return {first, pin.bits};
      }
      first += pin.bits;
    }
  }
  return {};
}

std::uint32_t device_place(const SpiLines& lines) noexcept { return lines.select_n; }
std::uint32_t device_place(const EscLines& lines) noexcept { return lines.out; }
std::uint32_t device_place(const I2cLines& lines) noexcept { return lines.scl_drive; }
std::uint32_t device_place(const ServoLines& lines) noexcept { return lines.out + 256u * lines.id; }
std::uint32_t device_place(const DistanceLines& lines) noexcept { return lines.trigger; }
std::uint32_t device_place(const LoadCellLines& lines) noexcept { return lines.sck; }
std::uint32_t device_place(const ThermometerLines& lines) noexcept { return lines.drive; }
std::uint32_t device_place(const SerialEncoderLines& lines) noexcept { return lines.sclk; }

}  // namespace

bool Pins::drive(std::uint32_t component, std::uint32_t pin, bool level, Clock at) {
  if (const auto found = modulators_.find({component, pin}); found != modulators_.end() && found->second.plugged) {
    found->second.plugged = false;
    lend(component, pin, nullptr, at);
  }
  for (const auto& one : two_way_) {
    if (one->component == component && one->input == pin) {
      one->outside = level;
      return settle(*one, at);
    }
  }
  return put(component, pin, level, at);
}

void Pins::join(std::uint32_t component, const ComponentConfiguration& configuration) {
  for (const PinConfiguration& pin : configuration.pins) {
    if (!pin.input || !pin.name.ends_with("_in")) {
      continue;
    }
    const std::string name = pin.name.substr(0, pin.name.size() - 3);
    const Place input = place_of(configuration, pin.name, true);
    const Place out = place_of(configuration, name + "_out", false);
    const Place drive = place_of(configuration, name + "_drive", false);
    if (out.bits != input.bits || drive.bits != input.bits) {
      continue;
    }
    for (std::uint32_t bit = 0; bit < input.bits; ++bit) {
      OutputPin* level = output(component, out.first + bit, 0);
      OutputPin* driven = output(component, drive.first + bit, 0);
      two_way_.push_back(std::make_unique<TwoWay>(TwoWay{component, input.first + bit, level, driven}));
      const auto settles = [this, both = two_way_.back().get()](bool, Clock state) { settle(*both, state); };
      level->watch(settles);
      driven->watch(settles);
    }
  }
}

bool Pins::settle(const TwoWay& pin, Clock at) {
  return put(pin.component, pin.input, pin.driven->level() ? pin.out->level() : pin.outside, at);
}

bool Pins::modulate(std::uint32_t component, const ModulatorLines& lines, std::int64_t level, Clock now, Clock until) {
  OutputPin* clock = output(component, lines.mclk, now);  // the bits until now have the old input
  if (clock == nullptr) {
    return false;
  }
  const auto [place, is_new] = modulators_.try_emplace({component, lines.data});
  Modulator& modulator = place->second;
  if (is_new && !put(component, lines.data, false, now)) {
    modulators_.erase(place);
    return false;
  }
  if (is_new || !modulator.plugged) {
    modulator.plugged = true;
    if (!lend(component, lines.data, &modulator, now) && is_new) {
      clock->watch([this, component, pin = lines.data, &modulator](bool high, Clock state) {
        if (high && modulator.plugged) {
          put(component, pin, modulator.bit(state), state);
        }
      });
    }
  }
  modulator.lead(level, now, until);
  return true;
}

BusDevice* Pins::attach(std::uint32_t component, const DeviceLines& lines, Clock now) {
  const std::uint32_t place = std::visit([](const auto& one) { return device_place(one); }, lines);
  if (attached(component, place) == nullptr) {
    auto made = std::visit([&](const auto& one) { return device_at(component, one, now); }, lines);
    if (made != nullptr) {
      devices_[{component, place}] = std::move(made);
    }
  }
  return attached(component, place);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const SpiLines& lines, Clock now) {
  for (const std::uint32_t pin : {lines.select_n, lines.sclk, lines.mosi}) {
    if (output(component, pin, now) == nullptr) {
      return nullptr;
    }
  }
  if (!drive(component, lines.miso, true, now)) {
    return nullptr;
  }
  if (lines.word_bits != 0) {
    return std::make_unique<SpiWords>(*this, component, lines, now);
  }
  return std::make_unique<SpiRegisters>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const EscLines& lines, Clock now) {
  if (output(component, lines.out, now) == nullptr || !drive(component, lines.in, true, now)) {
    return nullptr;
  }
  return std::make_unique<SpeedController>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const ServoLines& lines, Clock now) {
  for (const std::uint32_t pin : {lines.out, lines.enable}) {
    if (output(component, pin, now) == nullptr) {
      return nullptr;
    }
  }
  if (!drive(component, lines.in, true, now)) {
    return nullptr;
  }
  return std::make_unique<BusServo>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const I2cLines& lines, Clock now) {
  for (const std::uint32_t pin : {lines.scl_drive, lines.sda_drive}) {
    if (output(component, pin, now) == nullptr) {
      return nullptr;
    }
  }
  for (const std::uint32_t pin : {lines.scl_in, lines.sda_in}) {  // both have a pull-up
    if (!drive(component, pin, true, now)) {
      return nullptr;
    }
  }
  return std::make_unique<I2cRegisters>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const DistanceLines& lines, Clock now) {
  if (output(component, lines.trigger, now) == nullptr || !drive(component, lines.echo, false, now)) {
    return nullptr;
  }
  return std::make_unique<DistanceSensor>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const LoadCellLines& lines, Clock now) {
  if (output(component, lines.sck, now) == nullptr || !drive(component, lines.dout, true, now)) {
    return nullptr;
  }
  return std::make_unique<LoadCell>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const ThermometerLines& lines, Clock now) {
  for (const std::uint32_t pin : {lines.out(), lines.drive}) {
    if (output(component, pin, now) == nullptr) {
      return nullptr;
    }
  }
  if (!drive(component, lines.in, true, now)) {  // it has a pull-up
    return nullptr;
  }
  return std::make_unique<Thermometer>(*this, component, lines, now);
}

std::unique_ptr<BusDevice> Pins::device_at(std::uint32_t component, const SerialEncoderLines& lines, Clock now) {
  for (const std::uint32_t pin : {lines.sclk, lines.select_n, lines.mosi}) {
    if (output(component, pin, now) == nullptr) {
      return nullptr;
    }
  }
  if (!drive(component, lines.miso, true, now)) {
    return nullptr;
  }
  return std::make_unique<SerialEncoder>(*this, component, lines, now);
}

BusDevice* Pins::attached(std::uint32_t component, std::uint32_t place) const noexcept {
  const auto found = devices_.find({component, place});
  return found == devices_.end() ? nullptr : found->second.get();
}

void Pins::drive_at(std::uint32_t component, std::uint32_t pin, bool level, Clock at) {
  later_.emplace(at, Later{component, pin, level});
}

void Pins::play(std::uint32_t component, std::uint32_t pin, const std::vector<PinChange>& changes, Clock now) {
  Clock& until = played_until_[{component, pin}];
  const Clock start = std::max(until, now);
  for (const PinChange& one : changes) {
    drive_at(component, pin, one.level, start + one.at);
    until = std::max(until, start + one.at);
  }
}

std::optional<std::vector<PinChange>> Pins::take_edges(std::uint32_t component, std::uint32_t pin, Clock now) {
  constexpr std::size_t edges_most = std::size_t{1} << 20;
  OutputPin* found = output(component, pin, now);
  if (found == nullptr) {
    return std::nullopt;
  }
  const auto [place, is_new] = edges_.try_emplace({component, pin});
  std::deque<PinChange>& edges = place->second;
  if (is_new) {
    found->watch([&edges](bool level, Clock state) {
      edges.push_back({state, level});
      if (edges.size() > edges_most) {
        edges.pop_front();
      }
    });
  }
  std::vector<PinChange> taken(edges.begin(), edges.end());
  edges.clear();
  return taken;
}

// The clock of the next count. With more than one count a clock, the lines jump, as those of a shaft that is too fast.
Clock Pins::Shaft::next() const noexcept {
  if (counts == to) {
    return never;
  }
  const auto whole = static_cast<std::uint64_t>(std::llabs(to - from));
  const auto done = static_cast<std::uint64_t>(std::llabs(counts - from)) + 1;
  return begun + ((until - begun) * done + whole - 1) / whole;
}

std::int64_t Pins::Shaft::at(Clock now) const noexcept {
  if (now >= until) {
    return to;
  }
  const auto whole = static_cast<std::uint64_t>(std::llabs(to - from));
  const auto done = static_cast<std::int64_t>(whole * (now - begun) / (until - begun));
  return to < from ? from - done : from + done;
}

bool Pins::turn(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, Clock now, Clock until) {
  advance_turns(now);
  const auto [place, is_new] = shafts_.try_emplace({component, lines});
  Shaft& shaft = place->second;
  if (is_new && !(drive(component, lines.a, false, now) && drive(component, lines.b, false, now))) {
    shafts_.erase(place);
    return false;
  }
  shaft.prompt = is_prompt(component);
  shaft.from = shaft.counts;
  shaft.to = counts;
  shaft.begun = now;
  shaft.until = std::max(until, now + 1);
  return true;
}

Clock Pins::next_turn() const noexcept {
  Clock soonest = later_.empty() ? never : later_.begin()->first;
  for (const auto& [place, shaft] : shafts_) {
    soonest = shaft.prompt ? std::min(soonest, shaft.next()) : soonest;
  }
  return soonest;
}

void Pins::advance_turns(Clock now) {
  while (!later_.empty() && later_.begin()->first <= now) {
    const auto [at, next] = *later_.begin();
    later_.erase(later_.begin());
    drive(next.component, next.pin, next.level, at);
  }
  for (auto& [place, shaft] : shafts_) {
    for (Clock next = shaft.next(); next <= now; next = shaft.next()) {
      shaft.counts = shaft.at(next);
      show(place.first, place.second, shaft.counts, next);
    }
  }
}

// a leads b when it counts up: 00, 10, 11, 01.
void Pins::show(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, Clock at) {
  const auto quarter = static_cast<std::uint32_t>(counts & 3);
  drive(component, lines.a, quarter == 1 || quarter == 2, at);
  drive(component, lines.b, quarter >= 2, at);
  if (lines.per_turn > 0) {
    drive(component, lines.index, counts % lines.per_turn == 0, at);
  }
}

}  // namespace unitylink::device
