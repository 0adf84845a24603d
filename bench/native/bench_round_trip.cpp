// SPDX-License-Identifier: BSD-3-Clause
// The shortest possible time of a synchronous read: write the request, and block in read until the reply is complete.
//   bench_round_trip (--request '#R:0088' | --frame HEX) (--descriptor N | --tcp PORT)
// A request and its reply are one line each, or one frame each, which ends with 00. All replies must have the same
// length. Lines must be equal. For each line "COUNT" on standard input it makes COUNT round trips, and prints their
// times in ns on one line.
#include <chrono>
#include <vector>

#include "endpoint.hpp"
#include "round_trip.hpp"

namespace {

using unitylink::bench::argument;
using unitylink::bench::bytes_of;
using unitylink::bench::number;
using unitylink::bench::round_trip;
using unitylink::bench::stop;

int open_tcp(std::uint64_t port) {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (descriptor < 0 || connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    stop("cannot connect to 127.0.0.1:" + std::to_string(port), errno);
  }
  const int on = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return descriptor;
}

}  // namespace

int main(int count, char** values) {
  const std::span arguments(values, static_cast<std::size_t>(count));
  const std::string frame = bytes_of(argument(arguments, "--frame", ""));
  const std::string line_of = argument(arguments, "--request", "");
  const std::string request = frame.empty() ? line_of + "\n" : frame;
  const std::string port = argument(arguments, "--tcp", "");
  const std::string given = argument(arguments, "--descriptor", "");
  if (line_of.empty() == frame.empty() || port.empty() == given.empty()) {
    stop("usage: bench_round_trip (--request TEXT | --frame HEX) (--descriptor N | --tcp PORT)");
  }
  const int descriptor =
      port.empty() ? static_cast<int>(number("--descriptor", given)) : open_tcp(number("--tcp", port));
  if (isatty(descriptor) != 0) {
    unitylink::bench::make_raw(descriptor);
  }

  std::array<char, 4096> reply{};
  std::string expected;
  unitylink::bench::answer_counts([&](std::size_t trips) {
    std::vector<long long> times(trips);
    for (auto& time : times) {
      const auto start = std::chrono::steady_clock::now();
      const auto answer = round_trip(descriptor, request, reply);
      time = std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count();
      if (expected.empty()) {
        expected = answer;
      } else if (frame.empty() ? answer != expected : answer.size() != expected.size()) {
        stop("the reply changed to " + std::string(answer.substr(0, answer.size() - 1)));
      }
    }
    return times;
  });
  return 0;
}
