// SPDX-License-Identifier: BSD-3-Clause
#include "layer2_message/mapped_engine.hpp"

#include <algorithm>
#include <string>

#include "layer2_message/failure.hpp"

namespace unitylink {
namespace {

// after so many reads with different values, the words count as always changing
constexpr std::size_t settling_passes = 8;

}  // namespace

bool MappedEngine::read(std::uint32_t address, std::uint32_t& value) noexcept {
  if (ended_ || !memory_.has(address)) {
    return false;
  }
  value = memory_.load(address);
  statistics_.requests += 1;
  statistics_.replies += 1;
  return true;
}

bool MappedEngine::write(std::uint32_t address, std::uint32_t value) noexcept {
  if (ended_ || !memory_.has(address)) {
    return false;
  }
  memory_.store(address, value);
  statistics_.requests += 1;
  statistics_.replies += 1;
  return true;
}

// Reads all words or none, because reading a word may have an effect.
bool MappedEngine::read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                             bool atomic) noexcept {
  if (ended_ || !std::ranges::all_of(addresses, [this](std::uint32_t address) { return memory_.has(address); })) {
    return false;
  }
  memory_.load(addresses, values);
  if (atomic && !memory_.settle(addresses, values, settling_passes)) {
    return false;
  }
  statistics_.requests += 1;
  statistics_.replies += 1;
  return true;
}

Outcome MappedEngine::describe(const Exchange& exchange) const {
  Outcome outcome;
  outcome.status = exchange.status;
  if (exchange.status == Status::bus_error) {
    outcome.has_address = true;
    outcome.address =
        exchange.operation == Operation::read_many ? exchange.addresses[exchange.words] : exchange.address;
    outcome.text = in_words([&] { return memory_.beyond(outcome.address); });
  } else {
    outcome.text = in_words([&] {
      const std::string words = std::to_string(exchange.addresses.size()) + " words";
      return exchange.operation != Operation::read_many ? "mapped memory has no protocol, and none of its requests"
             : !exchange.repeat ? "mapped memory gives words of one moment by reading them twice, and these may not be"
                                : words + " changed during each of " + std::to_string(settling_passes) +
                                      " readings: mapped memory cannot give them as of one moment; read them apart, or "
                                      "let the device hold them";
    });
  }
  return outcome;
}

void MappedEngine::submit(Exchange& exchange, std::uint64_t now_ns) noexcept {
  now_ns_ = exchange.begun_ns = now_ns;
  const bool cancelled = exchange.batch != nullptr && exchange.batch->failed;
  finish(exchange, ended_ ? *ended_ : cancelled ? Status::cancelled : execute(exchange, now_ns));
}

Status MappedEngine::execute(Exchange& exchange, std::uint64_t now_ns) noexcept {
  switch (exchange.operation) {
    case Operation::read: return read(exchange.address, exchange.value) ? Status::ok : Status::bus_error;
    case Operation::write: return write(exchange.address, exchange.value) ? Status::ok : Status::bus_error;
    case Operation::read_many: return read_words(exchange);
    case Operation::define_group: define(exchange, now_ns); return Status::ok;
    case Operation::enable_publishing:
    case Operation::enable_checked_publishing: return Status::ok;  // a group is polled as soon as it is defined
    case Operation::disable_publishing: forget_groups(); return Status::ok;
    default: return Status::mismatch;
  }
}

Status MappedEngine::read_words(Exchange& exchange) noexcept {
  if (exchange.atomic && !exchange.repeat) {
    return Status::mismatch;
  }
  if (!read_many(exchange.addresses, exchange.values, false)) {
    while (memory_.has(exchange.addresses[exchange.words])) {
      exchange.words += 1;
    }
    return Status::bus_error;
  }
  return !exchange.atomic || memory_.settle(exchange.addresses, exchange.values, settling_passes) ? Status::ok
                                                                                                  : Status::mismatch;
}

// ---- polling

void MappedEngine::define(const Exchange& exchange, std::uint64_t now_ns) noexcept {
  Group& group = groups_[exchange.address];
  const std::uint64_t period_ns = exchange.value * std::uint64_t{1'000'000'000} / configuration_.base_hz;
  group = {exchange.addresses, exchange.value == 0 ? 0 : std::max<std::uint64_t>(period_ns, 1), now_ns + period_ns};
  claim(exchange.address, exchange.ring);
}

// A group without a ring is not polled.
void MappedEngine::claim(std::uint32_t group, PublishRing* ring) noexcept {
  rings_[group] = ring;
  if (ring == nullptr) {
    groups_[group] = {};
  }
  find_next();
}

void MappedEngine::advance(std::uint64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (ended_ || now_ns < next_due_ns_) {
    return;
  }
  for (std::size_t number = 0; number < groups_.size(); ++number) {
    Group& group = groups_[number];
    if (group.period_ns > 0 && group.due_ns <= now_ns) {
      poll(group, *rings_[number], now_ns);
    }
  }
  find_next();
}

// A late poll counts once. The polls that should have come before it are lost.
void MappedEngine::poll(Group& group, PublishRing& ring, std::uint64_t now_ns) noexcept {
  const std::span<std::uint32_t> words = std::span(words_).first(group.addresses.size());
  memory_.load(group.addresses, words);
  statistics_.mismatched_publishes += memory_.settle(group.addresses, words, settling_passes) ? 0 : 1;
  statistics_.publishes += 1;
  statistics_.overruns += ring.push(now_ns, words) ? 0 : 1;
  const std::uint64_t late = (now_ns - group.due_ns) / group.period_ns;
  ring.lose(late);
  group.due_ns += (late + 1) * group.period_ns;
}

void MappedEngine::find_next() noexcept {
  next_due_ns_ = no_deadline;
  for (const Group& group : groups_) {
    next_due_ns_ = group.period_ns > 0 ? std::min(next_due_ns_, group.due_ns) : next_due_ns_;
  }
}

void MappedEngine::forget_groups() noexcept {
  groups_.fill({});
  find_next();
}

void MappedEngine::forget(Status status) noexcept {
  ended_ = status;
  forget_groups();
}

}  // namespace unitylink
