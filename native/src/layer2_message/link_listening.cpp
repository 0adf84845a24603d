// SPDX-License-Identifier: BSD-3-Clause
// Who reads while nobody waits for an answer: who waits for publishes, else the reader thread.
#include <algorithm>
#include <chrono>
#include <thread>

#include "layer2_message/link_state.hpp"

namespace unitylink {
namespace {

constexpr std::uint64_t call_patience_ns = 250'000;      // where there was one call there may soon be another
constexpr std::uint64_t leader_patience_ns = 1'000'000;  // with one who reads, and may leave without a word
// with one who waited for publishes, and does something with them
constexpr std::uint64_t reader_patience_ns = 4'000'000;
constexpr std::uint64_t gone_patience_ns = 100'000'000;  // with a line that is gone
constexpr std::uint64_t reader_look_ns = 250'000'000;    // a reader that rests looks after the line so often
constexpr std::uint64_t reader_rest_ns = 20'000'000;     // who has waited for so long is not looked after any more

}  // namespace

void Link::start_reader() {
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
  } catch (...) {  // no memory, or no thread: then there is none, and the next who wants one tries again
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

// One turn of reading for others, unless somebody else reads or is about to.
void Link::stand_in(Lock& lock, std::condition_variable& elsewhere, std::uint64_t until_ns) noexcept {
  const std::uint64_t now = now_ns();
  const std::uint64_t call_ns = last_caller_ == std::this_thread::get_id() ? 0 : last_call_ns_ + call_patience_ns;
  const bool gone = line_ != Line::up;  // the reader opens it, and announces that
  if (leading_ || callers_ > 0 || now < call_ns || gone) {
    const std::uint64_t look_ns = std::min(until_ns, gone            ? now + gone_patience_ns
                                                     : now < call_ns ? call_ns
                                                                     : now + leader_patience_ns);
    wait(lock, elsewhere, look_ns);
    return;
  }
  reader_leading_ = true;
  lead(lock, until_ns);
  reader_leading_ = false;
  hand_over();
  published_.notify_one();
}

// Until `ready()`, the end of the link or the timeout. Who waits for publishes reads them himself: the reader would
// have to wake him, a second thread woken for each publish.
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
      idle_.wait_for(lock, std::chrono::nanoseconds(reader_patience_ns));
    } else {
      stand_in(lock, idle_, look);
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
  listen(lock, timeout_ns, [&] { return subscription->ring.size() > 0 || !subscription->open; });
  return subscription->ring.size() > 0;
}

std::uint64_t Link::wait_publishes(std::uint64_t seen, std::uint64_t timeout_ns) {
  Lock lock(mutex_);
  const auto news = [this] { return engine_->statistics().publishes + subscriptions_ended_ + events_made_; };
  listen(lock, timeout_ns, [&] { return news() != seen; });
  return news();
}

}  // namespace unitylink
