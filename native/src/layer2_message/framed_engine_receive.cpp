// SPDX-License-Identifier: BSD-3-Clause
// Gives each received frame to the request or the group that it belongs to.
#include <algorithm>

#include "layer1_stream/classic_decoder.hpp"
#include "layer1_stream/frame_heads.hpp"
#include "layer2_message/framed_engine.hpp"
#include "layer2_message/framed_request.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::uint8_t frame_kind_min = 0x80;  // a lower first byte begins a line of the classic protocol
// after a loss only few posts are in flight: for so long, or for the time of careful_posts if that is longer
constexpr std::uint64_t careful_ns = 40'000'000;
constexpr std::uint64_t careful_posts = 200;
constexpr std::uint32_t turns_at_once = 16;  // transmissions of a request that is answered with `order` or `behind`

Status status_of_reply(std::uint8_t status) noexcept {
  switch (status) {
    case reply_status::ok: return Status::ok;
    case reply_status::bus_error:
    case reply_status::bus_timeout: return Status::bus_error;
    case reply_status::denied: return Status::denied;
    case serve::not_allowed:
    case serve::stopped_since: return Status::refused;
    case serve::lease_held: return Status::lease_held;
    default: return Status::protocol_error;
  }
}

}  // namespace

struct FramedEngine::Sink {
  FramedEngine& engine;
  void on_frame(const Frame& frame) noexcept { engine.on_frame(frame); }
  void on_discard(Discard why, std::uint8_t, std::size_t bytes) noexcept {
    engine.statistics_.checksum_errors += why == Discard::check ? 1 : 0;
    engine.statistics_.malformed_messages += why == Discard::check ? 0 : 1;
    engine.statistics_.garbage_bytes += bytes;
  }
};

void FramedEngine::receive(std::span<const std::uint8_t> bytes, std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  statistics_.bytes_received += bytes.size();
  Sink sink{*this};
  while (!bytes.empty()) {
    if (!text_ && decoder_.pending() == 0 && bytes[0] < frame_kind_min && bytes[0] != frame::delimiter) {
      text_ = true;
      text_bytes_ = 0;
    }
    if (text_) {
      const auto end = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t byte) {
        return byte == frame::delimiter || byte == static_cast<std::uint8_t>(protocol::bytes::line_feed);
      });
      text_ = end == bytes.end();
      for (auto byte = bytes.begin(); byte != end && text_bytes_ < text_head_.size(); ++byte) {
        text_head_[text_bytes_++] = static_cast<char>(*byte);
      }
      if (!text_) {
        on_text();
      }
      bytes = bytes.subspan(text_ ? bytes.size() : static_cast<std::size_t>(end - bytes.begin()) + 1);
    } else {
      bytes = bytes.subspan(decoder_.take(bytes, sink));
    }
  }
}

// A line of the classic protocol. The answer to the classic question shows which device is there. A framed device
// answers HELLO before that, unless this answer was lost. A publish is no answer, because an old subscription may send
// it at any time. A board that serves another program says so in text, whatever it was asked.
void FramedEngine::on_text() noexcept {
  const std::string_view line(text_head_.data(), text_bytes_);
  if (!line.empty() && (line[0] == bytes::plain_publish || line[0] == bytes::checked_publish)) {
    statistics_.unclaimed_publishes += 1;
    return;
  }
  if (state_ != State::greeting || greeting_due_ || line.size() < 4) {
    return;
  }
  if (line == busy_line) {
    lasting_ ? cut(Status::busy, now_ns_) : end(Status::busy, now_ns_);
    return;
  }
  const std::string_view name = line.substr(1, 3);
  // an error is also an answer, because the gateware may not know the question
  const bool answers =
      line[0] == bytes::plain_head && (name == protocol::reply::read_configuration || name[0] == bytes::error_mark);
  if (!probe_ || !answers) {
    return;
  }
  if (++passed_over_ == probes) {
    refuse();
    return;
  }
  greeting_due_ = true;
  greeting_from_ns_ = 0;
  greeting_wait_ns_ = std::min(settings_.timeout_ns, 4 * (now_ns_ - greeting_sent_ns_) + settings_.timeout_ns / probes);
}

void FramedEngine::on_frame(const Frame& frame) noexcept {
  if (ended_) {
    return;
  }
  const std::span<const std::uint8_t> payload = frame.payload;
  switch (frame.kind) {
    case device_kind::publish: on_publish(payload); return;
    case device_kind::hello:
      if (const auto told = Greeting::parse(payload)) {
        on_greeting(*told);
        return;
      }
      break;
    case device_kind::open:
      if (payload.size() == 6) {
        on_opened(static_cast<std::uint16_t>(number_at(payload.data(), 2)), number_at(payload.data() + 2, 4));
        return;
      }
      break;
    case device_kind::closed:
      if (payload.empty()) {
        if (state_ == State::open) {
          ask();
        }
        return;
      }
      break;
    default:
      if (frame.kind >= device_kind::reply && frame.kind <= device_kind::reply + serve::stopped_since &&
          payload.size() >= frame_head::reply) {
        on_reply(static_cast<std::uint8_t>(frame.kind - device_kind::reply), payload);
        return;
      }
      break;
  }
  statistics_.malformed_messages += 1;
}

void FramedEngine::on_publish(std::span<const std::uint8_t> payload) noexcept {
  last_answer_ns_ = now_ns_;
  if (payload.size() < frame_head::publish) {
    statistics_.malformed_messages += 1;
    return;
  }
  const std::uint8_t number = payload[0];
  PublishRing* const ring = rings_[number];
  const std::size_t width = configuration_.data_bytes;
  if (ring == nullptr) {
    statistics_.unclaimed_publishes += 1;
  } else if (payload.size() != frame_head::publish + ring->words() * width) {
    statistics_.mismatched_publishes += 1;
  } else {
    Group& group = groups_[number];
    const auto sequence = static_cast<std::uint16_t>(number_at(payload.data() + 1, 2));
    const auto missing = static_cast<std::uint16_t>(sequence - group.sequence);
    if (missing >= 0x8000) {  // an old publish, out of order
      statistics_.mismatched_publishes += 1;
      return;
    }
    group.sequence = static_cast<std::uint16_t>(sequence + 1);
    statistics_.missing_publishes += missing;
    ring->miss(missing);
    const std::uint32_t clocks = number_at(payload.data() + 3, 4);
    statistics_.publishes += 1;
    if (tap_ != nullptr) {
      tap_->on_publish(number, missing, clocks, payload.subspan(frame_head::publish));
    }
    if (!ring->keeps()) {
      return;
    }
    const std::uint64_t time_ns = clock_.valid() ? std::min(now_ns_, clock_.host_ns(clocks, now_ns_)) : now_ns_;
    statistics_.overruns += ring->push(time_ns, payload.subspan(frame_head::publish), width) ? 0 : 1;
  }
}

void FramedEngine::on_reply(std::uint8_t status, std::span<const std::uint8_t> payload) noexcept {
  const auto id = static_cast<std::uint16_t>(number_at(payload.data(), 2));
  Place& place = place_of(id);
  const std::uint64_t confirmed = posts_.confirmed();
  // an old answer has an old count, which confirm() refuses
  if (posts_.confirm(number_at(payload.data() + 2, 2)) && posts_.confirmed() != confirmed) {
    progress_ns_ = now_ns_;
  }
  if (!place.used || place.id != id || place.transmissions == 0) {
    statistics_.stale_replies += 1;
    return;
  }
  last_answer_ns_ = now_ns_;
  in_vain_ = 0;
  if (place.transmissions == 1) {
    measure(now_ns_ - place.sent_ns);
  }
  // on a line that keeps the order, the answers of all earlier requests are lost
  for (std::uint16_t earlier = base_id_; earlier != id; ++earlier) {
    Place& other = place_of(earlier);
    if (other.used && other.last_order < place.first_order) {
      other.wait_ns = 0;  // its repeat gets a new time
      ask_again(other);
    }
  }
  on_answer(place, status, payload.subspan(frame_head::reply));
}

void FramedEngine::on_answer(Place& place, std::uint8_t status, std::span<const std::uint8_t> body) noexcept {
  Exchange* const exchange = place.exchange;
  if (place.taken_over() && !executed(status)) {
    if (status == reply_status::order && place.chained) {
      ask_in_turn(place);
    } else if (status == reply_status::invalid && believed(place)) {
      // the read was executed, but the device did not keep its long answer: read again
      release(place);
      if (exchange != nullptr) {
        finish(*exchange, exchange->cut_off());
      }
    }
    return;  // any other answer is for an earlier copy; the answer to the SYNC will follow
  }
  if (exchange == nullptr) {
    release(place);
    return;
  }
  if (place.refusal && status == reply_status::ok && body.size() == sync_reply_bytes) {
    release(place);
    finish(*exchange, *place.refusal);
    return;
  }
  if (status == reply_status::order && place.chained) {
    if (exchange->batch == nullptr || !exchange->batch->failed) {
      ask_in_turn(place);
    } else {
      refuse(place, Status::cancelled);
    }
    return;
  }
  if (status == reply_status::behind && !place.barrier) {
    return;  // this answers an earlier copy with another barrier; the answer to the last copy will follow
  }
  if (status == reply_status::behind) {
    if (static_cast<std::int16_t>(static_cast<std::uint16_t>(posts_.confirmed()) - place.post) < 0 &&
        place.last_order > gone_back_order_) {
      posts_.go_back();
      confirming_ = posts_.confirmed();
      careful_until_ns_ = now_ns_ + std::max(careful_ns, careful_posts * settings_.byte_time_ns * post_bytes_);
      gone_back_order_ = order_;
    }
    place.unbound = true;
    ask_in_turn(place);
    return;
  }
  const bool fits = take_reply(*exchange, status, body, configuration_);
  if ((status != reply_status::ok || !fits) && !believed(place)) {
    return;
  }
  if (!fits) {  // the device has other properties than it reports
    statistics_.malformed_messages += 1;
    release(place);
    finish(*exchange, exchange->writes() ? Status::unknown : Status::protocol_error);
    return;
  }
  statistics_.replies += 1;
  statistics_.device_errors += status == reply_status::ok ? 0 : 1;
  exchange->error = framed_status_name(status).value_or(std::string_view{});
  if (status == reply_status::ok) {
    on_executed(place);
  }
  if (!executed(status) && (exchange->writes() || exchange->batch != nullptr)) {
    refuse(place, status_of_reply(status));
    return;
  }
  const bool over = status == reply_status::ok && exchange->operation == Operation::close_session;
  release(place);
  progress_ns_ = is_own(*exchange) ? progress_ns_ : now_ns_;
  finish(*exchange, status_of_reply(status));
  if (over) {  // the session is closed; the next request opens another one
    lose_session();
    session_epoch_ = no_session;
    state_ = State::silent;
  } else if (exchange == &restoration_) {
    if (status == reply_status::ok || status == reply_status::denied) {  // a dead-man that has tripped is not started
      if (restored_ > restored_most_) {  // once for each step, however many sessions there are
        restored_most_ = restored_;
        progress_ns_ = now_ns_;
      }
      restore();
    } else {  // the earlier session had room for this, so the device is another one
      end(Status::mismatch, now_ns_);
    }
  }
}

// Takes from an answer what the engine itself needs.
void FramedEngine::on_executed(const Place& place) noexcept {
  const Exchange& exchange = *place.exchange;
  if (&exchange == &reading_) {
    if (place.transmissions == 1) {
      clock_.add(std::uint64_t{read_clock_[1]} << 32 | read_clock_[0], place.sent_ns, now_ns_);
    }
  } else if (exchange.operation == Operation::read_control && exchange.address == serve::dated_arm) {
    server_clock_.learn(exchange.values.front(), place.first_sent_ns);
  } else if (exchange.operation == Operation::write_control && exchange.address == control::publish) {
    publishing_ = exchange.value != 0;
    clock_due_ns_ = now_ns_;
  } else if (exchange.operation == Operation::write_control && exchange.address == control::deadman_ticks) {
    deadman_ticks_ = exchange.value;
  }
}

// Measures the round trip as TCP does (RFC 6298). So a repeat comes soon on a fast line, and not too soon on a line
// with changing delays.
void FramedEngine::measure(std::uint64_t round_trip_ns) noexcept {
  quickest_ns_ = std::min(quickest_ns_, round_trip_ns);
  if (smoothed_ns_ == 0) {
    smoothed_ns_ = std::max<std::uint64_t>(1, round_trip_ns);
    variation_ns_ = round_trip_ns / 2;
    return;
  }
  const std::uint64_t off = round_trip_ns > smoothed_ns_ ? round_trip_ns - smoothed_ns_ : smoothed_ns_ - round_trip_ns;
  variation_ns_ = (3 * variation_ns_ + off) / 4;
  smoothed_ns_ = std::max<std::uint64_t>(1, (7 * smoothed_ns_ + round_trip_ns) / 8);
}

void FramedEngine::ask_again(Place& place) noexcept {
  due_ += place.due ? 0 : 1;
  place.due = true;
}

// The device cannot execute it yet, because an earlier request was lost and is repeated. It is sent again at once, but
// after turns_at_once times only when it is late.
void FramedEngine::ask_in_turn(Place& place) noexcept {
  if (place.transmissions < turns_at_once) {
    ask_again(place);
  }
}

// True: the answer with an error has come twice, the second time to a repeat.
bool FramedEngine::believed(Place& place) noexcept {
  if (place.doubted && !place.due) {
    return true;
  }
  place.doubted = true;
  ask_again(place);
  return false;
}

// Ends a request that was not executed. It never will be, because a SYNC takes its id.
void FramedEngine::refuse(Place& place, Status status) noexcept {
  // a late answer to it would look like that to the SYNC
  if (reply_bytes(*place.exchange, configuration_) == sync_reply_bytes) {
    give_up(place);
    return;
  }
  place.refusal = status;
  place.barrier = place.unbound = place.doubted = false;
  ask_again(place);
}

void FramedEngine::release(Place& place) noexcept {
  due_ -= place.due ? 1 : 0;
  given_up_ -= place.exchange == nullptr ? 1 : 0;
  credit_ -= place.bytes;
  in_flight_ -= 1;
  place.used = place.due = false;
  while (base_id_ != next_id_ && !place_of(base_id_).used) {
    ++base_id_;
  }
}

}  // namespace unitylink
