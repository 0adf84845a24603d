// SPDX-License-Identifier: BSD-3-Clause
//
// Events of the gateware as an interrupt of the processor, through Linux's UIO: docs/mapped-memory.md.
//
//   unitylink::Interrupt events({link});
//   if (events.open(0x80, "/dev/uio0") != UL_OK || events.enable(0b101) != UL_OK) std::puts(events.text().c_str());
//   std::uint32_t lines = 0;
//   while (events.wait(lines) == UL_OK) std::printf("%x\n", lines);
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#include <unitylink.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

namespace unitylink {

// Reads and writes words through a link.
struct LinkBus {
  ul_link* link;

  ul_status read(std::uint32_t address, std::uint32_t& word) { return ul_read(link, address, &word, nullptr); }
  ul_status write(std::uint32_t address, std::uint32_t word) { return ul_write(link, address, word, nullptr); }
  std::string text() { return ul_last_error_text(); }
};

// Waits for the events of an `interrupt_slave`: +0 pending (a write clears), +1 enable. No event is lost: one that
// comes while another is handled stays pending, and the next wait returns at once. Only one thread may use it at a
// time.
template <class Bus>
class BasicInterrupt {
 public:
  static constexpr std::uint64_t for_ever = UINT64_MAX;

  explicit BasicInterrupt(Bus bus) : bus_(std::move(bus)) {}
  BasicInterrupt(const BasicInterrupt&) = delete;
  BasicInterrupt& operator=(const BasicInterrupt&) = delete;
  ~BasicInterrupt() { close(); }

  // Opens the UIO `device` whose interrupt the gateware raises. It may be the one that the link maps. `base` is the
  // address of the slave. UL_NOT_FOUND, UL_PERMISSION or UL_BUSY: see text().
  ul_status open(std::uint32_t base, const std::string& device) {
    close();
    base_ = base;
    device_ = device;
    file_ = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (file_ >= 0) return UL_OK;
    const int why = errno;
    const ul_status status = why == EACCES || why == EPERM ? UL_PERMISSION : why == EBUSY ? UL_BUSY : UL_NOT_FOUND;
    return failed(status, std::string(std::strerror(why)) +
                              "; see /sys/class/uio for the devices there are, and `ls -l` for who may use them");
  }

  // Lets the events of these lines interrupt, one bit for each. All others are only remembered.
  ul_status enable(std::uint32_t lines) { return told(bus_.write(base_ + 1, lines)); }

  // Waits for enabled events, clears them, and gives them in `lines`, one bit for each. UL_TIMEOUT if none comes in
  // time. UL_CLOSED without an open device. Other errors are those of the link.
  ul_status wait(std::uint32_t& lines, std::uint64_t timeout_ns = for_ever) {
    lines = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
      if (file_ < 0) return failed(UL_CLOSED, "the interrupt is not open");
      if (const ul_status status = take(lines); status != UL_OK || lines != 0) return status;
      if (const ul_status status = unmask(); status != UL_OK) return status;
      const auto gone = std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - begin);
      if (const ul_status status = sleep(timeout_ns, static_cast<std::uint64_t>(gone.count())); status != UL_OK)
        return status;
    }
  }

  // What the last error was. Empty without one.
  const std::string& text() const noexcept { return text_; }

  void close() {
    if (file_ >= 0) ::close(file_);
    file_ = -1;
  }

 private:
  ul_status take(std::uint32_t& lines) {
    std::uint32_t pending = 0, enabled = 0;
    ul_status status = bus_.read(base_, pending);
    if (status == UL_OK) status = bus_.read(base_ + 1, enabled);
    if (status == UL_OK && (pending & enabled) != 0) status = bus_.write(base_, pending & enabled);
    if (status == UL_OK) lines = pending & enabled;
    return told(status);
  }

  // Allows one more interrupt, because the kernel masks it each time.
  ul_status unmask() {
    const std::uint32_t one = 1;
    return ::write(file_, &one, sizeof one) == sizeof one ? UL_OK : gone("it cannot be unmasked");
  }

  // Sleeps until the kernel counts an interrupt, and reads the count, so that the next time really waits.
  ul_status sleep(std::uint64_t timeout_ns, std::uint64_t gone_ns) {
    const std::uint64_t left_ns = timeout_ns > gone_ns ? timeout_ns - gone_ns : 0;
    const std::uint64_t longest_ns = 3'600'000'000'000;  // then poll() is called again, which counts with an int
    const bool last = left_ns <= longest_ns;
    pollfd waiting{file_, POLLIN, 0};
    const int found = ::poll(&waiting, 1, static_cast<int>(((last ? left_ns : longest_ns) + 999'999) / 1'000'000));
    if (found < 0 && errno != EINTR) return gone("it cannot be waited for");
    if (found <= 0) {
      if (found < 0 || !last || timeout_ns == for_ever) return UL_OK;
      return failed(UL_TIMEOUT, "no enabled event in time");
    }
    std::uint32_t count = 0;
    const ssize_t came = ::read(file_, &count, sizeof count);
    if (came == sizeof count || (came < 0 && errno == EAGAIN)) return UL_OK;  // another reader may be faster
    return gone("the device is gone");
  }

  ul_status gone(const char* what) { return failed(UL_CLOSED, what); }
  ul_status failed(ul_status status, const std::string& what) {
    text_ = device_ + ": " + what;
    return status;
  }
  ul_status told(ul_status status) {
    text_ = status == UL_OK ? "" : bus_.text();
    return status;
  }

  Bus bus_;
  std::uint32_t base_ = 0;
  int file_ = -1;
  std::string device_, text_;
};

using Interrupt = BasicInterrupt<LinkBus>;

}  // namespace unitylink
