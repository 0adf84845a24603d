// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/spi_registers.hpp"

namespace unitylink::device {

SpiRegisters::SpiRegisters(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines), mosi_(pins.output(component, lines.mosi, now)) {
  selected_ = !pins.output(component, lines.select_n, now)->level();
  pins.output(component, lines.select_n, now)->watch([this](bool level, Clock state) { select(level, state); });
  pins.output(component, lines.sclk, now)->watch([this](bool level, Clock state) { clock(level, state); });
}

void SpiRegisters::select(bool level, Clock state) {
  selected_ = !level;
  bits_ = 0;
  reads_ = false;
  if (selected_ && (lines_.mode & 1u) == 0) {
    show(state);
  } else if (!selected_) {
    pins_.drive(component_, lines_.miso, true, state);
  }
}

void SpiRegisters::clock(bool level, Clock state) {
  if (!selected_) {
    return;
  }
  const bool leading = level != ((lines_.mode & 2u) != 0);
  if (leading == ((lines_.mode & 1u) == 0)) {
    shifted_ = static_cast<std::uint8_t>(shifted_ << 1 | (mosi_->level() ? 1 : 0));
    ++bits_;
    if (bits_ % 8 == 0) {
      heard();
    }
  } else {
    show(state);
  }
}

void SpiRegisters::heard() {
  if (!plugged) {
    return;
  }
  if (bits_ == 8) {
    reads_ = (shifted_ & 0x80u) != 0;
    place_ = shifted_ & 0x7Fu;
    return;
  }
  if (!reads_) {
    registers[place_] = shifted_;
  }
  place_ = (place_ + 1u) & 0x7Fu;
}

// Puts the next bit on miso, the highest of a byte first.
void SpiRegisters::show(Clock state) {
  const bool answers = plugged && reads_ && bits_ >= 8;
  pins_.drive(component_, lines_.miso, !answers || (registers[place_] >> (7 - bits_ % 8) & 1u) != 0, state);
}

}  // namespace unitylink::device
