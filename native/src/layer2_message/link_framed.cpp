// SPDX-License-Identifier: BSD-3-Clause
// What only the framed protocol can do, and what a classic link does instead.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "layer1_stream/frame_heads.hpp"
#include "layer2_message/failure.hpp"
#include "layer2_message/link.hpp"

namespace unitylink {
namespace {

constexpr std::size_t list_of_one_bytes = frame_head::list + frame_head::operation;

constexpr std::size_t words_max = 255;  // most words in one operation
constexpr std::size_t posts_per_flush = 256;
constexpr std::uint64_t silence_margin_ns = 400'000;
constexpr std::uint32_t server_clock_questions = 3;
constexpr std::uint64_t quick_answer_ns = 50'000'000;
constexpr double ticks_max = 4294967295.0;  // periods of the base frequency

// Asks a server for its clock, until an answer has come quickly. What is known from the begin of the session gets worse
// with each hour, and an answer that the line has held up says little.
Outcome ask_server_clock(Link& link, const RequestOptions& how) {
  Outcome outcome;
  for (std::uint32_t question = 0; question < server_clock_questions; ++question) {
    const std::uint64_t asked_ns = link.now_ns();
    std::uint32_t told_us = 0;  // the engine learns it
    outcome = link.read_control(protocol::serve::dated_arm, std::span(&told_us, 1), how);
    if (!outcome.ok() || link.now_ns() - asked_ns < quick_answer_ns) {
      break;
    }
  }
  return outcome;
}

}  // namespace

Outcome Link::framed_only(const char* what) const {
  return {Status::mismatch, std::string(what) + " needs gateware with the framed protocol; " +
                                (mapped_ ? "mapped memory has no protocol" : "this link speaks the classic one")};
}

// The most words that one message can read. Without `repeat` the device must keep the reply, so there are fewer. 0: it
// knows no lists.
std::size_t Link::words_read(bool repeat) const noexcept {
  if ((description_.features & protocol::control_value::feature_lists) == 0) {
    return 0;
  }
  const std::size_t kept =
      description_.cache > 2 + configuration_.data_bytes ? (description_.cache - 2) / configuration_.data_bytes : 0;
  return std::min({words_max, (description_.reply_max - frame_head::list_reply) / configuration_.data_bytes,
                   (description_.request_max - list_of_one_bytes) / configuration_.address_bytes,
                   repeat ? words_max : kept});
}

std::size_t Link::words_written() const noexcept {
  if (!framed_ || (description_.features & protocol::control_value::feature_lists) == 0) {
    return 0;
  }
  return std::min<std::size_t>(words_max, (description_.request_max - list_of_one_bytes) /
                                              (configuration_.address_bytes + configuration_.data_bytes));
}

// The most words of post() in one message.
std::size_t Link::words_posted() const noexcept {
  const std::size_t list = words_written();
  return list > 1 ? std::min(list, FramedEngine::post_words_max) : 1;
}

Outcome Link::transfer(std::span<const std::uint32_t> write_addresses, std::span<const std::uint32_t> write_values,
                       std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values, bool atomic,
                       const RequestOptions& how) {
  if (write_values.size() != write_addresses.size() || values.size() < addresses.size()) {
    return {Status::range, std::to_string(write_addresses.size()) + " addresses to write and " +
                               std::to_string(write_values.size()) + " values; " + std::to_string(addresses.size()) +
                               " to read and room for " + std::to_string(values.size())};
  }
  const std::size_t width = configuration_.address_bytes;
  const std::size_t asked = list_of_one_bytes + 2 * frame_head::operation +
                            write_addresses.size() * (width + configuration_.data_bytes) + addresses.size() * width;
  const std::size_t answered = frame_head::list_reply + addresses.size() * configuration_.data_bytes;
  const bool together = words_written() > 0 && asked <= description_.request_max &&
                        answered <= description_.reply_max && write_addresses.size() <= words_max &&
                        addresses.size() <= words_max;
  if (together && write_addresses.size() + addresses.size() > 0) {
    Exchange exchange;
    prepare(exchange, how);
    exchange.operation = Operation::transfer;
    exchange.write_addresses = write_addresses;
    exchange.write_values = write_values;
    exchange.addresses = addresses;
    exchange.values = values;
    exchange.atomic = atomic;
    Outcome outcome = run_one(exchange);
    outcome.index = exchange.status == Status::ok ? outcome.index : exchange.words;
    return outcome;
  }
  if (atomic && !write_addresses.empty() && !mapped_) {
    return {Status::mismatch, "the device cannot do " + std::to_string(write_addresses.size()) + " writes and " +
                                  std::to_string(addresses.size()) +
                                  " reads in one message; do less at once, or without atomic"};
  }
  if (!write_addresses.empty()) {
    if (Outcome outcome = write_many(write_addresses, write_values, how); !outcome.ok()) {
      return outcome;
    }
  }
  if (addresses.empty()) {
    return {};
  }
  RequestOptions reading = how;
  reading.repeat = how.repeat || mapped_;  // mapped memory reads words twice to get them as of one moment
  Outcome outcome = read_many(addresses, values, atomic, reading);
  if (!write_addresses.empty()) {
    outcome = behind_writes(std::move(outcome));
  }
  outcome.index += outcome.ok() ? 0 : static_cast<std::uint32_t>(write_addresses.size());
  return outcome;
}

Outcome Link::post(std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> values,
                   const RequestOptions& how) {
  if (!framed_) {
    return write_many(addresses, values, how);
  }
  if (values.size() != addresses.size()) {
    return {Status::range,
            std::to_string(addresses.size()) + " addresses but " + std::to_string(values.size()) + " values"};
  }
  if (Outcome checked = check_writes(addresses, values, 0); !checked.ok()) {
    return checked;
  }
  const std::uint64_t limit_ns = (how.timeout_ns > 0 ? how.timeout_ns : options_.engine.timeout_ns) * options_.attempts;
  Lock lock(mutex_);
  ++callers_;
  Outcome outcome;
  std::uint64_t since_ns = now_ns();
  std::uint64_t confirmed = framed_->posts().confirmed();
  const std::size_t together = words_posted();
  std::array<Post, FramedEngine::post_words_max> words;
  for (std::size_t index = 0; index < addresses.size() && outcome.ok(); index += together) {
    const std::size_t count = std::min(together, addresses.size() - index);
    for (std::size_t word = 0; word < count; ++word) {
      words[word] = {addresses[index + word], values[index + word]};
    }
    while (engine_->ended() || !takes_requests() || !framed_->post(std::span(words).first(count), now_ns())) {
      if (engine_->ended()) {
        outcome = {*engine_->ended(), "the link is closed (" + reason_ + ")"};
        break;
      }
      if (!takes_requests()) {
        outcome = {Status::down, "the line is gone (" + lost_because_ +
                                     ") and is being opened again; sync() tells what is not known of earlier posts"};
        break;
      }
      flush(now_ns());
      turn(lock, now_ns() + options_.engine.timeout_ns);
      if (framed_->posts().confirmed() != confirmed) {
        confirmed = framed_->posts().confirmed();
        since_ns = now_ns();
      } else if (now_ns() - since_ns > limit_ns) {
        outcome = {Status::timeout,
                   "posts unconfirmed after " + duration_text(now_ns() - since_ns) + ", and no room for more"};
        break;
      } else if (interrupted(lock)) {
        outcome = {Status::cancelled, "interrupted; earlier posts of this call were made"};
        break;
      }
    }
    outcome.index = static_cast<std::uint32_t>(index);
    if (index / posts_per_flush != (index + count) / posts_per_flush) {
      flush(now_ns());
    }
  }
  flush(now_ns());
  --callers_;
  last_call_ns_ = engine_->now_ns();
  if (leading_ && (blocked_ || engine_->next_deadline_ns() < leading_until_ns_)) {
    wake();
  }
  hand_over();
  return outcome;
}

Outcome Link::sync(const RequestOptions& how) {
  if (!framed_) {
    return {};
  }
  Exchange exchange;
  prepare(exchange, how);
  exchange.operation = Operation::synchronise;
  run(std::span(&exchange, 1));
  if (exchange.status != Status::ok) {
    return outcome_of(exchange);
  }
  const std::scoped_lock lock(mutex_);
  if (const std::uint64_t unknown = framed_->take_unknown_posts(); unknown > 0) {
    return {Status::unknown,
            std::to_string(unknown) +
                " posts were made, and the device was reset or taken over by another host, or the line lost, before it "
                "had confirmed them: read back what matters before going on"};
  }
  const std::uint32_t known = failed_session_ == framed_->sessions() ? failed_posts_ : 0;
  failed_session_ = framed_->sessions();
  failed_posts_ = exchange.words;
  if (exchange.words <= known) {
    return {};
  }
  const std::uint32_t failed = exchange.words - known;
  const bool denied = exchange.first_failure == protocol::reply_status::denied;
  Outcome outcome(
      denied ? Status::denied : Status::bus_error,
      std::to_string(failed) + (failed == 1 ? " post was " : " posts were ") +
          (denied ? "denied: the dead-man has tripped and the outputs are safe; arm() lets them be written again"
                  : "refused by the device's bus, or nothing answered there"));
  const PostQueue& posts = framed_->posts();
  const std::uint64_t first = posts.told() - ((posts.told() - exchange.value) & 0xFFFF);
  if (known == 0 && posts.known(first) && posts.words(first) > 1) {
    outcome.text += "; the first was one of " + std::to_string(posts.words(first)) + " words from " +
                    hex_address(posts.word(first, 0).address, configuration_.address_bytes) +
                    " on, those behind it were not written";
  } else if (known == 0 && posts.known(first)) {
    outcome.has_address = true;
    outcome.address = posts.word(first, 0).address;
    outcome.text += "; the first was that of " + hex_address(outcome.address, configuration_.address_bytes);
  }
  return outcome;
}

Outcome Link::read_control(std::uint32_t address, std::span<std::uint32_t> values, const RequestOptions& how) {
  if (!framed_) {
    return framed_only("reading the device's own registers");
  }
  if (values.empty() || values.size() > words_max || address > 0xFFFF) {
    return {Status::range, "control registers: 1 to 255 of them from an address of 16 bits, not " +
                               std::to_string(values.size()) + " from " + hex_address(address, 2)};
  }
  Exchange exchange;
  prepare(exchange, how);
  exchange.repeat = true;
  exchange.operation = Operation::read_control;
  exchange.address = address;
  exchange.values = values;
  run(std::span(&exchange, 1), how.until_ns);
  return outcome_of(exchange);
}

Outcome Link::write_control(std::uint32_t address, std::uint32_t value, const RequestOptions& how) {
  if (!framed_) {
    return framed_only("writing the device's own registers");
  }
  if (address > 0xFFFF) {
    return {Status::range, "control registers have addresses of 16 bits, not " + hex_address(address, 2)};
  }
  Exchange exchange;
  prepare(exchange, how);
  exchange.operation = Operation::write_control;
  exchange.address = address;
  exchange.value = value;
  run(std::span(&exchange, 1), how.until_ns);
  return outcome_of(exchange);
}

Outcome Link::set_dead_man(double silence_s, const RequestOptions& how) {
  if (!framed_) {
    return framed_only("a dead-man");
  }
  if ((description_.features & protocol::control_value::feature_deadman) == 0) {
    return {Status::mismatch, "a dead-man is requested, but this gateware was built without one"};
  }
  const double ticks = std::ceil(silence_s * static_cast<double>(configuration_.base_hz));
  if (!(ticks >= 0 && ticks <= ticks_max)) {
    return {Status::range, "a dead-man waits for 0 to " +
                               std::to_string(ticks_max / static_cast<double>(configuration_.base_hz)) +
                               " s of silence, not " + std::to_string(silence_s)};
  }
  {
    const std::scoped_lock lock(mutex_);
    dead_man_ticks_ = static_cast<std::uint32_t>(ticks);
  }
  Outcome outcome = write_control(protocol::control::deadman_ticks, static_cast<std::uint32_t>(ticks), how);
  if (outcome.ok() && ticks > 0) {
    start_reader();  // it sends the signs of life while nobody calls
  }
  return outcome;
}

void Link::rest_dead_man(std::uint32_t ticks) {
  const std::scoped_lock lock(mutex_);
  dead_man_ticks_ = ticks;
  if (framed_) {
    framed_->stop_signs_of_life();  // else a new session would start it again
  }
}

std::uint32_t Link::dead_man_ticks() {
  const std::scoped_lock lock(mutex_);
  return dead_man_ticks_;
}

Outcome Link::arm(const RequestOptions& how) {
  const std::uint64_t asked_ns = now_ns();
  if (framed_ && (description_.features & protocol::serve::feature_dated_arm) != 0) {
    if (Outcome outcome = ask_server_clock(*this, how); !outcome.ok()) {
      return outcome;
    }
  }
  // A server is told when it was asked for: whoever asks does not know of a stop that comes to the server before this.
  const auto ask = [&] {
    std::optional<std::uint32_t> asked_us;
    if (framed_) {
      const std::scoped_lock lock(mutex_);
      asked_us = framed_->server_clock().latest_us(asked_ns);
    }
    return asked_us ? write_control(protocol::serve::dated_arm, *asked_us, how)
                    : write_control(protocol::control::arm, 1, how);
  };
  Outcome outcome = ask();
  if (outcome.status == Status::denied) {  // it tripped in this session, which may not arm it: another one is needed
    Exchange farewell;
    prepare(farewell, how);
    farewell.operation = Operation::close_session;
    run(std::span(&farewell, 1));
    if (farewell.status != Status::ok) {
      return outcome_of(farewell);
    }
    outcome = ask();
  }
  std::uint32_t ticks = 0;
  {
    const std::scoped_lock lock(mutex_);
    ticks = dead_man_ticks_;
  }
  if (outcome.ok() && ticks > 0) {
    outcome = write_control(protocol::control::deadman_ticks, ticks, how);
    start_reader();
  }
  return outcome;
}

Outcome Link::trip(const RequestOptions& how) {
  if (!framed_ || (description_.features & protocol::control_value::feature_deadman) == 0) {
    return framed_ ? Outcome{Status::mismatch, "this gateware was built without a dead-man"}
                   : framed_only("a dead-man");
  }
  const std::uint64_t tick_ns = 1'000'000'000 / std::max<std::uint64_t>(1, configuration_.base_hz);
  for (std::uint32_t attempt = 0; attempt < options_.attempts; ++attempt) {
    Outcome outcome = write_control(protocol::control::deadman_ticks, 1, how);
    if (!outcome.ok() && outcome.status != Status::denied) {
      return outcome;
    }
    rest_dead_man(dead_man_ticks());  // with its own limit, not with the one tick of this trip
    if (!outcome.ok()) {              // denied: it has tripped already
      return {};
    }
    {
      const std::scoped_lock lock(mutex_);
      silent_until_ns_ = now_ns() + 2 * tick_ns + silence_margin_ns;
    }
    if (outcome = pass(silent_until_ns_); !outcome.ok()) {
      return outcome;
    }
    std::uint32_t state = 0;
    if (outcome = read_control(protocol::control::arm, std::span(&state, 1), how); !outcome.ok() || (state & 1) != 0) {
      return outcome;
    }
  }
  return {Status::timeout, "the device's dead-man does not trip, although nothing is sent to it"};
}

ClockState Link::clock() {
  const std::scoped_lock lock(mutex_);
  if (!framed_ || !framed_->clock().valid()) {
    return {};
  }
  return {.period_ns = framed_->clock().period_ns(),
          .drift_ppm = framed_->clock().drift_ppm(),
          .uncertainty_ns = framed_->clock().uncertainty_ns()};
}

}  // namespace unitylink
