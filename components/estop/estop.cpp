// SPDX-License-Identifier: BSD-3-Clause
// The model of estop.vhd.
#include <algorithm>

#include "device/component/component.hpp"

namespace unitylink::device {

namespace {

class EStop final : public Component {
 public:
  explicit EStop(const ComponentConfiguration& from)
      : Component(from, "10001", false),
        mask_((1u << from.generic("inputs", 1)) - 1u),
        closed_(from.generic("closed_level", 1) != 0 ? mask_ : 0),
        filter_clocks_((from.generic("filter_us", 100) * ((from.generic("clock_hz", 50'000'000) + 999) / 1000) + 999) /
                       1000),
        watchdog_clocks_(from.generic("watchdog_ms", 0) * (from.generic("clock_hz", 50'000'000) / 1000)),
        first_(~closed_ & mask_),
        second_(first_) {
    tell(0);
  }

 private:
  enum Register : std::uint32_t { control, status, chain, opened, feed };

  [[nodiscard]] std::uint32_t open_contacts() const noexcept { return second_ ^ closed_; }

  // The edge at which the chain or the watchdog stops it, if nothing else happens.
  [[nodiscard]] Clock breaks() const noexcept {
    return open_since_ == never ? never : open_since_ + static_cast<Clock>(filter_clocks_);
  }
  [[nodiscard]] Clock falls_silent() const noexcept {
    return watchdog_clocks_ == 0 ? never : fed_ + static_cast<Clock>(watchdog_clocks_);
  }

  [[nodiscard]] Clock next() const noexcept override {
    if (pins_ != first_ || first_ != second_ || moves_) {
      return 0;
    }
    return running_ ? std::min(breaks(), falls_silent()) : never;
  }

  // What `step` reads is the state before the edge, as in the VHDL.
  void step(Clock edge) override {
    const bool enable = (write_word(control) & 1u) != 0;
    const std::uint32_t open = open_contacts();
    const bool is_broken = breaks() <= edge;
    const bool was_running = running_;
    if (running_ && (is_broken || falls_silent() <= edge)) {
      running_ = false;
      tripped_ = true;
      late_ = late_ || !is_broken;
      opened_ = is_broken ? open : 0;
      event(0, edge);
    } else if (!enable) {
      running_ = false;
    } else if (!enabled_before_ && open == 0) {
      running_ = true;
      tripped_ = late_ = false;
      opened_ = 0;
    }
    if (!was_running || is_written(feed, edge)) {
      fed_ = edge + 1;
    }
    moves_ = enabled_before_ != enable || running_ != was_running;
    enabled_before_ = enable;
    second_ = first_;
    first_ = pins_;
    if (open_contacts() == 0) {
      open_since_ = never;
    } else if (open_since_ == never) {
      open_since_ = edge + 1;
    }
    tell(edge);
    output(0, running_, edge);
  }

  void tell(Clock edge) {
    const std::uint32_t open = open_contacts();
    word(status,
         static_cast<std::uint32_t>(running_) | static_cast<std::uint32_t>(tripped_) << 1 |
             static_cast<std::uint32_t>(late_) << 2 | static_cast<std::uint32_t>(open != 0) << 3,
         edge);
    word(chain, ~open & mask_, edge);
    word(opened, opened_, edge);
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == control) {
      word(address, write_word(address) & 1u, edge);
    }
  }

  void driven(std::uint32_t pin, bool level, Clock /*edge*/) override {
    pins_ = level ? pins_ | 1u << pin : pins_ & ~(1u << pin);
  }

  std::uint32_t mask_;
  std::uint32_t closed_;  // the pins when all contacts are closed
  std::int64_t filter_clocks_;
  std::int64_t watchdog_clocks_;
  std::uint32_t pins_ = 0;
  std::uint32_t first_;  // of the synchroniser
  std::uint32_t second_;
  std::uint32_t opened_ = 0;
  Clock open_since_ = never;  // the first edge that sees it open
  Clock fed_ = 0;             // the edge whose silence is 0 clocks
  bool enabled_before_ = true;
  bool running_ = false;
  bool tripped_ = false;
  bool late_ = false;
  bool moves_ = true;  // the next edge has something to do
};

}  // namespace

std::unique_ptr<Component> make_estop(const ComponentConfiguration& from) { return std::make_unique<EStop>(from); }

}  // namespace unitylink::device
