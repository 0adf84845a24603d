// SPDX-License-Identifier: BSD-3-Clause
// A wire on which the FPGA says that it has something: an input of a GPIO chip, through the kernel's character device.
#pragma once

#include <memory>
#include <string>

#include "layer0_driver/status.hpp"

namespace unitylink {

class GpioLine {
 public:
  // `place` is a chip and a line of it: "/dev/gpiochip0:25". bad_url, not_found, permission, busy, mismatch (no such
  // line).
  [[nodiscard]] static Outcome open(const std::string& place, std::unique_ptr<GpioLine>& line);
  GpioLine(const GpioLine&) = delete;
  GpioLine& operator=(const GpioLine&) = delete;
  ~GpioLine();

  // Readable when the line has risen since high() was asked.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool high() const noexcept;

 private:
  explicit GpioLine(int descriptor) noexcept : descriptor_(descriptor) {}

  int descriptor_;
};

}  // namespace unitylink
