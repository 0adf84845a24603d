// SPDX-License-Identifier: BSD-3-Clause
// A separate file, because the kernel's termios2 and <termios.h> cannot be included together. Only termios2 takes any
// baud rate.
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <cerrno>
#include <sys/ioctl.h>

#include "layer0_driver/serial_driver.hpp"

namespace unitylink::detail {

int make_raw(int descriptor, std::uint32_t baud_hz) noexcept {
  struct termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) {
    return errno;
  }
  settings.c_iflag = 0;
  settings.c_oflag = 0;
  settings.c_lflag = 0;
  // CLOCAL ignores carrier detect. Without HUPCL, closing does not lower DTR. (This would reset many boards.)
  settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = baud_hz;
  settings.c_ospeed = baud_hz;
  settings.c_cc[VMIN] = 1;  // with 0, a read without bytes would look like the end of the stream
  settings.c_cc[VTIME] = 0;
  return ::ioctl(descriptor, TCSETS2, &settings) == 0 ? 0 : errno;
}

}  // namespace unitylink::detail
