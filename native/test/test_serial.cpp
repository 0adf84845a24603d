// SPDX-License-Identifier: BSD-3-Clause
// The serial driver on a pseudo-terminal. A separate file, because the kernel's termios2 and <termios.h> cannot be
// included together.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

#include "layer0_driver/driver.hpp"

using namespace unitylink;

TEST_CASE("a serial port is raw, at its baud rate, exclusive, and keeps its modem lines at close") {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(::grantpt(master) == 0);
  REQUIRE(::unlockpt(master) == 0);
  const std::string name = ::ptsname(master);
  const int slave = ::open(name.c_str(), O_RDWR | O_NOCTTY);
  Url url;
  REQUIRE(parse_url("serial:" + name + "?baud=3000000", url).ok());
  std::unique_ptr<Driver> driver, second;
  REQUIRE(open_driver(url, 0, driver).ok());
  struct termios2 settings{};
  REQUIRE(::ioctl(slave, TCGETS2, &settings) == 0);
  CHECK(settings.c_ospeed == 3000000);
  CHECK(settings.c_ispeed == 3000000);
  CHECK((settings.c_cflag & HUPCL) == 0);
  CHECK((settings.c_cflag & CLOCAL) != 0);
  CHECK((settings.c_lflag & (ICANON | ECHO | ISIG)) == 0);
  CHECK(settings.c_iflag == 0);
  CHECK(settings.c_oflag == 0);
  CHECK(driver->byte_time_ns() == 0);  // the baud rate of a pseudo-terminal has no effect
  CHECK(open_driver(url, 0, second).status == Status::busy);
  const std::array<std::uint8_t, 4> odd{0x03, 0x11, 0x0A, 0xFF};  // bytes that a terminal changes unless it is raw
  std::array<std::uint8_t, 8> got{};
  CHECK(driver->send(odd).count == 4);
  CHECK(::read(master, got.data(), got.size()) == 4);
  CHECK(std::equal(odd.begin(), odd.end(), got.begin()));
  CHECK(driver->receive(got).count == 0);
  CHECK(driver->receive(got).status == Status::ok);
  ::close(slave);
  ::close(master);
  CHECK(driver->receive(got).status == Status::closed);
  driver->close();
}
