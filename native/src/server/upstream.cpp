// SPDX-License-Identifier: BSD-3-Clause
#include "server/upstream.hpp"

#include <algorithm>
#include <utility>

namespace unitylink::server {
namespace {

// Requests that wait in the link: enough that the line does not rest, and few, because what is there has no turn any
// more.
constexpr std::size_t held_most = 4;
constexpr std::size_t words_most = 1u << 20;  // bytes of publishes between two harvests; more are left out

}  // namespace

Errand& Upstream::errand() {
  if (idle_.empty()) {
    errands_.push_back(std::make_unique<Errand>());
    idle_.push_back(errands_.back().get());
    const std::scoped_lock lock(mutex_);
    arrived_.done.reserve(errands_.size());  // on_done() must not allocate
  }
  Errand& errand = *idle_.back();
  idle_.pop_back();
  errand.exchange = Exchange{};
  errand.body.clear();
  errand.answer.clear();
  errand.posts.clear();
  errand.post_words.clear();
  errand.joined.clear();
  errand.shareable = false;
  errand.home = this;
  errand.session = nullptr;
  return errand;
}

void Upstream::submit(Errand& errand) {
  if (turns_.empty() && link_.backlog() < held_most) {
    send(errand);
  } else if (turns_.add(errand)) {
    push();
  } else {
    recycle(errand);
  }
}

void Upstream::push() {
  std::size_t held = link_.backlog();
  while (!turns_.empty()) {
    if (held >= held_most) {
      link_.push();
      held = link_.backlog();
      if (held >= held_most) {
        return;
      }
    }
    send(turns_.next());
    held += 1;
  }
}

void Upstream::send(Errand& errand) {
  Exchange& exchange = errand.exchange;
  exchange.operation = Operation::forward;
  exchange.repeat = false;
  exchange.body = errand.body;
  exchange.answer = errand.answer;
  exchange.attempts_max = link_.options().attempts;
  exchange.owner = &errand;
  exchange.on_done = &Upstream::on_done;
  under_way_.push_back(&errand);
  link_.enqueue(exchange);
}

void Upstream::abandon(const Session& session) {
  for (Errand* const errand : under_way_) {
    if (errand->session != nullptr && !errand->drop(session)) {
      link_.withdraw(errand->exchange);
    }
  }
  turns_.leave(session, idle_);
}

void Upstream::on_done(Exchange& exchange) noexcept {
  auto* const errand = static_cast<Errand*>(exchange.owner);
  const std::scoped_lock lock(errand->home->mutex_);
  errand->home->arrived_.done.push_back(errand);
}

void Upstream::on_publish(std::uint32_t group, std::uint32_t missing, std::uint32_t clock,
                          std::span<const std::uint8_t> words) noexcept {
  const std::scoped_lock lock(mutex_);
  if (arrived_.words.size() + words.size() > words_most) {
    return;
  }
  try {
    const std::size_t begin = arrived_.words.size();
    arrived_.words.insert(arrived_.words.end(), words.begin(), words.end());
    arrived_.publishes.push_back({group, missing, clock, begin, arrived_.words.size()});
  } catch (const std::bad_alloc&) {  // it is left out, and its readers see the gap in the sequence
  }
}

const Upstream::Harvest& Upstream::harvest() {
  harvested_.done.clear();
  harvested_.done.reserve(errands_.size());  // here, because a caller may make errands while it reads the last harvest
  harvested_.publishes.clear();
  harvested_.words.clear();
  {
    const std::scoped_lock lock(mutex_);
    std::swap(arrived_, harvested_);
  }
  for (Errand* const errand : harvested_.done) {
    under_way_.erase(std::find(under_way_.begin(), under_way_.end(), errand));
  }
  return harvested_;
}

}  // namespace unitylink::server
