// SPDX-License-Identifier: BSD-3-Clause
// What the objects of C++ allocate, what they do under a lock, and how they fail:  probe cost|errors LINK
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

#include "steps.hpp"
#include "system_calls.hpp"

namespace {

std::atomic<long> allocations{0};

}  // namespace

// The C library's own functions behind the ones that this program replaces.
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void* malloc(std::size_t bytes) { return ++allocations, __libc_malloc(bytes); }
void* calloc(std::size_t count, std::size_t bytes) { return ++allocations, __libc_calloc(count, bytes); }
void* realloc(void* old, std::size_t bytes) { return ++allocations, __libc_realloc(old, bytes); }
void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  return ++allocations, __libc_memalign(alignment, bytes);
}
}

namespace {

// What has been done since it was made: allocations, system calls under a lock that may wait, and all of those.
struct Cost {
  long allocated = allocations;
  long locked_and_may_wait = system_calls::locked_and_may_wait;
  long locked = system_calls::locked;

  void tell(const char* name) const {
    const Cost now;
    std::printf("%s: %ld %ld %ld\n", name, now.allocated - allocated, now.locked_and_may_wait - locked_and_may_wait,
                now.locked - locked);
  }
};

// The first calls may make room that stays. Those after them are counted.
template <class Call>
void count(const char* name, const Call& call) {
  for (int i = 0; i < 20; ++i) call();
  const Cost before;
  for (int i = 0; i < 200; ++i) call();
  before.tell(name);
}

void count_cost(const unitylink::Link& link) {
  // show that the hooks count
  std::mutex mutex;
  count("memory", [] { std::free(std::malloc(1)); });
  count("wait under a lock", [&] {
    const std::scoped_lock lock(mutex);
    ::poll(nullptr, 0, 1);
  });
  count("look under a lock", [&] {
    const std::scoped_lock lock(mutex);
    ::poll(nullptr, 0, 0);
  });
  count("look", [] { ::poll(nullptr, 0, 0); });
  steps::Steps robot(link);
  auto cycle = robot.j[0].cycle();
  auto small = robot.targets.cycle();
  cycle.open().value();
  small.open().value();
  robot.j[1].mode.write(steps::Mode::idle).value();
  robot.published_pose.start().value();
  count("read", [&] { robot.count.read().value(); });
  count("read of two words", [&] { robot.big.read().value(); });
  count("write", [&] { robot.gain.write(1.5).value(); });
  count("write of two words", [&] { robot.exact.write(1.5).value(); });
  count("commit", [&] { robot.net.a.write(3).value(); });
  count("group", [&] { robot.targets.write({}).value(); });
  count("snapshot", [&] { robot.snapshot().value(); });
  count("cycle", [&] { cycle.exchange({}).value(); });
  count("cycle of outputs", [&] { small.exchange({}).value(); });
  count("refused", [&] { (void)cycle.exchange({.target = 9.0}); });
  count("poll", [&] { robot.published_pose.poll([](double, const auto&) {}).value(); });
  std::atomic<int> come{0};
  const unitylink::Listener listener(robot.published_pose, [&](double, const steps::StepsPublishedPose&) { ++come; });
  while (come < 3) std::this_thread::yield();
  const Cost before;
  for (const int begun = come; come < begun + 5;) cycle.exchange({}).value();
  before.tell("callback");
}

template <class T>
void tell(const char* name, const unitylink::result<T>& done) {
  std::printf("%s: %d %s\n", name, done ? 0 : done.error().status(), done ? "" : done.error().text());
}

void show_errors(const unitylink::Link& link) {
  tell("no port", unitylink::Link::open("tcp://127.0.0.1:1"));
  tell("no url", unitylink::Link::open("nonsense"));
  auto robot = steps::Steps::on(link);
  tell("robot", robot);
  if (!robot) return;
  tell("range", robot->small.write(101));
  tell("not a number", robot->j[1].target.write(std::nan("")));
  tell("not a member", robot->j[0].mode.write(static_cast<steps::Mode>(2)));
  tell("not started", robot->published_pose.wait(std::chrono::seconds(1)));
  try {
    robot->gain.write(11.0).value();
  } catch (const unitylink::Failure& failure) {
    std::printf("thrown: %d %s\n", failure.status(), failure.what());
  }
  tell("empty queue", robot->queue.sample.read());
  tell("queue", robot->published_on_queue_arrival.start());
  std::printf("ready\n");
  std::fflush(stdout);
  std::getchar();  // until the board is gone
  tell("lost", robot->count.read());
  auto cycle = robot->cycle();
  tell("lost cycle", cycle.exchange({}));
  tell("lost write", robot->net.a.write(1));
}

}  // namespace

int main(int, char** arguments) {
  try {
    const unitylink::Link link(arguments[2]);
    std::string_view(arguments[1]) == "cost" ? count_cost(link) : show_errors(link);
  } catch (const unitylink::Failure& failure) {
    std::printf("%s\n", failure.what());
    return 1;
  }
}
