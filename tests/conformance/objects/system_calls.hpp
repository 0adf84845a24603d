// SPDX-License-Identifier: BSD-3-Clause
// Counts the system calls that a thread makes while it holds a lock. Those that may wait are counted apart: then a
// thread that wants the lock waits for the device, too. A program includes this once.
#pragma once

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include <atomic>

namespace system_calls {

inline thread_local int locks = 0;                // that this thread holds
inline std::atomic<long> locked{0};               // system calls under a lock
inline std::atomic<long> locked_and_may_wait{0};  // those of them that may wait

// The C library's own function behind the one that this program replaces.
template <class Function>
Function* behind(const char* name, Function*) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

inline void made(bool may_wait) {
  if (locks == 0) return;
  ++locked;
  if (may_wait) ++locked_and_may_wait;
}

inline bool waits(int descriptor) { return (fcntl(descriptor, F_GETFL) & O_NONBLOCK) == 0; }

// A wait for news gives its own lock back. Any other is held meanwhile.
template <class Wait>
int wait_for_news(const Wait& wait) {
  --locks;
  made(true);
  const int status = wait();
  ++locks;
  return status;
}

}  // namespace system_calls

#define UL_BEHIND(name) static auto* const behind = system_calls::behind(#name, &::name)

extern "C" {
int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  UL_BEHIND(pthread_mutex_lock);
  const int status = behind(mutex);
  if (status == 0) ++system_calls::locks;
  return status;
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) noexcept {
  UL_BEHIND(pthread_mutex_trylock);
  const int status = behind(mutex);
  if (status == 0) ++system_calls::locks;
  return status;
}
int pthread_mutex_unlock(pthread_mutex_t* mutex) noexcept {
  UL_BEHIND(pthread_mutex_unlock);
  --system_calls::locks;
  return behind(mutex);
}
int pthread_cond_wait(pthread_cond_t* news, pthread_mutex_t* mutex) {
  UL_BEHIND(pthread_cond_wait);
  return system_calls::wait_for_news([&] { return behind(news, mutex); });
}
int pthread_cond_clockwait(pthread_cond_t* news, pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  UL_BEHIND(pthread_cond_clockwait);
  return system_calls::wait_for_news([&] { return behind(news, mutex, clock, until); });
}
int ppoll(pollfd* waiting, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  UL_BEHIND(ppoll);
  system_calls::made(timeout == nullptr || timeout->tv_sec != 0 || timeout->tv_nsec != 0);
  return behind(waiting, count, timeout, mask);
}
int nanosleep(const timespec* pause, timespec* left) {
  UL_BEHIND(nanosleep);
  system_calls::made(true);
  return behind(pause, left);
}
int sched_yield() noexcept {
  UL_BEHIND(sched_yield);
  system_calls::made(true);
  return behind();
}
int poll(pollfd* waiting, nfds_t count, int timeout_ms) {
  UL_BEHIND(poll);
  system_calls::made(timeout_ms != 0);
  return behind(waiting, count, timeout_ms);
}
ssize_t send(int descriptor, const void* bytes, size_t count, int flags) {
  UL_BEHIND(send);
  system_calls::made((flags & MSG_DONTWAIT) == 0 && system_calls::waits(descriptor));
  return behind(descriptor, bytes, count, flags);
}
ssize_t recv(int descriptor, void* bytes, size_t count, int flags) {
  UL_BEHIND(recv);
  system_calls::made((flags & MSG_DONTWAIT) == 0 && system_calls::waits(descriptor));
  return behind(descriptor, bytes, count, flags);
}
ssize_t read(int descriptor, void* bytes, size_t count) {
  UL_BEHIND(read);
  system_calls::made(system_calls::waits(descriptor));
  return behind(descriptor, bytes, count);
}
ssize_t write(int descriptor, const void* bytes, size_t count) {
  UL_BEHIND(write);
  system_calls::made(system_calls::waits(descriptor));
  return behind(descriptor, bytes, count);
}
}

#undef UL_BEHIND
