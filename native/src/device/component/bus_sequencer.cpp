// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/bus_sequencer.hpp"

#include <algorithm>
#include <charconv>
#include <string>

namespace unitylink::device {

namespace {

constexpr std::uint32_t longest_age = (1u << 20) - 1;

std::string writable_words(const ComponentConfiguration& from) {
  return "1" + std::string(4 + static_cast<std::size_t>(from.generic("values", 1)), '0') +
         std::string(static_cast<std::size_t>(from.generic("outputs", 0)), '1');
}

}  // namespace

BusSequencer::BusSequencer(const ComponentConfiguration& from)
    : Component(from, writable_words(from), false),
      values_(static_cast<std::uint32_t>(from.generic("values", 1))),
      outputs_(static_cast<std::uint32_t>(from.generic("outputs", 0))),
      failures_most_(static_cast<std::uint32_t>(from.generic("failures_most", 3))),
      data_mask_(from.data_mask()),
      tick_(from) {
  const std::string text = from.text("program");
  for (std::size_t number = 0; number < std::min(program_.size(), text.size() / 4); ++number) {
    const char* digits = text.data() + 4 * number;
    std::from_chars(digits, digits + 4, program_[number], 16);
  }
  word(control, 1, 0);
}

Clock BusSequencer::next() const noexcept {
  return std::min({due_, next_of_bus(), state_ == State::exchanging ? replied_ : never});
}

void BusSequencer::step(Clock edge) {
  if (edge >= next_of_bus()) {
    step_bus(edge);
  }
  run(edge);
}

void BusSequencer::run(Clock edge) {
  switch (state_) {
    case State::fetching:
      if (edge >= due_) {
        word_ = program_[pc_];
        state_ = State::running;
        due_ = edge + 1;
      }
      break;
    case State::running:
      if ((word_ & 0xC000u) == 0xC000u) {
        operate(edge);
      } else if (failing_) {
        go_on(edge);
      } else {
        state_ = State::exchanging;
        due_ = never;
        replied_ = never;  // that of the byte before is over: else each clock would be run until the next one
        begin({(word_ & 0x2000u) != 0, (word_ & 0x1000u) != 0, (word_ & 0x0800u) != 0, byte_to_send()}, edge);
      }
      break;
    case State::exchanging:
      if (edge == replied_) {
        answered(edge);
      }
      break;
  }
}

// All bytes of an output are of the moment of the first one.
std::uint8_t BusSequencer::byte_to_send() noexcept {
  if ((word_ & 0x8000u) == 0 || outputs_ == 0) {
    return static_cast<std::uint8_t>(word_ & 0xFFu);
  }
  if ((word_ & 0x0400u) != 0) {
    taken_ = write_word(first_value + values_ + (word_ & 7u)) & data_mask_;
  }
  return static_cast<std::uint8_t>(taken_ >> 8 * (word_ >> 8 & 3u));
}

void BusSequencer::operate(Clock edge) {
  switch (word_ >> 11 & 7u) {
    case wait:
      if (!enable_) {
        failing_ = false;
        start_anew(edge);
      } else if (failing_) {
        go_on(edge);
      } else if (edge >= expired_from_) {
        const std::uint64_t ticks = (word_ & 0xFFu) * ((word_ & 0x0400u) != 0 ? 256u : 1u);
        expired_from_ = ticks == 0 ? edge + 1 : tick_.state_of(tick_.until(edge) + ticks) + 1;
        go_on(edge);
      } else {
        due_ = expired_from_;
      }
      break;
    case sample:
      if (!failing_) {
        banks_[1 - bank_][stamp] = static_cast<std::uint32_t>(edge);
        pointer_ = first_value;
      }
      go_on(edge);
      break;
    case commit:
      if (failing_) {
        const bool too_many = ++in_a_row_ == failures_most_;
        fail(edge);
        if (too_many) {
          start_anew(edge);
        } else {
          go_to(word_ & 0xFFu, edge);
        }
      } else if (is_held(edge)) {
        due_ = edge + 1;
      } else {
        bank_ = 1 - bank_;
        valid_ = true;
        in_a_row_ = 0;
        fresh_since_ = tick_.until(edge);
        event(0, edge);
        for (std::uint32_t address = stamp; address < first_value + values_; ++address) {
          word(address, banks_[bank_][address] & data_mask_, edge);
        }
        go_to(word_ & 0xFFu, edge);
      }
      break;
    case skip:
      if ((told_ >> (word_ >> 8 & 7u) & 1u) == 0) {
        go_to(word_ & 0xFFu, edge);
      } else {
        go_on(edge);
      }
      break;
    default:
      if (failing_) {
        fail(edge);
        start_anew(edge);
      } else {
        set_up_ = true;
        go_on(edge);
      }
  }
  show(edge);
}

void BusSequencer::answered(Clock edge) {
  const bool differs = (word_ & 0x4000u) != 0 && reply_data_ != (word_ & 0xFFu);
  if (reply_failure_ != BusFailure::none || differs) {
    failing_ = true;
    reason_ = static_cast<std::uint32_t>(reply_failure_ != BusFailure::none ? reply_failure_ : BusFailure::wrong_reply);
    if (reply_failure_ == BusFailure::refused) {
      code_ = reply_data_;
    }
  }
  if ((word_ & 0x8400u) == 0x0400u) {
    keep();
  }
  go_on(edge);
  show(edge);
}

void BusSequencer::keep() {
  const std::uint32_t lane = word_ >> 8 & 3u;
  std::uint32_t& value = banks_[1 - bank_][pointer_];
  value = (value & ~(0xFFu << 8 * lane)) | static_cast<std::uint32_t>(reply_data_) << 8 * lane;
  const bool receives = (word_ & 0x0800u) != 0;
  if (receives ? (word_ & 1u) != 0 : lane == 0) {
    pointer_ = (pointer_ + 1) % 32;
  }
}

void BusSequencer::go_on(Clock edge) noexcept { go_to((pc_ + 1) % 256, edge); }

void BusSequencer::go_to(std::uint32_t pc, Clock edge) noexcept {
  pc_ = pc;
  state_ = State::fetching;
  due_ = edge + 2;
}

void BusSequencer::start_anew(Clock edge) noexcept {
  valid_ = false;
  set_up_ = false;
  in_a_row_ = 0;
  go_to(0, edge);
}

void BusSequencer::fail(Clock edge) {
  failing_ = false;
  failed_ = (failed_ + 1) & 0xFFFFu;
  word(failures, failed_ & data_mask_, edge);
  event(1, edge);
}

void BusSequencer::show(Clock edge) {
  word(status, (valid_ ? 1u : 0u) | (set_up_ ? 2u : 0u) | reason_ << 4 | code_ << 6, edge);
}

void BusSequencer::stored(std::uint32_t address, Clock edge) {
  if (address != control) {
    told_ |= 1u << (address - first_value - values_);
    word(address, write_word(address) & data_mask_, edge);
    return;
  }
  enable_ = (write_word(address) & 1u) != 0;
  word(control, enable_ ? 1 : 0, edge);
}

void BusSequencer::look(std::uint32_t address, Clock state) {
  if (address == age && state > 0) {
    const std::uint64_t passed = tick_.until(state - 1) - fresh_since_;
    word(age, static_cast<std::uint32_t>(std::min<std::uint64_t>(passed, longest_age)) & data_mask_, state - 1);
  }
}

void BusSequencer::reply(BusFailure failure, std::uint8_t data, Clock edge) noexcept {
  reply_failure_ = failure;
  reply_data_ = data;
  replied_ = edge + 1;
}

}  // namespace unitylink::device
