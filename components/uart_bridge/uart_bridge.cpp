// SPDX-License-Identifier: BSD-3-Clause
// The model of uart_bridge.vhd.
#include <algorithm>
#include <array>
#include <string>

#include "device/component/component.hpp"
#include "device/component/uart_line.hpp"
#include "uart_bridge_queue.hpp"

namespace unitylink::device {

namespace {

class UartBridge final : public Component {
 public:
  explicit UartBridge(const ComponentConfiguration& from)
      : Component(from, "1010", false),
        clock_hz_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000))),
        baud_hz_(static_cast<std::uint64_t>(from.generic("baud_hz", 115'200))),
        parity_(static_cast<Parity>(from.generic("parity", 0))),
        stop_bits_(static_cast<std::uint32_t>(from.generic("stop_bits", 1))),
        is_half_duplex_(from.generic("half_duplex", 0) != 0),
        hold_((static_cast<Clock>(from.generic("hold_us", 0)) * ((clock_hz_ + 999) / 1000) + 999) / 1000),
        depth_(static_cast<std::uint32_t>(from.generic("depth", 64))),
        room_(depth_),
        to_line_(depth_),
        from_line_(depth_),
        line_(clock_hz_, baud_hz_, parity_, stop_bits_),
        receiver_(clock_hz_, baud_hz_, parity_) {
    word(send, room_, 0);
    if (!outputs().empty()) {  // not in a look whether there is a model
      output(tx, true, never);
    }
  }

 private:
  enum Register : std::uint32_t { send, received, baud, state };
  enum Output : std::uint32_t { tx, tx_enable };
  enum class State { idle, leading, sending, holding };
  static constexpr std::uint32_t rate_most = 15;

  [[nodiscard]] std::uint64_t rate(std::uint32_t index) const noexcept {
    static constexpr std::array<std::uint64_t, 10> rates{0,      4800,    9600,    19'200,  38'400,
                                                         57'600, 115'200, 230'400, 460'800, 921'600};
    const bool is_known = index > 0 && index < rates.size() && rates[index] <= clock_hz_ / 8;
    return is_known ? rates[index] : baud_hz_;
  }

  [[nodiscard]] Clock next() const noexcept override {
    const Clock heard = is_deaf() ? never : receiver_.next();
    return std::min({due_, line_.next(), to_line_.next(), from_line_.next(), heard, put_, take_, look_});
  }

  void step(Clock edge) override {
    look_ = never;
    const bool to_send = to_line_.is_loaded();
    const bool is_ready = line_.is_ready(edge);
    const bool sent = state_ == State::sending && to_send && is_ready;
    const bool enabled = enabled_;
    const bool changes = state_ == State::idle && !to_send && index_ != (write_word(baud) & rate_most);
    drive_line(edge, to_send, is_ready, sent);
    const bool was_written = is_written(send, edge);
    to_line_.step(edge, sent, was_written, write_word(send) & 0xFFu);
    room_ += (sent ? 1u : 0u) - (was_written ? 1u : 0u);
    word(send, room_, edge);
    take_in(edge);
    if (is_half_duplex_ && enabled) {
      if (!enabled_) {
        receiver_.release(edge);
      }
    } else if (!changes && receiver_.step(edge)) {
      put_ = edge + 1;
    }
    if (changes) {
      index_ = write_word(baud) & rate_most;
      line_ = UartTransmitter(clock_hz_, rate(index_), parity_, stop_bits_);
      receiver_.tune(clock_hz_, rate(index_));
      receiver_.release(edge);
    }
    if (goes_on()) {
      look_ = edge + 1;
    }
    const bool sends = enabled_ || room_ != depth_;
    word(state, (sends ? 0x8000u : 0u) | lost_ << 8 | broken_, edge);
  }

  // Does the next edge change something of what is sent, or the rate?
  [[nodiscard]] bool goes_on() const noexcept {
    const bool to_send = to_line_.is_loaded();
    if (state_ == State::sending) {
      return line_.next() == never;
    }
    return state_ != State::leading && (to_send || (state_ == State::idle && index_ != (write_word(baud) & rate_most)));
  }

  void drive_line(Clock edge, bool to_send, bool is_ready, bool sent) {
    if (sent) {
      line_.take(static_cast<std::uint8_t>(to_line_.oldest()), edge);
    } else {
      line_.step(edge);
    }
    output(tx, line_.level(), edge);
    switch (state_) {
      case State::idle:
        if (to_send) {
          enable(true, edge);
          go(State::leading, edge + 1 + hold_);
        }
        break;
      case State::leading:
        if (edge == due_) {
          go(State::sending, never);
        }
        break;
      case State::sending:
        if (!to_send && is_ready) {
          go(State::holding, edge + 1 + hold_);
        }
        break;
      case State::holding:
        if (to_send) {
          go(State::sending, never);
        } else if (edge == due_) {
          enable(false, edge);
          go(State::idle, never);
        }
        break;
    }
  }

  // What came over the line, and what a read has taken.
  void take_in(Clock edge) {
    const bool came = from_line_.is_loaded();
    const bool takes = edge == take_;
    bool puts = false;
    std::uint32_t item = 0;
    if (edge == put_) {
      put_ = never;
      const bool is_right = !receiver_.framing_error() && !receiver_.parity_error();
      puts = is_right && from_line_.has_room();
      item = (gap_ ? 0x100u : 0u) | receiver_.data();
      gap_ = !puts;
      broken_ = (broken_ + (is_right ? 0 : 1)) & 0xFFu;
      lost_ = (lost_ + (is_right && !puts ? 1 : 0)) & 0x7Fu;
    }
    if (came && !told_ && !takes) {
      event(0, edge);
    }
    told_ = came && !takes && !(puts && unread_);
    unread_ = (unread_ || puts) && !takes;
    from_line_.step(edge, takes, puts, item);
    if (takes) {
      take_ = never;
    }
    if (from_line_.is_loaded() && !told_) {
      look_ = edge + 1;
    }
    word(received, from_line_.is_loaded() ? 0x200u | from_line_.oldest() : 0, edge);
  }

  void enable(bool on, Clock edge) {
    enabled_ = on;
    output(tx_enable, on, edge);
  }

  void go(State next, Clock due) noexcept {
    state_ = next;
    due_ = due;
  }

  [[nodiscard]] bool is_deaf() const noexcept { return is_half_duplex_ && enabled_; }

  // A read takes what it finds, a clock behind its own.
  Clock admitted(std::uint32_t address, bool writes, Clock edge) override {
    if (address == received && !writes && from_line_.is_loaded()) {
      take_ = edge + 1;
    }
    return edge;
  }

  [[nodiscard]] bool refuses(std::uint32_t address, std::uint32_t /*value*/) const override {
    return address == send && room_ == 0;
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == baud) {
      word(baud, write_word(baud) & rate_most, edge);
      look_ = edge + 1;
    }
  }

  void driven(std::uint32_t /*rx*/, bool level, Clock edge) override { receiver_.drive(level, edge); }

  std::uint64_t clock_hz_;
  std::uint64_t baud_hz_;
  Parity parity_;
  std::uint32_t stop_bits_;
  bool is_half_duplex_;
  Clock hold_;
  std::uint32_t depth_;
  std::uint32_t room_;
  UartBridgeQueue to_line_;
  UartBridgeQueue from_line_;
  UartTransmitter line_;
  UartReceiver receiver_;

  State state_ = State::idle;
  Clock due_ = never;  // the edge at which this state ends by itself
  std::uint32_t index_ = 0;
  bool enabled_ = false;
  bool gap_ = false;
  bool told_ = false;
  bool unread_ = false;
  std::uint32_t broken_ = 0;
  std::uint32_t lost_ = 0;
  Clock put_ = never;   // the edge that takes a character from the line
  Clock take_ = never;  // the edge at which a read takes a byte out
  Clock look_ = never;  // an edge at which something may change
};

}  // namespace

std::unique_ptr<Component> make_uart_bridge(const ComponentConfiguration& from) {
  return std::make_unique<UartBridge>(from);
}

}  // namespace unitylink::device
