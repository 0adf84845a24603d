// SPDX-License-Identifier: BSD-3-Clause
// Round trips through typed objects, and the same ones through the bare C ABI:  trip LINK
// For each line "KIND COUNT" on standard input it makes COUNT of them, and prints their times in ns on one line. KIND
// is read-objects, read-abi, cycle-objects or cycle-abi.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "walker.hpp"

namespace {

constexpr std::size_t joints = 18;
constexpr std::uint32_t positions = 0x200, targets = 0x100;

[[noreturn]] void stop(const char* what) {
  std::fprintf(stderr, "%s: %s\n", what, ul_last_error_text());
  std::exit(1);
}

template <class Trip>
void measure(long count, Trip&& trip) {
  std::vector<long long> times(static_cast<std::size_t>(count));
  for (auto& time : times) {
    const auto start = std::chrono::steady_clock::now();
    trip();
    time = std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count();
  }
  for (const auto time : times) std::printf("%lld ", time);
  std::printf("\n");
  std::fflush(stdout);
}

// The exchange group of the bare side: the same words, as raw numbers of two bytes.
std::uint32_t bare_group(ul_link* link) {
  std::array<ul_exchange_word, joints> outputs{}, inputs{};
  std::uint32_t group = 0;
  for (std::uint32_t i = 0; i < joints; ++i) {
    outputs[i] = {targets + i, 2};
    inputs[i] = {positions + i, 2};
  }
  if (ul_define_exchange(link, outputs.data(), joints, inputs.data(), joints, &group) != UL_OK) stop("exchange group");
  return group;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return std::fprintf(stderr, "usage: trip LINK\n"), 2;
  try {
    const unitylink::Link link(arguments[1]);
    const walker::Walker robot(link);
    auto cycle = robot.cycle();
    cycle.open().value();
    walker::WalkerOutputs outputs;
    const std::uint32_t group = bare_group(link.handle());
    std::array<std::uint32_t, joints> out{}, in{};
    double sum = 0.0;  // of all that is read, so that no read is left out
    char kind[32];
    long trips = 0;
    while (std::scanf("%31s %ld", kind, &trips) == 2) {
      const std::string name(kind);
      if (name == "read-objects") {
        measure(trips, [&] { sum += robot.position[0].read().value(); });
      } else if (name == "read-abi") {
        measure(trips, [&] {
          if (ul_read(link.handle(), positions, in.data(), nullptr) != UL_OK) stop("read");
          sum += in[0];
        });
      } else if (name == "cycle-objects") {
        measure(trips, [&] {
          outputs.target[0] = -outputs.target[0] + 0.5;
          const auto inputs = cycle.exchange(outputs).value();
          sum += inputs.position[0] + inputs.position[joints - 1];
        });
      } else {
        measure(trips, [&] {
          out[0] ^= 500;
          if (ul_exchange(link.handle(), group, out.data(), joints, in.data(), joints, nullptr) != UL_OK)
            stop("exchange");
          sum += in[0] + in[joints - 1];
        });
      }
    }
    return std::fprintf(stderr, "%f\n", sum) < 0 ? 1 : 0;
  } catch (const unitylink::Failure& failure) {
    return std::fprintf(stderr, "%s\n", failure.what()), 1;
  }
}
