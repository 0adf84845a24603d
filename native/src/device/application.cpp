// SPDX-License-Identifier: BSD-3-Clause
#include "device/application.hpp"

#include <algorithm>
#include <array>

#include "device/requests.hpp"

namespace unitylink::device {

namespace bytes = protocol::bytes;
namespace command = protocol::command;
namespace reply = protocol::reply;
namespace error = protocol::application_error;

namespace {

struct Command {
  std::string_view letters;
  bool arguments;  // a colon and data follow; without arguments the last letter is enough and the rest is ignored
};

constexpr std::array<Command, 12> commands{{{command::read, true},
                                            {command::read_many, true},
                                            {command::write, true},
                                            {command::read_configuration, false},
                                            {command::write_group_addresses, true},
                                            {command::write_group_rate, true},
                                            {command::read_group, true},
                                            {command::enable_publishing, false},
                                            {command::enable_checked_publishing, false},
                                            {command::disable_publishing, false},
                                            {command::write_event_mask, true},
                                            {command::read_event_mask, false}}};

bool reads_only(std::string_view letters) noexcept {
  return letters == command::read || letters == command::read_many || letters == command::read_configuration ||
         letters == command::read_group || letters == command::read_event_mask;
}

constexpr std::size_t longest_reply = 16 + 4 * protocol::limits::group_size_max;
constexpr Clock timeout_cycle = protocol::limits::bus_timeout_clocks + 1;

std::size_t common_prefix(std::string_view a, std::string_view b) noexcept {
  return static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
}

}  // namespace

Application::Application(const DeviceConfiguration& configuration, DatalinkReceiver& receiver,
                         SubscriptionManager& subscriptions, DatalinkTransmitter& transmitter, Bus& bus)
    : configuration_(configuration),
      receiver_(receiver),
      subscriptions_(subscriptions),
      transmitter_(transmitter),
      bus_(bus) {
  pending_.reserve(longest_reply);
  addresses_.reserve(protocol::limits::read_many_max);
}

Clock Application::request_clock() const noexcept {
  return receiver_.has_message() ? std::max(at_, receiver_.message().ready_at) : never;
}

Clock Application::publish_clock() const noexcept {
  const Clock pending = yielding_ ? never : subscriptions_.pending_at();
  return pending == never ? never : std::max(at_, pending);
}

Clock Application::next_clock() const noexcept {
  if (state_ == State::idle) {
    return std::min(request_clock(), publish_clock());
  }
  return state_ == State::emit && (transmitter_.full() || held()) ? never : at_;
}

void Application::step(Clock now) {
  switch (state_) {
    case State::idle: {
      const Clock request = request_clock();
      const Clock publish = publish_clock();
      at_ = std::min(request, publish);
      const bool publishes = publish == at_ && (request != at_ || configuration_.publish_mode == 2);
      if (!publishes) {
        begin_request();
      } else if (const auto group = subscriptions_.serve(now)) {
        begin_publish(*group);
      }
      break;
    }
    case State::emit: emit(); break;
    case State::single_access: access_single(); break;
    case State::block_access: access_block(); break;
  }
}

void Application::begin_request() {
  const Message& message = receiver_.message();
  request_ = true;
  at_ += timing::reply_head;
  pending_.clear();
  sent_ = 0;
  head(message.checked ? bytes::checked_head : bytes::plain_head);
  decision_ = at_;
  after_emit_ = State::idle;

  decide(message);
  state_ = State::emit;
  emit();
}

// Executes the request, or refuses it.
void Application::decide(const Message& message) {
  const std::string_view text(message.letters.data(), message.letters.size());
  std::size_t seen = 0;
  for (const Command& candidate : commands) {
    if (!has_command(configuration_, candidate.letters)) {
      continue;
    }
    const bool matches =
        candidate.arguments ? text == candidate.letters && message.colon : text.starts_with(candidate.letters);
    if (matches && yielding_ && !reads_only(candidate.letters)) {
      decision_ += candidate.letters.size();
      refuse(candidate.letters == command::write ? error::bus_error_write : error::incomplete_command);
      return;
    }
    if (matches) {
      Cursor cursor{message.data, candidate.letters.size() + (candidate.arguments ? 1 : 0)};
      execute(candidate.letters, cursor);
      decision_ += cursor.clocks;
      return;
    }
    seen = std::max(seen, common_prefix(text, candidate.letters));
  }
  decision_ += seen + 1;
  refuse(error::incomplete_command);
}

void Application::begin_publish(std::uint32_t group) {
  request_ = false;
  at_ += timing::reply_head;
  pending_.clear();
  sent_ = 0;
  head(checked_publish_ ? bytes::checked_publish : bytes::plain_publish);
  letters(reply::publish);
  mark(bytes::data_mark);
  const std::span<const std::uint32_t> addresses = subscriptions_.published(group);
  addresses_.assign(addresses.begin(), addresses.end());
  block_words_ = static_cast<std::uint32_t>(subscriptions_.addresses(group).size());
  group_ = group;
  next_address_ = 0;
  value(group, 1);
  value(block_words_, 1);
  decision_ = at_ + 1;
  after_emit_ = State::block_access;
  state_ = State::emit;
  emit();
}

// The head enters the FIFO at once. The other words enter after the decision, one per clock, while there is room.
void Application::emit() {
  while (sent_ < pending_.size()) {
    if (held()) {
      return;
    }
    if (sent_ == held_from_) {
      at_ = std::max(at_, receiver_.message().ready_at);
    }
    if (transmitter_.full()) {
      blocked_ = true;
      return;
    }
    if (blocked_) {
      at_ = std::max(at_, transmitter_.place_free_at());
      blocked_ = false;
    }
    Word word = pending_[sent_++];
    word.at = at_;
    transmitter_.push(word);
    at_ = word.kind == Word::Kind::head ? std::max(at_ + 1, decision_) : at_ + 1;
  }
  pending_.clear();
  sent_ = 0;
  held_from_ = never_held;
  switch (after_emit_) {
    case State::single_access: schedule_access(address_, State::single_access); break;
    case State::block_access: next_block_word(); break;
    default: finish(); break;
  }
}

void Application::schedule_access(std::uint32_t address, State state) {
  address_ = address;
  state_ = state;
  at_ += timing::bus_cycle - 1;  // the access happens when it is acknowledged
}

void Application::next_block_word() {
  if (configuration_.published_2012 && !request_ && next_address_ == addresses_.size() &&
      block_words_ == configuration_.group_size) {
    next_address_ = 0;  // 2012: its address counter has one bit too few for a full group
  }
  if (next_address_ < addresses_.size()) {
    if (request_) {
      ++at_;  // the address is read from the message
    }
    schedule_access(addresses_[next_address_++], State::block_access);
    return;
  }
  bus_.block(false, at_);
  after_emit_ = State::idle;
  state_ = State::emit;
  if (block_words_ > addresses_.size()) {
    ++at_;
    refuse_missing(error::missing_address);
  } else {
    tail();
  }
  emit();
}

void Application::access_single() {
  BusReply answer;
  if (write_) {
    answer.status = bus_.write(address_, write_value_, at_);
  } else {
    answer = bus_.read(address_, at_);
  }
  after_emit_ = State::idle;
  if (!refuse_access(answer.status, write_ ? error::bus_error_write : error::bus_error_read)) {
    letters(write_ ? reply::write : reply::read);
    if (!write_) {
      mark(bytes::data_mark);
      value(answer.value, configuration_.data_bytes());
    }
    tail();
  }
  emit();
}

void Application::access_block() {
  const BusReply answer = bus_.read(address_, at_);
  if (refuse_access(answer.status, error::bus_error_read)) {
    bus_.block(false, at_);
    if (configuration_.published_2012 && !request_ && answer.status == BusStatus::silent) {
      subscriptions_.ask_again(group_, at_);  // 2012: the request of the group stays set
    }
    after_emit_ = State::idle;
  } else {
    if (next_address_ == 1) {
      bus_.block(true, at_);
    }
    after_emit_ = State::block_access;
    value(answer.value, configuration_.data_bytes());
  }
  emit();
}

bool Application::held() const noexcept { return sent_ == held_from_ && receiver_.message().open; }

void Application::refuse_missing(std::string_view code) {
  held_from_ = pending_.size();
  refuse(code);
}

bool Application::refuse_access(BusStatus status, std::string_view code) {
  state_ = State::emit;
  at_ += status == BusStatus::silent ? timeout_cycle - (timing::bus_cycle - 1) : 1;
  if (status == BusStatus::ok) {
    return false;
  }
  refuse(status == BusStatus::silent ? error::bus_timeout : code);
  return true;
}

void Application::finish() {
  state_ = State::idle;
  if (request_) {
    receiver_.release(at_ + timing::buffer_swap);
  }
}

void Application::letters(std::string_view text) {
  for (const char c : text) {
    pending_.push_back({Word::Kind::letter, static_cast<std::uint8_t>(c), 0});
  }
}

void Application::value(std::uint32_t content, std::uint32_t width) {
  for (std::uint32_t byte = width; byte-- > 0;) {
    pending_.push_back({Word::Kind::data, static_cast<std::uint8_t>(content >> (8 * byte)), 0});
  }
}

void Application::success(std::string_view text) {
  letters(text);
  tail();
}

void Application::refuse(std::string_view code) {
  pending_.push_back({Word::Kind::error_mark, static_cast<std::uint8_t>(bytes::error_mark), 0});
  letters(code);
  tail();
}

}  // namespace unitylink::device
