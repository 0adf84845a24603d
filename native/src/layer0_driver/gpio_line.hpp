// SPDX-License-Identifier: BSD-3-Clause
// A wire on which the FPGA signals that it has bytes to send. It is an input of a GPIO chip, used through the kernel's
// character device.
#pragma once

#include <memory>
#include <string>

#include "layer0_driver/status.hpp"

namespace unitylink {

class GpioLine {
 public:
  // `place` names a chip and its line: "/dev/gpiochip0:25". Errors: bad_url, not_found, permission, busy, mismatch (no
  // such line).
  [[nodiscard]] static Outcome open(const std::string& place, std::unique_ptr<GpioLine>& line);
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine();

  // Readable if the line has risen since the last call of high().
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool high() const noexcept;

 private:
  explicit GpioLine(int descriptor) noexcept : descriptor_(descriptor) {}

  int descriptor_;
};

}  // namespace unitylink
