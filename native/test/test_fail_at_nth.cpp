// SPDX-License-Identifier: BSD-3-Clause
// For n = 1, 2, 3 …: the n-th allocation, transfer, opening or clock reading of a session fails. The promises must
// still hold. The program does not end. Each call returns a status. Nothing is executed twice, and no result is wrong.
// Afterwards the link works, or is closed with a reason.
#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#include <string_view>
#include <thread>
#include <unistd.h>
#include <vector>

#include "device/board.hpp"
#include "device/device.hpp"
#include "failing.hpp"
#include "open_files.hpp"
#include "unitylink.h"

using namespace unitylink;
using failing::Exempt;
using failing::How;
using failing::What;
using test::open_files;

namespace {

constexpr std::uint32_t base = 0x20;
constexpr std::size_t word_count = 6;

enum class Told { done, not_done, perhaps, first };  // first: perhaps only the first of several messages

struct Wish {
  std::uint32_t value;
  Told told;
  std::string what;
};

// The board, whose calls never fail. It counts what it executes.
class Rig {
 public:
  explicit Rig(const char* endpoint) {
    auto made = std::make_unique<device::Device>(configuration());
    made->bus().observe([this](std::uint32_t, std::uint32_t value) {
      const std::scoped_lock lock(mutex_);
      executed_[value] += 1;
    });
    board_ = std::make_unique<device::Board>(std::move(made), device::make_endpoint(endpoint, "127.0.0.1"));
    board_->set_plant({0.001, [this](double) {
                         thread_local const Exempt exempt;  // for the board's thread
                         ready_ = true;
                         return true;
                       }});
    board_->start();
    while (!ready_) {
      std::this_thread::yield();
    }
  }

  static device::DeviceConfiguration configuration() {
    device::DeviceConfiguration made;
    made.exchanges = 4;
    return made;
  }

  std::string url() { return board_->url(); }
  void hang_up() { board_->hang_up(); }
  std::uint32_t executed(std::uint32_t value) {
    const std::scoped_lock lock(mutex_);
    const auto found = executed_.find(value);
    return found == executed_.end() ? 0 : found->second;
  }

  // Compares the reported results with what the board has executed.
  void judge() {
    board_->stop();  // from here on nothing more can arrive
    for (const Wish& wish : wishes) {
      const std::uint32_t times = executed(wish.value);
      const bool right = wish.told == Told::done ? times == 1 : wish.told == Told::not_done ? times == 0 : times <= 1;
      INFO(wish.what << ": " << wish.value << " was executed " << times << " times");
      CHECK(right);
    }
  }

  std::vector<Wish> wishes;
  std::uint32_t next = 0;

 private:
  std::mutex mutex_;
  std::map<std::uint32_t, std::uint32_t> executed_;
  std::atomic<bool> ready_ = false;
  std::unique_ptr<device::Board> board_;
};

Told told_of(ul_status status) {
  return status == UL_OK ? Told::done : status == UL_UNKNOWN ? Told::perhaps : Told::not_done;
}

// One link from opening to closing. Only its calls may fail, not the code of the test.
class Session {
 public:
  Session(Rig& rig, std::string what, bool framed) : rig_(rig), what_(std::move(what)), framed_(framed) {
    std::iota(std::begin(addresses_), std::end(addresses_), base);
  }

  // Returns how many of its calls failed; 1 if the link could not be opened. `cut`: the line breaks in the middle.
  std::uint32_t run(const std::string& url, bool cut) {
    if (call([&] { return ul_open(url.c_str(), &link_); }) != UL_OK) {
      CHECK(link_ == nullptr);
      return refused_;
    }
    opened_ = true;
    work();
    if (cut) {
      rig_.hang_up();
    }
    work();  // once more, with or without a line
    usable_or_closed();
    call([&] { return ul_close(link_); });
    ul_free(link_);
    return refused_;
  }

  [[nodiscard]] bool opened() const { return opened_; }

 private:
  // Makes a call of the library. Only during this call can something fail in this thread.
  template <class Call>
  ul_status call(const Call& one) {
    --Exempt::depth;
    const ul_status status = one();
    ++Exempt::depth;
    refused_ += status != UL_OK ? 1 : 0;
    const bool known = (status >= UL_OK && status <= UL_CLOSED) || (status >= UL_BUSY && status <= UL_LEASE_HELD);
    if (!known || (status != UL_OK && *ul_last_error_text() == 0)) {
      FAIL_CHECK(what_ << ": status " << status << ", '" << ul_last_error_text() << "'");
    }
    return status;
  }

  std::vector<std::uint32_t> values(std::size_t count) {
    std::vector<std::uint32_t> made(count);
    std::iota(made.begin(), made.end(), rig_.next + 1);
    rig_.next += static_cast<std::uint32_t>(count);
    return made;
  }
  void told(const std::vector<std::uint32_t>& values, Told how, const char* name) {
    for (const std::uint32_t value : values) {
      rig_.wishes.push_back({value, how, what_ + ", " + name});
    }
  }
  Told of_several(ul_status status) const { return status != UL_OK && !framed_ ? Told::first : told_of(status); }

  void work() {
    std::uint32_t got[2 * word_count];
    const auto one = values(1);
    told(one, told_of(call([&] { return ul_write(link_, base, one[0], nullptr); })), "write");
    call([&] { return ul_read(link_, base, got, nullptr); });
    call([&] { return ul_read_many(link_, addresses_, word_count, got, 0, nullptr); });
    call([&] { return ul_read_each(link_, addresses_, word_count, got, nullptr); });
    const auto many = values(word_count);
    told(many, of_several(call([&] { return ul_write_many(link_, addresses_, many.data(), word_count, nullptr); })),
         "writes");
    const auto both = values(word_count);
    told(both, of_several(call([&] {
           return ul_transfer(link_, addresses_, both.data(), word_count, addresses_, got, word_count, 0, nullptr);
         })),
         "transfer");
    const auto listed = values(1);
    const ul_list_word list[] = {{UL_WRITE, base, listed[0], 0}, {UL_READ, base, 0, 0}};
    told(listed, of_several(call([&] { return ul_list(link_, list, 2, got, 1, 0, nullptr); })), "list");
    posts();
    exchange();
    subscription();
  }

  // The next sync reports the results of the posts.
  void posts() {
    const auto posted = values(word_count);
    const ul_status taken = call([&] { return ul_post(link_, addresses_, posted.data(), word_count, nullptr); });
    const ul_status status = call([&] { return ul_sync(link_, nullptr); });
    told(posted, taken == UL_OK && status == UL_OK ? Told::done : Told::first, "posts");
  }

  void exchange() {
    const ul_exchange_word outputs[] = {{base, 4}, {base + 1, 4}};
    std::uint32_t group = 0, got[2];
    if (call([&] { return ul_define_exchange(link_, outputs, 2, outputs, 2, &group); }) != UL_OK) {
      return;
    }
    const auto given = values(2);
    told(given, of_several(call([&] { return ul_exchange(link_, group, given.data(), 2, got, 2, nullptr); })),
         "exchange");
    call([&] { return ul_release_exchange(link_, group); });
  }

  void subscription() {
    const ul_subscription_options often{sizeof(ul_subscription_options), 1, 0, 1, 64};
    std::uint32_t name = 0, got[64 * 2];
    double times[64];
    std::size_t taken = 0;
    if (call([&] { return ul_subscribe(link_, addresses_, 2, &often, &name); }) != UL_OK) {
      return;
    }
    call([&] { return ul_wait_publish(link_, name, 2'000'000'000); });
    call([&] { return ul_drain(link_, name, times, got, 64, &taken); });
    call([&] { return ul_unsubscribe(link_, name); });
  }

  // Nothing fails in this thread from here on.
  void usable_or_closed() {
    std::uint32_t got = 0;
    ul_wait_up(link_, 5'000'000'000);
    ul_status status = UL_TIMEOUT;
    for (int again = 0; again < 50 && (status == UL_TIMEOUT || status == UL_DOWN); ++again) {
      status = ul_read(link_, base, &got, nullptr);
    }
    INFO(what_ << ": " << ul_last_error_text());
    CHECK((status == UL_OK || status == UL_CLOSED));
  }

  Rig& rig_;
  std::string what_;
  bool framed_;
  std::uint32_t refused_ = 0;
  bool opened_ = false;
  ul_link* link_ = nullptr;
  std::uint32_t addresses_[word_count];
};

struct Place {
  const char* endpoint = "tcp";
  bool cut = false;  // the line breaks in the middle
};

// Runs sessions for n = 1, 1 + stride, … until a session ends before its n-th call. No call of that last one may fail.
// Each session runs in a new thread, so that each contains what a thread does only once.
std::uint32_t sessions(const char* options, What what, How how, const char* name, std::uint32_t stride,
                       Place place = {}) {
  const Exempt exempt;
  Rig rig(place.endpoint);
  const bool cut = place.cut;
  const bool framed = std::string_view(options).find("framed") != std::string_view::npos;
  // the library must try again, and no call may fail
  const bool harmless =
      what == What::transfer && (how == How::interrupted || how == How::again || how == How::one_byte);
  // spin=0, because otherwise the number of calls would depend on the speed of the machine
  const std::string url =
      rig.url() + (harmless ? "?spin=0&timeout=2&attempts=3&" : "?spin=0&timeout=0.05&attempts=3&") + options;
  const std::size_t files = open_files();
  std::uint32_t nth = 1;
  for (int again = 0;;) {
    failing::arm(what, how, nth);
    Session session(rig, std::string(place.endpoint) + ", " + options + ": " + name + " " + std::to_string(nth),
                    framed);
    std::uint32_t refused = 0;
    std::string failure;
    std::thread([&] {
      const Exempt this_thread;
      refused = session.run(url, cut);
      failure = ul_last_error_text();
    }).join();
    if (failing::disarm()) {
      INFO(place.endpoint << ", " << options << ": " << name << " " << nth << ": " << failure);
      CHECK((!harmless || !session.opened() || refused == 0));
      nth += stride;
      again = 0;
    } else if (refused == 0 || (cut && session.opened()) || ++again == 1000) {
      // else the board may still serve the link of the session before
      CHECK((refused == 0 || cut));
      break;
    }
  }
  CHECK(open_files() <= files + 1);  // + 1: the board may still serve the last link
  rig.judge();
  return nth;
}

// `make fuzz` sets UNITYLINK_FAIL_EACH=1. Then every n is tried, which takes minutes.
std::uint32_t stride_of(std::uint32_t usual) { return std::getenv("UNITYLINK_FAIL_EACH") != nullptr ? 1 : usual; }

constexpr std::uint32_t least = 15;  // a session has at least so many

constexpr const char* links[] = {"protocol=framed", "protocol=classic", "protocol=framed&reconnect=1",
                                 "protocol=classic&reconnect=1"};

}  // namespace

TEST_CASE("the n-th allocation fails") {
  for (const char* options : links) {
    CHECK(sessions(options, What::allocation, How::once, "allocation", stride_of(1)) > least);
    CHECK(sessions(options, What::allocation, How::from_then_on, "a hundred allocations from", stride_of(9)) > least);
    CHECK(sessions(options, What::allocation, How::once, "a broken line and allocation", stride_of(1), {.cut = true}) >
          least);
  }
}

TEST_CASE("the n-th opening or setting up fails") {
  constexpr std::pair<How, const char*> manners[] = {
      {How::broken, "EIO at opening"}, {How::none_left, "EMFILE at opening"}, {How::interrupted, "EINTR at opening"}};
  constexpr std::uint32_t openings_least = 5;
  for (const char* options : links) {
    for (const auto& [how, name] : manners) {
      for (const char* endpoint : {"tcp", "udp", "pty"}) {
        CHECK(sessions(options, What::opening, how, name, 1, {.endpoint = endpoint}) > openings_least);
      }
      CHECK(sessions(options, What::opening, how, name, 1, {.cut = true}) > openings_least);
    }
  }
}

TEST_CASE("a port that the system refuses says why, and leaves nothing open") {
  constexpr struct {
    const char* endpoint;
    const char* scheme;          // "": the scheme of the board's URL
    std::uint32_t borne;         // openings that may fail without harm to the link
  } places[] = {{"tcp", "", 1},  // TCP_NODELAY
                {"udp", "", 0},
                // TIOCEXCL, the latency of an adapter, the kind of terminal
                {"pty", "serial", 3},
                // the same, the direction of the transceiver, and TIOCNXCL, because this link closes within the call
                {"pty", "rs485", 5}};
  const Exempt exempt;
  for (const auto& place : places) {
    INFO(place.endpoint << ", " << place.scheme);
    Rig rig(place.endpoint);
    std::string url = rig.url() + "?timeout=0.5&protocol=framed";
    const bool other = std::string_view(place.scheme) == "rs485";  // there is no such node here, so opening times out
    if (other) {
      url = "rs485" + url.substr(url.find(':')) + "&node=3&attempts=1";
    }
    const std::size_t files = open_files();
    std::uint32_t borne = 0;
    for (std::uint32_t nth = 1;; ++nth) {
      failing::arm(What::opening, How::none_left, nth);
      ul_link* link = nullptr;
      --Exempt::depth;
      const ul_status status = ul_open(url.c_str(), &link);
      ++Exempt::depth;
      const bool happened = failing::disarm();
      const std::string why = ul_last_error_text();
      ul_free(link);
      if (!happened) {
        break;
      }
      CAPTURE(nth);
      CAPTURE(why);
      const bool said =
          why.find("Too many open files") != std::string::npos || why.find("no more threads") != std::string::npos;
      borne += status == UL_OK || (other && status == UL_TIMEOUT) ? 1 : 0;
      CHECK((said || status == UL_OK || (other && status == UL_TIMEOUT)));
    }
    CHECK(borne == place.borne);
    CHECK(open_files() <= files + 1);
  }
}

TEST_CASE("the n-th read, write or wait fails") {
  constexpr std::pair<How, const char*> manners[] = {{How::interrupted, "EINTR at"},
                                                     {How::again, "EAGAIN at"},
                                                     {How::broken, "EIO at"},
                                                     {How::nothing, "0 bytes at"},
                                                     {How::one_byte, "1 byte at"}};
  for (const char* options : links) {
    for (const auto& [how, name] : manners) {
      CHECK(sessions(options, What::transfer, how, name, stride_of(19)) > least);
    }
  }
}

TEST_CASE("the clock jumps by an hour, or stands still") {
  for (const char* options : links) {
    CHECK(sessions(options, What::clock, How::from_then_on, "an hour at look", stride_of(61)) > least);
    CHECK(sessions(options, What::clock, How::once, "no time from look", stride_of(61)) > least);
  }
}
