// SPDX-License-Identifier: BSD-3-Clause
// Waiting for an interrupt, over a fake UIO device: a pseudo-terminal whose other end is the kernel.
#include <doctest/doctest.h>
#include <stdlib.h>
#include <termios.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "unitylink/interrupt.hpp"

namespace interrupt_test {
namespace {

constexpr std::uint32_t base = 0x80;

// `interrupt_slave` and UIO: an interrupt is told once for each time that it was unmasked.
class Kernel {
 public:
  Kernel() : end_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    REQUIRE(end_ >= 0);
    REQUIRE(::grantpt(end_) == 0);
    REQUIRE(::unlockpt(end_) == 0);
    name = ::ptsname(end_);
    device_ = ::open(name.c_str(), O_RDWR | O_NOCTTY);
    termios raw{};
    ::tcgetattr(device_, &raw);
    ::cfmakeraw(&raw);
    ::tcsetattr(device_, TCSANOW, &raw);
    thread_ = std::thread([this] { serve(); });
  }
  ~Kernel() {
    const std::uint32_t stop = 2;
    (void)!::write(device_, &stop, sizeof stop);
    thread_.join();
    ::close(device_);
    ::close(end_);
  }
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  void event(std::uint32_t lines) {
    const std::lock_guard guard(mutex_);
    pending |= lines;
    raise();
  }
  // Returns when somebody waits who unmasked the interrupt.
  void wait_until_unmasked() {
    std::unique_lock guard(mutex_);
    unmasked_.wait(guard, [this] { return !masked_; });
  }
  std::uint32_t word(std::uint32_t address) {
    const std::lock_guard guard(mutex_);
    return address == base ? pending : enabled;
  }
  void put(std::uint32_t address, std::uint32_t word) {
    const std::lock_guard guard(mutex_);
    if (address == base)
      pending &= ~word;
    else
      enabled = word;
  }

  std::uint32_t pending = 0, enabled = 0, told = 0;
  std::string name;

 private:
  void serve() {
    std::uint32_t said = 0;
    while (::read(end_, &said, sizeof said) == sizeof said && said == 1) {
      const std::lock_guard guard(mutex_);
      masked_ = false;
      unmasked_.notify_all();
      raise();
    }
  }
  void raise() {
    if (masked_ || (pending & enabled) == 0) return;
    masked_ = true;
    ++told;
    (void)!::write(end_, &told, sizeof told);
  }

  int end_, device_ = -1;
  bool masked_ = true;
  std::mutex mutex_;
  std::condition_variable unmasked_;
  std::thread thread_;
};

struct Bus {
  Kernel* kernel;
  ul_status broken = UL_OK;

  ul_status read(std::uint32_t address, std::uint32_t& word) {
    if (broken == UL_OK) word = kernel->word(address);
    return broken;
  }
  ul_status write(std::uint32_t address, std::uint32_t word) {
    kernel->put(address, word);
    return broken;
  }
  std::string text() { return "the bus is broken"; }
};

using Events = unitylink::BasicInterrupt<Bus>;

}  // namespace

TEST_CASE("what is pending is given at once and cleared") {
  Kernel kernel;
  Events events({&kernel});
  REQUIRE(events.open(base, kernel.name) == UL_OK);
  CHECK(events.enable(0b101) == UL_OK);
  kernel.event(0b111);
  std::uint32_t lines = 0;
  CHECK(events.wait(lines, 0) == UL_OK);
  CHECK(lines == 0b101);
  CHECK(kernel.pending == 0b010);  // not enabled: remembered
  CHECK(kernel.told == 0);
  CHECK(events.enable(0b010) == UL_OK);
  CHECK(events.wait(lines, 0) == UL_OK);
  CHECK(lines == 0b010);
}

TEST_CASE("an interrupt ends the wait, as often as it comes") {
  Kernel kernel;
  Events events({&kernel});
  REQUIRE(events.open(base, kernel.name) == UL_OK);
  CHECK(events.enable(0b11) == UL_OK);
  for (std::uint32_t round = 1; round <= 20; ++round) {
    std::uint32_t lines = 0;
    ul_status status = UL_ARGUMENT;
    std::thread waiter([&] { status = events.wait(lines); });
    kernel.wait_until_unmasked();  // it waits now
    kernel.event(1 + round % 2);
    waiter.join();
    CHECK(status == UL_OK);
    CHECK(lines == 1 + round % 2);
    CHECK(kernel.pending == 0);
    CHECK(kernel.told == round);
  }
}

TEST_CASE("no enabled event is a timeout, and one that was remembered comes later") {
  Kernel kernel;
  Events events({&kernel});
  REQUIRE(events.open(base, kernel.name) == UL_OK);
  CHECK(events.enable(0b01) == UL_OK);
  kernel.event(0b10);
  std::uint32_t lines = 7;
  CHECK(events.wait(lines, 1'000'000) == UL_TIMEOUT);
  CHECK(lines == 0);
  CHECK(events.text() == kernel.name + ": no enabled event in time");
  CHECK(events.enable(0b11) == UL_OK);
  CHECK(events.wait(lines, 0) == UL_OK);
  CHECK(lines == 0b10);
}

TEST_CASE("what is wrong with the device is told") {
  Kernel kernel;
  Events events({&kernel});
  std::uint32_t lines = 0;
  CHECK(events.wait(lines, 0) == UL_CLOSED);
  CHECK(events.open(base, "/dev/no_such_uio") == UL_NOT_FOUND);
  CHECK(events.text().find("/dev/no_such_uio: No such file or directory; see /sys/class/uio") == 0);
  Events broken({&kernel, UL_BUS_ERROR});
  REQUIRE(broken.open(base, kernel.name) == UL_OK);
  CHECK(broken.wait(lines, 0) == UL_BUS_ERROR);
  CHECK(broken.text() == "the bus is broken");
  broken.close();
  CHECK(broken.wait(lines, 0) == UL_CLOSED);
}

}  // namespace interrupt_test
