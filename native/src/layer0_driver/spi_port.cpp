// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/spi_port.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/spi/spidev.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/descriptor_driver.hpp"

namespace unitylink {
namespace {

Outcome cannot_open_spi(const std::string& path, int error) {
  if (error == ENOTTY) {
    return {Status::not_found, "SPI port " + path + ": this is not an SPI port of the kernel (spidev)"};
  }
  return refused_port("SPI port " + path, error,
                      "is SPI switched on (on a Raspberry Pi: dtparam=spi=on in config.txt)?",
                      "on Debian and Raspberry Pi OS: sudo adduser $USER spi, then log in again");
}

}  // namespace

Outcome SpiPort::open(const std::string& path, std::uint32_t speed_hz, std::unique_ptr<SpiPort>& port) {
  Descriptor opened(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!opened.open()) {
    return cannot_open_spi(path, errno);
  }
  std::unique_ptr<SpiPort> made(new SpiPort(opened.get(), speed_hz));
  const int descriptor = opened.release();  // the port owns it now
  std::uint8_t mode = 0;
  if (::ioctl(descriptor, SPI_IOC_RD_MODE, &mode) != 0) {
    return cannot_open_spi(path, errno);
  }
  // spidev allows several programs at once, and their messages would mix
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return cannot_open_spi(path, errno);
  }
  mode = SPI_MODE_0;
  std::uint8_t bits = 8;
  if (::ioctl(descriptor, SPI_IOC_WR_MODE, &mode) != 0 || ::ioctl(descriptor, SPI_IOC_WR_BITS_PER_WORD, &bits) != 0) {
    return {Status::mismatch, "SPI port " + path + ": it has no mode 0 with 8 bits a byte: " + std::strerror(errno)};
  }
  if (::ioctl(descriptor, SPI_IOC_WR_MAX_SPEED_HZ, &speed_hz) != 0) {
    const std::string why = std::strerror(errno);
    return {Status::mismatch, "SPI port " + path + ": cannot run at " + std::to_string(speed_hz) + " Hz: " + why +
                                  "; give another speed_hz="};
  }
  port = std::move(made);
  return {};
}

SpiPort::~SpiPort() { ::close(descriptor_); }

int SpiPort::exchange(std::span<const std::uint8_t> out, std::span<std::uint8_t> in) const noexcept {
  spi_ioc_transfer transfer{};
  transfer.tx_buf = reinterpret_cast<std::uintptr_t>(out.data());
  transfer.rx_buf = reinterpret_cast<std::uintptr_t>(in.data());
  transfer.len = static_cast<std::uint32_t>(std::min(out.size(), in.size()));
  transfer.speed_hz = speed_hz_;
  transfer.bits_per_word = 8;
  return ::ioctl(descriptor_, SPI_IOC_MESSAGE(1), &transfer) >= 0 ? 0 : errno;
}

}  // namespace unitylink
