// SPDX-License-Identifier: BSD-3-Clause
// An SPI slave, through the kernel's spidev. The PC is the master. Each byte that it sends also receives one.
//   spi:/dev/spidev0.0?speed_hz=10000000&poll=0.001&waiting=/dev/gpiochip0:25
// Options, with their defaults:
//   speed_hz=   (10000000) the frequency of sck
//   waiting=    the GPIO line to which the slave's output `waiting` is connected
//   poll=       (0.001) s between two polls of a slave that has nothing to send; with `waiting=` (0.1), in case the
//   wire
//               is broken

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <vector>

#include "layer0_driver/gpio_line.hpp"
#include "layer0_driver/pumped_driver.hpp"
#include "layer0_driver/spi_port.hpp"

namespace unitylink {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t speed_hz_default = 10'000'000;
constexpr std::uint64_t poll_ns_alone = 1'000'000;
constexpr std::uint64_t poll_ns_beside_line = 100'000'000;
constexpr std::size_t message_bytes = 1024;  // from the link, in one transfer
constexpr std::size_t look_bytes = 32;       // filler sent after them; the answer to one read fits into it
// doubles up to this while the slave still sends; spidev takes 4096 bytes in one transfer
constexpr std::size_t filler_bytes_most = 1024;
// after a byte in either direction, the slave is polled without a pause for so long
constexpr std::chrono::milliseconds linger{1};
constexpr std::uint8_t filler = 0;

// One thread makes all transfers: the bytes of the link, then zeros, during which the slave can send. A zero is filler
// only between messages. So no zeros are sent while a message of the link is incomplete. With `waiting=` the slave
// signals that it has bytes, so it need not be polled.
class SpiDriver final : public PumpedDriver {
 public:
  SpiDriver(std::unique_ptr<SpiPort> port, std::unique_ptr<GpioLine> line, SocketPair pair, std::uint64_t byte_time_ns,
            std::uint64_t poll_ns)
      : PumpedDriver(std::move(pair)),
        port_(std::move(port)),
        line_(std::move(line)),
        byte_time_ns_(byte_time_ns),
        poll_ns_(poll_ns) {}
  ~SpiDriver() override { SpiDriver::close(); }

  void begin() {
    start([this] { clock_all(); });
  }

  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return byte_time_ns_; }
  void messages_end_with(std::uint8_t end) noexcept override { end_ = end; }

 private:
  void let_go(bool) noexcept override {  // also in a forked child, because these descriptors are its own copies
    port_.reset();
    line_.reset();
  }

  void clock_all() {
    std::vector<std::uint8_t>&out = out_, &in = in_;
    std::size_t look = look_bytes;
    bool whole = true;  // the last message from the link is complete
    Clock::time_point busy_until = Clock::now();
    while (running()) {
      const bool busy = line_ ? line_->high() : Clock::now() < busy_until;
      const std::size_t count = fetch(std::span(out).first(message_bytes), busy && whole ? 0 : poll_ns_,
                                      line_ && whole ? line_->descriptor() : -1);
      if (count > 0) {
        whole = out[count - 1] == end_;
      }
      const std::size_t all = count + (whole ? look : 0);
      if (all == 0) {
        continue;
      }
      std::fill(out.begin() + static_cast<std::ptrdiff_t>(count), out.begin() + static_cast<std::ptrdiff_t>(all),
                filler);
      if (const int error = port_->exchange(std::span(out).first(all), in); error != 0) {
        ended("an SPI transfer failed: ",
              error == EMSGSIZE
                  ? "spidev's buffer is too small, it needs the 4096 bytes it has by default (spidev.bufsiz)"
                  : std::strerror(error));
        return;
      }
      const bool goes_on = in[all - 1] != filler || (all > 1 && in[all - 2] != filler);
      look = goes_on ? std::min(2 * look, filler_bytes_most) : look_bytes;
      const std::size_t heard = without_filler(std::span(in).first(all));
      if (count > 0 || heard > 0) {
        busy_until = Clock::now() + linger;
      }
      hand_on(std::span(in).first(heard));
    }
  }

  // Removes filler. Classic messages contain no zeros. A framed message ends with one zero, and any further zeros are
  // filler.
  std::size_t without_filler(std::span<std::uint8_t> bytes) noexcept {
    std::size_t kept = 0;
    for (const std::uint8_t byte : bytes) {
      if (byte != filler || (end_ == filler && inside_)) {
        bytes[kept++] = byte;
      }
      inside_ = byte != filler;
    }
    return kept;
  }

  std::unique_ptr<SpiPort> port_;
  std::unique_ptr<GpioLine> line_;  // the slave's `waiting`; nullptr without this option
  std::uint64_t byte_time_ns_;
  std::uint64_t poll_ns_;
  // made with the driver, so that the thread needs no memory
  std::vector<std::uint8_t> out_ = std::vector<std::uint8_t>(message_bytes + filler_bytes_most);
  std::vector<std::uint8_t> in_ = std::vector<std::uint8_t>(message_bytes + filler_bytes_most);
  std::atomic<std::uint8_t> end_ = '\n';
  bool inside_ = false;  // the last byte received belongs to an incomplete message
};

}  // namespace

// Errors: bad_url, not_found, permission, busy, mismatch (no such speed, mode or line).
Outcome open_spi(const Url& url, const Patience&, std::unique_ptr<Driver>& driver) {
  std::uint64_t speed_hz = speed_hz_default;
  if (const std::string* text = url.option("speed_hz");
      text != nullptr && (!parse_number(*text, 1'000'000'000, speed_hz) || speed_hz < 1000)) {
    return wrong_url(url, "speed_hz=" + *text + " is not a clock rate in Hz such as 10000000");
  }
  const std::string* place = url.option("waiting");
  std::uint64_t poll_ns = place == nullptr ? poll_ns_alone : poll_ns_beside_line;
  if (const std::string* text = url.option("poll"); text != nullptr && !parse_seconds(*text, poll_ns)) {
    return wrong_url(url, "poll=" + *text + " is not a time in seconds from 1e-6 to 3600");
  }
  std::unique_ptr<SpiPort> port;
  if (Outcome outcome = SpiPort::open(url.path, static_cast<std::uint32_t>(speed_hz), port); !outcome.ok()) {
    return outcome;
  }
  std::unique_ptr<GpioLine> line;
  if (place != nullptr) {
    if (Outcome outcome = GpioLine::open(*place, line); !outcome.ok()) {
      return outcome.status == Status::bad_url ? wrong_url(url, outcome.text) : outcome;
    }
  }
  SocketPair pair;
  if (Outcome outcome = make_socket_pair(pair); !outcome.ok()) {
    return outcome;
  }
  auto made =
      std::make_unique<SpiDriver>(std::move(port), std::move(line), std::move(pair), 8'000'000'000 / speed_hz, poll_ns);
  made->begin();
  driver = std::move(made);
  return {};
}

}  // namespace unitylink
