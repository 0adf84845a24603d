// SPDX-License-Identifier: BSD-3-Clause
// The part of spidev that the SPI driver uses. FAKE_SPI is `key=value` words with spaces between them:
//   device=/dev/spidev0.0   file=FILE (opened in its place)     port=5555   the board: TCP on this machine
//   exchange=1       the board answers each byte with a byte
//   log=FILE         gets a line for each setting, and at the end the number of transfers and bytes
//   gpiochip=/dev/gpiochip0   a GPIO chip (FILE is opened in its place); its line 25 is the board's `waiting`
//   unplug=1000      transfers fail after so many bytes      refuse=22   the error of setting the speed
// FAKE_SPI_FAIL=n: the n-th of the calls that open the port and its line, or set them up, fails with EMFILE. Each call
// reads it again.
#include <arpa/inet.h>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <linux/spi/spidev.h>
#include <map>
#include <netinet/tcp.h>
#include <sstream>
#include <string>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

namespace {

struct Port {
  std::map<std::string, std::string> settings;
  int descriptor = -1, board = -1;
  int chip = -1, line = -1;  // of GPIO; the line is a copy of the board's socket, which is readable when bytes wait
  std::deque<std::uint8_t> coming;  // bytes from the board that were not yet sent to the PC
  std::size_t whole = 0;            // bytes of `coming` in whole messages
  std::uint8_t next = 0;            // the byte on miso when the next transfer begins
  std::size_t transfers = 0, bytes = 0;
  long set_up = 0;  // calls since the port was opened

  Port() {
    const char* const told = std::getenv("FAKE_SPI");
    std::istringstream words(told != nullptr ? told : "");
    for (std::string word; words >> word;) {
      settings[word.substr(0, word.find('='))] = word.substr(word.find('=') + 1);
    }
  }
  long number(const char* key) {
    const auto found = settings.find(key);
    return found == settings.end() ? 0 : std::strtol(found->second.c_str(), nullptr, 0);
  }
  void log(const std::string& text) {
    if (std::FILE* file = std::fopen(settings["log"].c_str(), "a"); file != nullptr) {
      std::fprintf(file, "%s\n", text.c_str());
      std::fclose(file);
    }
  }
};

Port& port() {
  static Port one;
  return one;
}

bool refused() {
  const char* const nth = std::getenv("FAKE_SPI_FAIL");
  if (nth == nullptr || ++port().set_up != std::strtol(nth, nullptr, 10)) {
    return false;
  }
  errno = EMFILE;
  return true;
}

void connect_board() {
  Port& p = port();
  p.board = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(p.number("port")));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(p.board, reinterpret_cast<sockaddr*>(&place), sizeof place) != 0) {
    std::perror("fake_spidev: no board");
    std::abort();
  }
  const int at_once = 1;
  ::setsockopt(p.board, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
}

void gather() {
  Port& p = port();
  std::uint8_t bytes[4096];
  for (ssize_t count = 0; (count = ::recv(p.board, bytes, sizeof bytes, MSG_DONTWAIT)) > 0;) {
    p.coming.insert(p.coming.end(), bytes, bytes + count);
  }
  while (p.whole < p.coming.size()) {  // a frame ends with 0, text with a line feed
    std::size_t end = p.whole;
    while (end < p.coming.size() && p.coming[end] != (p.coming[p.whole] >= 0x80 ? 0 : '\n') && p.coming[end] != 0) {
      ++end;
    }
    if (end == p.coming.size()) {
      return;
    }
    p.whole = end + 1;
  }
}

std::uint8_t offer() {
  Port& p = port();
  gather();
  if (p.whole == 0) {
    return 0;
  }
  const std::uint8_t byte = p.coming.front();
  p.coming.pop_front();
  --p.whole;
  return byte;
}

int exchange(const spi_ioc_transfer& transfer) {
  Port& p = port();
  const auto* const out = reinterpret_cast<const std::uint8_t*>(transfer.tx_buf);
  auto* const in = reinterpret_cast<std::uint8_t*>(transfer.rx_buf);
  ++p.transfers;
  p.bytes += transfer.len;
  const long unplug = p.number("unplug");
  if (transfer.len > 4096 || (unplug > 0 && p.bytes > static_cast<std::size_t>(unplug))) {
    errno = transfer.len > 4096 ? EMSGSIZE : EIO;
    return -1;
  }
  if (::send(p.board, out, transfer.len, MSG_NOSIGNAL) != static_cast<ssize_t>(transfer.len)) {
    errno = EIO;
    return -1;
  }
  if (p.number("exchange") != 0) {
    if (::recv(p.board, in, transfer.len, MSG_WAITALL) != static_cast<ssize_t>(transfer.len)) {
      errno = EIO;
      return -1;
    }
    return static_cast<int>(transfer.len);
  }
  ::usleep(static_cast<useconds_t>(std::uint64_t{8'000'000} * transfer.len / transfer.speed_hz));
  for (std::uint32_t place = 0; place < transfer.len; ++place) {
    in[place] = p.next;
    p.next = offer();
  }
  return static_cast<int>(transfer.len);
}

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int open_instead(const char* name, const char* path, int flags, mode_t mode) {
  Port& p = port();
  const bool gpio = p.settings["gpiochip"] == path;
  const bool ours = p.settings["device"] == path || gpio;
  p.set_up = ours && !gpio ? 0 : p.set_up;
  if (ours && refused()) {
    return -1;
  }
  const int descriptor =
      real<int (*)(const char*, int, ...)>(name)(ours ? p.settings["file"].c_str() : path, flags, mode);
  if (gpio) {
    p.chip = descriptor;
  } else if (ours && descriptor >= 0 && p.descriptor < 0) {
    p.descriptor = descriptor;
    p.bytes = 0;  // when the port is opened again, transfers work again
    connect_board();
  }
  return descriptor;
}

int set_flags(const char* name, int descriptor, int what, void* argument) {
  if (descriptor >= 0 && descriptor == port().line && refused()) {
    return -1;
  }
  return real<int (*)(int, int, ...)>(name)(descriptor, what, argument);
}

int ask_chip(gpio_v2_line_request& request) {
  Port& p = port();
  constexpr std::uint64_t wanted = GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING;
  const bool right = request.num_lines == 1 && request.offsets[0] == 25 && request.config.flags == wanted;
  if (!right || p.line >= 0) {
    errno = right ? EBUSY : EINVAL;
    return -1;
  }
  request.fd = p.line = ::dup(p.board);
  return 0;
}

}  // namespace

extern "C" {

ssize_t read(int descriptor, void* bytes, size_t count) {
  if (descriptor >= 0 && descriptor == port().line) {  // no events of the line: its level is enough
    errno = EAGAIN;
    return -1;
  }
  return real<ssize_t (*)(int, void*, size_t)>("read")(descriptor, bytes, count);
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const auto mode = static_cast<mode_t>(va_arg(arguments, int));
  va_end(arguments);
  return open_instead("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const auto mode = static_cast<mode_t>(va_arg(arguments, int));
  va_end(arguments);
  return open_instead("open64", path, flags, mode);
}
int fcntl(int descriptor, int what, ...) {
  va_list arguments;
  va_start(arguments, what);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  return set_flags("fcntl", descriptor, what, argument);
}
int fcntl64(int descriptor, int what, ...) {
  va_list arguments;
  va_start(arguments, what);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  return set_flags("fcntl64", descriptor, what, argument);
}
int flock(int descriptor, int what) noexcept {
  if (descriptor >= 0 && descriptor == port().descriptor && refused()) {
    return -1;
  }
  return real<int (*)(int, int)>("flock")(descriptor, what);
}
int close(int descriptor) {
  Port& p = port();
  if (descriptor >= 0 && descriptor == p.chip) {
    p.chip = -1;
  }
  if (descriptor >= 0 && descriptor == p.line) {
    p.line = -1;
  }
  if (descriptor >= 0 && descriptor == p.descriptor) {
    p.descriptor = -1;
    p.log("transfers " + std::to_string(p.transfers) + " bytes " + std::to_string(p.bytes));
    ::close(p.board);
  }
  return real<int (*)(int)>("close")(descriptor);
}
int ioctl(int descriptor, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  Port& p = port();
  const bool sets_up = (descriptor == p.chip && request == GPIO_V2_GET_LINE_IOCTL) ||
                       (descriptor == p.descriptor && request != SPI_IOC_MESSAGE(1));
  if (descriptor >= 0 && sets_up && refused()) {
    return -1;
  }
  if (descriptor >= 0 && descriptor == p.chip && request == GPIO_V2_GET_LINE_IOCTL) {
    return ask_chip(*static_cast<gpio_v2_line_request*>(argument));
  }
  if (descriptor >= 0 && descriptor == p.line && request == GPIO_V2_LINE_GET_VALUES_IOCTL) {
    gather();
    static_cast<gpio_v2_line_values*>(argument)->bits = p.whole > 0 || p.next != 0;
    return 0;
  }
  if (descriptor < 0 || descriptor != p.descriptor) {
    return real<int (*)(int, unsigned long, ...)>("ioctl")(descriptor, request, argument);
  }
  switch (request) {
    case SPI_IOC_RD_MODE: *static_cast<std::uint8_t*>(argument) = 3; return 0;
    case SPI_IOC_WR_MODE: p.log("mode " + std::to_string(*static_cast<std::uint8_t*>(argument))); return 0;
    case SPI_IOC_WR_BITS_PER_WORD: p.log("bits " + std::to_string(*static_cast<std::uint8_t*>(argument))); return 0;
    case SPI_IOC_WR_MAX_SPEED_HZ:
      p.log("speed_hz " + std::to_string(*static_cast<std::uint32_t*>(argument)));
      errno = static_cast<int>(p.number("refuse"));
      return errno == 0 ? 0 : -1;
    case SPI_IOC_MESSAGE(1): return exchange(*static_cast<const spi_ioc_transfer*>(argument));
    default: errno = ENOTTY; return -1;
  }
}

}  // extern "C"
