// SPDX-License-Identifier: BSD-3-Clause
// A driver for Link on a virtual clock. At its other end is the twin. The wire between them may lose messages, and the
// twin may give false answers. A second of silence takes a millisecond, and the same seed gives the same history. A
// thread can use one of these at a time.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <sys/eventfd.h>
#include <unistd.h>

#include "device/device.hpp"
#include "faults/faulty_wire.hpp"
#include "faults/lying_peer.hpp"
#include "layer0_driver/driver.hpp"

namespace unitylink::test {

// The other end of the line. A test can change it while a link uses the line.
struct VirtualPlace {
  explicit VirtualPlace(std::uint64_t seed = 1, device::DeviceConfiguration configuration = {})
      : random(seed),
        device(configuration),
        there(random, 0, 833, 125'000),
        back(random, 0, 833, 125'000),
        liar(random, true) {}

  void lose(double share) {
    there.set({.lose = share});
    back.set({.lose = share});
  }

  faults::Random random;
  device::Device device;
  faults::FaultyWire there;
  faults::FaultyWire back;
  faults::LyingPeer liar;
  std::uint64_t turns = 0;  // how often the host began to send: at first, and after it had received something

  static inline thread_local std::uint64_t clock_ns = 1'000'000'000;
};

// Collects bytes, and gives the wire whole messages: frames up to their 00, and lines of text.
struct Messages {
  void send(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) {
    for (const std::uint8_t byte : bytes) {
      text = begins ? byte != 0 && byte < 0x80 : text;
      wire.send(std::span(&byte, 1), now_ns);
      begins = byte == 0 || (text && byte == '\n');
      if (begins && byte != 0) {
        wire.break_off(now_ns);
      }
    }
  }

  faults::FaultyWire& wire;
  bool begins = true;
  bool text = false;
};

class VirtualLine final : public Driver {
 public:
  explicit VirtualLine(VirtualPlace& place)
      : place_(place), readable_(::eventfd(1, EFD_NONBLOCK | EFD_CLOEXEC)), begun_ns_(now()) {}
  ~VirtualLine() override { VirtualLine::close(); }

  Transfer send(std::span<const std::uint8_t> bytes) noexcept override {
    place_.turns += std::exchange(silent_, false) ? 1 : 0;
    there_.send(bytes, now());
    return {bytes.size(), Status::ok};
  }

  // Advances the clock to the next event, but at most by a millisecond.
  Transfer receive(std::span<std::uint8_t> room) noexcept override {
    const std::uint64_t next = std::min(place_.there.next_ns(), place_.back.next_ns());
    VirtualPlace::clock_ns = std::clamp(next, now() + 20'000, now() + 1'000'000);
    place_.there.take(now(), [this](std::span<const std::uint8_t> bytes) {
      for (const std::uint8_t byte : bytes) {
        say(place_.liar.heard(byte));
        run();
        if (!place_.device.receive(byte)) {
          place_.device.run_until(place_.device.clock() + 1000);
          static_cast<void>(place_.device.receive(byte));
        }
      }
    });
    run();
    std::size_t count = 0;
    place_.back.take(now(), [this](std::span<const std::uint8_t> bytes) { heard_.append(bytes.begin(), bytes.end()); });
    count = std::min(room.size(), heard_.size());
    std::memcpy(room.data(), heard_.data(), count);
    heard_.erase(0, count);
    silent_ = silent_ || count > 0;
    return {count, Status::ok};
  }

  void close() noexcept override {
    if (readable_ >= 0) {
      ::close(std::exchange(readable_, -1));
    }
  }
  void disown() noexcept override { VirtualLine::close(); }
  [[nodiscard]] int descriptor() const noexcept override { return readable_; }
  [[nodiscard]] TimeSource time_source() const noexcept override { return &now; }
  [[nodiscard]] std::string reason() const override { return {}; }

 private:
  static constexpr std::uint64_t clock_period_ns = 20;

  static std::uint64_t now() noexcept { return VirtualPlace::clock_ns; }
  void run() {
    place_.device.run_until(std::max(place_.device.clock(), (now() - begun_ns_) / clock_period_ns));
    device::TimedByte timed;
    while (place_.device.take(timed)) {
      say(place_.liar.say(timed.byte));
    }
  }
  void say(const faults::LyingPeer::Bytes& bytes) {
    if (!bytes.empty()) {
      back_.send(bytes, now());
    }
  }

  VirtualPlace& place_;
  Messages there_{place_.there};
  Messages back_{place_.back};
  int readable_;
  std::uint64_t begun_ns_;
  std::string heard_;
  bool silent_ = true;  // the host has sent nothing since it last received something
};

}  // namespace unitylink::test
