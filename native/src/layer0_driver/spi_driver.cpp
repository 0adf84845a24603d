// SPDX-License-Identifier: BSD-3-Clause
// An SPI slave behind the kernel's spidev: the PC is the master, and each byte it clocks out brings one in.
//   spi:/dev/spidev0.0?speed_hz=10000000&poll=0.001&waiting=/dev/gpiochip0:25
// Options: speed_hz= (of sck, 10 MHz), waiting= (the line on which the slave's wire of that name is), poll= (s between
// looks at a slave that has nothing to say, 0.001; with a line 0.1, in case that the wire is off).

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
constexpr std::size_t message_bytes = 1024;  // of the link's, in a transfer
constexpr std::size_t look_bytes = 32;       // of filler behind them: an answer to one read comes within these
// as much again while the slave goes on speaking; spidev takes 4096 in all
constexpr std::size_t filler_bytes_most = 1024;
constexpr std::chrono::milliseconds linger{1};  // how long answers are looked for without a pause
constexpr std::uint8_t filler = 0;

// One thread clocks: what the link has to say, and zeros behind it for what the slave has. A zero is filler between
// messages only, so nothing is clocked while a message of the link's is cut. A line on which the slave says that it has
// something spares looking for it.
class SpiDriver final : public PumpedDriver {
 public:
  SpiDriver(std::unique_ptr<SpiPort> port, std::unique_ptr<GpioLine> line, const SocketPair& pair,
            std::uint64_t byte_time_ns, std::uint64_t poll_ns)
      : PumpedDriver(pair),
        port_(std::move(port)),
        line_(std::move(line)),
        byte_time_ns_(byte_time_ns),
        poll_ns_(poll_ns) {
    start([this] { clock_all(); });
  }
  ~SpiDriver() override { SpiDriver::close(); }

  [[nodiscard]] std::uint64_t byte_time_ns() const noexcept override { return byte_time_ns_; }
  void messages_end_with(std::uint8_t end) noexcept override { end_ = end; }

 private:
  void let_go(bool) noexcept override {  // in a forked child too: it is the child's copy of the descriptors
    port_.reset();
    line_.reset();
  }

  void clock_all() {
    std::vector<std::uint8_t> out(message_bytes + filler_bytes_most), in(out.size());
    std::size_t look = look_bytes;
    bool whole = true;  // the last message of the link's
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
        ended(std::string("an SPI transfer failed: ") +
              (error == EMSGSIZE
                   ? "spidev's buffer is too small, it needs the 4096 bytes it has by default (spidev.bufsiz)"
                   : std::strerror(error)));
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

  // Classic messages have no zeros; a framed one ends with one, and more of them mean nothing.
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
  std::unique_ptr<GpioLine> line_;  // of the slave's `waiting`; may be none
  std::uint64_t byte_time_ns_;
  std::uint64_t poll_ns_;
  std::atomic<std::uint8_t> end_ = '\n';
  bool inside_ = false;  // a message of the slave's
};

}  // namespace

// bad_url, not_found, permission, busy, mismatch (a speed, mode or line that is not there). closed once a transfer
// fails.
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
  driver = std::make_unique<SpiDriver>(std::move(port), std::move(line), pair, 8'000'000'000 / speed_hz, poll_ns);
  return {};
}

}  // namespace unitylink
