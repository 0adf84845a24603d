// SPDX-License-Identifier: BSD-3-Clause
// The model of pdm.vhd. It computes the bits at which a pin changes, and runs no others.
#include <algorithm>
#include <vector>

#include "device/component/component.hpp"

namespace unitylink::device {

namespace {

class Pdm final : public Component {
 public:
  explicit Pdm(const ComponentConfiguration& from)
      : Component(from, std::string(channels_of(from), '1'), false),
        period_((of(from, "clock_hz", 50'000'000) - 1) / of(from, "rate_hz", 1'000'000) + 1),
        whole_(std::uint64_t{1} << of(from, "bits", 15)),
        channels_(channels_of(from)) {
    wait_until(swept);  // after a reset the words are cleared
    const auto start = static_cast<std::uint32_t>(of(from, "start", 0));
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      Channel& one = channels_[number];
      one.first = swept + period_ + turn_clocks * number;
      one.taken = one.first;
      initial_word(number, start);
      pending_.push_back(start);
    }
    plan();
  }

 private:
  static constexpr Clock swept = 8;
  static constexpr Clock turn_clocks = 2;  // of a channel

  static std::uint64_t of(const ComponentConfiguration& from, const char* generic, std::uint32_t otherwise) {
    return static_cast<std::uint64_t>(from.generic(generic, otherwise));
  }
  static std::uint32_t channels_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(of(from, "channels", 4));
  }

  // Bits are counted from 1 on. Of each the edge `taken` reads the density, and the next edge changes the pin.
  struct Channel {
    Clock first = 0;            // the edge that reads the density of bit 1
    Clock taken = never;        // the edge that reads a density that was written; never: none was
    Clock changes = never;      // the edge that changes the pin
    std::uint64_t density = 0;  // in force
    std::uint64_t total = 0;    // behind bit `done`
    std::uint64_t done = 0;
    bool high = false;  // the pin behind bit `done`
  };

  [[nodiscard]] Clock next() const noexcept override { return next_; }

  void step(Clock edge) override {
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      Channel& one = channels_[number];
      if (edge == one.changes) {
        pass(one, (edge - 1 - one.first) / period_ + 1);
        one.high = !one.high;
        output(number, one.high, edge);
        expect(one);
      }
      if (edge == one.taken) {
        pass(one, (edge - one.first) / period_);
        one.density = pending_[number];
        one.taken = never;
        expect(one);
      }
    }
    plan();
  }

  // A word is in force from the first bit on whose density is read behind the write.
  void stored(std::uint32_t address, Clock edge) override {
    pending_[address] = write_word(address) & (2 * whole_ - 1);
    word(address, static_cast<std::uint32_t>(pending_[address]), edge);
    Channel& one = channels_[address];
    one.taken = edge < one.first ? one.first : one.first + ((edge - one.first) / period_ + 1) * period_;
    plan();
  }

  // All bits up to this one are added to the total.
  void pass(Channel& one, std::uint64_t bit) const noexcept {
    if (one.density < whole_) {
      one.total = (one.total + (bit - one.done) % whole_ * one.density) % whole_;
    }
    one.done = bit;
  }

  // When is the next bit that differs from the pin? A one comes with the carry. While all bits are ones, the total
  // falls by what the density lacks.
  void expect(Channel& one) const noexcept {
    std::uint64_t bits = 0;  // until then; 0: never
    if (one.high ? one.density == 0 : one.density >= whole_) {
      bits = 1;
    } else if (one.high && one.density < whole_) {
      bits = one.total / (whole_ - one.density) + 1;
    } else if (!one.high && one.density != 0) {
      bits = (whole_ - one.total + one.density - 1) / one.density;
    }
    one.changes = bits == 0 ? never : one.first + (one.done + bits - 1) * period_ + 1;
  }

  void plan() noexcept {
    next_ = never;
    for (const Channel& one : channels_) {
      next_ = std::min({next_, one.taken, one.changes});
    }
  }

  Clock period_;  // clocks of a bit
  std::uint64_t whole_;
  std::vector<Channel> channels_;
  std::vector<std::uint64_t> pending_;  // the densities that were written last
  Clock next_ = never;
};

}  // namespace

std::unique_ptr<Component> make_pdm(const ComponentConfiguration& from) { return std::make_unique<Pdm>(from); }

}  // namespace unitylink::device
