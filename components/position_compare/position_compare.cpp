// SPDX-License-Identifier: BSD-3-Clause
// The model of position_compare.vhd.
#include <algorithm>

#include "device/component/component.hpp"

namespace unitylink::device {

namespace {

class PositionCompare final : public Component {
 public:
  explicit PositionCompare(const ComponentConfiguration& from)
      : Component(from, "1110", false),
        pulse_clocks_(lasting(from.generic("pulse_ns", 1000), from.generic("clock_hz", 50'000'000))),
        level_at_rest_(from.generic("active_level", 1) == 0) {
    if (!outputs().empty()) {  // not in a look whether there is a model
      output(line, level_at_rest_, never);
    }
  }

 private:
  enum Register : std::uint32_t { control, at, step_word, count };
  enum Event : std::uint32_t { reached };
  enum Output : std::uint32_t { line };
  static constexpr std::uint32_t step_mask = 0x7FFFFFFF;
  static constexpr std::uint32_t sign = 0x80000000;

  struct Registers {
    std::uint32_t at = 0;
    std::uint32_t count = 0;
    bool past = false;
    bool valid = false;
    bool fresh = false;
    bool armed = false;
    bool pulse = false;
    bool above = false;
    bool is_active = false;

    bool operator==(const Registers&) const = default;
  };

  [[nodiscard]] static Clock lasting(std::int64_t time_ns, std::int64_t clock_hz) noexcept {
    const std::int64_t clock_khz = (clock_hz + 999) / 1000;
    return static_cast<Clock>((time_ns * clock_khz + 999'999) / 1'000'000);
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min(look_, now_.pulse ? ends_ : never); }

  void step(Clock edge) override {
    const Registers before = now_;
    const std::uint32_t asked = write_word(control);
    const bool enable = (asked & 1u) != 0;
    const bool down = (asked & 2u) != 0;
    const bool level = (asked & 4u) != 0;
    const std::uint32_t by = write_word(step_word) & step_mask;
    const bool is_same = before.fresh && !is_written(control, edge);
    const bool usable = enable && before.valid && is_same;
    const bool fires = usable && before.past && before.armed && !level && !before.pulse;

    now_.past = ((down ? before.at - value_.value : value_.value - before.at) & sign) == 0;
    now_.valid = value_.valid;
    now_.fresh = !is_written(at, edge);
    now_.above = enable && before.valid && (is_same ? before.past : before.above);
    now_.armed = before.valid && (before.armed || (usable && !before.past));
    if (fires) {
      now_.armed = by != 0;
      now_.at = down ? before.at - by : before.at + by;
      ends_ = edge + pulse_clocks_;
    }
    if (is_written(at, edge)) {
      now_.at = write_word(at);
    }
    if (is_written(at, edge) || is_written(control, edge)) {
      now_.armed = false;
    }
    now_.pulse = enable && !level && (fires || (before.pulse && edge < ends_));
    now_.is_active = enable && (level ? before.above : before.pulse);
    if (fires || (level && now_.above && !before.above)) {
      ++now_.count;
      event(reached, edge);
    }

    // A write of `control` is looked at in the clock behind it, too.
    look_ = now_ == before && !is_written(control, edge) ? never : edge + 1;
    output(line, now_.is_active != level_at_rest_, edge);
    word(at, now_.at, edge);
    word(count, now_.count, edge);
  }

  void wired(std::uint32_t, const WireValue& value, Clock edge) override {
    value_ = value;
    look_ = std::min(look_, edge);
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == control) {
      word(address, write_word(address) & 7u, edge);
    } else if (address == step_word) {
      word(address, write_word(address) & step_mask, edge);
    }
  }

  Clock pulse_clocks_;
  bool level_at_rest_;
  Registers now_;
  WireValue value_;
  Clock ends_ = never;  // the edge that ends the pulse
  Clock look_ = 0;      // an edge at which something may change
};

}  // namespace

std::unique_ptr<Component> make_position_compare(const ComponentConfiguration& from) {
  return std::make_unique<PositionCompare>(from);
}

}  // namespace unitylink::device
