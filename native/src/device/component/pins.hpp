// SPDX-License-Identifier: BSD-3-Clause
// The pins of all components of a device, as the outside drives and sees them: the seam between a component and a
// plant. It is the same for models and for compiled gateware, so a plant runs unchanged on both.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "device/clock.hpp"
#include "device/component/bus_device.hpp"
#include "device/component/component_configuration.hpp"
#include "device/component/modulator.hpp"
#include "device/component/output_pin.hpp"

namespace unitylink::device {

// The two or three lines of an incremental encoder, as input pins. index: high while counts % per_turn is 0.
struct EncoderLines {
  std::uint32_t a = 0;
  std::uint32_t b = 1;
  std::uint32_t index = 2;
  std::int64_t per_turn = 0;  // 0: there is no index

  friend bool operator<(const EncoderLines& left, const EncoderLines& right) noexcept { return left.a < right.a; }
};

// A pin has another level from this clock on.
struct PinChange {
  Clock at = 0;
  bool level = false;
};

// Ports called X_in, X_out and X_drive are one pin that goes both ways: an output that is driven is what is read.
class Pins {
 public:
  Pins() = default;
  Pins(const Pins&) = delete;
  Pins& operator=(const Pins&) = delete;
  virtual ~Pins() = default;
  // Numbers are places among the inputs, or among the outputs, of a component. False: there is no such pin.
  bool drive(std::uint32_t component, std::uint32_t pin, bool level, Clock at);
  // The output as it is in this state, or nullptr.
  virtual OutputPin* output(std::uint32_t component, std::uint32_t pin, Clock state) = 0;

  // Turns an encoder to so many counts, evenly until `until`. The lines change at their own clocks meanwhile.
  bool turn(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, Clock now, Clock until);
  // Lets the input of a modulator go to `level` evenly until `until`. The first call puts it at the lines. A level that
  // is driven on its line takes it away until the next call. False: there are no such pins.
  bool modulate(std::uint32_t component, const ModulatorLines& lines, std::int64_t level, Clock now, Clock until);
  // Puts a device at the pins of a component, once. nullptr: it has no such pins.
  BusDevice* attach(std::uint32_t component, const DeviceLines& lines, Clock now);
  // The device at this place of a component, or nullptr. The place is that of its first output, and for one of many
  // servos on a line 256 more for each id.
  [[nodiscard]] BusDevice* attached(std::uint32_t component, std::uint32_t place) const noexcept;
  // Drives an input later, as a device does that answers.
  void drive_at(std::uint32_t component, std::uint32_t pin, bool level, Clock at);
  // Gives an input these levels, each so many clocks from `now`. What is played to a pin follows what is still played.
  void play(std::uint32_t component, std::uint32_t pin, const std::vector<PinChange>& changes, Clock now);
  // The edges of an output since the last call, or nothing if there is no such pin. The first call begins. Of more
  // than `edges_most` the oldest are lost.
  std::optional<std::vector<PinChange>> take_edges(std::uint32_t component, std::uint32_t pin, Clock now);
  // When the next line changes that somebody waits for. The others change when the component is asked.
  [[nodiscard]] Clock next_turn() const noexcept;
  // All lines show what they show at `now`. Call it before a component is asked.
  void advance_turns(Clock now);

 protected:
  // Must the component see each change at its time, and not only before it is asked?
  [[nodiscard]] virtual bool is_prompt(std::uint32_t /*component*/) const noexcept { return true; }
  virtual bool put(std::uint32_t component, std::uint32_t pin, bool level, Clock at) = 0;
  // Lets a component take the bits of a pin by itself. False: it cannot, so each is put there.
  virtual bool lend(std::uint32_t /*component*/, std::uint32_t /*pin*/, Modulator* /*source*/, Clock /*at*/) {
    return false;
  }
  // Finds the pins of a component that go both ways.
  void join(std::uint32_t component, const ComponentConfiguration& configuration);

 private:
  struct TwoWay {
    std::uint32_t component;
    std::uint32_t input;
    OutputPin* out;
    OutputPin* driven;
    bool outside = false;  // what the outside gives
  };

  struct Later {
    std::uint32_t component;
    std::uint32_t pin;
    bool level;
  };

  bool settle(const TwoWay& pin, Clock at);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const SpiLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const EscLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const ServoLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const I2cLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const DistanceLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const LoadCellLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const ThermometerLines& lines, Clock now);
  std::unique_ptr<BusDevice> device_at(std::uint32_t component, const SerialEncoderLines& lines, Clock now);

  struct Shaft {
    std::int64_t counts = 0;  // that the lines show
    std::int64_t from = 0;    // counts at `begun`
    std::int64_t to = 0;
    Clock begun = 0;
    Clock until = 0;
    bool prompt = true;

    [[nodiscard]] Clock next() const noexcept;
    [[nodiscard]] std::int64_t at(Clock now) const noexcept;
  };

  void show(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, Clock at);

  std::vector<std::unique_ptr<TwoWay>> two_way_;
  std::map<std::pair<std::uint32_t, EncoderLines>, Shaft> shafts_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::unique_ptr<BusDevice>> devices_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Modulator> modulators_;
  std::multimap<Clock, Later> later_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Clock> played_until_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::deque<PinChange>> edges_;
};

}  // namespace unitylink::device
