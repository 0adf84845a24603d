// SPDX-License-Identifier: BSD-3-Clause
// Recovery after a missing or wrong answer: the requests in flight become void, and a fence is sent.
#include "layer2_message/classic_engine.hpp"

#include <algorithm>

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::uint32_t hastened_fences_max = 8;
constexpr std::uint64_t hastened_part = 8;  // the next fence comes after this part of the timeout

}  // namespace

// Lost bytes also cause errors of form and checksum. The code for lost bytes is higher than theirs, so the highest code
// is kept.
void ClassicEngine::keep_cause(Exchange& exchange, std::uint8_t datalink_code) noexcept {
  exchange.datalink_code = std::max(exchange.datalink_code, datalink_code);
}

// The device does not report which request has lost bytes. So each waiting request reports this error if it fails.
void ClassicEngine::blame(std::uint8_t datalink_code) noexcept {
  if (datalink_code < datalink_error::physical) {
    return;
  }
  for (const ExchangeList* list : {&in_flight_, &waiting_}) {
    for (Exchange* exchange = list->front(); exchange != nullptr; exchange = ExchangeList::after(*exchange)) {
      if (exchange->attempts > 0) {
        keep_cause(*exchange, datalink_code);
      }
    }
  }
}

// The status of a request without an answer. If the device has reported damaged or lost bytes, they are the reason.
Status ClassicEngine::silence_of(const Exchange& exchange) noexcept {
  return exchange.datalink_code >= datalink_error::physical ? Status::protocol_error : Status::timeout;
}

void ClassicEngine::void_in_flight(Status why, std::uint8_t datalink_code) noexcept {
  pending_begin_ = pending_end_ = 0;  // the fence turns a half-sent message into an error
  Exchange* const culprit = oldest_;
  if (culprit == &freeing_) {
    harmless_address_.reset();
  }
  blame(datalink_code);
  oldest_ = nullptr;
  batch_ = request_credit_ = reply_credit_ = 0;
  state_ = State::fence_due;
  fences_sent_ = fences_hastened_ = late_refusals_ = 0;
  fence_code_ = 0;

  ExchangeList again;
  ExchangeList over;
  while (!in_flight_.empty()) {
    Exchange& exchange = in_flight_.pop_front();
    const bool left = exchange.begin_ < position_;
    exchange.sent = exchange.sent || left;
    exchange.attempts -= left ? 0 : 1;
    exchange.error = {};
    exchange.stray_cycle = false;
    if (&exchange == culprit) {
      exchange.failures_ += 1;
      keep_cause(exchange, datalink_code);
    }
    const bool once_more =
        (!left || (exchange.repeat && exchange.failures_ < exchange.attempts_max)) && now_ns_ < limit_of(exchange);
    exchange.state_ = Exchange::State::waiting;
    if (once_more && exchange.batch != nullptr) {
      exchange.batch->failed = false;  // its answers are void as well
    }
    (once_more ? again : over).push_back(exchange);
  }
  put_back(again);
  while (!over.empty()) {
    Exchange& exchange = over.pop_front();
    const bool had_effect = exchange.operation == Operation::write && !exchange.repeat && exchange.sent;
    finish(exchange, had_effect ? Status::unknown : why == Status::timeout ? silence_of(exchange) : why);
  }
}

// Puts these requests before all others, to be sent again.
void ClassicEngine::put_back(ExchangeList& again) noexcept {
  look_ns_ = waiting_.empty() ? no_deadline : look_ns_;
  for (const Exchange* exchange = again.front(); exchange != nullptr; exchange = ExchangeList::after(*exchange)) {
    look_ns_ = std::min(look_ns_, limit_of(*exchange));
  }
  waiting_.prepend(again);
}

// Ends the requests that have waited too long.
void ClassicEngine::end_late() noexcept {
  ExchangeList remaining;
  ExchangeList over;
  look_ns_ = no_deadline;
  while (!waiting_.empty()) {
    Exchange& exchange = waiting_.pop_front();
    const std::uint64_t limit_ns = &exchange == &freeing_ ? no_deadline : limit_of(exchange);
    look_ns_ = now_ns_ < limit_ns ? std::min(look_ns_, limit_ns) : look_ns_;
    (now_ns_ < limit_ns ? remaining : over).push_back(exchange);
  }
  waiting_ = remaining;
  if (waiting_.empty() && state_ == State::fencing) {
    state_ = State::fence_due;  // no request waits for the answer
  }
  while (!over.empty()) {
    Exchange& exchange = over.pop_front();
    keep_cause(exchange, fence_code_);
    finish(exchange, fence_code_ == datalink_error::checksum ? Status::protocol_error : silence_of(exchange));
  }
}

void ClassicEngine::abandon(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept {
  const bool on_its_way = std::any_of(exchanges.begin(), exchanges.end(), [](const Exchange& exchange) {
    return exchange.state_ == Exchange::State::in_flight || exchange.state_ == Exchange::State::replied;
  });
  for (Exchange& exchange : exchanges) {
    exchange.attempts_max = 0;
  }
  if (on_its_way) {
    void_in_flight(Status::timeout, 0);
  }
  withdraw(exchanges, now_ns);
}

void ClassicEngine::withdraw(std::span<Exchange> exchanges, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  for (Exchange& exchange : exchanges) {
    exchange.attempts_max = 0;
    exchange.timeout_ns = std::min(exchange.timeout_ns, settings_.timeout_ns);
  }
  ExchangeList remaining;
  ExchangeList over;
  while (!waiting_.empty()) {
    Exchange& exchange = waiting_.pop_front();
    (exchange.attempts_max > 0 ? remaining : over).push_back(exchange);
  }
  waiting_ = remaining;
  if (waiting_.empty() && state_ == State::fencing) {
    state_ = State::fence_due;  // no request waits for the answer
  }
  while (!over.empty()) {
    Exchange& exchange = over.pop_front();
    finish(exchange, exchange.cut_off());
  }
}

void ClassicEngine::hasten_fence() noexcept {
  if (fences_hastened_ < hastened_fences_max && !fence_hastened_) {
    fences_hastened_ += 1;
    fence_hastened_ = true;
    fence_deadline_ns_ = std::min(fence_deadline_ns_, now_ns_ + waiting_.front()->timeout_ns / hastened_part);
  }
}

void ClassicEngine::on_fence_answer(const Message& message) noexcept {
  const char head = plain_fence_ ? bytes::plain_head : bytes::checked_head;
  if (state_ != State::fencing || message.head != head) {
    statistics_.stale_replies += 1;
    return;
  }
  if (message.kind == MessageKind::reply && message.letters == reply::read_configuration) {
    const bool maybe_2012 = !corrected_ && (!reported_ || has_comma_byte(*reported_));
    const auto configuration = parse_configuration(message.fields, decoder_.sum(), message.checksum, maybe_2012);
    const bool other = configuration && reported_ && *configuration != *reported_;
    // without a checksum, an unexpected answer is more likely noise than another device
    if (!configuration || (other && plain_fence_)) {
      statistics_.malformed_messages += 1;
      hasten_fence();
    } else if (other) {
      end(Status::mismatch, now_ns_);
    } else {
      reported_ = configuration;
      late_refusals_ = 0;
      fence_passed();
    }
  } else if (message.error == application_error::incomplete_command && message.letters.empty() && !reported_) {
    late_refusals_ = fences_sent_ - 1;
    fence_passed();
  } else {
    statistics_.stale_replies += 1;
  }
}

void ClassicEngine::fence_passed() noexcept {
  last_answer_ns_ = now_ns_;
  state_ = State::ready;
  fences_sent_ = fences_hastened_ = 0;
  fence_unanswered_ = false;
  fence_code_ = 0;
  if (Exchange* first = waiting_.front(); first != nullptr && first->operation == Operation::resynchronise) {
    waiting_.pop_front();
    first->sent = true;
    first->attempts += 1;
    finish(*first, Status::ok);
  }
}

void ClassicEngine::fence_failed() noexcept {
  statistics_.timeouts += 1;
  state_ = State::fence_due;
  fence_unanswered_ = true;
  if (!reported_) {
    plain_fence_ = !settings_.checksums;  // "?f1" may have been noise; otherwise it is detected again
  }
  ExchangeList remaining;
  ExchangeList over;
  while (!waiting_.empty()) {
    Exchange& exchange = waiting_.pop_front();
    exchange.attempts += 1;
    exchange.failures_ += 1;
    (exchange.failures_ < exchange.attempts_max ? remaining : over).push_back(exchange);
  }
  waiting_ = remaining;
  while (!over.empty()) {
    Exchange& exchange = over.pop_front();
    keep_cause(exchange, fence_code_);
    finish(exchange, fence_code_ == datalink_error::checksum ? Status::protocol_error : silence_of(exchange));
  }
}

}  // namespace unitylink
