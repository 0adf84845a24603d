// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/spi_registers.hpp"

namespace unitylink::device {

SpiRegisters::SpiRegisters(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now)
    : SpiSlave(pins, component, lines, now) {}

void SpiRegisters::begun() {
  bits_ = 0;
  reads_ = false;
}

void SpiRegisters::heard(bool bit) {
  shifted_ = static_cast<std::uint8_t>(shifted_ << 1 | (bit ? 1 : 0));
  if (++bits_ % 8 != 0) {
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

// The next bit, the highest of a byte first.
bool SpiRegisters::shown() { return !reads_ || bits_ < 8 || (registers[place_] >> (7 - bits_ % 8) & 1u) != 0; }

}  // namespace unitylink::device
