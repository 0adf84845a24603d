// SPDX-License-Identifier: BSD-3-Clause
#include "failing.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <dlfcn.h>
#include <new>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

namespace unitylink::failing {

thread_local int Exempt::depth = 0;

namespace {

constexpr int several = 100;

std::atomic<What> armed = What::nothing;
std::atomic<How> manner = How::once;
std::atomic<std::int64_t> left = 0;       // until it happens
std::atomic<std::int64_t> hour_s = 0;     // that has passed since
std::atomic<std::int64_t> stands_ns = 0;  // the clock, where it does

// How many times ago it was due: 0 now, negative not yet.
std::int64_t due(What what) noexcept {
  return armed.load(std::memory_order_relaxed) == what && Exempt::depth == 0 ? -(left.fetch_sub(1) - 1) : -1;
}

template <class Function>
Function* system_own(const char* name) noexcept {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// What a call that moves `bytes` gives in place of the real one, if it is its turn.
bool instead(std::size_t& bytes, ssize_t& result) noexcept {
  if (due(What::transfer) != 0) {
    return false;
  }
  switch (manner) {
    case How::one_byte: bytes = std::min<std::size_t>(bytes, 1); return false;
    case How::nothing: result = 0; return true;
    case How::interrupted: errno = EINTR; break;
    case How::again: errno = EAGAIN; break;
    default: errno = EIO; break;
  }
  result = -1;
  return true;
}

}  // namespace

void arm(What what, How how, std::uint32_t nth) noexcept {
  manner = how;
  left = nth;
  armed = what;
}

bool disarm() noexcept {
  armed = What::nothing;
  stands_ns = hour_s = 0;  // nobody is left who has seen them
  return left <= 0;
}

}  // namespace unitylink::failing

using namespace unitylink::failing;

void* operator new(std::size_t bytes) {
  const std::int64_t ago = due(What::allocation);
  if (ago >= 0 && (ago == 0 || (manner == How::from_then_on && ago < several))) {
    throw std::bad_alloc();
  }
  void* place = std::malloc(bytes > 0 ? bytes : 1);
  if (place == nullptr) {
    throw std::bad_alloc();
  }
  return place;
}

void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }

extern "C" {

ssize_t read(int file, void* room, std::size_t bytes) {
  static auto* const own = system_own<ssize_t(int, void*, std::size_t)>("read");
  ssize_t result = 0;
  return instead(bytes, result) ? result : own(file, room, bytes);
}

ssize_t write(int file, const void* from, std::size_t bytes) {
  static auto* const own = system_own<ssize_t(int, const void*, std::size_t)>("write");
  ssize_t result = 0;
  return instead(bytes, result) ? result : own(file, from, bytes);
}

ssize_t send(int file, const void* from, std::size_t bytes, int flags) {
  static auto* const own = system_own<ssize_t(int, const void*, std::size_t, int)>("send");
  ssize_t result = 0;
  return instead(bytes, result) ? result : own(file, from, bytes, flags);
}

int ppoll(pollfd* files, nfds_t count, const timespec* time, const sigset_t* signals) {
  static auto* const own = system_own<int(pollfd*, nfds_t, const timespec*, const sigset_t*)>("ppoll");
  std::size_t bytes = 0;
  ssize_t result = 0;
  return instead(bytes, result) ? static_cast<int>(result) : own(files, count, time, signals);
}

// Its deadline was made from that clock.
int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  static auto* const own = system_own<int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*)>("pthread_cond_clockwait");
  timespec real = *until;
  if (clock == CLOCK_MONOTONIC && Exempt::depth == 0) {
    real.tv_sec -= hour_s;
  }
  return own(condition, mutex, clock, &real);
}

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  static auto* const own = system_own<int(clockid_t, timespec*)>("clock_gettime");
  const int result = own(clock, time);
  if (clock != CLOCK_MONOTONIC || Exempt::depth > 0) {
    return result;
  }
  const std::int64_t ago = due(What::clock);
  if (ago == 0 && manner == How::from_then_on) {
    hour_s += 3600;
  }
  time->tv_sec += hour_s;
  const std::int64_t now_ns = time->tv_sec * 1'000'000'000 + time->tv_nsec;
  if (ago == 0 && manner == How::once) {
    stands_ns = now_ns;
  }
  if (ago > 0 && ago < several && manner == How::once && stands_ns != 0) {
    time->tv_sec = stands_ns / 1'000'000'000;
    time->tv_nsec = stands_ns % 1'000'000'000;
  }
  return result;
}

}
