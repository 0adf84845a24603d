// SPDX-License-Identifier: BSD-3-Clause
#include "failing.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <dlfcn.h>
#include <fcntl.h>
#include <new>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace unitylink::failing {

thread_local int Exempt::depth = 0;

namespace {

constexpr int several = 100;

std::atomic<What> armed = What::nothing;
std::atomic<How> manner = How::once;
std::atomic<std::int64_t> left = 0;       // calls until one fails
std::atomic<std::int64_t> hour_s = 0;     // the clock has jumped by so much
std::atomic<std::int64_t> stands_ns = 0;  // the time at which the clock stands still

// How many calls ago one had to fail: 0: this one; negative: not yet.
std::int64_t due(What what) noexcept {
  return armed.load(std::memory_order_relaxed) == what && Exempt::depth == 0 ? -(left.fetch_sub(1) - 1) : -1;
}

template <class Function>
Function* system_own(const char* name) noexcept {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

int number_of(How how) noexcept {
  switch (how) {
    case How::interrupted: return EINTR;
    case How::again: return EAGAIN;
    case How::none_left: return EMFILE;
    default: return EIO;
  }
}

// Whether a call that moves `bytes` must fail now. Then `result` replaces the real one. (one_byte only limits `bytes`.)
bool instead(std::size_t& bytes, ssize_t& result) noexcept {
  if (due(What::transfer) != 0) {
    return false;
  }
  if (manner == How::one_byte) {
    bytes = std::min<std::size_t>(bytes, 1);
    return false;
  }
  result = manner == How::nothing ? 0 : -1;
  errno = number_of(manner);
  return true;
}

// Whether a call that opens something, or sets it up, must fail now. It sets errno.
bool refused() noexcept {
  if (due(What::opening) != 0) {
    return false;
  }
  errno = number_of(manner);
  return true;
}

// Whether an allocation must fail now. It sets errno.
bool exhausted() noexcept {
  const std::int64_t ago = due(What::allocation);
  if (ago < 0 || (ago > 0 && (manner != How::from_then_on || ago >= several))) {
    return false;
  }
  errno = ENOMEM;
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
  stands_ns = hour_s = 0;  // all threads that have seen these times have ended
  return left <= 0;
}

}  // namespace unitylink::failing

using namespace unitylink::failing;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

void* operator new(std::size_t bytes) {
  void* const place = exhausted() ? nullptr : std::malloc(bytes > 0 ? bytes : 1);
  if (place == nullptr) {
    throw std::bad_alloc();
  }
  return place;
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }

extern "C" {

#else

extern "C" {

// The functions of the C library itself. These names exist for programs that replace malloc.
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* place, std::size_t bytes);

void* malloc(std::size_t bytes) noexcept { return exhausted() ? nullptr : __libc_malloc(bytes); }
void* calloc(std::size_t count, std::size_t bytes) noexcept {
  return exhausted() ? nullptr : __libc_calloc(count, bytes);
}
void* realloc(void* place, std::size_t bytes) noexcept { return exhausted() ? nullptr : __libc_realloc(place, bytes); }

#endif

int open(const char* path, int flags, ...) {
  static auto* const own = system_own<int(const char*, int, ...)>("open");
  std::va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return refused() ? -1 : own(path, flags, mode);
}

int socket(int family, int type, int protocol) noexcept {
  static auto* const own = system_own<int(int, int, int)>("socket");
  return refused() ? -1 : own(family, type, protocol);
}

int connect(int file, const sockaddr* address, socklen_t size) {
  static auto* const own = system_own<int(int, const sockaddr*, socklen_t)>("connect");
  return refused() ? -1 : own(file, address, size);
}

int getsockopt(int file, int level, int name, void* value, socklen_t* size) noexcept {
  static auto* const own = system_own<int(int, int, int, void*, socklen_t*)>("getsockopt");
  return refused() ? -1 : own(file, level, name, value, size);
}

int setsockopt(int file, int level, int name, const void* value, socklen_t size) noexcept {
  static auto* const own = system_own<int(int, int, int, const void*, socklen_t)>("setsockopt");
  return refused() ? -1 : own(file, level, name, value, size);
}

int eventfd(unsigned count, int flags) noexcept {
  static auto* const own = system_own<int(unsigned, int)>("eventfd");
  return refused() ? -1 : own(count, flags);
}

int fcntl(int file, int what, ...) {
  static auto* const own = system_own<int(int, int, ...)>("fcntl");
  std::va_list rest;
  va_start(rest, what);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return refused() ? -1 : own(file, what, argument);
}

int ioctl(int file, unsigned long what, ...) noexcept {
  static auto* const own = system_own<int(int, unsigned long, ...)>("ioctl");
  std::va_list rest;
  va_start(rest, what);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return refused() ? -1 : own(file, what, argument);
}

int flock(int file, int what) noexcept {
  static auto* const own = system_own<int(int, int)>("flock");
  return refused() ? -1 : own(file, what);
}

int isatty(int file) noexcept {
  static auto* const own = system_own<int(int)>("isatty");
  return refused() ? 0 : own(file);
}

int fstat(int file, struct stat* told) noexcept {
  static auto* const own = system_own<int(int, struct stat*)>("fstat");
  return refused() ? -1 : own(file, told);
}

void* mmap(void* place, std::size_t bytes, int may, int flags, int file, off_t offset) noexcept {
  static auto* const own = system_own<void*(void*, std::size_t, int, int, int, off_t)>("mmap");
  return file >= 0 && refused() ? MAP_FAILED : own(place, bytes, may, flags, file, offset);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*begin)(void*), void* argument) {
  static auto* const own =
      system_own<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create");
  return refused() ? EAGAIN : own(thread, attributes, begin, argument);
}

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

// Its deadline was computed from the clock that jumps.
int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  static auto* const own =
      system_own<int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*)>("pthread_cond_clockwait");
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
