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
  [[nodiscard]] TimeSource time_source() const noexcept override {
    return []() noexcept { return RobotTime::here().now_ns(); };
  }
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

Outcome open_port(const Url& url, std::uint64_t timeout_ns, int cancelled, std::unique_ptr<Driver>& driver) {
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
    return open_socket(url, timeout_ns, cancelled, driver);
  }
  return open_descriptor(url, driver);
}

}  // namespace

DriverSource::DriverSource(Url url, std::uint64_t timeout_ns) : url_(std::move(url)), timeout_ns_(timeout_ns) {}
DriverSource::~DriverSource() = default;

Outcome DriverSource::open(std::unique_ptr<Driver>& driver, int cancelled) {
  const std::string* const trace = url_.option("trace");
  if (trace != nullptr && capture_ == nullptr) {  // before the port: a file that cannot be written must not cost a connection
    std::unique_ptr<Capture> made;
    if (Outcome outcome = Capture::create(*trace, url_.text, made); !outcome.ok()) {
      return outcome;
    }
    capture_ = std::move(made);
  }
  Outcome outcome = open_port(url_, timeout_ns_, cancelled, driver);
  if (!outcome.ok() && capture_ != nullptr && capture_->empty()) {  // the next try is not to find a file in its way
    capture_->discard();
    capture_.reset();
  }
  if (outcome.ok() && capture_ != nullptr) {
    driver = std::make_unique<CapturingDriver>(std::move(driver), capture_);
  }
  return outcome;
}

void DriverSource::close() noexcept {
  if (capture_ != nullptr) {
    capture_->close();
  }
}

void DriverSource::disown() noexcept {
  if (capture_ != nullptr) {
    capture_->disown();
  }
}

Outcome open_driver(const Url& url, std::uint64_t timeout_ns, std::unique_ptr<Driver>& driver) {
  return DriverSource(url, timeout_ns).open(driver);
}

}  // namespace unitylink
