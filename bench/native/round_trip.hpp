// SPDX-License-Identifier: BSD-3-Clause
// What the smallest programs of the bench share: blocking round trips, as many as a line on standard input says.
#pragma once

#include <chrono>
#include <vector>

#include "endpoint.hpp"

namespace unitylink::bench {

// Converts pairs of hex digits to bytes.
inline std::string bytes_of(const std::string& digits) {
  std::string bytes;
  for (std::size_t at = 0; at + 1 < digits.size(); at += 2) {
    bytes.push_back(static_cast<char>(number("hexadecimal digits", "0x" + digits.substr(at, 2))));
  }
  return bytes;
}

// Makes one blocking round trip. The reply ends with the same byte as the request.
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

// For each line "COUNT" on standard input it prints the times of `trips(COUNT)` in ns, on one line.
template <class Trips>
void answer_counts(Trips&& trips) {
  std::array<char, 64> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), stdin) != nullptr) {
    std::string text(line.data());
    text.erase(text.find_last_not_of("\n") + 1);
    alarm(20);  // ends this program if the server does not answer, so that the bench does not wait for it
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
