// SPDX-License-Identifier: BSD-3-Clause
// What all fuzz programs share: the command line, the time limit, and the report of a failure.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>

namespace unitylink::fuzzing {

// Prints the broken promise and the input in hex, and ends the program.
[[noreturn]] inline void fail(const char* program, const char* what, std::uint64_t seed, std::uint64_t round,
                              std::span<const std::uint8_t> input) {
  std::printf("%s: %s; --seed %llu, round %llu, input (%zu bytes):\n", program, what,
              static_cast<unsigned long long>(seed), static_cast<unsigned long long>(round), input.size());
  for (const std::uint8_t byte : input) {
    std::printf("%02x", static_cast<unsigned>(byte));
  }
  std::printf("\n");
  std::exit(1);
}

// Runs rounds of `Fuzz(seed)`. The command line gives the seconds, or the number of strings. `Fuzz` counts `rounds`,
// the hostile `strings` in them, their `bytes`, and how many were `understood`.
template <typename Fuzz>
int run(const char* program, const char* understood, int count, char** arguments) {
  double seconds = 3;
  std::uint64_t seed = 1, strings = 0;
  for (int index = 1; index < count; ++index) {
    const bool has_value = index + 1 < count;
    if (has_value && std::strcmp(arguments[index], "--seconds") == 0) {
      seconds = std::strtod(arguments[++index], nullptr);
    } else if (has_value && std::strcmp(arguments[index], "--seed") == 0) {
      seed = std::strtoull(arguments[++index], nullptr, 10);
    } else if (has_value && std::strcmp(arguments[index], "--strings") == 0) {
      strings = std::strtoull(arguments[++index], nullptr, 10);
    } else {
      std::fprintf(stderr, "usage: %s [--seconds N | --strings N] [--seed S]\n", program);
      return 2;
    }
  }
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  const auto fuzz = std::make_unique<Fuzz>(seed);
  do {
    for (int round = 0; round < 20; ++round) {
      fuzz->round();
    }
  } while (strings > 0 ? fuzz->strings < strings : std::chrono::steady_clock::now() < until);
  std::printf("%s: %llu hostile strings, %llu bytes, %llu %s, seed %llu: all held\n", program,
              static_cast<unsigned long long>(fuzz->strings), static_cast<unsigned long long>(fuzz->bytes),
              static_cast<unsigned long long>(fuzz->understood), understood, static_cast<unsigned long long>(seed));
  return 0;
}

}  // namespace unitylink::fuzzing
