// SPDX-License-Identifier: BSD-3-Clause
// The model of modbus_master.vhd, with modbus_master_line.vhd.
#include <algorithm>

#include "device/component/bus_sequencer.hpp"
#include "device/component/ticker.hpp"
#include "device/component/uart_line.hpp"

namespace unitylink::device {

namespace {

// The CRC with one byte more, lowest bit first: polynomial 8005, reflected.
std::uint32_t crc_with(std::uint32_t crc, std::uint32_t byte) noexcept {
  crc ^= byte;
  for (int bit = 0; bit < 8; ++bit) {
    crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xA001u : crc >> 1;
  }
  return crc;
}

class ModbusMaster final : public BusSequencer {
 public:
  explicit ModbusMaster(const ComponentConfiguration& from)
      : BusSequencer(from),
        ticker_(from),
        pause_us_(pause_of(baud_hz(from))),
        timeout_us_(static_cast<std::uint64_t>(from.generic("timeout_us", 100'000))),
        lead_clocks_((clock_hz(from) + baud_hz(from) - 1) / baud_hz(from)),
        line_(clock_hz(from), baud_hz(from), parity_of(from), static_cast<std::uint32_t>(from.generic("stop_bits", 1))),
        receiver_(clock_hz(from), baud_hz(from), parity_of(from)),
        silent_from_(ticker_.state_of(pause_us_) + 1) {
    if (!outputs().empty()) {  // not in a look whether there is a model
      output(tx, true, never);
    }
  }

 private:
  enum Output : std::uint32_t { tx, tx_enable };
  enum class State { idle, quiet, leading, sending, low_sum, high_sum, draining, listening, refusing, checking };

  static std::uint64_t clock_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000));
  }
  static std::uint64_t baud_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("baud_hz", 19'200));
  }
  static Parity parity_of(const ComponentConfiguration& from) { return static_cast<Parity>(from.generic("parity", 1)); }
  static std::uint64_t pause_of(std::uint64_t baud) {
    return (baud > 19'200 ? 1750 : (38'500'000 + baud - 1) / baud) + (2'000'000 + baud - 1) / baud;
  }

  [[nodiscard]] bool is_talking() const noexcept {
    return state_ == State::sending || state_ == State::low_sum || state_ == State::high_sum;
  }
  [[nodiscard]] bool is_hearing() const noexcept {
    return state_ == State::listening || state_ == State::refusing || state_ == State::checking;
  }

  [[nodiscard]] Clock next_of_bus() const noexcept override {
    Clock due = std::min({look_, came_, line_.next(), drives_ ? never : receiver_.next()});
    if (state_ == State::quiet) {
      due = std::min({due, silent_from_, late_from_});
    } else if (state_ == State::leading) {
      due = std::min(due, lead_ends_);
    } else if (is_hearing()) {
      due = std::min(due, heard_ == 0 ? late_from_ : silent_from_);
    }
    return due;
  }

  void begin(const BusRequest& request, Clock edge) override {
    data_ = request.data;
    last_ = request.last;
    receives_ = request.receive;
    if (request.first) {
      talks_ = true;
      crc_ = 0xFFFF;
      start_timer(edge);
      go(State::quiet, edge);
    } else if (!request.receive) {
      go(State::sending, edge);
    } else {
      go(talks_ ? State::low_sum : State::listening, edge);
    }
  }

  void step_bus(Clock edge) override {
    look_ = never;
    const bool is_ready = line_.is_ready(edge);
    const bool came = edge == came_;
    const bool drove = drives_;
    const bool was_at_rest = rests_;
    rests_ = receiver_.settled(edge);
    if (is_talking() && is_ready) {
      line_.take(static_cast<std::uint8_t>(state_ == State::sending   ? data_
                                           : state_ == State::low_sum ? crc_
                                                                      : crc_ >> 8),
                 edge);
      sent(edge);
    } else {
      turn(edge, is_ready, came);
      line_.step(edge);
    }
    output(tx, line_.level(), edge);
    if (!rests_) {
      silent_from_ = never;
    } else if (came || drove) {
      start_pause(edge);
    } else if (!was_at_rest) {
      start_pause(edge - 1);
    }
    if (came) {
      came_ = never;
    }
    if (drove) {
      if (!drives_) {
        receiver_.release(edge);
      }
    } else if (receiver_.step(edge)) {
      came_ = edge + 1;
    }
  }

  // The line has taken a byte.
  void sent(Clock edge) {
    if (state_ == State::low_sum) {
      go(State::high_sum, edge);
    } else if (state_ == State::high_sum) {
      go(State::draining, edge);
    } else {
      crc_ = crc_with(crc_, data_);
      if (last_) {
        go(State::low_sum, edge);
      } else {
        end(BusFailure::none, data_, edge);
      }
    }
  }

  void turn(Clock edge, bool is_ready, bool came) {
    switch (state_) {
      case State::quiet:
        if (is_silent(edge)) {
          drive(true, edge);
          lead_ends_ = edge + lead_clocks_;
          go(State::leading, edge);
        } else if (edge >= late_from_) {
          end(BusFailure::no_answer, reply_, edge);
        }
        break;
      case State::leading:
        if (edge == lead_ends_) {
          go(State::sending, edge);
        }
        break;
      case State::draining:
        if (is_ready) {
          drive(false, edge);
          talks_ = false;
          crc_ = 0xFFFF;
          heard_ = 0;
          has_sum_ = false;
          refuses_ = false;
          start_timer(edge);
          if (receives_) {
            go(State::listening, edge);
          } else {
            end(BusFailure::none, reply_, edge);
          }
        }
        break;
      case State::listening:
      case State::refusing:
      case State::checking: hear(edge, came); break;
      default: break;
    }
  }

  void hear(Clock edge, bool came) {
    if (came && !receiver_.framing_error() && !receiver_.parity_error()) {
      take(receiver_.data(), edge);
    } else if (came || (heard_ != 0 && is_silent(edge))) {
      end(BusFailure::wrong_reply, reply_, edge);
    } else if (heard_ == 0 && edge >= late_from_) {
      end(BusFailure::no_answer, reply_, edge);
    }
  }

  void take(std::uint8_t byte, Clock edge) {
    const bool is_second = heard_ == 1;
    crc_ = crc_with(crc_, byte);
    heard_ = std::min(heard_ + 1, 2u);
    if (state_ == State::listening) {
      reply_ = byte;
      if (is_second && (byte & 0x80u) != 0) {
        refuses_ = true;
        go(State::refusing, edge);
      } else if (last_) {
        go(State::checking, edge);
      } else {
        end(BusFailure::none, reply_, edge);
      }
    } else if (state_ == State::refusing) {
      reply_ = byte;
      go(State::checking, edge);
    } else if (!has_sum_) {
      has_sum_ = true;
    } else if (crc_ != 0) {
      end(BusFailure::wrong_reply, reply_, edge);
    } else {
      end(refuses_ ? BusFailure::refused : BusFailure::none, reply_, edge);
    }
  }

  void end(BusFailure failure, std::uint8_t data, Clock edge) {
    go(State::idle, edge);
    reply(failure, data, edge);
  }

  void go(State state, Clock edge) noexcept {
    state_ = state;
    look_ = edge + 1;
  }

  // The last edge with a sound on the line.
  void start_pause(Clock edge) noexcept { silent_from_ = ticker_.state_of(ticker_.until(edge) + pause_us_) + 1; }
  [[nodiscard]] bool is_silent(Clock edge) const noexcept { return rests_ && edge >= silent_from_; }

  void start_timer(Clock edge) noexcept { late_from_ = ticker_.state_of(ticker_.until(edge) + timeout_us_) + 1; }

  void drive(bool on, Clock edge) {
    drives_ = on;
    output(tx_enable, on, edge);
  }

  void driven(std::uint32_t /*rx*/, bool level, Clock edge) override { receiver_.drive(level, edge); }

  Ticker ticker_;
  std::uint64_t pause_us_;
  std::uint64_t timeout_us_;
  Clock lead_clocks_;
  UartTransmitter line_;
  UartReceiver receiver_;

  State state_ = State::idle;
  std::uint8_t data_ = 0;
  std::uint8_t reply_ = 0;
  bool last_ = false;
  bool receives_ = false;
  bool talks_ = false;  // the request is still to end
  bool drives_ = false;
  bool rests_ = true;  // the line is high
  bool refuses_ = false;
  bool has_sum_ = false;     // the first byte of the CRC has come
  std::uint32_t heard_ = 0;  // bytes of the reply, at most 2
  std::uint32_t crc_ = 0xFFFF;
  Clock silent_from_;        // the first state in which the line has been silent for a pause
  Clock late_from_ = never;  // that in which the time is over
  Clock lead_ends_ = never;
  Clock came_ = never;  // the edge that takes a character
  Clock look_ = never;  // an edge at which something may change
};

}  // namespace

std::unique_ptr<Component> make_modbus_master(const ComponentConfiguration& from) {
  return std::make_unique<ModbusMaster>(from);
}

}  // namespace unitylink::device
