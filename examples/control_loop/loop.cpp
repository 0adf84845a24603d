// SPDX-License-Identifier: BSD-3-Clause
// Holds the joint at an angle, 1000 times a second:  loop LINK ANGLE SECONDS
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "joint.hpp"

int main(int count, char** arguments) {
  if (count != 4) return std::fprintf(stderr, "usage: loop LINK ANGLE SECONDS\n"), 2;
  try {
    unitylink::Link link(arguments[1]);
    joint::Joint robot(link);                            // checks that the board has this spec
    link.set_dead_man(std::chrono::seconds(1)).value();  // then the torque is its SAFE value
    auto cycle = robot.cycle();
    cycle.open().value();  // from here on nothing is allocated
    const double wanted = std::atof(arguments[2]);
    const long cycles = std::lround(1000 * std::atof(arguments[3]));
    joint::JointOutputs out;  // each output has its INITIAL
    joint::JointInputs in;
    timespec due{};
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (long left = cycles; left > 0; --left) {
      in = cycle.exchange(out).value();  // one message each way
      out.torque = std::clamp(8.0 * (wanted - in.angle) - 0.6 * in.speed, -2.0, 2.0);
      if ((due.tv_nsec += 1'000'000) >= 1'000'000'000) due.tv_nsec -= 1'000'000'000, ++due.tv_sec;
      clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
    }
    robot.torque.write(0.0).value();
    std::printf("%ld cycles, the angle is %.3f rad\n", cycles, in.angle);
  } catch (const unitylink::Failure& failure) {
    return std::fprintf(stderr, "%s\n", failure.what()), 1;
  }
}
