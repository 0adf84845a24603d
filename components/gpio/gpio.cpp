// SPDX-License-Identifier: BSD-3-Clause
// The model of gpio.vhd.
#include <algorithm>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"

namespace unitylink::device {

namespace {

class Gpio final : public Component {
 public:
  explicit Gpio(const ComponentConfiguration& from)
      : Component(from, "011111", true),
        pins_(static_cast<std::uint32_t>(from.generic("pins", 8))),
        mask_(pins_ >= 32 ? 0xFFFFFFFFu : (1u << pins_) - 1u),
        filter_(pins_, static_cast<std::uint32_t>(from.generic("stable_clocks", 1))) {}

 private:
  enum Register : std::uint32_t { levels, outputs, direction, set, clear, watch };

  [[nodiscard]] Clock next() const noexcept override { return std::min(filter_.next(), compare_); }

  void step(Clock edge) override {
    if (is_written(outputs, edge)) {
      put(write_word(outputs) & mask_, edge);
    } else if (is_written(set, edge)) {
      put(out_ | (write_word(set) & mask_), edge);
    } else if (is_written(clear, edge)) {
      put(out_ & ~write_word(clear), edge);
    }
    if (edge == compare_) {
      compare_ = never;
      const std::uint32_t now = filter_.levels();
      if (((now ^ before_) & write_word(watch)) != 0) {
        event(0, edge);
      }
      before_ = now;
    }
    if (filter_.step(edge)) {
      word(levels, filter_.levels(), edge);
      compare_ = edge + 1;
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    const std::uint32_t value = write_word(address) & mask_;
    if (address == direction) {
      for (std::uint32_t pin = 0; pin < pins_; ++pin) {
        output(pins_ + pin, (value >> pin & 1u) != 0, edge);  // pin_drive is behind pin_out
      }
    }
    if (address == direction || address == watch) {
      word(address, value, edge);
    }
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override { filter_.drive(pin, level, edge); }

  void put(std::uint32_t value, Clock edge) {
    out_ = value;
    for (const std::uint32_t address : {outputs, set, clear}) {
      word(address, out_, edge);
    }
    for (std::uint32_t pin = 0; pin < pins_; ++pin) {
      output(pin, (out_ >> pin & 1u) != 0, edge);
    }
  }

  std::uint32_t pins_;
  std::uint32_t mask_;
  InputFilter filter_;
  std::uint32_t out_ = 0;
  std::uint32_t before_ = 0;  // the levels when they were last compared
  Clock compare_ = never;     // the edge that compares them again
};

}  // namespace

std::unique_ptr<Component> make_gpio(const ComponentConfiguration& from) { return std::make_unique<Gpio>(from); }

}  // namespace unitylink::device
