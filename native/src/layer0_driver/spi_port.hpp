// SPDX-License-Identifier: BSD-3-Clause
// One chip select of an SPI bus, through the kernel's spidev. It uses mode 0 and 8 bits, most significant bit first.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "layer0_driver/status.hpp"

namespace unitylink {

class SpiPort {
 public:
  [[nodiscard]] static Outcome open(const std::string& path, std::uint32_t speed_hz, std::unique_ptr<SpiPort>& port);
  SpiPort(const SpiPort&) = delete;
  SpiPort& operator=(const SpiPort&) = delete;
  ~SpiPort();

  // Makes one transfer. Its length is that of `out` or `in`, whichever is shorter. Returns 0 or an errno.
  [[nodiscard]] int exchange(std::span<const std::uint8_t> out, std::span<std::uint8_t> in) const noexcept;

 private:
  SpiPort(int descriptor, std::uint32_t speed_hz) noexcept : descriptor_(descriptor), speed_hz_(speed_hz) {}

  int descriptor_;
  std::uint32_t speed_hz_;
};

}  // namespace unitylink
