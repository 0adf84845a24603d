// SPDX-License-Identifier: BSD-3-Clause
// Sessions and time: how a session begins, how its loss is noticed and reported, and when an answer is late.
#include <algorithm>

#include "layer2_message/framed_engine.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::uint32_t openings_max = 3;
constexpr std::uint32_t vain_at_once = 4;  // so many HELLOs and OPENs follow each other without a pause
constexpr std::uint32_t vain_doublings = 16;
constexpr std::uint64_t vain_pause_ns = 1'000'000;  // the first pause
// after so many transmissions of one request, the engine asks whether the session still exists
constexpr std::uint32_t unanswered_max = 2;
constexpr std::uint32_t first_exchange = 1 + limits::groups_max;  // after the dead-man and the groups
constexpr std::uint32_t restoration_steps = first_exchange + limits::exchanges_max + 1;  // publishing
constexpr std::uint32_t restoration_attempts = 1000;  // enough attempts, so that only the end of the session ends it
constexpr std::uint64_t clock_interval_soon_ns = 20'000'000;
constexpr std::uint64_t clock_interval_late_ns = 500'000'000;
constexpr std::uint32_t keep_alive_part = 3;  // a sign of life comes after this part of the dead-man's time
// The first epoch is random. This step goes through all other epochs before one comes again. If each were random, a
// message that is late by some sessions would meet its own epoch once in 65,280.
constexpr std::uint32_t epoch_step = 40'343;  // prime to `epochs`

}  // namespace

void FramedEngine::ask() noexcept {
  state_ = state_ == State::open ? State::checking : State::greeting;
  greet();
  greeting_wait_ns_ = smoothed_ns_ == 0
                          ? settings_.timeout_ns
                          : std::min(settings_.timeout_ns, 4 * (smoothed_ns_ + 4 * variation_ns_) + 2'000'000);
}

// Sends HELLO or OPEN, depending on the state. It is sent at once, or after a pause if the last ones had no effect.
void FramedEngine::greet() noexcept {
  if (greeting_due_) {
    return;
  }
  greeting_due_ = true;
  in_vain_ += 1;
  const std::uint32_t doublings = std::min(in_vain_ - std::min(in_vain_, vain_at_once + 1), vain_doublings);
  greeting_from_ns_ =
      in_vain_ <= vain_at_once ? 0 : greeting_sent_ns_ + std::min(settings_.timeout_ns, vain_pause_ns << doublings);
}

// The device does not know frames, or only those of another version.
void FramedEngine::refuse() noexcept {
  state_ = State::silent;
  while (!waiting_.empty()) {
    waiting_.front()->sent = true;
    finish(waiting_.pop_front(), Status::mismatch);
  }
}

void FramedEngine::on_greeting(const Greeting& told) noexcept {
  last_answer_ns_ = now_ns_;
  const bool asked = state_ == State::greeting || state_ == State::checking ||
                     (state_ == State::opening && told.nonce != greeting_->nonce);
  if (!asked) {
    statistics_.stale_replies += 1;
    return;
  }
  if (greeting_ && (told.version != frame::version || !greeting_->same_device(told))) {
    end(Status::mismatch, now_ns_);
    return;
  }
  if (told.version != frame::version) {
    refuse();
    return;
  }
  greeting_ = told;
  notice_restart(told.epoch);
  if (state_ == State::checking) {
    if (told.epoch == epoch()) {
      state_ = State::open;
      greeting_due_ = false;
      for (std::uint16_t id = base_id_; id != next_id_; ++id) {
        Place& place = place_of(id);
        if (place.used) {
          ask_again(place);
        }
      }
      return;
    }
    lose_session();
  }
  offered_epoch_ = static_cast<std::uint16_t>((offered_epoch_ + epoch_step) % epochs);
  state_ = State::opening;
  openings_ = 1;
  greet();
}

// An OPEN without an answer may have opened the session that it requested.
void FramedEngine::notice_restart(std::uint32_t told_epoch) noexcept {
  if (sessions_ > 0 && told_epoch != session_epoch_ && told_epoch != offered_epoch_) {
    statistics_.restarts += 1;
    session_epoch_ = told_epoch;
  }
}

void FramedEngine::on_opened(std::uint16_t epoch, std::uint32_t clock) noexcept {
  if (state_ != State::opening || epoch != offered_epoch_) {
    statistics_.stale_replies += 1;
    return;
  }
  last_answer_ns_ = now_ns_;
  state_ = State::open;
  greeting_due_ = false;
  if ((greeting_->features & serve::feature_dated_arm) != 0) {
    server_clock_.learn(clock, opening_sent_ns_);
  }
  decoder_.set_key({.epoch = epoch, .always_long = checked_long()});
  decoder_.set_payload_max(greeting_->reply_max);
  window_ = std::min(greeting_->window, window_max);
  while (window_ > settings_.window) {
    window_ /= 2;
  }
  configuration_.address_bytes = greeting_->address_bytes;
  configuration_.data_bytes = greeting_->data_bytes;
  session_epoch_ = epoch;
  sessions_ += 1;
  statistics_.sessions += 1;
  restored_ = 0;
  restore();
}

// The session is lost. Reads in flight are sent again. All other requests in flight end as unknown.
void FramedEngine::lose_session() noexcept {
  ExchangeList again;
  look_ns_ = waiting_.empty() ? no_deadline : look_ns_;
  for (std::uint16_t id = base_id_; id != next_id_; ++id) {
    Place& place = place_of(id);
    Exchange* const exchange = place.used ? place.exchange : nullptr;
    const std::uint64_t place_limit_ns = place.limit_ns;
    place = Place{};
    if (exchange == nullptr) {
      continue;
    }
    const bool harmless = !exchange->writes() && exchange->repeat && exchange->operation != Operation::write_control;
    if (!is_own(*exchange) && harmless && exchange->attempts_max > 0) {
      exchange->state_ = Exchange::State::waiting;
      exchange->limit_ns_ = place_limit_ns;
      look_ns_ = std::min(look_ns_, place_limit_ns);
      again.push_back(*exchange);
    } else {
      finish(*exchange, exchange->operation == Operation::write_control ? Status::unknown : exchange->cut_off());
    }
  }
  waiting_.prepend(again);
  for (Exchange* waiting = waiting_.front(); waiting != nullptr; waiting = ExchangeList::after(*waiting)) {
    waiting->follows_ = 0;
  }
  forget_session();
}

// Drops what belonged to the session.
void FramedEngine::forget_session() noexcept {
  base_id_ = next_id_ = 0;
  credit_ = due_ = in_flight_ = given_up_ = 0;
  unknown_posts_ += posts_.restart();
  careful_until_ns_ = confirming_ = 0;
  gone_back_order_ = order_;
  confirm_ns_ = clock_due_ns_ = no_deadline;
  clock_.clear();
}

// Sets up a new session like the last one, one request after the other.
void FramedEngine::restore() noexcept {
  for (; restored_ < restoration_steps; ++restored_) {
    Exchange step;
    step.attempts_max = restoration_attempts;
    if (restored_ == 0 || restored_ == restoration_steps - 1) {
      const bool deadman = restored_ == 0;
      step.operation = Operation::write_control;
      step.address = deadman ? control::deadman_ticks : control::publish;
      publishing_ = publishing_ && std::any_of(groups_.begin(), groups_.end(),
                                               [](const Group& group) { return group.ring != nullptr; });
      step.value = deadman ? deadman_ticks_ : publishing_ ? 1 : 0;
      if (step.value == 0) {
        continue;
      }
    } else if (restored_ >= first_exchange) {
      const ExchangeGroup& group = exchange_groups_[restored_ - first_exchange];
      if (group.outputs.empty() && group.inputs.empty()) {
        continue;
      }
      step.operation = Operation::define_exchange;
      step.address = restored_ - first_exchange;
      step.outputs = group.outputs;
      step.inputs = group.inputs;
    } else {
      const Group& group = groups_[restored_ - 1];
      if (group.ring == nullptr) {
        continue;
      }
      step.operation = Operation::define_group;
      step.address = restored_ - 1;
      step.value = group.divisor;
      step.on_event = group.on_event;
      step.addresses = group.addresses;
      step.ring = group.ring;
    }
    ++restored_;
    restoration_ = step;
    queue(restoration_, true);
    return;
  }
  restored_most_ = 0;
}

// ---- time

std::uint64_t FramedEngine::clock_interval_ns() const noexcept {
  if (!publishing_) {
    return no_deadline - now_ns_;
  }
  return clock_.readings() < ClockFit::kept ? clock_interval_soon_ns : clock_interval_late_ns;
}

std::uint64_t FramedEngine::keep_alive_ns() const noexcept {
  const std::uint64_t hz = std::max<std::uint64_t>(1, configuration_.base_hz);
  return std::uint64_t{deadman_ticks_} * 1'000'000'000 / hz / keep_alive_part;
}

// The time that the line needs for a request when it is full, and for the answer.
std::uint64_t FramedEngine::message_allowance_ns() const noexcept {
  return greeting_ ? allowance_ns(greeting_->credit + greeting_->reply_max) : allowance_ns(greeting_bytes);
}

// The latest end of a request, sent or not. The loss of its session does not extend it.
std::uint64_t FramedEngine::limit_of(const Exchange& exchange) const noexcept {
  if (exchange.limit_ns_ != 0) {
    return exchange.limit_ns_;
  }
  const std::uint64_t attempts = std::max(1u, exchange.attempts_max);
  const std::uint64_t limit =
      std::max(exchange.begun_ns, progress_ns_) + exchange.timeout_ns * attempts + message_allowance_ns();
  return exchange.expires_ns == 0 ? limit : std::min(limit, exchange.expires_ns);
}

std::uint64_t FramedEngine::next_deadline_ns() const noexcept {
  if (ended_ || state_ == State::silent) {
    return no_deadline;
  }
  std::uint64_t next = waiting_.empty() ? no_deadline : look_ns_;
  for (std::uint16_t id = base_id_; id != next_id_; ++id) {
    const Place& place = places_[id % window_];
    if (place.used && place.exchange != nullptr) {
      next = std::min(next, place.limit_ns);
    }
    if (place.used && !place.due) {
      next = std::min(next, place.sent_ns + place.wait_ns);
    }
  }
  if (state_ != State::open) {
    return std::min(next, greeting_due_ && greeting_from_ns_ > now_ns_ ? greeting_from_ns_ : greeting_deadline_ns_);
  }
  if (std::any_of(confirmations_.begin(), confirmations_.end(), [this](const Exchange& own) { return idle(own); })) {
    next = std::min(next, confirm_ns_);
  }
  if (idle(reading_)) {
    next = std::min(next, clock_due_ns_);
    next = deadman_ticks_ > 0 ? std::min(next, last_sent_ns_ + keep_alive_ns()) : next;
  }
  return next;
}

void FramedEngine::advance(std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (ended_ || now_ns < next_deadline_ns()) {
    return;
  }
  for (std::uint16_t id = base_id_; id != next_id_; ++id) {
    Place& place = place_of(id);
    if (place.used && place.exchange != nullptr && now_ns >= place.limit_ns) {
      give_up(place);
    } else if (place.used && !place.due && now_ns >= place.sent_ns + place.wait_ns) {
      expire(place);
    }
  }
  if (!waiting_.empty() && now_ns >= look_ns_) {
    end_late();
  }
  const bool asking = state_ == State::greeting || state_ == State::opening || state_ == State::checking;
  if (asking && !greeting_due_ && now_ns >= greeting_deadline_ns_) {
    statistics_.timeouts += 1;
    if (state_ == State::opening && (openings_++ >= openings_max || in_vain_ > vain_at_once)) {
      state_ = State::greeting;
    }
    greeting_due_ = true;
    greeting_from_ns_ = 0;
    greeting_wait_ns_ = std::min(settings_.timeout_ns, 2 * greeting_wait_ns_);
    if (state_ != State::checking && waiting_.empty() && !publishing_ && deadman_ticks_ == 0) {
      state_ = State::silent;  // there are no more requests
      greeting_due_ = false;
    }
  }
}

void FramedEngine::expire(Place& place) noexcept {
  statistics_.timeouts += 1;
  if (place.exchange != nullptr && place.exchange->attempts_max == 0) {
    give_up(place);
    return;
  }
  ask_again(place);
  const std::uint64_t most = place.exchange != nullptr ? place.exchange->timeout_ns : settings_.timeout_ns;
  place.wait_ns = std::max(place.wait_ns, std::min(most, 2 * place.wait_ns));
  if (state_ == State::open && place.transmissions >= unanswered_max) {
    ask();
  }
}

// Its caller gets the result, and a SYNC takes its id over.
void FramedEngine::give_up(Place& place) noexcept {
  Exchange& exchange = *place.exchange;
  place.exchange = nullptr;
  given_up_ += 1;
  place.refusal.reset();
  place.doubted = false;
  place.wait_ns = settings_.timeout_ns;
  ask_again(place);
  finish(exchange, exchange.operation == Operation::write_control ? Status::unknown : exchange.cut_off());
}

// Ends the requests that have waited too long.
void FramedEngine::end_late() noexcept {
  take_back([this](const Exchange& exchange) { return now_ns_ >= limit_of(exchange); });
  look_ns_ = no_deadline;
  for (const Exchange* waiting = waiting_.front(); waiting != nullptr; waiting = ExchangeList::after(*waiting)) {
    look_ns_ = std::min(look_ns_, limit_of(*waiting));
  }
}

template <class Wanted>
void FramedEngine::take_back(Wanted wanted) noexcept {
  ExchangeList remaining;
  ExchangeList over;
  while (!waiting_.empty()) {
    Exchange& exchange = waiting_.pop_front();
    (wanted(exchange) ? over : remaining).push_back(exchange);
  }
  waiting_ = remaining;
  while (!over.empty()) {
    Exchange& exchange = over.pop_front();
    finish(exchange, exchange.attempts_max == 0 ? exchange.cut_off() : Status::timeout);
  }
}

void FramedEngine::abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept {
  withdraw(exchanges, now_ns);
  for (std::uint16_t id = base_id_; id != next_id_; ++id) {
    Place& place = place_of(id);
    if (place.used && place.exchange != nullptr && place.exchange->attempts_max == 0) {
      give_up(place);
    }
  }
}

void FramedEngine::withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  for (Exchange& exchange : exchanges) {
    exchange.attempts_max = 0;
    exchange.timeout_ns = std::min(exchange.timeout_ns, settings_.timeout_ns);
  }
  take_back([](const Exchange& exchange) { return exchange.attempts_max == 0; });
  for (std::uint16_t id = base_id_; id != next_id_; ++id) {
    Place& place = place_of(id);
    if (place.used && place.exchange != nullptr && place.exchange->attempts_max == 0) {
      place.limit_ns = std::min(place.limit_ns, now_ns + place.exchange->timeout_ns);
    }
  }
}

void FramedEngine::forget(Status status) noexcept {
  ended_ = status;
  waiting_ = {};
  base_id_ = next_id_ = 0;
}

void FramedEngine::end(Status status, std::uint64_t now_ns) noexcept {
  if (!ended_) {
    ended_ = status;
    finish_all(status, now_ns, false);
    base_id_ = next_id_ = 0;
  }
}

void FramedEngine::cut(Status status, std::uint64_t now_ns) noexcept {
  if (ended_) {
    return;
  }
  finish_all(status, now_ns, true);
  for (Place& place : places_) {
    place = Place{};
  }
  forget_session();
  server_clock_.forget();  // the next server may have another one
  decoder_.reset();
  decoder_.set_key(FrameKey{});  // publishes of the old session must not count in the new one
  text_ = greeting_due_ = false;
  in_vain_ = 0;
  greeting_from_ns_ = 0;
  pending_begin_ = pending_end_ = 0;
  state_ = State::silent;
}

// `strict`: the value of a control register is unknown, too.
void FramedEngine::finish_all(Status status, std::uint64_t now_ns, bool strict) noexcept {
  now_ns_ = now_ns;
  for (std::uint16_t id = base_id_; id != next_id_; ++id) {
    Place& place = place_of(id);
    if (place.used && place.exchange != nullptr) {
      const bool changes =
          place.exchange->writes() || (strict && place.exchange->operation == Operation::write_control);
      finish(*place.exchange, changes ? Status::unknown : status);
    }
  }
  while (!waiting_.empty()) {
    finish(waiting_.pop_front(), status);
  }
}

}  // namespace unitylink
