// SPDX-License-Identifier: BSD-3-Clause
// The model of servo_bus.vhd, with servo_bus_sender.vhd and servo_bus_receiver.vhd.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/tick.hpp"
#include "device/component/uart_line.hpp"
#include "servo_bus_packets.hpp"

namespace unitylink::device {

namespace {

class ServoBus final : public Component {
 public:
  explicit ServoBus(const ComponentConfiguration& from)
      : Component(from, writable(count_of(from)), false),
        feetech_(from.generic("protocol", 0) != 0),
        first_id_(static_cast<std::uint32_t>(from.generic("first_id", 1))),
        cycle_us_(1'000'000 / static_cast<std::uint64_t>(from.generic("cycle_hz", 200))),
        timeout_us_(static_cast<std::uint64_t>(from.generic("timeout_us", 1000))),
        gap_us_(static_cast<std::uint64_t>(from.generic("gap_us", 20))),
        failures_most_(static_cast<std::uint32_t>(from.generic("failures_most", 3))),
        tick_(clock_hz(from), 1'000'000),
        bit_clocks_((clock_hz(from) + baud_hz(from) - 1) / baud_hz(from)),
        line_(clock_hz(from), baud_hz(from)),
        receiver_(clock_hz(from), baud_hz(from)),
        reply_(feetech_),
        servos_(count_of(from)) {
    word(control(), 1, 0);
    for (std::uint32_t number = 0; number < servos_.size(); ++number) {
      word(address(number, ServoField::age), longest_age, 0);
    }
    if (!outputs().empty()) {  // not in a look whether there is a model
      output(tx, true, never);
    }
    due_ = next_turn(0);
  }

 private:
  enum Output : std::uint32_t { tx, tx_enable };
  enum Event : std::uint32_t { cycled, failed };
  enum class State { idle, copying, choosing, leading, sending, listening, stamping, committing, pausing };
  static constexpr std::uint32_t longest_age = (1u << 20) - 1;
  static constexpr std::uint32_t most_bytes = 63;

  struct Servo {
    bool valid = false;
    bool told = false;
    bool engaged = false;
    bool holding = false;
    std::uint32_t sent = 0;  // the goal of this cycle
    std::uint32_t last = 0;  // position
    std::uint32_t alarm = 0;
    std::uint32_t reason = 0;
    std::uint32_t failures = 0;
    std::uint32_t in_a_row = 0;
    std::uint64_t stamp_us = 0;
  };

  static std::uint64_t clock_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000));
  }
  static std::uint64_t baud_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("baud_hz", 1'000'000));
  }
  static std::uint32_t count_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("servos", 6));
  }
  static std::string writable(std::uint32_t servos) {
    std::string found;
    for (std::uint32_t number = 0; number < servos; ++number) {
      found += "11000000";
    }
    return found + "10";
  }
  static std::uint32_t address(std::uint32_t number, ServoField field) noexcept {
    return servo_fields * number + static_cast<std::uint32_t>(field);
  }
  [[nodiscard]] std::uint32_t control() const noexcept {
    return servo_fields * static_cast<std::uint32_t>(servos_.size());
  }
  [[nodiscard]] std::uint8_t id_of(std::uint32_t number) const noexcept {
    return static_cast<std::uint8_t>(first_id_ + number);
  }
  [[nodiscard]] std::uint64_t ticks_before(Clock state) const noexcept {
    return state == 0 ? 0 : tick_.until(state - 1);
  }

  [[nodiscard]] Clock next() const noexcept override {
    return std::min(due_, state_ == State::listening ? std::min(receiver_.next(), taken_) : never);
  }

  void step(Clock edge) override {
    if (state_ == State::listening) {
      hear(edge);
    }
    if (edge != due_) {
      return;
    }
    switch (state_) {
      case State::idle: rest(edge); break;
      case State::copying: copy(edge); break;
      case State::choosing: choose(edge); break;
      case State::leading:
        sent_ = 0;
        line_.take(text_[sent_++], edge);
        output(tx, line_.level(), edge);
        go(State::sending, line_.next());
        break;
      case State::sending: send(edge); break;
      case State::listening: lose(edge); break;
      case State::stamping:
        servos_[servo_].stamp_us = ticks_before(edge);
        servos_[servo_].last = reply_.word(ServoField::position);
        go(State::committing, edge + 1);
        break;
      case State::committing:
        if (is_held(edge)) {
          due_ = edge + 1;
        } else {
          commit(edge);
        }
        break;
      case State::pausing: go_on(edge); break;
    }
  }

  // The first edge from `edge` on at which a cycle may begin.
  [[nodiscard]] Clock next_turn(Clock edge) const noexcept {
    const std::uint64_t past = edge < 2 ? 0 : tick_.until(edge - 2);
    return tick_.state_of((past / cycle_us_ + 1) * cycle_us_) + 1;
  }

  void rest(Clock edge) {
    if (!enable_) {
      for (std::uint32_t number = 0; number < servos_.size(); ++number) {
        Servo& one = servos_[number];
        one.valid = one.engaged = one.holding = false;
        show_status(number, edge);
      }
      due_ = never;
    } else if (edge == next_turn(edge)) {
      begun_ticks_ = tick_.until(edge);
      packet_ = ServoPacket::torques;
      start_copy();
      go(State::copying, edge + 1);
    } else {
      due_ = next_turn(edge);
    }
  }

  void start_copy() noexcept {
    servo_ = 0;
    half_ = false;
    told_ = engaged_ = 0;
  }

  void copy(Clock edge) {
    due_ = edge + 1;
    if (is_held(edge)) {
      start_copy();
      return;
    }
    half_ = !half_;
    if (half_) {
      return;
    }
    Servo& one = servos_[servo_];
    const std::uint32_t drive = write_word(address(servo_, ServoField::drive)) & 3u;
    const bool known = one.valid || one.engaged;
    const bool holds = drive == 1;
    if (!holds || !one.holding) {
      one.sent = drive >= 2 ? write_word(address(servo_, ServoField::goal)) & 0xFFFFu : one.last;
    }
    one.told = drive == 0 || known;
    one.engaged = drive != 0 && known;
    one.holding = holds && (one.valid || one.holding);
    told_ += one.told ? 1 : 0;
    engaged_ += one.engaged ? 1 : 0;
    if (++servo_ == servos_.size()) {
      servo_ = 0;
      state_ = State::choosing;
    }
  }

  void choose(Clock edge) {
    const std::uint32_t count = packet_ == ServoPacket::goals ? engaged_ : told_;
    if (packet_ != ServoPacket::question && count == 0) {
      packet_ = packet_ == ServoPacket::torques ? ServoPacket::goals : ServoPacket::question;
      due_ = edge + 1;
      return;
    }
    ServoPacketText text(feetech_, packet_, id_of(servo_), count);
    for (std::uint32_t number = 0; number < servos_.size(); ++number) {
      if (packet_ == ServoPacket::torques && servos_[number].told) {
        text.add_torque(id_of(number), servos_[number].engaged);
      } else if (packet_ == ServoPacket::goals && servos_[number].engaged) {
        text.add_goal(id_of(number), servos_[number].sent);
      }
    }
    text_ = text.whole();
    output(tx_enable, true, edge);
    go(State::leading, edge + 1 + bit_clocks_);
  }

  void send(Clock edge) {
    if (line_.is_ready(edge) && sent_ < text_.size()) {
      line_.take(text_[sent_++], edge);
    } else if (edge == line_.next()) {
      line_.step(edge);
      if (line_.next() == never) {  // the last stop bit has ended
        output(tx_enable, false, edge);
        due_ = edge + 1;
        return;
      }
    } else {
      leave(edge);
      return;
    }
    output(tx, line_.level(), edge);
    due_ = line_.next();
  }

  // A clock behind the last stop bit.
  void leave(Clock edge) {
    if (packet_ == ServoPacket::question) {
      reply_.clear();
      receiver_.release(edge);
      taken_ = never;
      expires_ = expiry(edge + 1);
      go(State::listening, expires_);
    } else {
      pause(edge);
    }
  }

  // The edge at which a reply is given up if no byte comes from state `from` on.
  [[nodiscard]] Clock expiry(Clock from) const noexcept { return tick_.state_of(ticks_before(from) + timeout_us_) + 2; }

  void hear(Clock edge) {
    if (edge == good_) {
      good_ = never;
      go(State::stamping, edge + 1);
      return;
    }
    if (edge == taken_) {
      taken_ = never;
      if (reply_.take(data_, broken_, id_of(servo_))) {
        good_ = edge + 1;
        taken_ = edge + 1;  // so that this edge comes
      }
      if (edge + 1 < expires_) {
        expires_ = expiry(edge + 1);
      }
      if (reply_.heard() == most_bytes) {
        expires_ = std::min(expires_, edge + 2);
      }
      due_ = expires_;
    }
    if (receiver_.step(edge)) {
      data_ = receiver_.data();
      broken_ = receiver_.framing_error();
      taken_ = edge + 1;
    }
  }

  void lose(Clock edge) {
    Servo& one = servos_[servo_];
    one.failures = (one.failures + 1) & 0xFFu;
    one.reason = reply_.heard() != 0 ? 2 : 1;
    if (one.in_a_row == failures_most_ - 1) {
      one.valid = false;
    } else {
      ++one.in_a_row;
    }
    word(address(servo_, ServoField::failures), one.failures, edge);
    show_status(servo_, edge);
    event(failed, edge);
    pause(edge);
  }

  void commit(Clock edge) {
    Servo& one = servos_[servo_];
    one.valid = true;
    one.reason = one.in_a_row = 0;
    one.alarm = reply_.alarm();
    for (const ServoField field : {ServoField::position, ServoField::speed, ServoField::load}) {
      word(address(servo_, field), reply_.word(field), edge);
    }
    show_status(servo_, edge);
    pause(edge);
  }

  void pause(Clock edge) {
    taken_ = good_ = never;
    go(State::pausing, tick_.state_of(tick_.until(edge) + gap_us_) + 1);
  }

  void go_on(Clock edge) {
    State next_state = State::choosing;
    if (packet_ != ServoPacket::question) {
      packet_ = packet_ == ServoPacket::torques ? ServoPacket::goals : ServoPacket::question;
    } else if (++servo_ == servos_.size()) {
      servo_ = 0;
      const std::uint64_t lasted = ticks_before(edge) - begun_ticks_;
      word(control() + 1, static_cast<std::uint32_t>(std::min<std::uint64_t>(lasted, 0xFFFF)), edge);
      event(cycled, edge);
      next_state = State::idle;
    }
    go(enable_ ? next_state : State::idle, edge + 1);
  }

  void go(State state, Clock due) noexcept {
    state_ = state;
    due_ = due;
  }

  void show_status(std::uint32_t number, Clock edge) {
    const Servo& one = servos_[number];
    word(address(number, ServoField::status), (one.valid ? 1u : 0u) | one.reason << 1 | one.alarm << 3, edge);
  }

  void stored(std::uint32_t place, Clock edge) override {
    if (place == control()) {
      enable_ = (write_word(place) & 1u) != 0;
      word(place, enable_ ? 1 : 0, edge);
      due_ = state_ == State::idle ? edge + 1 : due_;
    } else if (place % servo_fields == static_cast<std::uint32_t>(ServoField::drive)) {
      word(place, write_word(place) & 3u, edge);
    } else {
      word(place, write_word(place) & 0xFFFFu, edge);
    }
  }

  void look(std::uint32_t place, Clock state) override {
    if (place >= control() || place % servo_fields != static_cast<std::uint32_t>(ServoField::age) || state == 0) {
      return;
    }
    const Servo& one = servos_[place / servo_fields];
    const std::uint64_t passed = one.valid ? ticks_before(state) - one.stamp_us : longest_age;
    word(place, static_cast<std::uint32_t>(passed) & longest_age, state - 1);
  }

  void driven(std::uint32_t /*rx*/, bool level, Clock edge) override { receiver_.drive(level, edge); }

  bool feetech_;
  std::uint32_t first_id_;
  std::uint64_t cycle_us_;
  std::uint64_t timeout_us_;
  std::uint64_t gap_us_;
  std::uint32_t failures_most_;
  Tick tick_;  // of a microsecond
  Clock bit_clocks_;
  UartTransmitter line_;
  UartReceiver receiver_;
  ServoReply reply_;
  std::vector<Servo> servos_;

  State state_ = State::idle;
  Clock due_ = 0;
  bool enable_ = true;
  ServoPacket packet_ = ServoPacket::torques;
  std::uint32_t servo_ = 0;
  bool half_ = false;
  std::uint32_t told_ = 0;
  std::uint32_t engaged_ = 0;
  std::uint64_t begun_ticks_ = 0;
  std::vector<std::uint8_t> text_;
  std::size_t sent_ = 0;
  Clock expires_ = never;
  Clock taken_ = never;  // the edge that takes a byte
  Clock good_ = never;   // the edge that knows that the reply is good
  std::uint8_t data_ = 0;
  bool broken_ = false;
};

}  // namespace

std::unique_ptr<Component> make_servo_bus(const ComponentConfiguration& from) {
  return std::make_unique<ServoBus>(from);
}

}  // namespace unitylink::device
