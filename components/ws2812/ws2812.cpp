// SPDX-License-Identifier: BSD-3-Clause
// The model of ws2812.vhd.
#include <algorithm>
#include <string>

#include "device/component/component.hpp"

namespace unitylink::device {

namespace {

class Ws2812 final : public Component {
 public:
  explicit Ws2812(const ComponentConfiguration& from)
      : Component(from, std::string(first_place + leds_of(from), '1'), false),
        leds_(leds_of(from)),
        colour_bits_(static_cast<std::uint32_t>(8 * from.generic("channels", 3))),
        mask_(colour_bits_ == 32 ? 0xFFFFFFFFu : (1u << colour_bits_) - 1u) {
    const auto khz = static_cast<std::uint64_t>((from.generic("clock_hz", 50'000'000) + 500) / 1000);
    const auto reset_us = static_cast<std::uint64_t>(from.generic("reset_us", 280));
    zero_clocks_ = 350 * khz / 1'000'000;
    one_clocks_ = (700 * khz + 500'000) / 1'000'000;
    bit_clocks_ = (1250 * khz + 500'000) / 1'000'000;
    pause_ = 1 + (reset_us * khz + 999) / 1000 / (bit_clocks_ * colour_bits_);
    word(update, 1, 0);
    left_ = colour_bits_ - 1;
    ahead_ = leds_ + 1;
    plan_bit();
  }

 private:
  static constexpr std::uint32_t first_place = 2;
  enum Register : std::uint32_t { control, update };

  [[nodiscard]] static std::uint32_t leds_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("leds", 60));
  }
  [[nodiscard]] bool is_on() const noexcept { return (write_word(control) & 1u) != 0; }

  [[nodiscard]] Clock next() const noexcept override {
    return sending_ ? std::min({edge_of_line_, fetch_, end_}) : pending_ ? 0 : never;
  }

  // The edges of the line are those of the bit that begins at `bit_`. A word that begins may be part of the pause.
  void step(Clock edge) override {
    if (!sending_) {
      if (pending_) {
        pending_ = false;
        sending_ = true;
        ahead_ = 0;
        left_ = 0;
        is_quiet_ = true;  // the low end of a bit that there is not
        bit_ = edge + 1 - one_clocks_;
        plan_bit();
      }
    } else {
      if (edge == edge_of_line_) {
        const bool rises = edge == bit_;
        output(0, rises, edge);
        edge_of_line_ = rises ? bit_ + ((shift_ >> left_ & 1u) != 0 ? one_clocks_ : zero_clocks_) : never;
      }
      if (edge == fetch_) {
        const auto place = static_cast<std::uint32_t>(first_place + ahead_);
        next_ = is_on() && ahead_ < leds_ ? write_word(place) & mask_ : 0;
        fetch_ = never;
      }
      if (edge == end_) {
        end_bit(edge);
      }
    }
    word(update, pending_ || sending_ ? 1 : 0, edge);
  }

  void end_bit(Clock edge) {
    bit_ = edge + 1;
    if (left_ != 0) {
      --left_;
    } else {
      left_ = colour_bits_ - 1;
      shift_ = next_;
      is_quiet_ = ahead_ >= leds_;
      if (ahead_++ == leds_ + pause_) {
        sending_ = false;
        if (!pending_) {
          event(0, edge);
        }
        return;
      }
    }
    plan_bit();
  }

  // The colour of the next LED is read behind what the bus asks for in the clock before.
  void plan_bit() noexcept {
    edge_of_line_ = is_quiet_ ? never : bit_;
    fetch_ = left_ == 0 ? bit_ + one_clocks_ + 2 : never;
    end_ = bit_ + bit_clocks_ - 1;
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == control) {
      word(control, write_word(control) & 1u, edge);
    } else if (address >= first_place) {
      word(address, write_word(address) & mask_, edge);
    }
    if (address < first_place) {
      pending_ = true;
      word(update, 1, edge);
    }
  }

  std::uint32_t leds_;
  std::uint32_t colour_bits_;
  std::uint32_t mask_;
  Clock zero_clocks_ = 1;
  Clock one_clocks_ = 1;
  Clock bit_clocks_ = 1;
  std::uint64_t pause_ = 1;  // in LEDs

  Clock bit_ = 0;               // the edge at which this bit begins
  Clock edge_of_line_ = never;  // the edge that changes the line
  Clock fetch_ = never;         // the edge that reads the next colour
  Clock end_ = never;           // the last edge of this bit
  std::uint64_t ahead_ = 0;     // the next LED
  std::uint32_t left_ = 0;      // bits behind this one
  std::uint32_t shift_ = 0;     // the colour that is sent
  std::uint32_t next_ = 0;      // and the next one
  bool pending_ = true;
  bool sending_ = true;  // the pause that is first behind a reset
  bool is_quiet_ = true;
};

}  // namespace

std::unique_ptr<Component> make_ws2812(const ComponentConfiguration& from) { return std::make_unique<Ws2812>(from); }

}  // namespace unitylink::device
