// SPDX-License-Identifier: BSD-3-Clause
// The floor under a synchronous read: write the request, block in read until the reply's line feed, nothing else.
//   bench_round_trip (--request '#R:0088' | --frame HEX) (--descriptor N | --tcp PORT)
// A request is a line, and so is its reply, the same every time; a frame ends with 00, and so does its reply, of the same length every time.
// For every line "COUNT" on standard input it makes COUNT round trips and prints their times in ns on one line.
#include <chrono>
#include <vector>

#include "endpoint.hpp"

namespace {

using unitylink::bench::argument;
using unitylink::bench::number;
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

// The bytes of pairs of digits.
std::string bytes_of(const std::string& digits) {
  std::string bytes;
  for (std::size_t at = 0; at + 1 < digits.size(); at += 2) {
    bytes.push_back(static_cast<char>(number("--frame", "0x" + digits.substr(at, 2))));
  }
  return bytes;
}

// One blocking round trip; the reply ends as the request does.
std::string_view round_trip(int descriptor, std::string_view request, std::span<char> reply) {
  const char end = request.back();
  if (write(descriptor, request.data(), request.size()) != static_cast<ssize_t>(request.size())) {
    stop("the request did not go out whole", errno);
  }
  std::size_t size = 0;
  do {
    const auto count = read(descriptor, reply.data() + size, reply.size() - size);
    if (count <= 0) {
      stop("the server is gone", count < 0 ? errno : 0);
    }
    size += static_cast<std::size_t>(count);
  } while (reply[size - 1] != end && size < reply.size());
  return {reply.data(), size};
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
  const int descriptor = port.empty() ? static_cast<int>(number("--descriptor", given)) : open_tcp(number("--tcp", port));
  if (isatty(descriptor) != 0) {
    unitylink::bench::make_raw(descriptor);
  }

  std::array<char, 4096> reply{};
  std::string expected;
  std::vector<long long> times;
  std::array<char, 64> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), stdin) != nullptr) {
    std::string text(line.data());
    text.erase(text.find_last_not_of("\n") + 1);
    times.assign(number("a count", text), 0);
    alarm(20);  // a server that never answers ends this program, not the bench's patience
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
    alarm(0);
    for (const auto time : times) {
      std::printf("%lld ", time);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
  return 0;
}
