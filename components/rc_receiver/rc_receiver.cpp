// SPDX-License-Identifier: BSD-3-Clause
// The model of rc_receiver.vhd, with rc_receiver_ppm.vhd and rc_receiver_sbus.vhd.
#include <algorithm>
#include <array>
#include <memory>
#include <string>

#include "device/component/component.hpp"
#include "rc_receiver_ppm.hpp"
#include "rc_receiver_sbus.hpp"

namespace unitylink::device {

namespace {

class RcReceiver final : public Component {
 public:
  explicit RcReceiver(const ComponentConfiguration& from)
      : Component(from, std::string(channels_of(from) + 5, '0'), false),
        channels_(channels_of(from)),
        lost_channel_(static_cast<std::uint32_t>(8 * from.generic("lost_us", 0))),
        timeout_us_(static_cast<std::uint64_t>(1000 * from.generic("timeout_ms", 100))),
        tick_(clock_hz(from), 1'000'000) {
    const bool inverted = from.generic("inverted", 1) != 0;
    if (from.generic("protocol", 1) != 0) {
      frames_ = std::make_unique<SbusFrames>(clock_hz(from), inverted);
    } else {
      const std::int64_t filter_ns = from.generic("filter_ns", 1000);
      const std::uint32_t stable = InputFilter::lasting(filter_ns, static_cast<std::int64_t>(clock_hz(from)));
      frames_ = std::make_unique<PpmFrames>(clock_hz(from), channels_, inverted, stable);
    }
    for (std::uint32_t channel = 0; channel < channels_; ++channel) {
      word(channel, lost_channel_, 0);
    }
    word(channels_ + age, oldest, 0);
  }

 private:
  enum Register : std::uint32_t { state, age, fresh_frames, broken_frames, repeats };  // behind the channels
  enum Event : std::uint32_t { frame, failed };
  static constexpr std::uint32_t oldest = (1u << 20) - 1;

  static std::uint64_t clock_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000));
  }
  static std::uint32_t channels_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("channels", 16));
  }
  [[nodiscard]] std::uint64_t ticks_before(Clock edge) const noexcept { return edge == 0 ? 0 : tick_.until(edge - 1); }

  [[nodiscard]] Clock next() const noexcept override {
    return std::min({frames_->next(), shows_, pending_ ? Clock{0} : never, expires_});
  }

  void step(Clock edge) override {
    const bool takes = pending_ && !is_held(edge);
    const bool expires = valid_ && edge >= expires_ && !is_held(edge);
    const bool was_whole = edge == shows_ && shown_.whole;
    if (edge == shows_ && shown_.broken) {
      word(channels_ + broken_frames, ++breaks_ & 0xFFFFu, edge);
    }
    const bool is_fresh = takes && (kept_ & (failsafe_flag | lost_flag)) == 0;
    const bool fails = (takes && (kept_ & failsafe_flag) != 0) || expires;
    if (fails && valid_ && !is_fresh) {
      event(failed, edge);
    }
    if (fails) {
      valid_ = false;
    }
    if (is_fresh) {
      valid_ = true;
      values_ = frames_->values();
      base_us_ = tick_.until(edge);
      expires_ = tick_.state_of(base_us_ + timeout_us_) + 1;
      event(frame, edge);
      word(channels_ + fresh_frames, ++fresh_ & 0xFFFFu, edge);
    }
    if (!valid_) {
      expires_ = never;
    }
    if (takes) {
      state_ = (is_fresh ? (kept_ & 3u) << 3 : state_ & 0x18u) | (kept_ & (failsafe_flag | lost_flag)) >> 1;
      if ((kept_ & lost_flag) != 0) {
        word(channels_ + repeats, ++repeats_ & 0xFFFFu, edge);
      }
    }
    if (takes || fails) {
      for (std::uint32_t channel = 0; channel < channels_; ++channel) {
        word(channel, valid_ ? values_[channel] : lost_channel_, edge);
      }
      word(channels_ + state, state_ | (valid_ ? 1u : 0u), edge);
    }

    shows_ = edge == shows_ ? never : shows_;
    const RcFrame found = frames_->step(edge);
    if (was_whole) {
      pending_ = true;
      kept_ = frames_->flags();
    } else if (takes || found.put) {
      pending_ = false;
    }
    if (found.whole || found.broken) {
      shown_ = found;
      shows_ = edge + 1;
    }
  }

  void look(std::uint32_t address, Clock at) override {
    if (address == channels_ + age && at > 0) {
      const std::uint64_t passed = valid_ ? ticks_before(at) - base_us_ : oldest;
      word(address, static_cast<std::uint32_t>(std::min<std::uint64_t>(passed, oldest)), at - 1);
    }
  }

  void driven(std::uint32_t /*line*/, bool level, Clock edge) override { frames_->drive(level, edge); }

  static constexpr std::uint32_t lost_flag = 4;
  static constexpr std::uint32_t failsafe_flag = 8;

  std::uint32_t channels_;
  std::uint32_t lost_channel_;
  std::uint64_t timeout_us_;
  Tick tick_;
  std::unique_ptr<RcFrames> frames_;
  std::array<std::uint32_t, 16> values_{};
  std::uint32_t state_ = 0;  // without its lowest bit
  bool valid_ = false;
  std::uint64_t base_us_ = 0;  // ticks until the last fresh frame
  Clock expires_ = never;      // the edge that sees that it is too old
  RcFrame shown_;              // what the front end has given …
  Clock shows_ = never;        // … which is seen at this edge
  bool pending_ = false;       // a frame waits for the end of a block
  std::uint32_t kept_ = 0;     // its flags
  std::uint32_t fresh_ = 0;
  std::uint32_t breaks_ = 0;
  std::uint32_t repeats_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_rc_receiver(const ComponentConfiguration& from) {
  return std::make_unique<RcReceiver>(from);
}

}  // namespace unitylink::device
