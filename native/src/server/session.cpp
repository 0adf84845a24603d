// SPDX-License-Identifier: BSD-3-Clause
// Frames in and out, sessions, and the order of requests. session_requests.cpp has what the requests do,
// session_posts.cpp the posts.
#include "server/session.hpp"

#include <algorithm>
#include <utility>

#include "layer1_stream/frame_heads.hpp"

namespace unitylink::server {

namespace control = protocol::control;
namespace device_kind = protocol::device_kind;
namespace request_kind = protocol::request_kind;
namespace status = protocol::reply_status;

namespace {

constexpr std::uint8_t request_bits = protocol::frame::chained_bit | protocol::frame::barrier_bit;
constexpr std::uint32_t credit = 16384;      // bytes of requests that a client may have unanswered
constexpr std::size_t waiting_most = 65536;  // bytes of requests that wait; a client that sends more has to wait
constexpr std::size_t output_most = 65536;   // bytes for a client that does not read; then publishes are left out

bool is_post(std::uint8_t kind) noexcept { return kind == request_kind::post || kind == request_kind::post_list; }

void put(std::vector<std::uint8_t>& into, std::uint32_t value, std::size_t bytes) {
  for (std::size_t left = bytes; left > 0; --left) {
    into.push_back(static_cast<std::uint8_t>(value >> (8 * (left - 1))));
  }
}

}  // namespace

Session::Session(Host& host, Grant grant, std::uint16_t seed, std::uint64_t now_ns, std::uint32_t user)
    : host_(host),
      grant_(std::move(grant)),
      user_(user),
      nonce_(seed),
      places_(host.facts().description.window),
      fed_ns_(now_ns) {
  decoder_.set_payload_max(host.facts().description.request_max);
  sequences_.resize(host.facts().configuration.groups);
  forget({});
}

device::FrameRequest::Widths Session::widths() const noexcept {
  return {host_.facts().configuration.address_bytes, host_.facts().configuration.data_bytes};
}

// A server speaks no classic text. It makes exchange groups of lists.
std::uint32_t Session::features() const noexcept {
  using namespace protocol::control_value;
  const std::uint32_t board = host_.facts().description.features & ~(feature_classic | feature_exchanges);
  return board | ((board & feature_lists) != 0 ? feature_exchanges : 0) | protocol::serve::feature_dated_arm;
}

// ---- in

bool Session::wants_bytes() const noexcept {
  return waiting_bytes_ < waiting_most && out_.size() - sent_ < output_most;
}

void Session::take(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) {
  now_ns_ = now_ns;
  decoder_.feed(bytes, *this);
  pump();
}

void Session::on_frame(const Frame& frame) {
  if (frame.kind == request_kind::hello) {
    hello(frame.payload);
  } else if (frame.kind == request_kind::open) {
    open_session(frame.payload);
  } else if (!open()) {
    on_discard(Discard::check, frame.kind, 0);
  } else if ((frame.kind & protocol::frame::device_bit) != 0 ||
             (!is_post(frame.kind) && is_post(frame.kind & static_cast<std::uint8_t>(~request_bits)))) {
    counters_.discarded += 1;
  } else {
    fed_ns_ = now_ns_;
    waiting_.push_back({frame.kind, {frame.payload.begin(), frame.payload.end()}});
    waiting_bytes_ += sizeof(Waiting) + frame.payload.size();
  }
}

void Session::on_discard(Discard, std::uint8_t kind, std::size_t) {
  counters_.discarded += 1;
  if (!open() && kind != request_kind::hello && kind != request_kind::open && !closed_told_) {
    closed_told_ = true;
    send(device_kind::closed, {});
  }
}

std::uint64_t Session::dead_man_due_ns() const noexcept {
  const std::uint64_t hz = std::max<std::uint64_t>(1, host_.facts().configuration.base_hz);
  return dead_man_ticks_ == 0 ? Engine::no_deadline : fed_ns_ + std::uint64_t{dead_man_ticks_} * 1'000'000'000 / hz;
}

void Session::rest_dead_man(std::uint64_t now_ns) noexcept {
  resting_ticks_ = dead_man_due_ns() > now_ns && dead_man_ticks_ > 0 ? dead_man_ticks_ : resting_ticks_;
  dead_man_ticks_ = 0;
}

void Session::wake_dead_man(std::uint64_t now_ns) noexcept {
  if (resting_ticks_ > 0) {
    dead_man_ticks_ = std::exchange(resting_ticks_, 0);
    fed_ns_ = now_ns;
  }
}

// ---- sessions

void Session::hello(std::span<const std::uint8_t> payload) {
  if (payload.size() != 2) {
    counters_.discarded += 1;
    return;
  }
  const Facts& facts = host_.facts();
  closed_told_ = false;
  offered_ = true;
  const bool common = payload[0] <= protocol::frame::version && protocol::frame::version <= payload[1];
  std::vector<std::uint8_t> told;
  put(told, common ? protocol::frame::version : 0, 1);
  put(told, ++nonce_, 2);
  put(told, key_.epoch, 2);
  put(told, facts.configuration.address_bytes, 1);
  put(told, facts.configuration.data_bytes, 1);
  put(told, credit, 2);
  put(told, facts.description.request_max, 2);
  put(told, facts.description.reply_max, 2);
  put(told, facts.description.window, 1);
  put(told, facts.description.cache, 1);
  put(told, features(), 2);
  put(told, static_cast<std::uint32_t>(facts.description.spec_hash >> 32), 4);
  put(told, static_cast<std::uint32_t>(facts.description.spec_hash), 4);
  send(device_kind::hello, told);
}

void Session::open_session(std::span<const std::uint8_t> payload) {
  device::Fields fields(payload);
  const auto nonce = static_cast<std::uint16_t>(fields.take(2));
  const auto epoch = static_cast<std::uint16_t>(fields.take(2));
  const std::uint32_t flags = fields.take(1);
  const std::uint32_t known =
      (features() & protocol::control_value::feature_long_frames) != 0 ? protocol::frame::checked_long_flag : 0;
  const bool again = open() && nonce == session_nonce_ && epoch == key_.epoch;
  const bool fresh = offered_ && nonce == nonce_ && epoch >> 8 != 0xFF && (flags & ~known) == 0;
  if (!fields.ended_well() || (!again && !fresh)) {
    counters_.discarded += 1;
    return;
  }
  if (!again) {
    offered_ = false;
    begin_session({epoch, (flags & protocol::frame::checked_long_flag) != 0});
    session_nonce_ = nonce;
  }
  std::vector<std::uint8_t> told;
  put(told, key_.epoch, 2);
  put(told, host_.clock_us(), 4);
  send(device_kind::open, told);
}

// A dead-man that still runs here belongs to a client that has lost its session, so it trips at once: its time is over.
// It goes before the groups, for which the board is waited for.
void Session::begin_session(const FrameKey& key) {
  host_.abandon(*this);
  if (std::exchange(dead_man_ticks_, 0) > 0) {
    host_.trip();
  }
  forget(key);
  for (std::uint32_t group = 0; group < sequences_.size(); ++group) {
    static_cast<void>(host_.define_group(*this, group, {}, 0, false));
  }
}

// All of the session before.
void Session::forget(const FrameKey& key) {
  key_ = key;
  decoder_.set_key(key);
  waiting_.clear();
  waiting_bytes_ = 0;
  asks_ = Ask::nothing;
  refused_ = 0;
  armed_ = false;
  running_ = 0;
  alone_ = false;
  for (std::size_t index = 0; index < places_.size(); ++index) {
    places_[index].id = static_cast<std::uint16_t>(index - places_.size());
    places_[index].empty = true;
    places_[index].running = false;
  }
  posts_ = failed_posts_ = first_failed_ = 0;
  first_failure_ = 0;
  publishing_ = false;
  exchanges_.assign((features() & protocol::control_value::feature_exchanges) != 0 ? exchanges_kept : 0, {});
  resting_ticks_ = 0;
  trips_ = host_.trips();
}

// ---- order

void Session::pump() {
  while (!waiting_.empty() && !alone_ && !lost_) {
    if (is_post(waiting_.front().kind)) {
      if (!start_posts()) {
        return;
      }
      continue;
    }
    if (!start(waiting_.front())) {
      return;
    }
    if (!waiting_.empty()) {  // CLOSE has emptied it
      waiting_bytes_ -= sizeof(Waiting) + waiting_.front().payload.size();
      waiting_.pop_front();
    }
  }
}

bool Session::executed(std::uint16_t id) const noexcept {
  const Place& place = places_[id & (places_.size() - 1)];
  return static_cast<std::uint16_t>(place.id - id) < 0x8000;
}

// Asks for the lease of a write that is allowed. The request waits meanwhile, and all behind it.
Session::Lack Session::lack(std::uint32_t address, bool writes) {
  if (!(writes ? grant_.writes : grant_.reads).has(address)) {
    return Lack::right;
  }
  if (!writes || grant_.leased.has(address)) {
    return Lack::nothing;
  }
  if (refused_ != 0) {
    return Lack::refused;
  }
  if (std::exchange(asks_, Ask::lease) == Ask::nothing) {
    host_.ask_for_lease(*this, address);
  }
  return Lack::answer;
}

bool Session::arms() const noexcept {
  return request_.operation == request_kind::write_control &&
         (request_.address == protocol::serve::dated_arm || (request_.address == control::arm && request_.value == 1));
}

// Not in the session in which the dead-man has tripped, and with the right to do it. Without a dead-man, too: the
// server itself has stopped such a board.
bool Session::may_ask_to_arm() const noexcept { return arms() && grant_.arm && trips_ == host_.trips(); }

// Who governs the server decides, and arms the board. A client that does not say when it has asked for it asks now. One
// that knows the server's clock badly may say that it asks later.
Session::Lack Session::lack_to_arm() {
  if (std::exchange(armed_, false)) {
    return Lack::nothing;
  }
  if (refused_ != 0) {
    return Lack::refused;
  }
  if (std::exchange(asks_, Ask::arm) == Ask::nothing) {
    const bool dated = request_.address == protocol::serve::dated_arm;
    const auto age_us = dated ? static_cast<std::int32_t>(host_.clock_us() - request_.value) : 0;
    host_.ask_to_arm(*this, static_cast<std::uint32_t>(std::max(age_us, 0)));
  }
  return Lack::answer;
}

// The first thing that `request_` lacks.
Session::Lack Session::lack() {
  if (may_ask_to_arm()) {
    return lack_to_arm();
  }
  Lack found = Lack::nothing;
  const auto look = [&](std::uint32_t address, bool writes) {
    found = found == Lack::nothing ? lack(address, writes) : found;
  };
  if (request_.operation == request_kind::read || request_.operation == request_kind::write) {
    look(request_.address, request_.operation == request_kind::write);
  } else if (request_.operation == request_kind::exchange && request_.address < exchanges_.size()) {
    for (const device::ExchangeWord& word : exchanges_[request_.address].outputs) {
      look(word.address, true);
    }
  }
  for (const device::ListWord& word : request_.words) {
    look(word.address, word.writes());
  }
  return found;
}

bool Session::refuses(Lack lack, Status& why) noexcept {
  why = lack == Lack::right ? protocol::serve::not_allowed : lack == Lack::refused ? std::exchange(refused_, 0) : 0;
  counters_.refused += why != 0 ? 1 : 0;
  return why != 0;
}

void Session::resume(Ask what, Status outcome) {
  if (asks_ == what) {  // else that session is over
    asks_ = Ask::nothing;
    refused_ = outcome;
    armed_ = outcome == status::ok && what == Ask::arm;
    pump();
  }
}

// ---- out

// Keeps the answer of a request that was executed, and sends it.
void Session::settle(std::uint16_t id, Status outcome, std::span<const std::uint8_t> data) {
  Place& place = place_of(id);
  place.running = false;
  if (outcome == status::ok || outcome == status::bus_error || outcome == status::bus_timeout) {
    place.id = id;
    place.empty = false;
    place.status = static_cast<std::uint8_t>(outcome);
    place.reply.assign(data.begin(), data.end());
    counters_.requests += 1;
  }
  reply(id, outcome, data);
}

void Session::reply(std::uint16_t id, Status outcome, std::span<const std::uint8_t> data) {
  payload_.clear();
  put(payload_, id, 2);
  put(payload_, posts_, 2);
  payload_.insert(payload_.end(), data.begin(), data.end());
  send(static_cast<std::uint8_t>(device_kind::reply + outcome), payload_);
}

void Session::send(std::uint8_t kind, std::span<const std::uint8_t> payload) {
  const std::size_t before = out_.size();
  out_.resize(before + frame_bytes(payload.size(), true));
  FrameEncoder encoder({out_.data() + before, out_.size() - before}, kind, key_);
  out_.resize(before + encoder.bytes(payload).finish());
}

void Session::sent(std::size_t bytes) noexcept {
  sent_ += bytes;
  if (sent_ == out_.size()) {
    out_.clear();
    sent_ = 0;
  }
}

void Session::publish(std::uint32_t group, std::uint32_t missing, std::uint32_t clock,
                      std::span<const std::uint8_t> words) {
  if (!publishing_) {
    return;
  }
  std::uint16_t& sequence = sequences_[group];
  sequence = static_cast<std::uint16_t>(sequence + missing);
  const std::uint16_t number = sequence++;
  if (out_.size() - sent_ >= output_most) {
    counters_.publishes_lost += 1;
    return;
  }
  counters_.publishes += 1;
  payload_.clear();
  put(payload_, group, 1);
  put(payload_, number, 2);
  put(payload_, clock, 4);
  payload_.insert(payload_.end(), words.begin(), words.end());
  send(device_kind::publish, payload_);
}

}  // namespace unitylink::server
