// SPDX-License-Identifier: BSD-3-Clause
// Histories of the fault simulation:
//   fuzz_faults --seconds N --seed S                    many histories; each has the next profile
//   fuzz_faults --messages M --profile P [--classic]    one history
//   fuzz_faults --strings N                             until N messages have been sent
// It fails at the first violation.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "faults/simulation.hpp"

using namespace unitylink::faults;

int main(int count, char** arguments) {
  double seconds = 0;
  unsigned long long strings = 0;
  bool framed = true;
  std::string profile;
  Plan plan{.seed = 1, .messages = 10'000, .profile = {}, .framed = true, .clients = 16, .window = 32};
  for (int index = 1; index < count; ++index) {
    const auto value = [&] { return index + 1 < count ? arguments[++index] : ""; };
    if (std::strcmp(arguments[index], "--seconds") == 0) {
      seconds = std::atof(value());
    } else if (std::strcmp(arguments[index], "--strings") == 0) {
      strings = std::strtoull(value(), nullptr, 0);
    } else if (std::strcmp(arguments[index], "--seed") == 0) {
      plan.seed = std::strtoull(value(), nullptr, 0);
    } else if (std::strcmp(arguments[index], "--messages") == 0) {
      plan.messages = std::strtoull(value(), nullptr, 0);
    } else if (std::strcmp(arguments[index], "--profile") == 0) {
      profile = value();
    } else if (std::strcmp(arguments[index], "--classic") == 0) {
      framed = false;
    } else {
      std::fprintf(stderr, "fuzz_faults: what is %s?\n", arguments[index]);
      return 2;
    }
  }
  if (!profile.empty() && !find_profile(profile)) {
    std::fprintf(stderr, "fuzz_faults: no profile %s\n", profile.c_str());
    return 2;
  }
  const auto begun = std::chrono::steady_clock::now();
  unsigned long long histories = 0, messages = 0, faults = 0;
  do {
    plan.profile = profile.empty() ? profiles()[histories % profiles().size()] : *find_profile(profile);
    // Without --classic every third history is classic.
    plan.framed = framed && (!profile.empty() || histories % 3 != 2);
    const Report report = run(plan);
    messages += report.messages;
    faults += report.faults;
    ++histories;
    if (!report.violations.empty()) {
      std::printf("unitylink faults --seed %llu --messages %llu --profile %s --protocol %s\n",
                  static_cast<unsigned long long>(plan.seed), static_cast<unsigned long long>(plan.messages),
                  std::string(plan.profile.name).c_str(), plan.framed ? "framed" : "classic");
      for (const std::string& text : report.violations) {
        std::printf("  %s\n", text.c_str());
      }
      return 1;
    }
    ++plan.seed;
  } while (strings > 0 ? messages < strings
                       : std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() < seconds);
  std::printf("fuzz_faults: %llu histories, %llu messages, %llu faults, 0 violations\n", histories, messages, faults);
  return 0;
}
