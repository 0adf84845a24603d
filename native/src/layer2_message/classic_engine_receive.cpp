// SPDX-License-Identifier: BSD-3-Clause
// Gives each received message to the request or the group that it belongs to.
#include "layer2_message/classic_engine.hpp"

#include <algorithm>

#include "layer2_message/shapes.hpp"

namespace unitylink {
namespace {

using namespace protocol;

Status status_of_error(std::string_view error) noexcept {
  const bool bus = error == application_error::bus_error_read || error == application_error::bus_error_write ||
                   error == application_error::bus_timeout;
  return bus ? Status::bus_error : Status::protocol_error;
}

std::uint32_t word_at(std::span<const std::uint8_t> data, std::size_t index, std::size_t width) noexcept {
  std::uint32_t word = 0;
  for (std::size_t byte = 0; byte < width; ++byte) {
    word = word << 8 | data[index * width + byte];
  }
  return word;
}

}  // namespace

struct ClassicEngine::Sink {
  ClassicEngine& engine;
  void on_message(const Message& message) noexcept { engine.on_message(message); }
  void on_publish(const Publish& publish) noexcept { engine.on_publish(publish); }
  void on_garbage(std::size_t bytes) noexcept { engine.statistics_.garbage_bytes += bytes; }
};

void ClassicEngine::receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  statistics_.bytes_received += bytes.size();
  Sink sink{*this};
  decoder_.feed(bytes, sink);
}

void ClassicEngine::on_publish(const Publish& publish) noexcept {
  last_answer_ns_ = now_ns_;
  PublishRing* ring = rings_[publish.group];
  if (ring == nullptr) {
    statistics_.unclaimed_publishes += 1;
  } else if (publish.words.size() != ring->words() || publish.count != ring->words() ||
             publish.checked != publishes_checked_) {
    statistics_.mismatched_publishes += 1;
  } else {
    statistics_.publishes += 1;
    statistics_.overruns += ring->push(now_ns_, publish.words) ? 0 : 1;
  }
}

void ClassicEngine::on_message(const Message& message) noexcept {
  if (ended_) {
    return;
  }
  switch (message.kind) {
    case MessageKind::busy: lasting_ ? drop(Status::busy, now_ns_) : end(Status::busy, now_ns_); return;
    case MessageKind::datalink_error: on_datalink_error(message.code); return;
    case MessageKind::bad_checksum: statistics_.checksum_errors += 1; break;
    case MessageKind::malformed: statistics_.malformed_messages += 1; break;
    case MessageKind::application_error:
    case MessageKind::reply:
      if (message.is_publish()) {  // an error of the device's bus has cut it short
        statistics_.mismatched_publishes += 1;
      } else if (state_ == State::ready) {
        on_reply(message);
      } else {
        on_fence_answer(message);
      }
      return;
  }
  if (!message.is_publish()) {
    on_bad_reply();
  }
}

// A reply cannot be accepted. It is not known to which request it belongs.
void ClassicEngine::on_bad_reply() noexcept {
  if (state_ == State::fencing) {
    hasten_fence();
  } else if (state_ == State::ready && oldest_ != nullptr) {
    void_in_flight(Status::protocol_error, 0);
  }
}

void ClassicEngine::on_reply(const Message& message) noexcept {
  const bool refusal = message.error == application_error::incomplete_command && message.letters.empty();
  const bool surplus = refusal && late_refusals_ > 0;
  if (oldest_ == nullptr || surplus ||
      (message.kind == MessageKind::reply && message.letters == reply::read_configuration)) {
    late_refusals_ -= surplus ? 1 : 0;
    statistics_.stale_replies += 1;
    return;
  }
  Exchange& exchange = *oldest_;
  const char head =
      exchange.checked || exchange.operation == Operation::empty_message ? bytes::checked_head : bytes::plain_head;
  if (message.head == head && message.kind == MessageKind::application_error &&
      letters_of(exchange.operation).reply.starts_with(message.letters)) {
    on_application_error(exchange, message);
  } else if (message.head == head && message.kind == MessageKind::reply && take_data(exchange, message)) {
    if (exchange.operation == Operation::write_group_addresses) {
      // set at once, because the next message may be the group's first publish
      rings_[exchange.address] = exchange.ring;
    }
    on_bus_answer(exchange, true);
    replied(exchange, Status::ok);
  } else {
    statistics_.malformed_messages += 1;
    on_bad_reply();
  }
}

void ClassicEngine::on_application_error(Exchange& exchange, const Message& message) noexcept {
  statistics_.device_errors += 1;
  exchange.error = message.error;
  exchange.words = exchange.operation == Operation::read_many && configuration_.data_bytes > 0
                       ? static_cast<std::uint32_t>(message.data.size() / configuration_.data_bytes)
                       : 0;
  const Status status = status_of_error(message.error);
  if (message.error == application_error::bus_timeout) {
    on_bus_timeout(exchange);
  } else if (status == Status::bus_error) {
    on_bus_answer(exchange, false);
  }
  replied(exchange, status);
}

bool ClassicEngine::take_data(Exchange& exchange, const Message& message) noexcept {
  const std::span<const std::uint8_t> data = message.data;
  if (message.letters != letters_of(exchange.operation).reply || exchange.operation == Operation::empty_message) {
    return false;
  }
  if (exchange.operation == Operation::read_group) {
    const std::size_t rate = configuration_.rate_bytes;
    const std::size_t width = configuration_.address_bytes;
    if (data.size() < rate + 1 || data.size() != rate + 1 + data[rate] * width ||
        exchange.values.size() < 1u + data[rate]) {
      return false;
    }
    exchange.values[0] = word_at(data, 0, rate);
    exchange.words = data[rate];
    for (std::size_t index = 0; index < exchange.words; ++index) {
      exchange.values[1 + index] = word_at(data.subspan(rate + 1), index, width);
    }
    return true;
  }
  if (data.size() != reply_data_bytes(exchange, configuration_)) {
    return false;
  }
  if (exchange.operation == Operation::read) {
    exchange.value = word_at(data, 0, configuration_.data_bytes);
  } else if (exchange.operation == Operation::read_many) {
    exchange.words = static_cast<std::uint32_t>(exchange.addresses.size());
    for (std::size_t index = 0; index < exchange.words; ++index) {
      exchange.values[index] = word_at(data, index, configuration_.data_bytes);
    }
  } else if (exchange.operation == Operation::read_event_mask) {
    std::copy(data.begin(), data.end(), exchange.values.begin());
  }
  return true;
}

void ClassicEngine::replied(Exchange& exchange, Status status) noexcept {
  statistics_.replies += 1;
  last_answer_ns_ = now_ns_;
  progress_ns_ = now_ns_;
  exchange.status = status;
  exchange.state_ = Exchange::State::replied;
  if (status != Status::ok && exchange.batch != nullptr) {
    exchange.batch->failed = true;
  }
  request_credit_ -= exchange.request_bytes_;
  reply_credit_ -= exchange.reply_bytes_;
  oldest_ = ExchangeList::after(exchange);
  oldest_since_ns_ = now_ns_;
  if (oldest_ == nullptr && !wants_bus_freed()) {
    settle_batch();
  }
}

// All requests were answered, so the n-th answer belongs to the n-th request.
void ClassicEngine::settle_batch() noexcept {
  batch_ = 0;
  ExchangeList again;
  while (!in_flight_.empty()) {
    Exchange& settled = in_flight_.pop_front();
    settled.sent = true;
    const bool spoiled = settled.stray_cycle && settled.status == Status::ok;
    settled.failures_ += spoiled ? 1 : 0;
    if (spoiled && settled.repeat && settled.failures_ < settled.attempts_max) {
      settled.state_ = Exchange::State::waiting;
      again.push_back(settled);
    } else {
      finish(settled, !spoiled ? settled.status : settled.writes() ? Status::unknown : Status::protocol_error);
    }
  }
  put_back(again);
}

void ClassicEngine::on_datalink_error(std::uint8_t code) noexcept {
  statistics_.datalink_errors += 1;
  last_answer_ns_ = now_ns_;
  if (state_ == State::fencing) {
    fence_code_ = code;
    blame(code);
    if (code == datalink_error::format && !plain_fence_ && !reported_) {
      plain_fence_ = true;  // a datalink without checksums answers '$' in this way
      state_ = State::fence_due;
    } else {
      hasten_fence();
    }
  } else if (state_ == State::ready && oldest_ != nullptr) {
    if (oldest_->operation == Operation::empty_message) {
      oldest_->datalink_code = code;
      replied(*oldest_, Status::ok);
    } else {
      void_in_flight(Status::protocol_error, code);
    }
  }
}

}  // namespace unitylink
