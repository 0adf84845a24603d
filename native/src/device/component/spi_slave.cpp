// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/spi_slave.hpp"

namespace unitylink::device {

SpiSlave::SpiSlave(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines), mosi_(pins.output(component, lines.mosi, now)) {
  selected_ = !pins.output(component, lines.select_n, now)->level();
  pins.output(component, lines.select_n, now)->watch([this](bool level, Clock state) { select(level, state); });
  pins.output(component, lines.sclk, now)->watch([this](bool level, Clock state) { clock(level, state); });
}

void SpiSlave::select(bool level, Clock state) {
  if (level) {
    lasted("select_hold", clocked_from_, state);
  } else {
    lasted("select_high", selected_from_, state);
  }
  selected_ = !level;
  selected_from_ = state;
  clocked_from_ = never;
  begun();
  if (selected_ && (lines_.mode & 1u) == 0) {
    show(state);
  } else if (!selected_) {
    pins_.drive(component_, lines_.miso, true, state);
  }
}

void SpiSlave::clock(bool level, Clock state) {
  if (!selected_) {
    return;
  }
  if (clocked_from_ == never) {
    lasted("select_setup", selected_from_, state);
  } else {
    lasted(level ? "sclk_low" : "sclk_high", clocked_from_, state);
  }
  clocked_from_ = state;
  const bool leading = level != ((lines_.mode & 2u) != 0);
  if (leading != ((lines_.mode & 1u) == 0)) {
    show(state);
  } else if (plugged) {
    heard(mosi_->level());
  }
}

void SpiSlave::show(Clock state) { pins_.drive(component_, lines_.miso, !plugged || shown(), state); }

}  // namespace unitylink::device
