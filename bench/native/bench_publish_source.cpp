// SPDX-License-Identifier: BSD-3-Clause
// Publishes messages to any subscriber: in bursts with a certain bit rate, or as fast as the subscriber takes them.
//   bench_publish_source --endpoint tcp|pty [--bits-per-second 64000000] [--burst-us 1000]     (0 bits/s: unpaced)
//     [--words N]     frames of N words; without it lines of the classic protocol, of one word
// It prints its address, and serves one client after another until standard input ends.
#include <ctime>

#include "endpoint.hpp"
#include "frame_publisher.hpp"
#include "publisher.hpp"

namespace {

using namespace unitylink::bench;

std::uint64_t now_ns() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000u + static_cast<std::uint64_t>(time.tv_nsec);
}

// The messages that are due by the clock. A source that was late sends all that is due at once, so the mean rate is
// right.
class Pace {
 public:
  // Each message has `message_bytes`.
  Pace(std::uint64_t bits_per_second, std::uint64_t burst_us, std::size_t message_bytes)
      : bits_per_second_(bits_per_second),
        burst_ns_(burst_us * 1000),
        message_bits_(8.0 * static_cast<double>(message_bytes)) {}

  void start() {
    start_ns_ = next_ns_ = now_ns();
    sent_ = 0;
  }

  // Waits for the next burst, or for a request from the client. Returns the number of messages that are due now.
  std::size_t wait(const Endpoint& endpoint) {
    const auto now = now_ns();
    if (now < next_ns_) {
      const timespec left{static_cast<time_t>((next_ns_ - now) / 1'000'000'000u),
                          static_cast<long>((next_ns_ - now) % 1'000'000'000u)};
      pollfd ready{endpoint.descriptor(), POLLIN, 0};
      if (ppoll(&ready, 1, &left, nullptr) > 0) {
        return 0;
      }
    }
    next_ns_ += burst_ns_;
    const auto due = static_cast<std::uint64_t>(static_cast<double>(now_ns() - start_ns_) * 1e-9 *
                                                static_cast<double>(bits_per_second_) / message_bits_);
    const auto count = due > sent_ ? due - sent_ : 0;
    sent_ += count;
    return static_cast<std::size_t>(count);
  }

 private:
  std::uint64_t bits_per_second_;
  std::uint64_t burst_ns_;
  double message_bits_;
  std::uint64_t start_ns_ = 0;
  std::uint64_t next_ns_ = 0;
  std::uint64_t sent_ = 0;
};

// Serves this client. True: the client has left. False: standard input has ended.
template <class Device>
bool serve(const Endpoint& endpoint, Device& device, Pace& pace, bool paced) {
  std::array<char, 4096> chunk{};
  std::string out;
  bool running = false;
  while (true) {
    pollfd ready[] = {{endpoint.descriptor(), POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    if (poll(ready, 2, running ? 0 : -1) < 0 && errno != EINTR) {
      stop("poll", errno);
    }
    if (ready[1].revents != 0) {
      return false;
    }
    out.clear();
    if ((ready[0].revents & POLLIN) != 0) {
      const auto count = endpoint.receive(chunk);
      if (count == 0) {
        return true;
      }
      device.receive({chunk.data(), count}, out);
    } else if ((ready[0].revents & (POLLHUP | POLLERR)) != 0) {
      return true;
    }
    if (device.publishing() && !running) {
      pace.start();
    }
    running = device.publishing();
    if (running && out.empty()) {
      device.publish(paced ? pace.wait(endpoint) : 2048, out);
    }
    if (!out.empty() && !endpoint.send(out)) {
      return true;
    }
  }
}

// Serves one client after another.
template <class Device>
void serve_all(Endpoint& endpoint, Device device, std::uint64_t bits_per_second, std::uint64_t burst_us) {
  Pace pace(bits_per_second, burst_us, device.publish_bytes());
  announce(endpoint);
  while (endpoint.accept_client() && serve(endpoint, device, pace, bits_per_second != 0)) {
    device.reset();
    endpoint.leave();
    if (endpoint.pty()) {
      usleep(10000);  // nobody has the pty open; wait for the next client
    }
  }
}

}  // namespace

int main(int count, char** values) {
  const std::span arguments(values, static_cast<std::size_t>(count));
  Endpoint endpoint(argument(arguments, "--endpoint", "tcp"));
  const auto bits_per_second = number("--bits-per-second", argument(arguments, "--bits-per-second", "64000000"));
  const auto burst_us = number("--burst-us", argument(arguments, "--burst-us", "1000"));
  if (burst_us == 0) {
    stop("--burst-us is at least 1");
  }
  if (const auto words = number("--words", argument(arguments, "--words", "0")); words > 0) {
    if (words > unitylink::protocol::limits::group_size_max) {
      stop("--words is at most " + std::to_string(unitylink::protocol::limits::group_size_max));
    }
    serve_all(endpoint, FramePublisher(static_cast<std::uint32_t>(words)), bits_per_second, burst_us);
    return 0;
  }
  const auto messages_per_second = bits_per_second / (8 * Publisher::line_bytes);
  if (messages_per_second >= 1u << 24) {
    stop("--bits-per-second is too high for the three bytes of a base frequency");
  }
  serve_all(endpoint,
            Publisher(messages_per_second > 0xFFFF ? static_cast<std::uint32_t>(messages_per_second) : 1'000'000u),
            bits_per_second, burst_us);
  return 0;
}
