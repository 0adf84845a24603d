// SPDX-License-Identifier: BSD-3-Clause
// What requests do, and why some are not executed.
#include <algorithm>
#include <array>
#include <numeric>

#include "device/framed/framed_application.hpp"
#include "layer1_stream/frame_heads.hpp"

namespace unitylink::device {

namespace control = protocol::control;
namespace list = protocol::list_operation;
namespace request_kind = protocol::request_kind;
namespace status = protocol::reply_status;

namespace {

constexpr Clock silent_cycle = protocol::limits::bus_timeout_clocks + 1;

std::size_t bytes_of(std::span<const ExchangeWord> words) noexcept {
  return std::accumulate(words.begin(), words.end(), std::size_t{0},
                         [](std::size_t sum, const ExchangeWord& w) { return sum + w.bytes; });
}

// Only these requests can have replies that the cache does not keep.
bool may_be_long(std::uint8_t operation) {
  return operation == request_kind::list || operation == request_kind::exchange ||
         operation == request_kind::read_control;
}

}  // namespace

void FramedApplication::request(std::uint8_t kind, std::span<const std::uint8_t> payload) {
  if (payload.size() < 2) {
    count(control::discarded_kind);
    return;
  }
  if (!built(kind & ~protocol::frame::chained_bit & ~protocol::frame::barrier_bit) ||
      !request_.parse(kind, payload, widths())) {
    count(control::frames);
    request_.id = static_cast<std::uint16_t>(payload[0] << 8 | payload[1]);
    reply(status::invalid, {});
    return;
  }
  const ReplyCache::Verdict verdict = cache_.verdict(request_.id);
  if (verdict == ReplyCache::Verdict::stale) {
    count(control::discarded_stale);
    return;
  }
  if (verdict == ReplyCache::Verdict::repeated) {
    count(control::duplicates);
    if (const ReplyCache::Place& place = cache_.place(request_.id); place.kept) {
      reply(place.status, place.reply);
    } else {
      data_.clear();
      // the id belongs to another request
      const Status why = may_be_long(request_.operation) ? refusal(true) : status::invalid;
      const Status outcome = why != status::ok ? why : perform(true);
      reply(outcome, data_);
    }
    return;
  }
  count(control::frames);
  const Status early = untimely();
  if (const Status why = early != status::ok ? early : refusal(false); why != status::ok) {
    if (why == status::denied) {
      count(control::refused);
    }
    reply(why, {});
    return;
  }
  const Status outcome = perform(false);
  cache_.keep(request_.id, static_cast<std::uint8_t>(outcome), data_);
  reply(outcome, data_);
  if (request_.operation == request_kind::close) {
    begin_session({});
  }
}

// A request for which the gateware was not built is an unknown request.
bool FramedApplication::built(std::uint32_t operation) const noexcept {
  switch (operation) {
    case request_kind::list: return configuration_.lists;
    case request_kind::exchange:
    case request_kind::define_exchange: return !exchanges_.empty();
    case request_kind::define_group: return !groups_.empty();
    default: return true;
  }
}

// Why a request must not be executed yet.
FramedApplication::Status FramedApplication::untimely() const noexcept {
  if (request_.chained && !cache_.executed(static_cast<std::uint16_t>(request_.id - 1))) {
    return status::order;
  }
  if (request_.barrier && *request_.barrier != posts_) {
    return status::behind;
  }
  return status::ok;
}

// Why a request will never be executed. The checks have the order of docs/protocol.md, section 3.
FramedApplication::Status FramedApplication::refusal(bool repeated) const noexcept {
  const std::size_t word_bytes = configuration_.data_bytes();
  bool writes = request_.operation == request_kind::write;
  std::size_t reply_bytes = frame_head::reply;
  bool lost_if_repeated = false;
  switch (request_.operation) {
    case request_kind::read: reply_bytes += word_bytes; break;
    case request_kind::list: {
      const auto reads =
          std::count_if(request_.words.begin(), request_.words.end(), [](const ListWord& w) { return !w.writes(); });
      writes = static_cast<std::size_t>(reads) < request_.words.size();
      const std::size_t kept = 2 + word_bytes * static_cast<std::size_t>(reads);
      reply_bytes += kept;
      lost_if_repeated = kept > configuration_.cache_bytes &&
                         std::any_of(request_.words.begin(), request_.words.end(),
                                     [](const ListWord& w) { return w.operation == list::read_fifo; });
      break;
    }
    case request_kind::exchange: {
      if (request_.address >= exchanges_.size() || !exchanges_[request_.address].defined) {
        return status::no_group;
      }
      const Exchange& exchange = exchanges_[request_.address];
      if (request_.data.size() != bytes_of(exchange.outputs)) {
        return status::invalid;
      }
      writes = !exchange.outputs.empty();
      break;
    }
    case request_kind::read_control:
      if (!ControlRegisters::has(request_.address, request_.value)) {
        return status::bad_address;
      }
      reply_bytes += 4 * request_.value;
      break;
    case request_kind::write_control: return control_refusal();
    case request_kind::define_group:
      if (request_.address >= groups_.size() || request_.addresses.size() > configuration_.group_size) {
        return status::no_group;
      }
      reply_bytes = frame_head::publish + word_bytes * request_.addresses.size();
      break;
    case request_kind::define_exchange:
      if (request_.address >= exchanges_.size() || request_.members.size() > configuration_.exchange_size) {
        return status::no_group;
      }
      reply_bytes += bytes_of(std::span(request_.members).subspan(request_.outputs));
      break;
    default: break;
  }
  if (writes && bus_.tripped() && !repeated) {
    return status::denied;
  }
  return lost_if_repeated || reply_bytes > configuration_.reply_max ? status::too_long : status::ok;
}

FramedApplication::Status FramedApplication::control_refusal() const noexcept {
  if ((request_.address == control::publish && groups_.empty()) ||
      ((request_.address == control::deadman_ticks || request_.address == control::arm) && !configuration_.deadman)) {
    return status::bad_address;
  }
  switch (request_.address) {
    case control::deadman_ticks: return bus_.tripped() ? status::denied : status::ok;
    case control::arm:
      return request_.value != 1 ? status::invalid : bus_.tripped_in_session() ? status::denied : status::ok;
    case control::publish: return request_.value > 1 ? status::invalid : status::ok;
    default: return status::bad_address;
  }
}

FramedApplication::Status FramedApplication::perform(bool repeated) {
  data_.clear();
  switch (request_.operation) {
    case request_kind::read: {
      std::uint32_t value = 0;
      const Status outcome = read(request_.address, value);
      if (outcome == status::ok) {
        put(value, configuration_.data_bytes());
      }
      return outcome;
    }
    case request_kind::write: return write(request_.address, request_.value);
    case request_kind::list: return perform_list(repeated);
    case request_kind::exchange: return perform_exchange(repeated);
    case request_kind::read_control:
      for (std::uint32_t index = 0; index < request_.value; ++index) {
        put(this->control(request_.address + index), 4);
      }
      return status::ok;
    case request_kind::write_control: write_control(); return status::ok;
    case request_kind::define_group: define_group(); return status::ok;
    case request_kind::define_exchange: {
      Exchange& exchange = exchanges_[request_.address];
      const auto first_input = request_.members.begin() + static_cast<std::ptrdiff_t>(request_.outputs);
      exchange.outputs.assign(request_.members.begin(), first_input);
      exchange.inputs.assign(first_input, request_.members.end());
      exchange.defined = true;
      return status::ok;
    }
    case request_kind::sync:
      put(posts_, 2);
      put(failed_posts_, 2);
      put(first_failed_, 2);
      put(first_failure_, 1);
      return status::ok;
    default: return status::ok;
  }
}

FramedApplication::Status FramedApplication::perform_list(bool repeated) {
  const bool atomic = (request_.flags & protocol::frame::atomic_flag) != 0;
  put(0, 2);
  std::uint32_t done = 0;
  Status outcome = status::ok;
  if (atomic) {
    bus_.block(true, at_);
  }
  for (const ListWord& word : request_.words) {
    if (word.writes()) {
      outcome = repeated ? status::ok : write_word(word);
    } else {
      std::uint32_t value = 0;
      if (outcome = read(word.address, value); outcome == status::ok) {
        put(value, configuration_.data_bytes());
      }
    }
    if (outcome != status::ok) {
      data_.resize(2);
      break;
    }
    ++done;
  }
  if (atomic) {
    bus_.block(false, at_);
  }
  data_[0] = static_cast<std::uint8_t>(done >> 8);
  data_[1] = static_cast<std::uint8_t>(done);
  return outcome;
}

FramedApplication::Status FramedApplication::perform_exchange(bool repeated) {
  const Exchange& exchange = exchanges_[request_.address];
  Fields fields(request_.data);
  Status outcome = status::ok;
  bus_.block(true, at_);
  for (const ExchangeWord& output : exchange.outputs) {
    const std::uint32_t value = fields.take(output.bytes);
    if (outcome = repeated ? status::ok : write(output.address, value); outcome != status::ok) {
      break;
    }
  }
  for (const ExchangeWord& input : exchange.inputs) {
    std::uint32_t value = 0;
    if (outcome == status::ok) {
      outcome = read(input.address, value);
    }
    put(value, input.bytes);
  }
  bus_.block(false, at_);
  if (outcome != status::ok) {
    data_.clear();
  }
  return outcome;
}

void FramedApplication::define_group() {
  const std::uint32_t group = request_.address;
  for (std::uint32_t& address : request_.addresses) {
    address &= configuration_.address_mask();
  }
  groups_[group].sequence = 0;
  subscriptions_.set_addresses(group, request_.addresses, at_);
  subscriptions_.set_rate(group, request_.value, at_);
  subscriptions_.enable_event(group, (request_.flags & protocol::frame::event_flag) != 0, at_);
}

void FramedApplication::write_control() {
  switch (request_.address) {
    case control::deadman_ticks: bus_.set(request_.value, at_); break;
    case control::arm: bus_.arm(); break;
    default:
      publishing_ = request_.value != 0;
      publishing_ ? subscriptions_.enable(at_) : subscriptions_.disable(at_);
      break;
  }
}

std::uint32_t FramedApplication::control(std::uint32_t address) noexcept {
  switch (address) {
    case control::deadman_ticks: return bus_.ticks();
    case control::arm: return (bus_.tripped() ? 1u : 0u) | (bus_.running() ? 2u : 0u) | (publishing_ ? 4u : 0u);
    case control::publish: return publishing_ ? 1 : 0;
    case control::publish_overruns: return subscriptions_.overruns();
    default: return registers_.read(address, at_);
  }
}

// ---- the bus

FramedApplication::Status FramedApplication::access(BusStatus answer) noexcept {
  at_ += answer == BusStatus::silent ? silent_cycle : timing::bus_cycle;
  switch (answer) {
    case BusStatus::error: count(control::bus_errors); return status::bus_error;
    case BusStatus::denied: count(control::refused); return status::denied;
    case BusStatus::silent: count(control::bus_timeouts); return status::bus_timeout;
    default: return status::ok;
  }
}

FramedApplication::Status FramedApplication::read(std::uint32_t address, std::uint32_t& value) {
  const BusReply answer = bus_.read(address & configuration_.address_mask(), at_);
  value = answer.value;
  return access(answer.status);
}

FramedApplication::Status FramedApplication::write(std::uint32_t address, std::uint32_t value) {
  return access(bus_.write(address & configuration_.address_mask(), value & configuration_.data_mask(), at_));
}

FramedApplication::Status FramedApplication::write_word(const ListWord& word) {
  std::uint32_t value = word.value;
  if (word.operation == list::write_masked || word.operation == list::add) {
    std::uint32_t old = 0;
    if (const Status outcome = read(word.address, old); outcome != status::ok) {
      return outcome;
    }
    value = word.operation == list::add ? old + value : (old & ~word.mask) | (value & word.mask);
  }
  return write(word.address, value);
}

}  // namespace unitylink::device
