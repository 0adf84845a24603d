// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/gpio_line.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer0_driver/url.hpp"

namespace unitylink {
namespace {

constexpr std::uint64_t line_most = 1023;

}  // namespace

Outcome GpioLine::open(const std::string& place, std::unique_ptr<GpioLine>& line) {
  const std::size_t colon = place.rfind(':');
  std::uint64_t number = 0;
  if (colon == std::string::npos || colon == 0 ||
      !parse_number(std::string_view(place).substr(colon + 1), line_most, number)) {
    return {Status::bad_url, "waiting=" + place + " is not a line of a GPIO chip such as /dev/gpiochip0:25"};
  }
  const std::string path = place.substr(0, colon);
  const auto refused = [&](int error) {
    return refused_port("GPIO line " + place, error, "gpiodetect and gpioinfo tell what there is",
                        "on Debian and Raspberry Pi OS: sudo adduser $USER gpio, then log in again");
  };
  const Descriptor chip(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!chip.open()) {
    return refused(errno);
  }
  gpio_v2_line_request request{};
  request.offsets[0] = static_cast<std::uint32_t>(number);
  request.num_lines = 1;
  request.config.flags = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING;
  std::strncpy(request.consumer, "unitylink", sizeof request.consumer - 1);
  const int error = ::ioctl(chip.get(), GPIO_V2_GET_LINE_IOCTL, &request) == 0 ? 0 : errno;
  if (error == ENOTTY) {
    return {Status::not_found, "GPIO line " + place + ": " + path + " is not a GPIO chip of the kernel"};
  }
  if (error == EINVAL) {
    return {Status::mismatch, "GPIO line " + place + ": the chip has no such line, or the line reports no edges"};
  }
  if (error != 0) {
    return refused(error);
  }
  Descriptor opened(request.fd);
  if (::fcntl(opened.get(), F_SETFL, O_NONBLOCK) != 0) {  // otherwise high() would wait for the next edge
    return refused(errno);
  }
  line.reset(new GpioLine(request.fd));
  opened.release();  // the line owns it now
  return {};
}

GpioLine::~GpioLine() { ::close(descriptor_); }

bool GpioLine::high() const noexcept {
  std::array<gpio_v2_line_event, 16> risings{};
  while (::read(descriptor_, risings.data(), sizeof risings) > 0) {}
  gpio_v2_line_values values{};
  values.mask = 1;
  return ::ioctl(descriptor_, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) == 0 && (values.bits & 1) != 0;
}

}  // namespace unitylink
