// SPDX-License-Identifier: BSD-3-Clause
// Which driver a URL names.
#include <cerrno>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "layer0_driver/capturing_driver.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer0_driver/ftdi_driver.hpp"
#include "layer0_driver/rs485_driver.hpp"
#include "layer0_driver/serial_driver.hpp"
#include "layer0_driver/socket_driver.hpp"
#include "layer0_driver/spi_driver.hpp"

namespace unitylink {
namespace {

// To a virtual board in this process, whose time the link has too.
class LocalDriver final : public DescriptorDriver {
 public:
  using DescriptorDriver::DescriptorDriver;
  [[nodiscard]] std::uint64_t now_ns() const noexcept override { return RobotTime::here().now_ns(); }
};

// Whether this process made the pair of sockets, one end of which it is.
bool made_here(int descriptor) noexcept {
  ucred maker{};
  socklen_t size = sizeof maker;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_PEERCRED, &maker, &size) == 0 && maker.pid == ::getpid();
}

// The driver takes the descriptor over: closing it is how the other side learns that the link has ended.
Outcome open_descriptor(const Url& url, std::unique_ptr<Driver>& driver) {
  std::uint64_t number = 0;
  if (!parse_number(url.path, 1u << 20, number)) {
    return {Status::bad_url, "link URL '" + url.text + "': not a descriptor number"};
  }
  const int descriptor = static_cast<int>(number);
  if (::fcntl(descriptor, F_SETFD, FD_CLOEXEC) != 0) {
    return {Status::not_found, "link URL '" + url.text + "': no descriptor " + url.path + " is open in this process"};
  }
  if (made_here(descriptor)) {
    driver = std::make_unique<LocalDriver>(descriptor);
  } else {
    driver = std::make_unique<DescriptorDriver>(descriptor);
  }
  return {};
}

Outcome open_port(const Url& url, std::uint64_t timeout_ns, std::unique_ptr<Driver>& driver) {
  if (url.scheme == "serial") {
    return open_serial(url, driver);
  }
  if (url.scheme == "ftdi") {
    return open_ftdi(url, driver);
  }
  if (url.scheme == "rs485") {
    return open_rs485(url, driver);
  }
  if (url.scheme == "spi") {
    return open_spi(url, driver);
  }
  if (url.scheme == "tcp" || url.scheme == "udp") {
    return open_socket(url, timeout_ns, driver);
  }
  return open_descriptor(url, driver);
}

}  // namespace

Outcome open_driver(const Url& url, std::uint64_t timeout_ns, std::unique_ptr<Driver>& driver) {
  const std::string* const trace = url.option("trace");
  std::unique_ptr<Capture> capture;
  if (trace != nullptr) {  // before the port: a file that cannot be written must not cost a connection
    if (Outcome outcome = Capture::create(*trace, url.text, capture); !outcome.ok()) {
      return outcome;
    }
  }
  Outcome outcome = open_port(url, timeout_ns, driver);
  if (outcome.ok() && capture != nullptr) {
    driver = std::make_unique<CapturingDriver>(std::move(driver), std::move(capture));
  }
  return outcome;
}

}  // namespace unitylink
