// SPDX-License-Identifier: BSD-3-Clause
// The thread of a server waits for the board without its mutex. So while a board does not answer, others can still do
// what needs no board, and a stop waits for nothing.
#pragma once

#include <mutex>

#include "layer2_message/link.hpp"

namespace unitylink::server {

// Calls `call`, which waits for the board behind `link`. `mutex` is locked before and after it.
template <class Call>
auto while_unlocked(std::mutex& mutex, Link& link, const Call& call) {
  struct Unlocked {
    explicit Unlocked(std::mutex& held) : mutex(held) { mutex.unlock(); }
    ~Unlocked() { mutex.lock(); }
    std::mutex& mutex;
  };
  const Unlocked unlocked(mutex);
  link.leave();
  return call();
}

}  // namespace unitylink::server
