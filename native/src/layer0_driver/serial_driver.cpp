// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/serial_driver.hpp"

#include <cerrno>
#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/descriptor_driver.hpp"

namespace unitylink {
namespace {

constexpr std::uint64_t bits_per_byte = 10;  // start, 8 data, stop
// the slowest rate that termios names; with a slower one a timeout would take hours
constexpr std::uint64_t baud_hz_min = 50;

class SerialDriver final : public DescriptorDriver {
 public:
  SerialDriver(int descriptor, std::uint64_t byte_time_ns) noexcept
      : DescriptorDriver(descriptor), byte_time_ns_(byte_time_ns) {}
  ~SerialDriver() override { SerialDriver::close(); }

  void close() noexcept override {
    if (descriptor() >= 0) {
      ::ioctl(descriptor(), TIOCNXCL);
    }
    DescriptorDriver::close();
  }
  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return byte_time_ns_; }

 private:
  std::uint64_t byte_time_ns_;
};

// Device numbers 136 to 143 are Unix 98 pseudo-terminals. Their baud rate has no effect.
bool is_pseudo_terminal(int descriptor) noexcept {
  struct stat status{};
  return ::fstat(descriptor, &status) == 0 && major(status.st_rdev) >= 136 && major(status.st_rdev) <= 143;
}

// Asks a USB adapter to deliver bytes at once and not when its latency timer ends. Many drivers have no such setting.
void ask_low_latency(int descriptor) noexcept {
  serial_struct serial{};
  if (::ioctl(descriptor, TIOCGSERIAL, &serial) == 0) {
    serial.flags |= ASYNC_LOW_LATENCY;
    static_cast<void>(::ioctl(descriptor, TIOCSSERIAL, &serial));
  }
}

Outcome cannot_open_serial(const std::string& path, int error) {
  return refused_port("serial port " + path, error, "is it plugged in?",
                      "on Debian and Ubuntu: sudo adduser $USER dialout, then log in again");
}

}  // namespace

Outcome open_serial(const Url& url, const Patience&, std::unique_ptr<Driver>& driver) {
  std::uint64_t baud_hz = default_baud_hz;
  if (const std::string* text = url.option("baud");
      text != nullptr && (!parse_number(*text, 0xFFFFFFFFu, baud_hz) || baud_hz < baud_hz_min)) {
    return wrong_url(url, "baud=" + *text + " is not a baud rate such as 3000000");
  }
  Descriptor port(::open(url.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!port.open()) {
    return cannot_open_serial(url.path, errno);
  }
  const int descriptor = port.get();
  if (::isatty(descriptor) == 0) {
    return errno == ENOTTY || errno == EINVAL
               ? Outcome{Status::not_found, "serial port " + url.path + ": this is not a serial port"}
               : cannot_open_serial(url.path, errno);
  }
  // Keeps other programs out. TIOCEXCL does not stop root, and flock does not stop programs that do not ask for the
  // lock. Together they stop nearly all.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return cannot_open_serial(url.path, errno);
  }
  static_cast<void>(::ioctl(descriptor, TIOCEXCL));
  if (const int error = detail::make_raw(descriptor, static_cast<std::uint32_t>(baud_hz)); error != 0) {
    ::ioctl(descriptor, TIOCNXCL);
    if (error == EINVAL) {
      return {Status::mismatch, "serial port " + url.path + ": cannot run at " + std::to_string(baud_hz) + " baud"};
    }
    return cannot_open_serial(url.path, error);
  }
  ask_low_latency(descriptor);
  const std::uint64_t byte_time_ns = is_pseudo_terminal(descriptor) ? 0 : bits_per_byte * 1'000'000'000u / baud_hz;
  driver = std::make_unique<SerialDriver>(descriptor, byte_time_ns);
  port.release();  // the driver owns it now
  return {};
}

}  // namespace unitylink
