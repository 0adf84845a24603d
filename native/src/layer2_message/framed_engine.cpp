// SPDX-License-Identifier: BSD-3-Clause
// What is sent, and when. Received frames are in framed_engine_receive.cpp, sessions and missing answers in
// framed_engine_session.cpp.
#include "layer2_message/framed_engine.hpp"

#include <algorithm>

#include "layer2_message/framed_request.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::uint64_t posts_in_flight_bytes = 16384;  // most bytes of posts in flight, on a line without losses
constexpr std::uint64_t posts_in_flight_least = 4;
// most posts in flight after a loss, if the speed of the line is not known the device is asked for its count after each
// quarter of the posts that may be in flight
constexpr std::uint64_t posts_in_flight_blind = 32;
constexpr std::uint64_t confirm_part = 4;
// a request waits at least this part of the timeout before its first repeat, because hosts may pause
constexpr std::uint64_t wait_part = 20;
// after an answer has shown a loss, the repeat comes this long after a round trip (RFC 9002, 6.2)
constexpr std::uint64_t repeat_wait_ns = 1'000'000;
// how long after the last post of a burst the device is asked for its count
constexpr std::uint64_t confirm_patience_ns = 5'000'000;
// not the fence, because an answer to an earlier fence may still arrive
constexpr std::string_view classic_question = "#RLC\n";

}  // namespace

FramedEngine::FramedEngine(const EngineSettings& settings, bool probe) noexcept
    : settings_(settings), probe_(probe), offered_epoch_(static_cast<std::uint16_t>(settings.seed % epochs)) {
  for (Exchange* own : {&restoration_, &reading_}) {
    own->state_ = Exchange::State::done;
  }
  for (Exchange& own : confirmations_) {
    own.state_ = Exchange::State::done;
  }
}

void FramedEngine::configure(const Configuration& configuration) noexcept { configuration_ = configuration; }

void FramedEngine::claim(std::uint32_t group, PublishRing* ring) noexcept {
  Engine::claim(group, ring);
  if (ring == nullptr) {
    groups_[group] = {};
  }
}

void FramedEngine::submit(Exchange& exchange, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  queue(exchange, false);
}

void FramedEngine::queue(Exchange& exchange, bool first) noexcept {
  exchange.begun_ns = now_ns_;
  exchange.state_ = Exchange::State::waiting;
  exchange.follows_ = posts_.made();
  if (ended_) {
    finish(exchange, *ended_);
    return;
  }
  if (exchange.timeout_ns == 0) {
    exchange.timeout_ns = settings_.timeout_ns;
  }
  exchange.limit_ns_ = 0;
  look_ns_ = waiting_.empty() ? limit_of(exchange) : std::min(look_ns_, limit_of(exchange));
  if (first && (waiting_.empty() || !waiting_.front()->chained)) {
    exchange.follows_ = 0;
    waiting_.push_front(exchange);
  } else {
    waiting_.push_back(exchange);
  }
}

bool FramedEngine::post(std::span<const Post> words, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (ended_ || !posts_.fits(words.size())) {
    return false;
  }
  posts_.make(words);
  confirm_ns_ = std::min(confirm_ns_, now_ns + confirm_patience_ns);
  return true;
}

// ---- sending

std::span<const std::uint8_t> FramedEngine::transmit(std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (pending_begin_ == pending_end_) {
    pending_begin_ = pending_end_ = 0;
  }
  if (!ended_) {
    if (state_ == State::silent && (!waiting_.empty() || posts_.sent() < posts_.made())) {
      ask();
    }
    if (greeting_due_ && now_ns >= greeting_from_ns_) {
      encode_greeting();
    }
    if (state_ == State::open) {
      maintain();
      while (send_due() || send_next()) {}
    }
  }
  return std::span<const std::uint8_t>(pending_).subspan(pending_begin_, pending_end_ - pending_begin_);
}

void FramedEngine::sent(std::size_t bytes) noexcept {
  pending_begin_ += bytes;
  statistics_.bytes_sent += bytes;
  last_sent_ns_ = now_ns_;
}

std::size_t FramedEngine::backlog() const noexcept {
  std::size_t count = 0;
  for (const Exchange* waiting = waiting_.front(); waiting != nullptr; waiting = ExchangeList::after(*waiting)) {
    count += 1;
  }
  return count;
}

void FramedEngine::encode_greeting() noexcept {
  const std::span<std::uint8_t> space = room();
  if (space.size() < 64) {
    return;
  }
  space[0] = frame::delimiter;  // ends a message that was sent in part
  std::size_t size = 1;
  if (state_ == State::opening) {
    size += FrameEncoder(space.subspan(size), request_kind::open, FrameKey{})
                .word(greeting_->nonce, 2)
                .word(offered_epoch_, 2)
                .word(checked_long() ? frame::checked_long_flag : 0, 1)
                .finish();
  } else {
    size += FrameEncoder(space.subspan(size), request_kind::hello, FrameKey{})
                .word(frame::version, 1)
                .word(frame::version, 1)
                .finish();
    if (probe_ && sessions_ == 0) {  // gateware without frames skips HELLO, but answers this question
      std::copy(classic_question.begin(), classic_question.end(), space.begin() + static_cast<std::ptrdiff_t>(size));
      size += classic_question.size();
      space[size++] = frame::delimiter;
    }
    statistics_.fences += 1;
    for (Exchange* waiting = waiting_.front(); waiting != nullptr; waiting = ExchangeList::after(*waiting)) {
      waiting->attempts += 1;
    }
  }
  pending_end_ += size;
  greeting_due_ = false;
  greeting_sent_ns_ = now_ns_;
  if (state_ == State::opening && openings_ == 1) {
    opening_sent_ns_ = now_ns_;
  }
  greeting_deadline_ns_ = now_ns_ + greeting_wait_ns_ + allowance_ns(greeting_bytes);
}

// Sends the oldest request that must be sent (again).
bool FramedEngine::send_due() noexcept {
  for (std::uint16_t id = base_id_; due_ > 0 && id != next_id_; ++id) {
    Place& place = place_of(id);
    if (!place.used || !place.due ||
        (place.exchange != nullptr && place.unbound && posts_.sent() < place.exchange->follows_)) {
      continue;
    }
    if (place.exchange != nullptr && place.exchange->expired(now_ns_)) {
      give_up(place);  // what is sent now is a SYNC, after which the device executes no earlier copy
    }
    const std::size_t size = encode(place);
    if (size == 0) {
      return false;
    }
    commit(place, size);
    place.due = false;
    due_ -= 1;
    statistics_.retries += 1;
    return true;
  }
  return false;
}

// Sends the next new message: posts and requests in the order in which they were made.
bool FramedEngine::send_next() noexcept {
  if (given_up_ > 0) {  // a late copy of a given-up request must not undo what its caller does after the result
    return false;
  }
  if (!waiting_.empty() && waiting_.front()->follows_ <= posts_.sent()) {
    // posts do not wait for a request, because the requests that fill the window may wait for posts
    const bool question = is_confirmation(*waiting_.front());
    const bool sent = send_request();
    if (sent || !question) {
      return sent;
    }
  }
  return posts_.sent() < posts_.made() && send_post();
}

// Sends the first waiting request.
bool FramedEngine::send_request() noexcept {
  Exchange& exchange = *waiting_.front();
  if (exchange.operation == Operation::resynchronise) {  // a session is open: this request is done when the session is
                                                         // set up like the last one
    if (restoring()) {
      return false;
    }
    exchange.sent = true;
    exchange.attempts += 1;
    finish(waiting_.pop_front(), Status::ok);
    return true;
  }
  if (exchange.batch != nullptr && exchange.batch->failed) {
    finish(waiting_.pop_front(), exchange.left_out());
    return true;
  }
  if (exchange.expired(now_ns_)) {
    finish(waiting_.pop_front(), Status::timeout);
    return true;
  }
  if (exchange.operation == Operation::exchange && restoring()) {
    return false;  // its group may not be defined yet
  }
  Place& place = place_of(next_id_);
  // Only half of a large window is used. The other half is for requests after a lost one.
  const std::uint32_t most = window_ >= 64 ? window_ / 2 : window_;
  if (place.used || in_flight_ >= most) {
    return false;
  }
  Place fresh;
  fresh.exchange = &exchange;
  fresh.chained = exchange.chained;
  fresh.id = next_id_;
  const std::size_t size = encode(fresh);
  if (size == 0) {
    const bool hopeless = pending_begin_ == pending_end_;
    if (hopeless) {
      finish(waiting_.pop_front(), Status::range);
    }
    return hopeless;
  }
  const std::size_t limit = greeting_->credit;
  if (credit_ > 0 && credit_ + size > limit) {
    return false;
  }
  waiting_.pop_front();
  place = fresh;
  place.used = true;
  place.bytes = static_cast<std::uint32_t>(size);
  place.limit_ns = limit_of(exchange);
  exchange.state_ = Exchange::State::in_flight;
  exchange.sent = true;
  if (exchange.operation == Operation::define_group) {  // set at once, because a publish may arrive before the answer
    rings_[exchange.address] = exchange.ring;
    groups_[exchange.address] = {exchange.ring, exchange.addresses, exchange.value, exchange.on_event, 0};
  }
  if (exchange.operation == Operation::define_exchange) {
    exchange_groups_[exchange.address] = {exchange.outputs, exchange.inputs};
  }
  commit(place, size);
  credit_ += place.bytes;
  in_flight_ += 1;
  next_id_ += 1;
  return true;
}

// After a loss all posts on their way are sent again. Then at most two round trips are in flight: one on its way, and
// one being confirmed.
std::uint64_t FramedEngine::posts_most() const noexcept {
  if (now_ns_ >= careful_until_ns_) {
    return std::max(posts_in_flight_least, posts_in_flight_bytes / std::max<std::uint64_t>(1, post_bytes_));
  }
  const std::uint64_t post_ns = settings_.byte_time_ns * post_bytes_;
  return post_ns == 0 ? posts_in_flight_blind : posts_in_flight_least + 2 * quickest_ns_ / post_ns;
}

bool FramedEngine::send_post() noexcept {
  const bool confirming = std::any_of(confirmations_.begin(), confirmations_.end(),
                                      [](const Exchange& own) { return own.state_ == Exchange::State::in_flight; });
  // more posts are only sent while an answer is expected, or its absence will be noticed
  if (confirming && posts_.sent() - posts_.confirmed() >= posts_most()) {
    return false;
  }
  const std::uint64_t number = posts_.sent();
  const std::size_t count = posts_.words(number);
  std::array<std::uint32_t, post_words_max> addresses;
  std::array<std::uint32_t, post_words_max> values;
  for (std::size_t index = 0; index < count; ++index) {
    addresses[index] = posts_.word(number, index).address;
    values[index] = posts_.word(number, index).value;
  }
  FrameEncoder encoder(room(), count == 1 ? request_kind::post : request_kind::post_list, decoder_.key());
  encoder.word(static_cast<std::uint32_t>(number), 2);
  if (count == 1) {
    encoder.word(addresses[0], configuration_.address_bytes).word(values[0], configuration_.data_bytes);
  } else {
    put_post(encoder, std::span(addresses).first(count), std::span(values).first(count), configuration_);
  }
  const std::size_t size = encoder.finish();
  if (size == 0) {
    return false;
  }
  pending_end_ += size;
  post_bytes_ = size;
  statistics_.posts += posts_.repeats() ? 0 : count;
  statistics_.retries += posts_.repeats() ? 1 : 0;
  posts_.send();
  confirm();
  return true;
}

// The number of bytes of its frame. 0 if there is no room for them.
std::size_t FramedEngine::encode(Place& place) noexcept {
  const Exchange* const exchange = place.exchange;
  const bool taken_over = place.taken_over();
  if (place.unbound && !taken_over) {
    place.barrier = posts_.confirmed() < posts_.sent();
    place.post = static_cast<std::uint16_t>(posts_.sent());
  }
  const bool barrier = place.barrier && !taken_over;
  std::uint32_t kind = taken_over ? request_kind::sync : framed_kind(*exchange);
  kind |= (place.chained ? frame::chained_bit : 0) | (barrier ? frame::barrier_bit : 0);
  FrameEncoder encoder(room(), static_cast<std::uint8_t>(kind), decoder_.key());
  encoder.word(place.id, 2);
  if (barrier) {
    encoder.word(place.post, 2);
  }
  if (!taken_over) {
    put_request(encoder, *exchange, configuration_);
  }
  const std::size_t size = encoder.payload_bytes() <= greeting_->request_max ? encoder.finish() : 0;
  if (size == 0) {
    return 0;
  }
  return size;
}

// Call it when the frame of this place was sent.
void FramedEngine::commit(Place& place, std::size_t size) noexcept {
  if (place.wait_ns == 0) {
    const std::uint64_t most = place.exchange != nullptr ? place.exchange->timeout_ns : settings_.timeout_ns;
    const std::uint64_t least = place.transmissions == 0 ? most / wait_part : smoothed_ns_ + repeat_wait_ns;
    const std::uint64_t measured = smoothed_ns_ == 0 ? most : std::max(least, smoothed_ns_ + 4 * variation_ns_);
    place.wait_ns = std::min(most, measured) + allowance_ns(credit_ + size + greeting_->reply_max);
  }
  pending_end_ += size;
  place.unbound = false;
  place.transmissions += 1;
  place.last_order = ++order_;
  place.sent_ns = now_ns_;
  if (place.transmissions == 1) {
    place.first_order = place.last_order;
    place.first_sent_ns = now_ns_;
  }
  if (place.exchange != nullptr) {
    place.exchange->attempts += 1;
  }
  statistics_.requests += 1;
}

// Sends the engine's own requests when they are needed: the count of posts, the time of the device, a sign of life.
void FramedEngine::maintain() noexcept {
  confirm();
  const bool life_due = deadman_ticks_ > 0 && now_ns_ - last_sent_ns_ >= keep_alive_ns();
  if (idle(reading_) && (now_ns_ >= clock_due_ns_ || life_due)) {
    reading_ = Exchange{};
    reading_.operation = Operation::read_control;
    reading_.address = control::time_low;
    reading_.values = read_clock_;
    reading_.attempts_max = 1;
    clock_due_ns_ = now_ns_ + clock_interval_ns();
    queue(reading_, true);
  }
}

// Asks for the device's count of posts: after each quarter of those that may be in flight, and some time after the last
// one.
void FramedEngine::confirm() noexcept {
  if (posts_.made() == posts_.confirmed()) {
    confirm_ns_ = no_deadline;
  } else if (Exchange* const own = idle_confirmation();
             own != nullptr && (posts_.sent() >= confirming_ + posts_most() / confirm_part || now_ns_ >= confirm_ns_)) {
    *own = Exchange{};
    own->operation = Operation::synchronise;
    own->attempts_max = 3;
    queue(*own, true);  // in front of the posts still to be sent, because they may have to wait for its answer
    confirming_ = posts_.sent();
    confirm_ns_ = now_ns_ + std::max(confirm_patience_ns, 2 * smoothed_ns_);
  }
}

Exchange* FramedEngine::idle_confirmation() noexcept {
  const auto found =
      std::find_if(confirmations_.begin(), confirmations_.end(), [this](const Exchange& own) { return idle(own); });
  return found == confirmations_.end() ? nullptr : &*found;
}

bool FramedEngine::idle(const Exchange& exchange) const noexcept { return exchange.state_ == Exchange::State::done; }

}  // namespace unitylink
