// SPDX-License-Identifier: BSD-3-Clause
// The steps in C++. steps.py and steps.c do the same and print the same lines.
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "steps.hpp"

namespace {

int step = 0;

void say(const char* name, const char* format, ...) {
  va_list parts;
  std::printf("%02d %s: ", ++step, name);
  va_start(parts, format);
  std::vprintf(format, parts);
  va_end(parts);
  std::printf("\n");
}

template <class T>
void refused(const char* name, const unitylink::result<T>& done) {
  say(name, done ? "done" : done.error().status() == UL_RANGE ? "refused" : "unexpected");
}

void say_status(const char* name, const steps::Status& status) {
  say(name, "%d %d %.1f", status.ready, static_cast<int>(status.mode), status.heat);
}

void whole(steps::Steps& robot) {
  robot.count.write(123456).value();
  say("count", "%u", robot.count.read().value());
  robot.count.write(4294967295U).value();
  say("count", "%u", robot.count.read().value());
  robot.small.write(-100).value();
  say("small", "%d", robot.small.read().value());
  refused("small 101", robot.small.write(101));
  refused("small -101", robot.small.write(-101));
  say("small", "%d", robot.small.read().value());
  robot.big.write(18446744073709551615U).value();
  say("big", "%llu", static_cast<unsigned long long>(robot.big.read().value()));
  robot.big.write(81985529216486895U).value();
  say("big", "%llu", static_cast<unsigned long long>(robot.big.read().value()));
}

void real(steps::Steps& robot) {
  robot.gain.write(2.5).value();
  say("gain", "%.6f", robot.gain.read().value());
  refused("gain 10.5", robot.gain.write(10.5));
  refused("gain NaN", robot.gain.write(std::nan("")));
  robot.exact.write(-0.1).value();
  say("exact", "%.17g", robot.exact.read().value());
  refused("exact infinite", robot.exact.write(INFINITY));
  robot.j[0].torque.write(1.503).value();
  say("torque", "%.8f", robot.j[0].torque.read().value());
  robot.j[1].torque.write(99.0).value();
  say("torque", "%.8f", robot.j[1].torque.read().value());
  robot.j[1].torque.write(-99.0).value();
  say("torque", "%.8f", robot.j[1].torque.read().value());
  robot.j[0].target.write(-1.2345).value();
  refused("target 3.5", robot.j[0].target.write(3.5));
  say("pos", "%.3f %.3f", robot.j[0].pos.read().value(), robot.j[1].pos.read().value());
}

void named(steps::Steps& robot) {
  robot.j[0].mode.write(steps::Mode::stop).value();
  say("mode", "%d", static_cast<int>(robot.j[0].mode.read().value()));
  refused("mode 2", robot.j[0].mode.write(static_cast<steps::Mode>(2)));
  refused("mode of the board", robot.j[1].mode.read());
  robot.level.write(steps::Level::high).value();
  say("level", "%d", static_cast<int>(robot.level.read().value()));
  robot.level.write(static_cast<steps::Level>(200)).value();
  say("level", "%d", static_cast<int>(robot.level.read().value()));
  robot.status.write({.ready = true, .mode = steps::Mode::run, .heat = -12.5}).value();
  say_status("status", robot.status.read().value());
  refused("status hot", robot.status.write({.ready = true, .mode = steps::Mode::run, .heat = 64.0}));
  const bool lamps[] = {true, false, true};
  for (std::size_t item = 0; item < robot.lamps.size(); ++item) robot.lamps[item].write(lamps[item]).value();
  say("lamps", "%d %d %d", robot.lamps[0].read().value(), robot.lamps[1].read().value(), robot.lamps[2].read().value());
}

void say_net(steps::Steps& robot) { say("net", "%d %.1f", robot.net.a.read().value(), robot.net.b.read().value()); }

void special(steps::Steps& robot) {
  say("faults", "%d", robot.faults.read().value());
  robot.faults.clear(4).value();
  say("faults", "%d", robot.faults.read().value());
  say("lost", "%d", robot.lost.read().value());
  robot.reset.pulse(3).value();
  say("reset", "pulsed");
  refused("reset 16", robot.reset.pulse(16));
  robot.net.a.write(-7).value();
  say_net(robot);
  robot.net.b.write(12.3).value();
  say_net(robot);
  robot.net.a.write(8).value();
  say_net(robot);
}

void say_joint(const char* name, const steps::JointInputs& state) {
  say(name, "%.3f %d %.3f", state.pos, static_cast<int>(state.mode), state.torque);
}

void together(steps::Steps& robot) {
  robot.targets.write({.j_0_target = 0.25, .j_1_target = -0.25}).value();
  say("limit", "%d", robot.limit.read().value());
  robot.j[1].mode.write(steps::Mode::idle).value();
  auto cycle = robot.j[0].cycle();
  say_joint("cycle", cycle.exchange({.target = 1.5, .mode = steps::Mode::run, .torque = -2.25}).value());
  refused("cycle 4", cycle.exchange({.target = 4.0, .mode = steps::Mode::idle, .torque = 0.0}));
  say_joint("cycle", cycle.exchange({.target = -1.5, .mode = steps::Mode::stop, .torque = 50.0}).value());
  const auto shot = robot.snapshot().value();
  say("snapshot", "%u %d %llu %.3f %.3f", shot.count, shot.small, static_cast<unsigned long long>(shot.big), shot.gain,
      shot.j[1].torque);
  robot.published_pose.start().value();
  robot.published_pose.wait(std::chrono::seconds(10)).value();
  bool said = false;
  robot.published_pose
      .poll([&](double, const steps::StepsPublishedPose& pose) {
        if (!said) say("published", "%.3f", pose.j_1_pos);
        said = true;
      })
      .value();
}

}  // namespace

int main(int, char** arguments) {
  try {
    const unitylink::Link link(arguments[1]);
    steps::Steps robot(link);
    whole(robot);
    real(robot);
    named(robot);
    special(robot);
    together(robot);
  } catch (const unitylink::Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
  }
}
