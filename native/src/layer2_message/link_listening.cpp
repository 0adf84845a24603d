// SPDX-License-Identifier: BSD-3-Clause
// Which thread reads while no caller waits for an answer: one that waits for publishes, else the reader thread.
#include <algorithm>
#include <chrono>
#include <thread>

#include "layer2_message/link_state.hpp"

namespace unitylink {
namespace {

// How long a thread waits before it reads for others:
constexpr std::uint64_t call_patience_ns = 250'000;      // after a call, because another call may soon follow
constexpr std::uint64_t leader_patience_ns = 1'000'000;  // while there is a leader, who may leave without a signal
                                                         // (unless it calls attend(): leave() is a signal)
constexpr std::uint64_t reader_patience_ns = 4'000'000;  // after a wait for publishes, because another may soon follow
// The reader looks less often while those who wait for publishes always come back in time: twice as long each time.
constexpr std::uint64_t reader_patience_most_ns = 32'000'000;
constexpr std::uint64_t gone_patience_ns = 100'000'000;  // while the line is gone

// The reader rests while another thread has waited for publishes for this long.
constexpr std::uint64_t reader_rest_ns = 20'000'000;
// A resting reader checks this often whether it is needed.
constexpr std::uint64_t reader_look_ns = 250'000'000;

}  // namespace

void Link::start_reader() {
  if (step_ != nullptr) {  // then it is read whenever somebody waits
    return;
  }
  const std::scoped_lock guard(reader_mutex_);
  {
    const std::scoped_lock lock(mutex_);
    if (reader_wanted_ || engine_->ended()) {
      return;
    }
    reader_wanted_ = true;
  }
  try {
    reader_ = std::thread([this] { read_loop(); });
  } catch (...) {  // no memory, or no thread: the next call that needs the reader tries again
    const std::scoped_lock lock(mutex_);
    reader_wanted_ = false;
    throw;
  }
}

void Link::stop_reader() {
  const std::scoped_lock guard(reader_mutex_);
  {
    const std::scoped_lock lock(mutex_);
    reader_wanted_ = false;
    wake();
    idle_.notify_all();
  }
  if (reader_.joinable()) {
    reader_.join();
  }
}

// Reads once for others, unless another thread reads or will soon read.
void Link::stand_in(Lock& lock, std::condition_variable& elsewhere, std::uint64_t until_ns) noexcept {
  const std::uint64_t now = now_ns();
  const std::uint64_t call_ns =
      step_ != nullptr || last_caller_ == std::this_thread::get_id() ? 0 : last_call_ns_ + call_patience_ns;
  const bool gone = line_ != Line::up;  // the reader opens it again, and calls announce() then
  if (leading_ || callers_ > 0 || now < call_ns || gone) {
    const std::uint64_t look_ns = std::min(until_ns, gone            ? now + gone_patience_ns
                                                     : now < call_ns ? call_ns
                                                     : attended_     ? Engine::no_deadline
                                                                     : now + leader_patience_ns);
    wait(lock, elsewhere, look_ns);
    return;
  }
  reader_leading_ = true;
  lead(lock, until_ns);
  touch_steps();
  reader_leading_ = false;
  hand_over();
  published_.notify_one();
}

// Waits until `ready()`, the end of the link or the timeout. A thread that waits for publishes reads them itself.
// Otherwise each publish would wake two threads: the reader, and the one that waits.
template <typename Ready>
void Link::listen(Lock& lock, std::uint64_t timeout_ns, Ready ready) {
  if (ready() || engine_->ended()) {
    return;
  }
  const std::uint64_t now = now_ns();
  const std::uint64_t until_ns = timeout_ns < Engine::no_deadline - now ? now + timeout_ns : Engine::no_deadline;
  if (reader_leading_ && listeners_ == 0) {
    wake();
  }
  ++listeners_;
  do {
    stand_in(lock, published_, until_ns);
  } while (!ready() && !engine_->ended() && now_ns() < until_ns);
  --listeners_;
  last_listened_ns_ = now_ns();
  if (reader_rests_) {
    idle_.notify_one();
  }
}

void Link::read_loop() noexcept {
  Lock lock(mutex_);
  std::uint64_t patience_ns = reader_patience_ns;
  while (reader_wanted_ && !engine_->ended()) {
    if (line_ != Line::up) {
      reopen(lock);
      continue;
    }
    const std::uint64_t look = look_ns();
    if (now_ns() >= look) {
      look_after(lock);
      continue;
    }
    const std::uint64_t heard_ns = now_ns() - last_listened_ns_;
    if (listeners_ > 0 && heard_ns > reader_rest_ns) {
      reader_rests_ = true;
      idle_.wait_for(lock, std::chrono::nanoseconds(std::min(look - now_ns(), reader_look_ns)));
      reader_rests_ = false;
    } else if (listeners_ > 0 || heard_ns < reader_patience_ns) {
      reader_patient_ = patience_ns > reader_patience_ns;
      const auto end = idle_.wait_for(lock, std::chrono::nanoseconds(std::min(look - now_ns(), patience_ns)));
      reader_patient_ = false;
      const bool woken = end == std::cv_status::no_timeout;  // perhaps by a request whose caller does not read
      patience_ns = woken ? reader_patience_ns : std::min(2 * patience_ns, reader_patience_most_ns);
    } else {
      stand_in(lock, idle_, look);
      patience_ns = reader_patience_ns;
    }
  }
  hand_over();
}

bool Link::wait_publish(std::uint32_t id, std::uint64_t timeout_ns) {
  Lock lock(mutex_);
  if (find(id) == nullptr) {
    return false;
  }
  const std::shared_ptr<Subscription> subscription = subscriptions_[group_of(id)];
  listen(lock, timeout_ns, [&] { return subscription->ring.size() > 0 || !subscription->heard(); });
  return subscription->ring.size() > 0;
}

std::uint64_t Link::wait_publishes(std::uint64_t seen, std::uint64_t timeout_ns) {
  Lock lock(mutex_);
  const auto news = [this] { return engine_->statistics().publishes + subscriptions_ended_ + events_made_; };
  listen(lock, timeout_ns, [&] { return news() != seen; });
  return news();
}

}  // namespace unitylink
