// SPDX-License-Identifier: BSD-3-Clause
// The line that comes back (reconnect=1): how its loss is noticed and reported, and how it is opened and set up again.
//
// The reader thread does all of this. Such a link keeps it as long as the link exists. While the line is gone there is
// no leader, and requests are declined. Requests that were in flight are reported as unknown, or as not sent. None of
// them is sent again. Subscriptions, exchange groups, publishing and the dead-man are set up again.
#include <algorithm>
#include <chrono>

#include "layer2_message/failure.hpp"
#include "layer2_message/link_state.hpp"

namespace unitylink {
namespace {

// before the second attempt; doubled before each later one
constexpr std::uint64_t pause_first_ns = 10'000'000;
constexpr std::uint64_t pause_most_ns = 1'000'000'000;
// after so long without a byte, the link asks whether the device is there
constexpr std::uint64_t silence_ns = 500'000'000;
constexpr std::uint64_t program_look_ns = 20'000'000;  // how often the reader checks whether the program works again
constexpr double program_patience_most_s = 3600;
constexpr std::size_t events_kept = 64;

// Makes an attempt. Without memory, descriptors or threads it fails, and the next one may succeed.
template <class Act>
Outcome attempted(const Act& act) noexcept {
  try {
    return act();
  } catch (const std::exception&) {
    Outcome outcome;
    outcome.status = Status::closed;
    return outcome;
  }
}

}  // namespace

// From now on the loss of the line does not end the link.
void Link::last() {
  {
    const std::scoped_lock lock(mutex_);
    lasts_ = reader_kept_ = true;
    engine_->set_lasting();
    classic_.set_lasting();
    heard_ns_ = now_ns();
  }
  start_reader();
}

bool Link::takes_requests() const noexcept {
  return engine_->ended() || line_ == Line::up || (line_ == Line::opening && std::this_thread::get_id() == restorer_);
}

// ---- reads that wait for the line (wait= in the URL)

bool Link::waits_for_line(std::span<const Exchange> exchanges) const noexcept {
  return lasts_ && options_.wait_ns > 0 && std::this_thread::get_id() != restorer_ &&
         std::all_of(exchanges.begin(), exchanges.end(), [](const Exchange& exchange) {
           const bool reads = exchange.operation == Operation::read || exchange.operation == Operation::read_many ||
                              exchange.operation == Operation::read_control;
           return reads && exchange.repeat;
         });
}

// Whether one of the reads was cut off. Then all of them are made again.
bool Link::was_cut(std::span<Exchange> exchanges) noexcept {
  if (std::none_of(exchanges.begin(), exchanges.end(),
                   [](const Exchange& exchange) { return exchange.status == Status::down; })) {
    return false;
  }
  for (Exchange& exchange : exchanges) {
    if (exchange.batch != nullptr) {
      exchange.batch->failed = false;
    }
  }
  return true;
}

bool Link::wait_for_line(Lock& lock, std::uint64_t until_ns) {
  while (line_ != Line::up && !engine_->ended()) {
    const std::uint64_t now = now_ns();
    if (now >= until_ns || interrupted(lock)) {
      return false;
    }
    wait(lock, published_, std::min(until_ns, now + 100'000'000));
  }
  return !engine_->ended();
}

Outcome Link::wait_up(std::uint64_t timeout_ns) {
  Lock lock(mutex_);
  const std::uint64_t now = now_ns();
  const std::uint64_t until_ns = timeout_ns < Engine::no_deadline - now ? now + timeout_ns : Engine::no_deadline;
  if (wait_for_line(lock, until_ns)) {
    return {};
  }
  if (engine_->ended()) {
    return end();
  }
  const std::string tried = trouble_.empty() ? "" : "; attempt " + std::to_string(attempts_) + ": " + trouble_;
  return {Status::down, "the line is gone (" + lost_because_ + ") and is being opened again" + tried};
}

// ---- events

void Link::tell(LinkEvent::Kind kind, std::string_view text) noexcept {
  generation_ += kind == LinkEvent::Kind::lost ? 0 : 1;
  try {
    events_.push_back({kind, now_ns(), in_words([&] { return std::string(text); })});
    events_made_ += 1;
  } catch (const std::bad_alloc&) {  // the event is left out, but generation() has changed
  }
  if (events_.size() > events_kept) {
    events_.pop_front();
  }
  announce();
}

// Reports each restart of the device that the engine has counted.
void Link::notice_restarts() noexcept {
  if (engine_->statistics().restarts != restarts_seen_) {
    restarts_seen_ = engine_->statistics().restarts;
    tell(LinkEvent::Kind::restarted, "the device was reset, or another program has had it");
  }
}

std::vector<LinkEvent> Link::events(std::uint64_t& from) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t first = events_made_ - events_.size();
  const std::uint64_t skipped = std::min<std::uint64_t>(events_.size(), from > first ? from - first : 0);
  from = events_made_;
  return {events_.begin() + static_cast<std::ptrdiff_t>(skipped), events_.end()};
}

// ---- loss

void Link::lose(Status status, std::string_view reason) noexcept {
  if (!lasts_) {
    fail(status, reason);
    return;
  }
  if (engine_->ended() || line_ == Line::gone) {
    return;
  }
  const bool was_up = line_ == Line::up;
  line_ = Line::gone;
  blocked_ = false;
  lost_ns_ = now_ns();
  if (was_up) {
    lost_because_ = in_words([&] { return std::string(reason); });
    trouble_.clear();
    attempts_ = 0;
  } else {
    trouble_ = in_words([&] { return std::string(reason); });
  }
  engine_->cut(Status::down, lost_ns_);
  turn_.notify_all();
  idle_.notify_all();
  if (was_up) {
    tell(LinkEvent::Kind::lost, reason);
  } else {
    announce();
  }
}

// When the reader asks whether the device is there, if no byte arrives before.
std::uint64_t Link::look_ns() const noexcept { return lasts_ ? heard_ns_ + silence_ns : Engine::no_deadline; }

void Link::look_after(Lock& lock) {
  std::uint32_t word = 0;
  Exchange question;
  prepare(question, {.checked = std::nullopt, .repeat = true, .timeout_ns = 0});
  question.operation = framed_ ? Operation::read_control : Operation::resynchronise;
  question.address = protocol::control::magic;
  question.values = std::span(&word, 1);
  lock.unlock();
  run(std::span(&question, 1));
  lock.lock();
  // so that the next question comes soon, but not at once
  heard_ns_ = std::max(heard_ns_, now_ns() - std::min(now_ns(), silence_ns / 2));
  if (question.status == Status::timeout) {
    lose(Status::timeout, "the device does not answer");
  }
}

// ---- the program

Outcome Link::watch_program(double patience_s) {
  if (mapped_ && patience_s != 0) {
    return {Status::mismatch, "mapped memory has no dead-man, and no line that could be given up"};
  }
  if (!(patience_s >= 0 && patience_s <= program_patience_most_s)) {
    return {Status::range, "the time to wait for a program is 0 to 3600 s, not " + std::to_string(patience_s)};
  }
  program_patience_ns_ = static_cast<std::uint64_t>(patience_s * 1e9);
  program_until_ns_ = program_patience_ns_ > 0 ? now_ns() + program_patience_ns_ : Engine::no_deadline;
  if (program_patience_ns_ > 0) {
    start_reader();  // it checks the time while nobody calls
    const std::scoped_lock lock(mutex_);
    wake();
  }
  return {};
}

void Link::alive() noexcept {
  if (const std::uint64_t patience_ns = program_patience_ns_; patience_ns > 0) {
    program_until_ns_ = now_ns() + patience_ns;
  }
}

// ---- the way back

// The reader makes one attempt.
void Link::reopen(Lock& lock) {
  while (leading_) {
    wake();
    ++followers_;
    turn_.wait(lock);
    --followers_;
  }
  driver_.reset();
  const auto over = [this] { return engine_->ended() || !reader_wanted_; };
  if (!program_lives()) {
    idle_.wait_for(lock, std::chrono::nanoseconds(program_look_ns), over);
    return;
  }
  if (attempts_ > 0) {
    const std::uint64_t pause_ns = std::min(pause_most_ns, pause_first_ns << std::min(attempts_ - 1, 10u));
    idle_.wait_for(lock, std::chrono::nanoseconds(pause_ns), over);
  }
  if (over()) {
    return;
  }
  attempts_ += 1;
  lock.unlock();
  std::unique_ptr<Driver> fresh;
  Outcome outcome = attempted([&] { return source_->open(fresh, cancel_descriptor_.get()); });
  lock.lock();
  if (over()) {
    return;
  }
  if (outcome.ok()) {
    driver_ = std::move(fresh);
    driver_->messages_end_with(static_cast<std::uint8_t>(
        framed_ ? protocol::frame::delimiter : static_cast<std::uint8_t>(protocol::bytes::line_feed)));
    line_ = Line::opening;
    restorer_ = std::this_thread::get_id();
    lock.unlock();
    outcome = attempted([&] { return restore(); });
    lock.lock();
    restorer_ = {};
    if (engine_->ended()) {
      return;
    }
    if (outcome.ok() && line_ == Line::opening) {
      line_ = Line::up;
      heard_ns_ = now_ns();
      engine_->statistics().reconnections += 1;
      tell(LinkEvent::Kind::back, in_words([&] {
             return attempts_ == 1 ? "at the first attempt" : "after " + std::to_string(attempts_) + " attempts";
           }));
      return;
    }
    if (line_ == Line::opening) {
      lose(outcome.status, outcome.text);
    }
  } else {
    trouble_ = std::move(outcome.text);
  }
}

// Sets the device up as before. On a framed link, FramedEngine does this in each new session.
Outcome Link::restore() {
  Exchange exchange;
  prepare(exchange, {.checked = std::nullopt, .repeat = true, .timeout_ns = 0});
  exchange.operation = Operation::resynchronise;
  run(std::span(&exchange, 1));
  Outcome outcome = outcome_of(exchange);
  if (!outcome.ok()) {
    return outcome;
  }
  // locked only now, so that nobody who closes a subscription waits for a silent device
  const std::scoped_lock one_at_a_time(configuring_);
  if (framed_) {
    return stop_closed_groups();
  }
  if (!quieted_) {
    return {};
  }
  quieted_ = false;
  outcome = quiet_device();
  bool any = false;
  for (std::uint32_t group = 0; group < configuration_.groups && outcome.ok(); ++group) {
    std::shared_ptr<Subscription> subscription;
    {
      const std::scoped_lock lock(mutex_);
      subscription = subscriptions_[group];
    }
    if (subscription && subscription->open) {
      any = true;
      outcome = configure_group(group, *subscription);
    }
  }
  if (outcome.ok() && any) {
    outcome = command(options_.publish_checked && checksums_ ? Operation::enable_checked_publishing
                                                             : Operation::enable_publishing);
  }
  quieted_ = true;  // also after a failure, so that the next attempt does all of it again
  return outcome;
}

// Stops groups whose subscriptions were closed while FramedEngine set them up.
Outcome Link::stop_closed_groups() {
  for (std::uint32_t group = 0; group < configuration_.groups; ++group) {
    bool closed = false;
    {
      const std::scoped_lock lock(mutex_);
      const std::shared_ptr<Subscription>& subscription = subscriptions_[group];
      closed = subscription && std::exchange(subscription->closed_unheard, false);
    }
    if (closed) {
      if (Outcome outcome = set_rate(group, 0); !outcome.ok()) {
        return outcome;
      }
    }
  }
  return {};
}

}  // namespace unitylink
