// SPDX-License-Identifier: BSD-3-Clause
// Frames in, sessions, posts, publishes, bytes out. The execution of requests is in framed_execution.cpp.
#include "device/framed/framed_application.hpp"

#include <algorithm>

namespace unitylink::device {

namespace control = protocol::control;
namespace device_kind = protocol::device_kind;
namespace request_kind = protocol::request_kind;
namespace status = protocol::reply_status;

namespace {

constexpr Clock frame_latency = 2;  // a border taken -> the frame may be executed
constexpr std::uint8_t request_bits = protocol::frame::chained_bit | protocol::frame::barrier_bit;

bool is_post(std::uint32_t kind) noexcept { return kind == request_kind::post || kind == request_kind::post_list; }

// Whether a frame of this kind changes how the next frame is read.
bool changes_session(std::uint32_t kind) noexcept {
  return kind == request_kind::open || (kind & ~request_bits & 0xFFu) == request_kind::close;
}

// Whether no host sends this kind: it is a kind of the device, or a post with bits that only requests have.
bool is_foreign(std::uint32_t kind) noexcept {
  return (kind & protocol::frame::device_bit) != 0 ||
         ((kind & request_bits) != 0 && is_post(kind & ~request_bits & 0xFFu));
}

}  // namespace

FramedApplication::FramedApplication(const DeviceConfiguration& configuration, SubscriptionManager& subscriptions,
                                     DeadMan& dead_man, PhysicalTransmitter& physical)
    : configuration_(configuration),
      subscriptions_(subscriptions),
      bus_(dead_man),
      physical_(physical),
      registers_(configuration),
      cache_(configuration.window, configuration.cache_bytes),
      exchanges_(configuration.exchanges),
      groups_(configuration.publish_mode > 0 ? configuration.groups : 0),
      waiting_(configuration.request_max, configuration.credit),
      offer_(configuration.offers, configuration.offer_secret, configuration.clock_hz) {
  decoder_.set_payload_max(configuration.request_max);
  payload_.reserve(frame_payload_max);
  out_.reserve(frame_bytes_max + 1);
}

// ---- in

void FramedApplication::take(std::uint8_t byte, Clock now) {
  at_ = std::max(at_, now);
  taken_at_ = now;
  decoder_.take(std::span(&byte, 1), *this);
}

void FramedApplication::on_frame(const Frame& frame) {
  if (!outside_session(frame.kind) && !open()) {
    on_discard(Discard::check, frame.kind, 0);
    return;
  }
  waiting_.push(frame.kind, frame.payload, taken_at_ + frame_latency);
  paused_ = changes_session(frame.kind);
  if (!outside_session(frame.kind) && !is_foreign(frame.kind)) {
    bus_.feed(taken_at_);
  }
}

void FramedApplication::on_discard(Discard why, std::uint8_t kind, std::size_t) {
  if (why == Discard::too_long) {
    count(control::discarded_long);
  } else if (!open() && kind != request_kind::hello && kind != request_kind::open) {
    count(control::discarded_session);
    if (!closed_told_) {
      closed_told_ = true;
      waiting_.push(device_kind::closed, {}, taken_at_ + frame_latency);
    }
  } else {
    count(control::discarded_check);
  }
}

// ---- when

Clock FramedApplication::next_clock(bool port_free) const noexcept {
  Clock next = bus_.due();
  if (sending()) {
    const Clock goes_on = physical_.room() > 0 ? at_ : says_nothing() ? std::max(at_, waiting_.front().at) : never;
    return std::min(next, goes_on);
  }
  if (!port_free) {
    return next;
  }
  if (!waiting_.empty()) {
    next = std::min(next, std::max(at_, waiting_.front().at));
  }
  return open() ? std::min(next, std::max(at_, subscriptions_.pending_at())) : next;
}

void FramedApplication::step(Clock now, bool port_free, Clock limit) {
  if (bus_.due() <= now && bus_.tripped()) {
    bus_.make_safe(now);
  } else if (bus_.due() <= now) {
    trip(now);
  } else if (sending() && physical_.room() == 0) {
    at_ = std::max(at_, now);
    execute();  // this frame has no answer
  } else if (sending()) {
    do {
      physical_.put(static_cast<char>(out_[sent_++]), at_++);
    } while (sending() && at_ < std::min(limit, bus_.due()) && physical_.room() > 0);
  } else if (port_free) {
    at_ = std::max(at_, now);
    if (open() && subscriptions_.pending_at() <= now) {  // publishes have priority over replies
      if (const auto group = subscriptions_.serve(now)) {
        publish(*group);
      }
    } else if (!waiting_.empty() && waiting_.front().at <= now) {
      execute();
    }
  }
}

bool FramedApplication::says_nothing() const noexcept {
  if (waiting_.empty() || waiting_.front().kind == device_kind::closed) {
    return false;
  }
  return is_post(waiting_.front().kind) || is_foreign(waiting_.front().kind);
}

void FramedApplication::execute() {
  const std::uint8_t kind = waiting_.front().kind;
  const std::span<const std::uint8_t> payload(waiting_.front().payload);
  if (kind == device_kind::closed) {
    send(kind, {});
  } else if (kind == request_kind::hello) {
    hello(payload);
  } else if (kind == request_kind::open) {
    open_session(payload);
  } else if (is_foreign(kind)) {
    count(control::discarded_kind);
  } else {
    is_post(kind) ? post(kind, payload) : request(kind, payload);
  }
  paused_ = paused_ && !changes_session(kind);
  waiting_.pop();
}

// ---- sessions

void FramedApplication::hello(std::span<const std::uint8_t> payload) {
  if (payload.size() != 2) {
    count(control::discarded_kind);
    return;
  }
  count(control::frames);
  closed_told_ = false;
  const bool common = payload[0] <= protocol::frame::version && protocol::frame::version <= payload[1];
  data_.clear();
  put(common ? protocol::frame::version : 0, 1);
  put(offer_.make(), 2);
  put(key_.epoch, 2);
  put(configuration_.address_bytes(), 1);
  put(configuration_.data_bytes(), 1);
  put(configuration_.credit, 2);
  put(configuration_.request_max, 2);
  put(configuration_.reply_max, 2);
  put(configuration_.window, 1);
  put(configuration_.cache_bytes, 1);
  put(configuration_.features(), 2);
  put(static_cast<std::uint32_t>(configuration_.spec_hash >> 32), 4);
  put(static_cast<std::uint32_t>(configuration_.spec_hash), 4);
  send(device_kind::hello, data_);
}

void FramedApplication::open_session(std::span<const std::uint8_t> payload) {
  if (payload.size() != 5) {
    count(control::discarded_kind);
    return;
  }
  Fields fields(payload);
  const auto nonce = static_cast<std::uint16_t>(fields.take(2));
  const auto epoch = static_cast<std::uint16_t>(fields.take(2));
  const std::uint32_t flags = fields.take(1);
  const std::uint32_t known_flags = configuration_.long_frames ? protocol::frame::checked_long_flag : 0;
  const bool again = open() && nonce == session_nonce_ && epoch == key_.epoch;
  const bool fresh = !again && epoch >> 8 != 0xFF && (flags & ~known_flags) == 0 && offer_.take(nonce, at_);
  if (!again && !fresh) {
    count(control::discarded_stale);
    return;
  }
  count(control::frames);
  if (!again) {
    if (bus_.running()) {
      trip(at_);
    }
    begin_session({epoch, (flags & protocol::frame::checked_long_flag) != 0});
    session_nonce_ = nonce;
  }
  data_.clear();
  put(key_.epoch, 2);
  put(static_cast<std::uint32_t>(at_), 4);
  send(device_kind::open, data_);
}

void FramedApplication::begin_session(const FrameKey& key) {
  key_ = key;
  decoder_.set_key(key);
  cache_.clear();
  posts_ = failed_posts_ = first_failed_ = 0;
  first_failure_ = 0;
  subscriptions_.clear(at_);
  publishing_ = false;
  for (Exchange& exchange : exchanges_) {
    exchange.defined = false;
  }
  bus_.begin_session();
}

// The dead-man trips: writes every output that has a safe value. Afterwards no write is executed.
void FramedApplication::trip(Clock now) {
  bus_.trip(now);
  count(control::deadman_trips);
}

// ---- posts

void FramedApplication::post(std::uint8_t kind, std::span<const std::uint8_t> payload) {
  if ((kind == request_kind::post_list && !configuration_.lists) || !request_.parse_post(kind, payload, widths())) {
    count(control::discarded_kind);
    return;
  }
  const auto distance = static_cast<std::uint16_t>(request_.id - posts_);
  if (distance != 0) {
    count(distance < 0x8000 ? control::posts_ahead : control::posts_old);
    return;
  }
  count(control::posts);
  Status outcome = status::ok;
  if (bus_.tripped()) {
    count(control::refused);
    outcome = status::denied;
  } else {
    for (const ListWord& word : request_.words) {
      if (outcome = write_word(word); outcome != status::ok) {
        break;
      }
    }
  }
  if (outcome != status::ok) {
    count(control::post_errors);
    if (failed_posts_ == 0) {
      first_failed_ = request_.id;
      first_failure_ = outcome;
    }
    failed_posts_ = static_cast<std::uint16_t>(failed_posts_ + (failed_posts_ == 0xFFFF ? 0 : 1));
  }
  ++posts_;
}

// ---- publishes

void FramedApplication::publish(std::uint32_t group) {
  const Clock since = at_;
  data_.clear();
  put(group, 1);
  put(groups_[group].sequence, 2);
  put(static_cast<std::uint32_t>(since), 4);
  Status outcome = status::ok;
  bus_.block(true, at_);
  for (const std::uint32_t address : subscriptions_.addresses(group)) {
    std::uint32_t value = 0;
    if (outcome = read(address, value); outcome != status::ok) {
      break;
    }
    put(value, configuration_.data_bytes());
  }
  bus_.block(false, at_);
  if (outcome == status::ok) {
    ++groups_[group].sequence;
    count(control::publishes);
    send(device_kind::publish, data_);
  }
}

// ---- out

void FramedApplication::put(std::uint32_t value, std::size_t bytes) {
  for (std::size_t left = bytes; left > 0; --left) {
    data_.push_back(static_cast<std::uint8_t>(value >> (8 * (left - 1))));
  }
}

void FramedApplication::reply(Status outcome, std::span<const std::uint8_t> data) {
  payload_.clear();
  for (const std::uint16_t word : {request_.id, posts_}) {
    payload_.push_back(static_cast<std::uint8_t>(word >> 8));
    payload_.push_back(static_cast<std::uint8_t>(word));
  }
  payload_.insert(payload_.end(), data.begin(), data.end());
  send(static_cast<std::uint8_t>(device_kind::reply + outcome), payload_);
}

void FramedApplication::send(std::uint8_t kind, std::span<const std::uint8_t> payload) {
  out_.resize(frame_bytes_max + 1);
  FrameEncoder encoder(out_, kind, key_);
  out_.resize(encoder.bytes(payload).finish());
  sent_ = 0;
}

}  // namespace unitylink::device
