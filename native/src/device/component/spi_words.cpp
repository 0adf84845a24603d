// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/spi_words.hpp"

namespace unitylink::device {

namespace {

constexpr std::uint32_t number_bits = 4;
constexpr std::uint32_t sampling_edges = 2;  // the line is not driven, then it is 0

}  // namespace

SpiWords::SpiWords(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now)
    : SpiSlave(pins, component, lines, now), bits_(lines.word_bits), numbered_(lines.numbered) {}

void SpiWords::begun() {
  asked_ = 1;
  started_ = false;
  edges_ = 0;
}

void SpiWords::heard(bool bit) {
  if (!started_) {
    started_ = bit;
  } else if (asked_ < 1u << number_bits) {
    asked_ = asked_ << 1 | (bit ? 1u : 0u);
  }
}

bool SpiWords::shown() {
  if (numbered_ && asked_ < 1u << number_bits) {
    return true;
  }
  const std::uint32_t before = numbered_ ? sampling_edges : 0;
  const std::uint32_t edge = edges_++;
  if (edge < before) {
    return edge + 1 < before;
  }
  const std::uint32_t place = edge - before;
  if (place == 0) {
    sample();
  }
  if (place < bits_) {
    return (word_ >> (bits_ - 1 - place) & 1u) != 0;
  }
  const std::uint32_t upwards = place - bits_ + 1;
  return numbered_ && upwards < bits_ && (word_ >> upwards & 1u) != 0;
}

void SpiWords::sample() {
  const std::uint32_t first = numbered_ ? 4 * (asked_ & 15u) : 0;
  word_ = 0;
  for (std::uint32_t byte = 0; byte < 4; ++byte) {
    word_ = word_ << 8 | registers[first + byte];
  }
}

}  // namespace unitylink::device
