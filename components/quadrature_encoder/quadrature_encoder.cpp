// SPDX-License-Identifier: BSD-3-Clause
// The model of quadrature_encoder.vhd, with its quadrature_encoder_counts.vhd.
#include <algorithm>
#include <array>

#include "device/component/component.hpp"
#include "device/component/edge_velocity.hpp"
#include "device/component/input_filter.hpp"

namespace unitylink::device {

namespace {

constexpr Clock round_clocks = 16;

class QuadratureEncoder final : public Component {
 public:
  explicit QuadratureEncoder(const ComponentConfiguration& from)
      : Component(from, from.generic("with_velocity", 0) != 0 ? "1001000" : "100100", true),
        filter_(3, InputFilter::lasting(from.generic("filter_ns", 40), from.generic("clock_hz", 50'000'000))),
        with_index_(from.generic("with_index", 0) != 0),
        with_stamps_(from.generic("with_stamps", 0) != 0),
        words_(from.generic("with_velocity", 0) != 0 ? velocity + 1u : velocity),
        data_mask_(from.data_mask()),
        speed_(from, from.generic("velocity_us", 1000), from.generic("stall_us", 100'000)) {
    wait_until(round_clocks + 1);
    initial_wire(position_wire, wire_of(0));
    if (has_velocity()) {
      initial_wire(velocity_wire, wire_of(0));
    }
  }

 private:
  enum Register : std::uint32_t {
    position,
    index_position,
    index_count,
    impossible,
    stamp,
    index_stamp,
    velocity,
    words
  };
  enum Event : std::uint32_t { indexed, failed, stopped };
  enum Wire : std::uint32_t { position_wire, velocity_wire };
  enum Pin : std::uint32_t { a = 1, b = 2, index = 4 };  // bits of the levels
  // The edges of a round that matter: two for each word, and the last one.
  static constexpr Clock takes_steps = 2 * position;
  static constexpr Clock takes_failed = 2 * impossible;
  static constexpr Clock frees_index = 2 * index_stamp;
  static constexpr Clock takes_velocity = 2 * velocity;
  static constexpr Clock shows = round_clocks - 1;

  // The first edge from `edge` on with this place in its round.
  [[nodiscard]] static Clock at_place(Clock place, Clock edge) noexcept {
    return edge + (place + round_clocks - edge % round_clocks) % round_clocks;
  }

  [[nodiscard]] Clock next() const noexcept override {
    return std::min({filter_.next(), compare_, turn_, speed_next()});
  }

  // A value in 32 bits, from those of a word.
  [[nodiscard]] WireValue wire_of(std::uint32_t value) const noexcept {
    const std::uint32_t sign = (data_mask_ >> 1) + 1;
    return {((value & data_mask_) ^ sign) - sign, true};
  }

  // A write waits for the turn of its word, and for the end of that round.
  Clock offered(std::uint32_t address, std::uint32_t value, Clock edge) override {
    const Clock taken = at_place(2 * address, edge);
    given_ = {taken, value};
    turn_ = std::min(turn_, taken);
    return at_place(shows, taken);
  }

  void step(Clock edge) override {
    const Clock place = edge % round_clocks;
    const bool had_index = has_index_;
    const bool given = given_.taken == edge;
    speed_.tick(edge);
    if (has_velocity()) {
      wire(velocity_wire, wire_of(static_cast<std::uint32_t>(speed_.value())), edge + 1);
    }
    if (place == takes_velocity) {
      live_[velocity] = static_cast<std::uint32_t>(speed_.value());
    }
    if (place == takes_steps) {
      take(given);
      wire(position_wire, wire_of(live_[position]), edge + 1);  // it follows the turn by a clock
    } else if (place == takes_failed) {
      live_[impossible] = (given ? given_.value : live_[impossible]) + (has_failed_ ? 1u : 0u);
      has_failed_ = false;
    } else if (place == frees_index && due_) {
      has_index_ = false;
      due_ = false;
    }
    look(edge, had_index);
    if (place == shows) {
      for (std::uint32_t address = 0; address < words_; ++address) {
        word(address, live_[address] & data_mask_, edge);
      }
    }
    plan(edge);
  }

  // The turn of the position takes what came in the round before.
  void take(bool given) noexcept {
    const std::uint32_t from = given ? given_.value : live_[position];
    due_ = has_index_;
    if (due_) {
      live_[index_position] = from + index_steps_;
      ++live_[index_count];
      live_[index_stamp] = with_stamps_ ? index_at_ : 0;
    }
    if (has_stepped_) {
      live_[stamp] = step_at_;
    }
    live_[position] = from + steps_;
    steps_ = 0;
    has_stepped_ = false;
  }

  void look(Clock edge, bool had_index) {
    const std::uint32_t now = filter_.levels();
    const std::uint32_t changed = now ^ before_;
    const bool counts = edge >= round_clocks;
    const bool up = ((now & a) != 0) != ((before_ & b) != 0);
    const bool steps = ((changed & a) != 0) != ((changed & b) != 0);
    if (steps) {
      speed_.moved(edge, up);
    }
    if (has_velocity() && speed_.stalls(edge, steps)) {
      event(stopped, edge);
    }
    if (counts && (changed & (a | b)) == (a | b)) {
      has_failed_ = true;
      event(failed, edge);
    } else if (counts && steps) {
      steps_ += up ? 1u : ~0u;
      has_stepped_ = with_stamps_;
      step_at_ = static_cast<std::uint32_t>(edge);
    }
    if (counts && with_index_ && (changed & now & index) != 0) {
      event(indexed, edge);
      if (!had_index) {
        has_index_ = true;
        index_steps_ = steps_;
        index_at_ = static_cast<std::uint32_t>(edge);
      }
    }
    before_ = now;
    compare_ = filter_.step(edge) ? edge + 1 : never;
  }

  // The next edge with a turn that has something to do. Words that changed are shown at the end of their round.
  void plan(Clock edge) noexcept {
    turn_ = never;
    const Clock after = edge + 1;
    if (edge % round_clocks < shows && edge >= round_clocks) {
      turn_ = at_place(shows, after);
    }
    if (steps_ != 0 || has_stepped_ || has_index_) {
      turn_ = std::min(turn_, at_place(takes_steps, after));
    }
    if (has_failed_) {
      turn_ = std::min(turn_, at_place(takes_failed, after));
    }
    if (due_) {
      turn_ = std::min(turn_, at_place(frees_index, after));
    }
    if (has_velocity() && static_cast<std::uint32_t>(speed_.value()) != live_[velocity]) {
      turn_ = std::min(turn_, at_place(takes_velocity, after));
    }
    if (given_.taken != never && given_.taken > edge) {
      turn_ = std::min(turn_, given_.taken);
    }
  }

  [[nodiscard]] bool has_velocity() const noexcept { return words_ > velocity; }
  [[nodiscard]] Clock speed_next() const noexcept { return has_velocity() ? speed_.next() : never; }

  void driven(std::uint32_t pin, bool level, Clock edge) override { filter_.drive(pin, level, edge); }

  struct Given {
    Clock taken = never;  // the edge that takes the word from the bus
    std::uint32_t value = 0;
  };

  InputFilter filter_;
  bool with_index_;
  bool with_stamps_;
  std::uint32_t words_;  // that exist
  std::uint32_t data_mask_;
  EdgeVelocity speed_;
  std::array<std::uint32_t, words> live_{};
  Given given_;
  std::uint32_t before_ = 0;  // the levels when they were last compared
  std::uint32_t steps_ = 0;   // since the position had its turn
  std::uint32_t step_at_ = 0;
  std::uint32_t index_steps_ = 0;  // until the index
  std::uint32_t index_at_ = 0;
  bool has_stepped_ = false;
  bool has_failed_ = false;
  bool has_index_ = false;
  bool due_ = false;       // the index came before the position had its turn
  Clock compare_ = never;  // the edge that compares the levels again
  Clock turn_ = never;     // the next edge that is the turn of something
};

}  // namespace

std::unique_ptr<Component> make_quadrature_encoder(const ComponentConfiguration& from) {
  return std::make_unique<QuadratureEncoder>(from);
}

}  // namespace unitylink::device
