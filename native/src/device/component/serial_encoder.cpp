// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/serial_encoder.hpp"

#include <bit>

namespace unitylink::device {

namespace {

constexpr std::uint32_t busy_bits = 3;  // a device with BiSS-C needs some clocks
constexpr std::uint32_t check_bits = 6;
constexpr std::uint32_t word_bits = 16;
constexpr std::uint32_t angle_command = 0xFFFF;
constexpr std::uint32_t field_command = 0x7FFD;
constexpr std::uint32_t clear_command = 0x4001;
constexpr std::uint32_t field = 0x0583;
constexpr std::uint32_t error_flag = 1u << 14;

std::uint32_t with_parity(std::uint32_t word) noexcept {
  return (std::popcount(word & 0x7FFFu) & 1) != 0 ? word | 0x8000u : word & 0x7FFFu;
}

}  // namespace

SerialEncoder::SerialEncoder(Pins& pins, std::uint32_t component, const SerialEncoderLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines), mosi_(pins.output(component, lines.mosi, now)) {
  OutputPin* sclk = pins.output(component, lines.sclk, now);
  if (lines.kind == Kind::chip) {
    OutputPin* select_n = pins.output(component, lines.select_n, now);
    select_n->watch([this](bool level, Clock state) { select(level, state); });
    sclk->watch([this](bool level, Clock state) { clock_chip(level, state); });
  } else {
    sclk->watch([this](bool level, Clock state) { clock(level, state); });
  }
}

// SSI and BiSS-C: the clock is high at rest, and its first fall latches.
void SerialEncoder::clock(bool level, Clock state) {
  if (!level && (edge_ == never || state - edge_ >= lines_.quiet)) {
    latch(state);
  } else if (level) {
    show_next(state);
  }
  edge_ = state;
}

void SerialEncoder::latch(Clock state) {
  frame_.clear();
  place_ = 0;
  pins_.drive(component_, lines_.miso, true, state);
  if (!plugged) {
    return;
  }
  ++registers[5];
  const std::uint32_t reading = number(0, 4) & (lines_.bits < 32 ? (1u << lines_.bits) - 1 : ~0u);
  if (lines_.kind == Kind::ssi) {
    add(~0u, lines_.lead_bits);
    add(lines_.gray ? reading ^ reading >> 1 : reading, lines_.bits);
    add(~0u, lines_.tail_bits);
    frame_.push_back(false);
    return;
  }
  frame_.push_back(true);
  add(0, 1 + busy_bits);
  add(0b10, 2);  // the start bit, and one that belongs to a register
  add(reading, lines_.bits);
  add((registers[4] & 1u) != 0 ? 0 : 1, 1);
  add((registers[4] & 2u) != 0 ? 0 : 1, 1);
  add_check();
}

// CRC-6 of polynomial 43 (hexadecimal) over what follows the start bits. It is sent inverted.
void SerialEncoder::add_check() {
  std::uint32_t crc = 0;
  for (std::size_t place = frame_.size() - lines_.bits - 2; place < frame_.size(); ++place) {
    const bool top = ((crc & 0x20u) != 0) != frame_[place];
    crc = (crc << 1 & 0x3Fu) ^ (top ? 3u : 0u);
  }
  add(~crc, check_bits);
}

void SerialEncoder::add(std::uint32_t word, std::uint32_t bits) {
  for (std::uint32_t left = bits; left > 0; --left) {
    frame_.push_back(left > 32 || (word >> (left - 1) & 1u) != 0);
  }
}

void SerialEncoder::show_next(Clock state) {
  if (place_ < frame_.size()) {
    pins_.drive(component_, lines_.miso, frame_[place_], state);
    if (++place_ == frame_.size()) {
      if (lines_.kind == Kind::biss) {  // its last bit may have no clock behind it
        pins_.drive_at(component_, lines_.miso, false, state + (state - rose_));
      }
      pins_.drive_at(component_, lines_.miso, true, state + lines_.quiet);
    }
  }
  rose_ = state;
}

// SPI: an answer is to the command before.
void SerialEncoder::select(bool level, Clock state) {
  selected_ = !level;
  if (selected_) {
    heard_ = heard_bits_ = 0;
    return;
  }
  pins_.drive(component_, lines_.miso, true, state);
  if (plugged && heard_bits_ == word_bits) {
    ++registers[5];
    obey();
  }
}

void SerialEncoder::clock_chip(bool level, Clock state) {
  if (!selected_ || heard_bits_ >= word_bits) {
    return;
  }
  if (level) {
    const bool bit = (reply_ >> (word_bits - 1 - heard_bits_) & 1u) != 0;
    pins_.drive(component_, lines_.miso, !plugged || bit, state);
  } else {
    heard_ = heard_ << 1 | (mosi_->level() ? 1u : 0u);
    ++heard_bits_;
  }
}

void SerialEncoder::obey() {
  error_ = error_ || (registers[4] & 1u) != 0;
  const std::uint32_t flag = error_ ? error_flag : 0;
  switch (heard_) {
    case angle_command: reply_ = with_parity(flag | (number(0, 4) & 0x3FFFu)); break;
    case field_command: reply_ = with_parity(flag | field); break;
    case clear_command:
      reply_ = with_parity(flag | 1u);
      error_ = false;
      break;
    default: reply_ = with_parity(error_flag);
  }
}

}  // namespace unitylink::device
