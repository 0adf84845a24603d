// SPDX-License-Identifier: BSD-3-Clause
// The model of sigma_delta_adc.vhd, with its sigma_delta_adc_sinc3.vhd.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <utility>

#include "device/component/component.hpp"
#include "device/component/modulator.hpp"

namespace unitylink::device {

namespace {

// Three sums at the rate of the bits, and three differences for each value.
class Sinc3 {
 public:
  Sinc3() = default;
  explicit Sinc3(std::uint32_t osr) : osr_(osr), left_(osr - 1), width_(bits_of(osr * osr * osr)) {}

  // True: a value is there.
  bool take(bool bit) noexcept {
    sums_[2] += sums_[1];
    sums_[1] += sums_[0];
    sums_[0] += bit ? 1 : 0;
    if (left_ != 0) {
      --left_;
      return false;
    }
    left_ = osr_ - 1;
    std::uint32_t value = sums_[2];
    for (std::uint32_t& before : before_) {
      value -= std::exchange(before, value);
    }
    value_ = value & ((1u << width_) - 1);
    return true;
  }
  [[nodiscard]] std::uint32_t left() const noexcept { return left_; }  // bits before the last one of a value
  [[nodiscard]] std::uint32_t width() const noexcept { return width_; }
  // From the middle, where half of the bits are 1.
  [[nodiscard]] std::int32_t value() const noexcept {
    return static_cast<std::int32_t>(value_) - static_cast<std::int32_t>(osr_ * osr_ * osr_ / 2);
  }

 private:
  static std::uint32_t bits_of(std::uint64_t number) noexcept {
    std::uint32_t bits = 1;
    while (std::uint64_t{1} << bits < number + 1) {
      ++bits;
    }
    return bits;
  }

  std::uint32_t osr_ = 1;
  std::uint32_t left_ = 0;
  std::uint32_t width_ = 1;
  std::array<std::uint32_t, 3> sums_{};
  std::array<std::uint32_t, 3> before_{};
  std::uint32_t value_ = 0;
};

class SigmaDeltaAdc final : public Component {
 public:
  explicit SigmaDeltaAdc(const ComponentConfiguration& from)
      : Component(from, writable(static_cast<std::uint32_t>(from.generic("channels", 2))), false),
        channels_(static_cast<std::uint32_t>(from.generic("channels", 2))),
        period_(static_cast<Clock>(std::max<std::int64_t>(
            4, (from.generic("clock_hz", 50'000'000) - 1) / from.generic("modulator_hz", 10'000'000) + 1))) {
    for (Channel& one : channel_) {
      one.slow = Sinc3(static_cast<std::uint32_t>(from.generic("osr", 64)));
      one.fast = Sinc3(static_cast<std::uint32_t>(from.generic("trip_osr", 8)));
    }
    word(status, 4, 0);  // all are lost
    if (!outputs().empty()) {
      output(trip, true, never);  // state 0 has it
    }
  }

 private:
  static constexpr std::uint32_t channels_most = 3;
  static constexpr std::uint32_t equal_most = 128;  // bits
  static constexpr std::uint32_t settles = 4;       // values
  static constexpr Clock take_at = 2;               // clocks behind the rise of mclk
  static constexpr Clock filter_clocks = 4;         // from the take of the last bit to the value

  static std::string writable(std::uint32_t channels) {
    return "1010" + std::string(channels, '1') + std::string(channels, '0');
  }

  enum Register : std::uint32_t { control, status, limit, stamp, offset };
  enum Output : std::uint32_t { mclk, trip };
  enum Event : std::uint32_t { sampled, tripped };

  struct Channel {
    Sinc3 slow;
    Sinc3 fast;
    Modulator* source = nullptr;        // of its bits; else the pin is driven
    std::uint32_t equals = equal_most;  // bits, beyond the first one
    std::uint32_t settled = 0;          // values
    std::int32_t value = 0;
    bool before = false;
  };

  static std::int64_t signed_of(std::uint32_t word, std::uint32_t bits) noexcept {
    const std::int64_t sign = std::int64_t{1} << (bits - 1);
    return ((std::int64_t{word} & (2 * sign - 1)) ^ sign) - sign;
  }
  [[nodiscard]] std::int32_t offset_of(std::uint32_t number) const noexcept {
    return static_cast<std::int32_t>(signed_of(write_word(offset + number), channel_[0].slow.width() + 1));
  }
  [[nodiscard]] std::uint32_t limit_now() const noexcept {
    return write_word(limit) & ((1u << channel_[0].fast.width()) - 1);
  }

  // Bits change nothing that is seen, but the last one of a value, and one that begins or ends a row of equal ones. So
  // no bit is an edge of its own: `catch_up` takes all of them that have come meanwhile.
  [[nodiscard]] Clock next() const noexcept override {
    Clock soonest = std::min({next_, turns_, slow_at_, nth_take(channel_[0].slow.left()) + filter_clocks});
    if (beyond_ != 0 || limit_now() != 0) {
      soonest = std::min({soonest, fast_at_, nth_take(channel_[0].fast.left()) + filter_clocks});
    }
    for (std::uint32_t number = 0; number < channels_; ++number) {
      const Channel& one = channel_[number];
      if (one.equals != equal_most) {
        soonest = std::min(soonest, nth_take(equal_most - one.equals - 1) + 1);
      } else if (one.source != nullptr || pin(pins_, number) != one.before || pin(bits_, number) != one.before) {
        soonest = std::min(soonest, nth_take(0) + 1);
      }
    }
    return is_watched(mclk) ? std::min(soonest, toggle_) : soonest;
  }

  void step(Clock edge) override {
    catch_up(edge);
    const bool enable = (write_word(control) & 1u) != 0;
    const std::uint32_t lost_before = lost_;
    const std::uint32_t beyond_before = beyond_;
    const bool ran = running_;
    const bool had_enable = enabled_before_;
    turns_ = never;
    bool changes = settle(edge);
    if (edge == fast_at_) {
      compare(edge);
    }
    if (fast_at_ <= edge) {  // without a limit nobody waited for it
      fast_at_ = never;
    }
    const std::uint32_t bad = lost_before | beyond_before;
    if (!enable) {
      running_ = false;
    } else if (ran && bad != 0) {
      stop(bad, edge);
    } else if (!had_enable) {
      running_ = is_tripped_ = false;
      culprits_ = bad;
      if (bad != 0) {
        stop(bad, edge);
      } else {
        running_ = true;
      }
    }
    enabled_before_ = enable;
    changes = changes || lost_ != lost_before || beyond_ != beyond_before || running_ != ran || had_enable != enable;
    tell(edge);
    next_ = changes ? edge + 1 : never;
    if (is_watched(mclk)) {
      show(mclk, edge + 1);
    }
  }

  void stop(std::uint32_t bad, Clock edge) {
    running_ = false;
    is_tripped_ = true;
    culprits_ = bad;
    event(tripped, edge);
  }

  // Values that are there now, and channels without bits. Returns whether the next edge has to look again.
  bool settle(Clock edge) {
    const bool fresh = edge == slow_at_;
    bool changes = false;
    lost_ = 0;
    for (std::uint32_t number = 0; number < channels_; ++number) {
      Channel& one = channel_[number];
      const std::uint32_t before = one.settled;
      if (fresh) {
        one.value = one.slow.value() - offset_of(number);
        one.settled = std::min(before + 1, settles);
      }
      if (one.equals == equal_most) {
        one.settled = 0;
      }
      lost_ |= before != settles ? 1u << number : 0;
      changes = changes || one.settled != before;
    }
    if (fresh) {
      slow_at_ = never;
      event(sampled, edge);
      word(stamp, static_cast<std::uint32_t>(edge), edge);
    }
    return changes;
  }

  // The limit that holds is that of the edge before.
  void compare(Clock edge) noexcept {
    const std::uint32_t most = is_written(limit, edge) ? limit_before_ : limit_now();
    beyond_ = 0;
    for (std::uint32_t number = 0; number < channels_; ++number) {
      const auto size = static_cast<std::uint32_t>(std::abs(channel_[number].fast.value()));
      beyond_ |= most != 0 && size > most ? 1u << number : 0;
    }
  }

  // The edge of take `number` from the next one on.
  [[nodiscard]] Clock nth_take(std::uint32_t number) const noexcept { return rise_ + take_at + number * period_; }
  static bool pin(std::uint32_t pins, std::uint32_t number) noexcept { return (pins >> number & 1u) != 0; }

  // All that happens to bits before edge `edge`: mclk rises, and with it the bits of the last rise are sampled, and
  // those of the sources change. Two clocks later the filters take what was sampled.
  void catch_up(Clock edge) noexcept {
    for (; rise_ < edge; rise_ += period_) {
      if (!is_sampled_) {
        bits_ = pins_;
        is_sampled_ = true;
        for (std::uint32_t number = 0; number < channels_; ++number) {
          if (Modulator* source = channel_[number].source; source != nullptr) {
            pins_ = (pins_ & ~(1u << number)) | (source->bit(rise_ + 1) ? 1u << number : 0);
          }
        }
      }
      if (rise_ + take_at >= edge) {
        return;
      }
      take(rise_ + take_at);
      is_sampled_ = false;
    }
  }

  void take(Clock edge) noexcept {
    for (std::uint32_t number = 0; number < channels_; ++number) {
      Channel& one = channel_[number];
      const bool level = pin(bits_, number);
      const std::uint32_t equals = level != one.before ? 0 : std::min(one.equals + 1, equal_most);
      if ((equals == equal_most) != (one.equals == equal_most)) {
        turns_ = edge + 1;
      }
      one.equals = equals;
      one.before = level;
      if (one.slow.take(level)) {
        slow_at_ = edge + filter_clocks;
      }
      if (one.fast.take(level)) {
        fast_at_ = edge + filter_clocks;
      }
    }
  }

  void show(std::uint32_t /*pin*/, Clock state) override {
    catch_up(state);
    while (toggle_ < state) {
      is_high_ = !is_high_;
      const Clock edge = toggle_;
      toggle_ += is_high_ ? period_ / 2 : period_ - period_ / 2;
      output(mclk, is_high_, edge);
    }
  }

  void tell(Clock edge) {
    word(status, (running_ ? 1u : 0u) | (is_tripped_ ? 2u : 0u) | (lost_ != 0 ? 4u : 0u) | culprits_ << 4, edge);
    output(trip, !running_, edge);
    for (std::uint32_t number = 0; number < channels_; ++number) {
      const auto value = static_cast<std::uint32_t>(channel_[number].value);
      word(offset + channels_ + number, value, edge);
      wire(number, {value, running_}, edge);
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    const std::uint32_t value = write_word(address);
    if (address == control) {
      word(address, value & 1u, edge);
    } else if (address == limit) {
      limit_before_ = std::exchange(limit_written_, limit_now());
      word(address, limit_now(), edge);
    } else {
      word(address, static_cast<std::uint32_t>(offset_of(address - offset)), edge);
    }
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override {
    catch_up(edge);
    pins_ = (pins_ & ~(1u << pin)) | (level ? 1u << pin : 0);
  }

  bool drawn(std::uint32_t pin, Modulator* source, Clock edge) override {
    catch_up(edge);
    channel_[pin].source = source;
    return true;
  }

  std::uint32_t channels_;
  Clock period_;
  std::array<Channel, channels_most> channel_{};
  std::uint32_t pins_ = 0;
  std::uint32_t bits_ = 0;  // as the clock rose
  std::uint32_t lost_ = 7;
  std::uint32_t beyond_ = 0;
  std::uint32_t limit_before_ = 0;  // that of the last write but one
  std::uint32_t limit_written_ = 0;
  std::uint32_t culprits_ = 0;
  bool enabled_before_ = true;
  bool running_ = false;
  bool is_tripped_ = false;
  Clock rise_ = 0;  // the next edge at which mclk rises, or the last one, whose bits are not taken yet
  bool is_sampled_ = false;
  Clock toggle_ = 0;  // the next edge that changes the output mclk
  bool is_high_ = false;
  Clock turns_ = never;    // the edge that sees a row of equal bits begin or end
  Clock slow_at_ = never;  // the edge that takes new values
  Clock fast_at_ = never;
  Clock next_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_sigma_delta_adc(const ComponentConfiguration& from) {
  return std::make_unique<SigmaDeltaAdc>(from);
}

}  // namespace unitylink::device
