// SPDX-License-Identifier: BSD-3-Clause
// What a bare program of the bench does: one blocking round trip, as often as a line on standard input says.
#pragma once

#include <chrono>
#include <vector>

#include "endpoint.hpp"

namespace unitylink::bench {

// The bytes of pairs of digits.
inline std::string bytes_of(const std::string& digits) {
  std::string bytes;
  for (std::size_t at = 0; at + 1 < digits.size(); at += 2) {
    bytes.push_back(static_cast<char>(number("hexadecimal digits", "0x" + digits.substr(at, 2))));
  }
  return bytes;
}

// One blocking round trip; the reply ends as the request does.
inline std::string_view round_trip(int descriptor, std::string_view request, std::span<char> reply) {
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

// For every line "COUNT" on standard input: prints what `trips(COUNT)` returns, times in ns, on one line.
template <class Trips>
void answer_counts(Trips&& trips) {
  std::array<char, 64> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), stdin) != nullptr) {
    std::string text(line.data());
    text.erase(text.find_last_not_of("\n") + 1);
    alarm(20);  // a server that never answers ends this program, not the bench's patience
    const std::vector<long long> times = trips(number("a count", text));
    alarm(0);
    for (const auto time : times) {
      std::printf("%lld ", time);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace unitylink::bench
