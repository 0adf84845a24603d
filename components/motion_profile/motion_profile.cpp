// SPDX-License-Identifier: BSD-3-Clause
// The model of motion_profile.vhd.
#include <algorithm>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/signed_value.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

__extension__ using Wide = __int128;

constexpr std::uint32_t fraction_bits = 24;
constexpr std::uint32_t place_bits = 32 + fraction_bits;
constexpr Clock clocks_to_give = 9;  // from the tick to the edge that gives

class MotionProfile final : public Component {
 public:
  explicit MotionProfile(const ComponentConfiguration& from)
      : Component(from, "1011100", false),
        smooth_bits_(static_cast<std::uint32_t>(from.generic("smooth_bits", 0))),
        wire_bits_{static_cast<std::uint32_t>(from.generic("position_wire_bits", 32)),
                   static_cast<std::uint32_t>(from.generic("velocity_wire_bits", 24)),
                   static_cast<std::uint32_t>(from.generic("acceleration_wire_bits", 24))},
        ticks_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)),
               static_cast<std::uint64_t>(from.generic("loop_hz", 20'000))),
        steps_(std::size_t{1} << smooth_bits_) {
    for (std::uint32_t number = 0; number < 3; ++number) {
      initial_wire(number, {0, true});
    }
  }

 private:
  enum Register : std::uint32_t { control, status, target, speed_limit, acceleration_limit, position_word, velocity };

  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] std::uint32_t ramp_now() const noexcept {
    return std::min(write_word(acceleration_limit) & 0xFFFFFFu, write_word(speed_limit));
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min({tick_, give_, follow_}); }

  void step(Clock edge) override {
    if (!enable()) {
      rest_at_feedback();
    } else {
      if (edge > 0 && ticks_.until(edge) != ticks_.until(edge - 1)) {
        sample();
        give_ = edge + clocks_to_give;
      }
      if (edge == give_) {
        compute(edge);
        give_ = never;
      }
      if (is_written(target, edge)) {
        waits_ = moves_ = true;
        rests_ = false;
      }
    }
    follow_ = never;
    tick_ = enable() ? ticks_.state_of(ticks_.until(edge) + 1) : never;
    tell(edge);
  }

  void rest_at_feedback() noexcept {
    speed_ = brake_ = sum_ = change_ = 0;
    index_ = 0;
    full_ = waits_ = rests_ = false;
    moves_ = true;
    give_ = never;
    if (feedback_.valid) {
      position_ = static_cast<std::int32_t>(feedback_.value);
    }
    place_ = position_ * (std::int64_t{1} << fraction_bits);
    mean_ = Wide{place_} << smooth_bits_;
  }

  void sample() noexcept {
    waits_ = false;
    rest_ =
        wrapped((std::int64_t{static_cast<std::int32_t>(write_word(target))} << fraction_bits) - place_, place_bits);
    most_ = write_word(speed_limit);
    if (speed_ == 0) {
      ramp_ = ramp_now();
      back_ = rest_ < 0;
    }
  }

  void compute(Clock edge) {
    const std::int64_t way = back_ ? -rest_ : rest_;
    const std::int64_t faster = speed_ + ramp_;
    const bool is_last = speed_ == 0 && way < ramp_;
    if (is_last) {
    } else if ((speed_ > most_ || way < brake_) && speed_ != 0) {
      brake_ -= speed_;
      speed_ -= ramp_;
    } else if (way >= brake_ + faster && faster <= most_) {
      brake_ += faster;
      speed_ = faster;
    }
    const std::int64_t moved = is_last ? rest_ : back_ ? -speed_ : speed_;
    place_ = wrapped(place_ + moved, place_bits);
    change_ = moved - (full_ ? steps_[index_] : 0);
    steps_[index_] = moved;
    index_ = (index_ + 1) % steps_.size();
    full_ = full_ || index_ == 0;
    sum_ += change_;
    mean_ += sum_;
    change_ >>= smooth_bits_;
    position_ = static_cast<std::int32_t>(static_cast<std::uint32_t>(mean_ >> (fraction_bits + smooth_bits_)));
    if (!waits_) {
      rests_ = is_last && moved == 0 && sum_ == 0;
      if (rests_ && moves_) {
        moves_ = false;
        event(0, edge);
      }
    }
  }

  void tell(Clock edge) {
    const std::int64_t speed = sum_ >> (smooth_bits_ + fraction_bits - 8);
    tell_status(edge);
    word(position_word, static_cast<std::uint32_t>(position_), edge);
    word(velocity, static_cast<std::uint32_t>(speed), edge);
    const std::int64_t given[] = {position_, speed, change_};
    for (std::uint32_t number = 0; number < 3; ++number) {
      wire(number, {static_cast<std::uint32_t>(limited(given[number], wire_bits_[number])), true}, edge);
    }
  }

  void tell_status(Clock edge) { word(status, (enable() ? 1u : 0u) | (rests_ ? 2u : 0u), edge); }

  void stored(std::uint32_t address, Clock edge) override {
    const std::uint32_t value = write_word(address);
    switch (address) {
      case control:
        word(address, value & 1u, edge);
        tell_status(edge);
        break;
      case acceleration_limit: word(address, value & 0xFFFFFFu, edge); break;
      default: word(address, value, edge);
    }
  }

  void wired(std::uint32_t /*input*/, const WireValue& value, Clock edge) override {
    feedback_ = value;
    follow_ = enable() ? never : edge;
  }

  std::uint32_t smooth_bits_;
  std::uint32_t wire_bits_[3];
  Tick ticks_;
  WireValue feedback_;
  std::vector<std::int64_t> steps_;  // of the last periods
  std::size_t index_ = 0;
  std::int64_t place_ = 0;  // in 1 / 2**fraction_bits count, like all that follows
  std::int64_t rest_ = 0;
  std::int64_t most_ = 0;
  std::int64_t ramp_ = 0;
  std::int64_t speed_ = 0;
  std::int64_t brake_ = 0;
  std::int64_t sum_ = 0;
  std::int64_t change_ = 0;
  Wide mean_ = 0;
  std::int32_t position_ = 0;
  bool back_ = false;
  bool full_ = false;
  bool waits_ = false;
  bool moves_ = true;
  bool rests_ = false;
  Clock tick_ = never;
  Clock give_ = never;
  Clock follow_ = never;
};

}  // namespace

std::unique_ptr<Component> make_motion_profile(const ComponentConfiguration& from) {
  return std::make_unique<MotionProfile>(from);
}

}  // namespace unitylink::device
