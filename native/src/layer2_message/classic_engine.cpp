// SPDX-License-Identifier: BSD-3-Clause
// What is sent, and when. Received messages are in classic_engine_receive.cpp, missing answers in
// classic_engine_recovery.cpp, and bus timeouts of 2012 gateware in classic_engine_bus.cpp.
#include "layer2_message/classic_engine.hpp"

#include <algorithm>

#include "layer1_stream/classic_encoder.hpp"
#include "layer2_message/shapes.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::uint8_t fence_opener = '!';  // makes a half-received message an error; skipped by an idle device
constexpr std::size_t fence_bytes_max = 16;
constexpr std::size_t configuration_reply_bytes_max = 40;

}  // namespace

ClassicEngine::ClassicEngine(const EngineSettings& settings) noexcept
    : settings_(settings), decoder_(settings.sum), plain_fence_(!settings.checksums) {}

void ClassicEngine::configure(const Configuration& configuration) noexcept {
  configuration_ = configuration;
  decoder_.set_data_bytes(configuration.data_bytes);
}

void ClassicEngine::submit(Exchange& exchange, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  prepare(exchange);
  if (ended_) {
    finish(exchange, *ended_);
  } else {
    look_ns_ = waiting_.empty() ? limit_of(exchange) : std::min(look_ns_, limit_of(exchange));
    waiting_.push_back(exchange);
  }
}

void ClassicEngine::prepare(Exchange& exchange) noexcept {
  exchange.begun_ns = now_ns_;
  exchange.state_ = Exchange::State::waiting;
  if (exchange.timeout_ns == 0) {
    exchange.timeout_ns = settings_.timeout_ns;
  }
  const Letters letters = letters_of(exchange.operation);
  exchange.request_bytes_ = static_cast<std::uint32_t>(
      encoded_bytes(letters.command.size(), request_data_bytes(exchange, configuration_), exchange.checked));
  exchange.reply_bytes_ = static_cast<std::uint32_t>(
      encoded_bytes(letters.reply.size(), reply_data_bytes(exchange, configuration_), exchange.checked));
}

bool ClassicEngine::admits(const Exchange& exchange) const noexcept {
  if (pending_end_ + exchange.request_bytes_ > pending_.size()) {
    return false;
  }
  if (in_flight_.empty() || &exchange == &freeing_) {  // all requests before it were answered
    return true;
  }
  const auto alone = [](Operation operation) {
    return operation == Operation::resynchronise || operation == Operation::empty_message;
  };
  return !alone(exchange.operation) && !alone(in_flight_.front()->operation) && batch_ < settings_.window &&
         request_credit_ + exchange.request_bytes_ <= settings_.receive_fifo_bytes &&
         reply_credit_ + exchange.reply_bytes_ <= settings_.transmit_fifo_bytes;
}

std::span<const std::uint8_t> ClassicEngine::transmit(std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (pending_begin_ == pending_end_) {
    pending_begin_ = pending_end_ = 0;
  }
  if (wants_bus_freed()) {
    free_bus();
  }
  while (!waiting_.empty() && !ended_ && state_ != State::fencing) {
    Exchange& exchange = *waiting_.front();
    if (exchange.batch != nullptr && exchange.batch->failed) {
      waiting_.pop_front();
      finish(exchange, exchange.left_out());
    } else if (state_ == State::fence_due) {
      encode_fence();
    } else if (!admits(exchange)) {
      break;
    } else if (exchange.operation == Operation::resynchronise) {
      state_ = State::fence_due;
    } else {
      encode(waiting_.pop_front());
    }
  }
  return std::span<const std::uint8_t>(pending_).subspan(pending_begin_, pending_end_ - pending_begin_);
}

void ClassicEngine::sent(std::size_t bytes) noexcept {
  pending_begin_ += bytes;
  position_ += bytes;
  statistics_.bytes_sent += bytes;
}

void ClassicEngine::encode(Exchange& exchange) noexcept {
  const std::span<std::uint8_t> room(pending_.data() + pending_end_, pending_.size() - pending_end_);
  ClassicEncoder encoder(room, decoder_.sum(), exchange.checked);
  encoder.command(letters_of(exchange.operation).command);
  const unsigned width = configuration_.address_bytes;
  switch (exchange.operation) {
    case Operation::read: encoder.word(exchange.address, width); break;
    case Operation::write: encoder.word(exchange.address, width).word(exchange.value, configuration_.data_bytes); break;
    case Operation::write_group_addresses: encoder.word(exchange.address, 1); [[fallthrough]];
    case Operation::read_many:
      encoder.word(static_cast<std::uint32_t>(exchange.addresses.size()), 1);
      for (const std::uint32_t address : exchange.addresses) {
        encoder.word(address, width);
      }
      break;
    case Operation::write_group_rate:
      encoder.word(exchange.address, 1).word(exchange.value, configuration_.rate_bytes);
      break;
    case Operation::read_group: encoder.word(exchange.address, 1); break;
    case Operation::write_event_mask:
      for (const std::uint8_t byte : exchange.mask) {
        encoder.byte(byte);
      }
      break;
    default: break;
  }
  exchange.begin_ = position_ + (pending_end_ - pending_begin_);
  if (exchange.operation == Operation::empty_message) {  // without a checksum, which the encoder would add
    room[0] = static_cast<std::uint8_t>(bytes::checked_head);
    room[1] = static_cast<std::uint8_t>(bytes::line_feed);
    pending_end_ += 2;
  } else {
    pending_end_ += encoder.finish();
  }
  statistics_.requests += 1;
  statistics_.retries += exchange.attempts > 0 ? 1 : 0;
  exchange.attempts += 1;
  exchange.stray_cycle = false;
  exchange.state_ = Exchange::State::in_flight;
  in_flight_.push_back(exchange);
  batch_ += 1;
  request_credit_ += exchange.request_bytes_;
  reply_credit_ += exchange.reply_bytes_;
  if (oldest_ == nullptr) {
    oldest_ = &exchange;
    oldest_since_ns_ = now_ns_;
  }
}

void ClassicEngine::encode_fence() noexcept {
  pending_begin_ = pending_end_ = 0;
  // noise, or an earlier host, may have begun a frame at the device. Then all bytes up to the next 00 belong to that
  // frame
  if (fence_unanswered_) {
    pending_[pending_end_++] = static_cast<std::uint8_t>(frame::delimiter);
  }
  pending_[pending_end_++] = fence_opener;
  const std::span<std::uint8_t> room(pending_.data() + pending_end_, pending_.size() - pending_end_);
  ClassicEncoder encoder(room, decoder_.sum(), !plain_fence_);
  pending_end_ += encoder.command(command::read_configuration).finish();
  state_ = State::fencing;
  fence_hastened_ = false;
  fences_sent_ += 1;
  statistics_.fences += 1;
  fence_deadline_ns_ = now_ns_ + waiting_.front()->timeout_ns +
                       2 * settings_.byte_time_ns * (pending_end_ + configuration_reply_bytes_max);
}

// ---- time

// The time that one attempt may take.
std::uint64_t ClassicEngine::allowance_ns(const Exchange& exchange) const noexcept {
  return exchange.timeout_ns + 2 * settings_.byte_time_ns * (exchange.request_bytes_ + exchange.reply_bytes_);
}

// The latest end of a request, sent or not. It includes one more attempt than its own, for the fences between its
// attempts.
std::uint64_t ClassicEngine::limit_of(const Exchange& exchange) const noexcept {
  const std::uint64_t fence_ns = 2 * settings_.byte_time_ns * (fence_bytes_max + configuration_reply_bytes_max);
  const auto patience_ns = [this, fence_ns](const Exchange& one) {
    return (std::max(1u, one.attempts_max) + 1) * (allowance_ns(one) + fence_ns);
  };
  const Exchange* const first = in_flight_.empty() ? waiting_.front() : in_flight_.front();
  const std::uint64_t most_ns = std::max(patience_ns(exchange), first != nullptr ? patience_ns(*first) : 0);
  return std::max(exchange.begun_ns, progress_ns_) + most_ns;
}

std::uint64_t ClassicEngine::next_deadline_ns() const noexcept {
  std::uint64_t next = waiting_.empty() ? no_deadline : look_ns_;
  if (state_ == State::fencing) {
    return std::min(next, fence_deadline_ns_);
  }
  if (state_ == State::ready && oldest_ != nullptr) {
    next = std::min({next, oldest_since_ns_ + allowance_ns(*oldest_), limit_of(*oldest_)});
  }
  return next;
}

void ClassicEngine::advance(std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (ended_ || now_ns < next_deadline_ns()) {
    return;
  }
  if (!waiting_.empty() && now_ns >= look_ns_) {
    end_late();
  }
  if (now_ns < next_deadline_ns()) {
    return;
  }
  if (state_ == State::ready && oldest_ != nullptr) {
    statistics_.timeouts += 1;
    void_in_flight(Status::timeout, 0);
  } else if (fence_hastened_) {
    state_ = State::fence_due;
  } else if (state_ == State::fencing) {
    fence_failed();
  }
}

void ClassicEngine::forget(Status status) noexcept {
  ended_ = status;
  state_ = State::fence_due;
  oldest_ = nullptr;
  in_flight_ = {};
  waiting_ = {};
}

void ClassicEngine::end(Status status, std::uint64_t now_ns) noexcept {
  if (!ended_) {
    ended_ = status;
    finish_all(status, now_ns, false);
  }
}

void ClassicEngine::cut(Status status, std::uint64_t now_ns) noexcept {
  if (ended_) {
    return;
  }
  drop(status, now_ns);
  decoder_ = ClassicDecoder(settings_.sum);
  decoder_.set_data_bytes(configuration_.data_bytes);
}

void ClassicEngine::drop(Status status, std::uint64_t now_ns) noexcept {
  finish_all(status, now_ns, true);
  pending_begin_ = pending_end_ = 0;
  batch_ = request_credit_ = reply_credit_ = 0;
  fences_sent_ = fences_hastened_ = late_refusals_ = 0;
  fence_hastened_ = fence_unanswered_ = false;
  fence_code_ = 0;
}

// `strict`: a write that was sent is unknown, even if it could be repeated.
void ClassicEngine::finish_all(Status status, std::uint64_t now_ns, bool strict) noexcept {
  now_ns_ = now_ns;
  state_ = State::fence_due;
  oldest_ = nullptr;
  while (!in_flight_.empty()) {
    Exchange& exchange = in_flight_.pop_front();
    exchange.sent = exchange.sent || exchange.begin_ < position_;
    const bool unknown = exchange.operation == Operation::write && (strict || !exchange.repeat) && exchange.sent;
    finish(exchange, unknown ? Status::unknown : status);
  }
  while (!waiting_.empty()) {
    finish(waiting_.pop_front(), status);
  }
}

}  // namespace unitylink
