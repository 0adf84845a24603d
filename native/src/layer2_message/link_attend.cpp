// SPDX-License-Identifier: BSD-3-Clause
// A link in the loop of another thread, such as a server's. This thread leads for a long time. It waits for the device
// and for its own descriptors at once, so no message has to be handed from one thread to another.
#include <algorithm>
#include <chrono>

#include "layer0_driver/polling.hpp"
#include "layer2_message/link_state.hpp"

namespace unitylink {
namespace {

constexpr std::uint64_t gone_look_ns = 20'000'000;  // how often the thread checks whether the line is back

}  // namespace

void Link::enqueue(Exchange& exchange) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t now = now_ns();
  if (takes_requests()) {
    engine_->submit(exchange, now);
  } else {
    engine_->decline(exchange, Status::down, now);
  }
}

std::size_t Link::backlog() {
  const std::scoped_lock lock(mutex_);
  return engine_->backlog();
}

void Link::push() {
  const std::scoped_lock lock(mutex_);
  flush(now_ns());
}

bool Link::attend(int other, std::uint64_t until_ns, bool looking) {
  Lock lock(mutex_);
  if (!attended_) {
    ++listeners_;  // so that the reader rests, and does not read again at once
    while (leading_) {
      wake();
      ++followers_;
      turn_.wait(lock);
      --followers_;
    }
    attended_ = leading_ = true;
  }
  flush(now_ns());
  if (engine_->ended() || line_ != Line::up) {
    lock.unlock();
    leave();
    const std::uint64_t now = now_ns();
    pollfd waiting{other, POLLIN, 0};
    static_cast<void>(poll_for(std::span(&waiting, 1), std::min(gone_look_ns, until_ns - std::min(until_ns, now))));
    return false;
  }
  callers_ += looking ? 1 : 0;
  lead(lock, until_ns, other);
  callers_ -= looking ? 1 : 0;
  leading_ = true;  // lead() ends the role
  return true;
}

void Link::leave() {
  const std::scoped_lock lock(mutex_);
  if (!attended_) {
    return;
  }
  attended_ = leading_ = false;
  --listeners_;
  touch_steps();
  turn_.notify_all();
  idle_.notify_all();
  published_.notify_all();  // one of them reads now
}

bool Link::rest(int other, std::uint64_t until_ns) {
  leave();
  start_reader();  // it notices a line that is lost while nobody calls
  pollfd waiting{other, POLLIN, 0};
  static_cast<void>(poll_for(std::span(&waiting, 1), until_ns - std::min(until_ns, now_ns())));
  const std::scoped_lock lock(mutex_);
  return !engine_->ended() && line_ == Line::up;
}

void Link::withdraw(Exchange& exchange) {
  const std::scoped_lock lock(mutex_);
  if (!exchange.done()) {
    engine_->withdraw(std::span(&exchange, 1), now_ns());
  }
}

void Link::tap_publishes(PublishTap* tap) {
  const std::scoped_lock lock(mutex_);
  engine_->tap(tap);
}

Outcome Link::keep_publishes(std::uint32_t& id, std::size_t ring) {
  const std::scoped_lock lock(mutex_);
  Subscription* const subscription = find(id);
  if (subscription == nullptr) {
    return {Status::closed, "the subscription is closed"};
  }
  if (Outcome outcome = check_ring(ring, subscription->ring.words()); !outcome.ok()) {
    return outcome;
  }
  subscription->ring = PublishRing(subscription->ring.words(), ring);
  id = subscription->id += protocol::limits::groups_max;  // an earlier listener may still ask by its number
  return {};
}

void Link::keep_no_more(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  if (Subscription* const subscription = find(id); subscription != nullptr) {
    subscription->ring.keep_no_more();
    subscriptions_ended_ += 1;
    announce();
  }
}

}  // namespace unitylink
