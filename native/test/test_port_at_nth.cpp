// SPDX-License-Identifier: BSD-3-Clause
// For n = 1, 2, 3 …: the n-th allocation, or the n-th opening, of a link to a port of a certain kind fails. Each call
// must return a status, and nothing may stay open. test_fail_at_nth.cpp has the promises of the protocols.
#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <dlfcn.h>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>

#include "device/board.hpp"
#include "failing.hpp"
#include "layer0_driver/driver.hpp"
#include "layer0_driver/polling.hpp"
#include "layer0_driver/pumped_driver.hpp"
#include "open_files.hpp"
#include "unitylink.h"

using namespace unitylink;
using failing::Exempt;
using failing::How;
using failing::What;
using test::mappings_of;
using test::open_files;

namespace {

// A board whose own calls never fail.
class ExemptBoard {
 public:
  explicit ExemptBoard(const char* endpoint)
      : board_(device::DeviceConfiguration{}, device::make_endpoint(endpoint, "127.0.0.1")) {
    board_.set_plant({0.001, [this](double) {
                        thread_local const Exempt exempt;  // for the board's thread
                        ready_ = true;
                        return true;
                      }});
    board_.start();
    while (!ready_) {
      std::this_thread::yield();
    }
  }
  std::string url() { return board_.url(); }

 private:
  std::atomic<bool> ready_ = false;
  device::Board board_;
};

// Opens a link, writes, reads and subscribes, with a failure armed. Returns false when it did not happen any more: then
// all calls must succeed.
bool one_life(const std::string& url, What what, How how, std::uint32_t nth) {
  bool happened = false;
  failing::arm(what, how, nth);
  std::thread([&] {
    const Exempt this_thread;
    const std::uint32_t addresses[] = {1, 2}, given[] = {nth, nth + 1};
    std::uint32_t got[2] = {}, name = 0;
    const ul_subscription_options often{sizeof(ul_subscription_options), 1, 0, 1, 4};
    ul_link* link = nullptr;
    --Exempt::depth;
    const ul_status opened = ul_open(url.c_str(), &link);
    const ul_status wrote = link == nullptr ? opened : ul_write_many(link, addresses, given, 2, nullptr);
    const ul_status read = link == nullptr ? opened : ul_read_many(link, addresses, 2, got, 0, nullptr);
    const ul_status listens = link == nullptr ? opened : ul_subscribe(link, addresses, 2, &often, &name);
    ++Exempt::depth;
    happened = failing::disarm();
    const bool all = opened == UL_OK && wrote == UL_OK && read == UL_OK && listens == UL_OK;
    INFO(url << ": " << nth << ": " << ul_last_error_text());
    CHECK((happened || all));
    CHECK((all || *ul_last_error_text() != 0));
    CHECK((opened == UL_OK) == (link != nullptr));
    CHECK((wrote != UL_OK || read != UL_OK || (got[0] == nth && got[1] == nth + 1)));
    ul_free(link);
  }).join();
  return happened;
}

std::uint32_t lives(const std::string& url, What what, How how, std::uint32_t stride = 1) {
  std::uint32_t nth = 1;
  while (one_life(url, what, how, nth)) {
    nth += stride;
  }
  return nth;
}

}  // namespace

TEST_CASE("a driver's thread that throws ends its link with the reason, and not the program") {
  class Thrower final : public PumpedDriver {
   public:
    explicit Thrower(SocketPair pair) : PumpedDriver(std::move(pair)) {}
    ~Thrower() override { Thrower::close(); }
    using PumpedDriver::start;

   private:
    void let_go(bool) noexcept override {}
  };
  const auto reason_of = [](auto error) {
    SocketPair pair;
    REQUIRE(make_socket_pair(pair).ok());
    Thrower driver(std::move(pair));
    driver.start([error] { throw error; });
    std::uint8_t byte = 0;
    pollfd waiting{driver.descriptor(), POLLIN, 0};
    REQUIRE(poll_for(std::span(&waiting, 1), for_ever) == 1);
    CHECK(driver.receive(std::span(&byte, 1)).status == Status::closed);
    return driver.reason();
  };
  CHECK(reason_of(std::bad_alloc()) == "out of memory");
  CHECK(reason_of(std::runtime_error("the bus is on fire")) == "the bus is on fire");
}

TEST_CASE("registers in memory: the n-th allocation, opening or mapping fails") {
  const Exempt exempt;
  std::string path = "/tmp/unitylink-nth-XXXXXX";
  const int file = ::mkstemp(path.data());
  REQUIRE(file >= 0);
  REQUIRE(::ftruncate(file, 1024) == 0);
  const std::size_t files = open_files();
  CHECK(lives("mmap:" + path, What::allocation, How::once) > 20);
  CHECK(lives("mmap:" + path, What::allocation, How::from_then_on) > 20);
  CHECK(lives("mmap:" + path, What::opening, How::none_left) > 3);
  CHECK(lives("mmap:" + path, What::opening, How::broken) > 3);
  CHECK(open_files() == files);
  CHECK(mappings_of(path) == 0);
  ::close(file);
  ::unlink(path.c_str());
}

TEST_CASE("an FTDI chip: the n-th allocation, thread, or call of the USB library fails") {
  const Exempt exempt;
  ExemptBoard board("tcp");
  const std::string place = board.url();
  ::setenv("UNITYLINK_LIBUSB", UNITYLINK_FAKE_USB, 1);
  ::setenv("UNITYLINK_ROOT", "/nowhere", 1);  // no serial port of the kernel's to use instead
  ::setenv("FAKE_USB", ("serial=FT1 port=" + place.substr(place.rfind(':') + 1)).c_str(), 1);
  void* const library = ::dlopen(UNITYLINK_FAKE_USB, RTLD_NOW | RTLD_LOCAL);
  REQUIRE(library != nullptr);
  const auto held = reinterpret_cast<int (*)()>(::dlsym(library, "fake_usb_held"));
  const std::string url = "ftdi:FT1?mode=fifo&protocol=framed&timeout=0.05&attempts=2&spin=0";
  const std::size_t files = open_files();
  CHECK(lives(url, What::allocation, How::once) > 50);
  CHECK(held() == 0);
  CHECK(lives(url, What::allocation, How::from_then_on, 7) > 50);
  CHECK(held() == 0);
  CHECK(lives(url, What::opening, How::none_left) > 3);
  CHECK(held() == 0);
  int nth = 1;
  for (bool happened = true; happened; ++nth) {
    CAPTURE(nth);
    ::setenv("FAKE_USB_FAIL", std::to_string(nth).c_str(), 1);
    ul_link* link = nullptr;
    const ul_status opened = ul_open(url.c_str(), &link);
    std::uint32_t word = 0;
    const ul_status read = link == nullptr ? opened : ul_read(link, 1, &word, nullptr);
    happened = opened != UL_OK || read != UL_OK;
    CHECK((!happened || *ul_last_error_text() != 0));
    ul_free(link);
    CHECK(held() == 0);
  }
  CHECK(nth > 15);  // the calls of opening alone
  ::unsetenv("FAKE_USB_FAIL");
  CHECK(open_files() <= files + 1);  // + 1: the board may still serve the last link
  ::dlclose(library);
}

TEST_CASE("an RS-485 pair: the n-th allocation or thread fails, and its driver opens or leaves nothing behind") {
  const Exempt exempt;
  ExemptBoard board("pty");
  Url url;
  REQUIRE(parse_url("rs485" + board.url().substr(board.url().find(':')) + "?node=3", url).ok());
  const std::size_t files = open_files();
  for (const What what : {What::allocation, What::opening}) {
    std::uint32_t nth = 1;
    for (bool happened = true; happened; ++nth) {
      CAPTURE(nth);
      failing::arm(what, How::once, nth);
      std::thread([&] {
        std::unique_ptr<Driver> driver;
        bool opened = false;
        try {
          opened = open_driver(url, 0, driver).ok();
        } catch (const std::exception&) {  // no memory, or no thread
        }
        const Exempt now;
        happened = failing::disarm();
        CHECK((happened || opened));
        CHECK((driver != nullptr) == opened);
      }).join();
      CHECK(open_files() == files);
    }
    CHECK(nth > 5);
  }

  std::unique_ptr<Driver> driver;
  REQUIRE(open_driver(url, 0, driver).ok());
  failing::arm(What::allocation, How::once, 1);  // in the master's thread, because this one is exempt
  pollfd waiting{driver->descriptor(), POLLIN, 0};
  REQUIRE(poll_for(std::span(&waiting, 1), for_ever) == 1);
  CHECK(failing::disarm());
  std::uint8_t byte = 0;
  CHECK(driver->receive(std::span(&byte, 1)).status == Status::closed);
  CHECK(driver->reason() == "out of memory");
  driver.reset();
  CHECK(open_files() == files);
}
