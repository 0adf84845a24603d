// SPDX-License-Identifier: BSD-3-Clause
// What the requests of a client do: most go to the board, some concern the client alone.
#include <algorithm>
#include <iterator>

#include "layer1_stream/frame_heads.hpp"
#include "layer2_message/framed_request.hpp"
#include "server/session.hpp"

namespace unitylink::server {

namespace control = protocol::control;
namespace list = protocol::list_operation;
namespace request_kind = protocol::request_kind;
namespace status = protocol::reply_status;

namespace {

constexpr std::uint32_t running_reads_most = 16;  // of one client at the board, or waiting for their turn

// Requests that the board never sees.
bool is_local(std::uint8_t operation) noexcept {
  return operation == request_kind::sync || operation == request_kind::close ||
         operation == request_kind::define_group || operation == request_kind::define_exchange ||
         operation == request_kind::write_control;
}

void append(std::vector<std::uint8_t>& into, std::uint32_t value, std::size_t bytes) {
  for (std::size_t left = bytes; left > 0; --left) {
    into.push_back(static_cast<std::uint8_t>(value >> (8 * (left - 1))));
  }
}

std::size_t bytes_of(std::span<const device::ExchangeWord> words) noexcept {
  std::size_t bytes = 0;
  for (const device::ExchangeWord& word : words) {
    bytes += word.bytes;
  }
  return bytes;
}

}  // namespace

// False: it must wait for the requests before it.
bool Session::start(const Waiting& next) {
  if (next.payload.size() < 2) {
    counters_.discarded += 1;
    return true;
  }
  const bool whole = request_.parse(next.kind, next.payload, widths());
  const bool lists = (features() & protocol::control_value::feature_lists) != 0;
  if (!whole || (request_.operation == request_kind::list && !lists) ||
      (request_.operation == request_kind::define_group && sequences_.empty())) {
    reply(static_cast<std::uint16_t>(next.payload[0] << 8 | next.payload[1]), status::invalid, {});
    return true;
  }
  const Place& place = place_of(request_.id);
  const auto distance = static_cast<std::uint16_t>(request_.id - place.id);
  if (place.running || distance >= 0x8000 || (distance == 0 && place.empty)) {
    counters_.repeats += 1;  // its answer will come, or nobody waits for it
    return true;
  }
  if (distance == 0) {
    counters_.repeats += 1;
    reply(request_.id, place.status, place.reply);
    return true;
  }
  const bool changes = request_.operation == request_kind::write || request_.operation == request_kind::exchange ||
                       std::any_of(request_.words.begin(), request_.words.end(),
                                   [](const device::ListWord& word) { return word.writes(); });
  const bool in_turn = changes || request_.chained || request_.barrier || is_local(request_.operation);
  if ((in_turn && running_ > 0) || running_ >= running_reads_most) {
    return false;
  }
  if (request_.chained && !executed(static_cast<std::uint16_t>(request_.id - 1))) {
    reply(request_.id, status::order, {});
  } else if (request_.barrier && *request_.barrier != posts_) {
    reply(request_.id, status::behind, {});
  } else if (const Lack lacking = lack(); lacking == Lack::answer) {
    return false;
  } else if (Status why = 0; refuses(lacking, why)) {
    reply(request_.id, why, {});
  } else {
    perform(next);
  }
  return true;
}

void Session::perform(const Waiting& next) {
  const std::size_t word_bytes = widths().data_bytes;
  const auto body = std::span<const std::uint8_t>(next.payload).subspan(request_.barrier ? 4 : 2);
  const auto kind = request_.operation;
  switch (kind) {
    case request_kind::read: forward(kind, body, word_bytes, false); break;
    case request_kind::write: forward(kind, body, 0, true); break;
    case request_kind::list: {
      const auto reads = static_cast<std::size_t>(std::count_if(
          request_.words.begin(), request_.words.end(), [](const device::ListWord& word) { return !word.writes(); }));
      forward(kind, body, 2 + reads * word_bytes, reads < request_.words.size());
      break;
    }
    case request_kind::read_control:
      if (request_.address == protocol::serve::dated_arm) {
        tell_clock();
        break;
      }
      forward(kind, body, 4 * std::size_t{request_.value}, false);
      break;
    case request_kind::exchange: forward_exchange(); break;
    default: perform_here(); break;
  }
}

// Whether `request_` reads plain words only, so that one answer serves all who ask for the same.
bool Session::shareable() const noexcept {
  const Addresses& plain = host_.facts().plain;
  if (request_.operation == request_kind::read) {
    return plain.has(request_.address);
  }
  return request_.operation == request_kind::list &&
         std::ranges::all_of(request_.words, [&plain](const device::ListWord& word) {
           return word.operation == list::read && plain.has(word.address);
         });
}

void Session::forward(std::uint8_t kind, std::span<const std::uint8_t> body, std::size_t answer_bytes, bool changes) {
  Errand& errand = host_.errand();
  errand.session = this;
  errand.operation = request_.operation;
  errand.id = request_.id;
  errand.address = request_.address;
  errand.body.assign(body.begin(), body.end());
  errand.answer.resize(answer_bytes);
  errand.exchange.kind = kind;
  errand.exchange.changes = changes;
  errand.shareable = !changes && shareable();
  Place& place = place_of(request_.id);
  place.running = true;
  place.running_id = request_.id;
  running_ += 1;
  alone_ = changes;
  host_.submit(errand);
}

void Session::finish(Errand& errand) {
  running_ -= 1;
  alone_ = alone_ && !errand.exchange.changes;
  if (!errand.answered()) {
    lost_ = true;
    return;
  }
  const Status outcome = errand.exchange.reply_status;
  if (outcome == status::denied) {
    host_.notice_trip();
  }
  if (!errand.posts.empty()) {
    finish_posts(errand);
  } else {
    std::span<std::uint8_t> data(errand.answer);
    if (outcome != status::ok) {
      const bool told =
          errand.operation == request_kind::list && unitylink::executed(static_cast<std::uint8_t>(outcome));
      data = data.first(told ? 2 : 0);
      if (told) {
        data[0] = static_cast<std::uint8_t>(errand.exchange.words >> 8);
        data[1] = static_cast<std::uint8_t>(errand.exchange.words);
      }
    } else if (errand.operation == request_kind::exchange) {
      data = data.first(exchange_inputs(errand, data));
    } else if (errand.operation == request_kind::read_control) {
      overlay(errand, data);
    }
    settle(errand.id, outcome, data);
  }
  pump();
}

// ---- exchange groups: each is an atomic list of the board

void Session::forward_exchange() {
  if (request_.address >= exchanges_.size() || !exchanges_[request_.address].defined) {
    reply(request_.id, status::no_group, {});
    return;
  }
  const ExchangeGroup& group = exchanges_[request_.address];
  if (request_.data.size() != bytes_of(group.outputs)) {
    reply(request_.id, status::invalid, {});
    return;
  }
  const auto [address_bytes, data_bytes] = widths();
  payload_.assign(1, protocol::frame::atomic_flag);
  device::Fields fields(request_.data);
  if (!group.outputs.empty()) {
    append(payload_, list::write, 1);
    append(payload_, static_cast<std::uint32_t>(group.outputs.size()), 1);
    for (const device::ExchangeWord& word : group.outputs) {
      append(payload_, word.address, address_bytes);
      append(payload_, fields.take(word.bytes), data_bytes);
    }
  }
  if (!group.inputs.empty()) {
    append(payload_, list::read, 1);
    append(payload_, static_cast<std::uint32_t>(group.inputs.size()), 1);
    for (const device::ExchangeWord& word : group.inputs) {
      append(payload_, word.address, address_bytes);
    }
  }
  if (group.outputs.empty() && group.inputs.empty()) {
    settle(request_.id, status::ok, {});
    return;
  }
  const std::vector<std::uint8_t> body = payload_;
  forward(static_cast<std::uint8_t>(request_kind::list), body, 2 + group.inputs.size() * data_bytes, true);
}

// Turns the answer of the list into that of the exchange, in place. Returns its length.
std::size_t Session::exchange_inputs(const Errand& errand, std::span<std::uint8_t> data) const noexcept {
  const std::size_t word_bytes = widths().data_bytes;
  std::size_t from = 2, to = 0;
  for (const device::ExchangeWord& word : exchanges_[errand.address].inputs) {
    for (std::size_t byte = word_bytes - word.bytes; byte < word_bytes; ++byte) {
      data[to++] = data[from + byte];
    }
    from += word_bytes;
  }
  return to;
}

Session::Status Session::define_exchange() {
  const auto [address_bytes, data_bytes] = widths();
  const Description& board = host_.facts().description;
  const auto first_input = request_.members.begin() + static_cast<std::ptrdiff_t>(request_.outputs);
  const std::size_t inputs = request_.members.size() - request_.outputs;
  const std::size_t asked = frame_head::list + 2 * frame_head::operation +
                            request_.outputs * (address_bytes + data_bytes) + inputs * address_bytes;
  const std::size_t answered = frame_head::list_reply + inputs * data_bytes;
  if (request_.address >= exchanges_.size() || asked > board.request_max || answered > board.reply_max) {
    return status::no_group;
  }
  const auto without = [](const Addresses& addresses) {
    return [&addresses](const device::ExchangeWord& word) { return !addresses.has(word.address); };
  };
  if (std::any_of(request_.members.begin(), first_input, without(grant_.writes)) ||
      std::any_of(first_input, request_.members.end(), without(grant_.reads))) {
    counters_.refused += 1;
    return protocol::serve::not_allowed;
  }
  exchanges_[request_.address] = {{request_.members.begin(), first_input}, {first_input, request_.members.end()}, true};
  return status::ok;
}

// ---- what concerns the client alone

void Session::tell_clock() {
  std::vector<std::uint8_t> told;
  append(told, host_.clock_us(), 4);
  const bool alone = request_.value == 1;
  settle(request_.id, alone ? status::ok : status::bad_address, alone ? std::span(told) : std::span<std::uint8_t>());
}

void Session::perform_here() {
  switch (request_.operation) {
    case request_kind::sync: {
      std::vector<std::uint8_t> told;
      append(told, posts_, 2);
      append(told, failed_posts_, 2);
      append(told, first_failed_, 2);
      append(told, first_failure_, 1);
      settle(request_.id, status::ok, told);
      break;
    }
    case request_kind::close:
      settle(request_.id, status::ok, {});
      if (std::exchange(dead_man_ticks_, 0) > 0) {
        static_cast<void>(host_.set_dead_man());
      }
      begin_session({});
      break;
    case request_kind::define_exchange: settle(request_.id, define_exchange(), {}); break;
    case request_kind::define_group:
      if (request_.address >= sequences_.size() || request_.addresses.size() > host_.facts().configuration.group_size) {
        reply(request_.id, status::no_group, {});
      } else if (frame_head::publish + widths().data_bytes * request_.addresses.size() >
                 host_.facts().description.reply_max) {
        reply(request_.id, status::too_long, {});
      } else if (std::any_of(request_.addresses.begin(), request_.addresses.end(),
                             [this](std::uint32_t address) { return !grant_.reads.has(address); })) {
        counters_.refused += 1;
        reply(request_.id, protocol::serve::not_allowed, {});
      } else {
        sequences_[request_.address] = 0;
        const Status outcome = host_.define_group(*this, request_.address, request_.addresses, request_.value,
                                                  (request_.flags & protocol::frame::event_flag) != 0);
        settle_here(outcome);
      }
      break;
    default: settle_here(write_control()); break;
  }
}

void Session::settle_here(Status outcome) {
  if (outcome == Host::unanswered) {
    lost_ = true;
  } else {
    settle(request_.id, outcome, {});
  }
}

Session::Status Session::write_control() {
  const bool dead_man = (features() & protocol::control_value::feature_deadman) != 0;
  switch (request_.address) {
    case control::publish:
      if (sequences_.empty()) {
        return status::bad_address;
      }
      publishing_ = request_.value == 1;
      return request_.value > 1 ? status::invalid : status::ok;
    case control::deadman_ticks:
      if (!dead_man) {
        return status::bad_address;
      }
      if (grant_.writes.empty() && request_.value > 0) {
        counters_.refused += 1;
        return protocol::serve::not_allowed;
      }
      dead_man_ticks_ = request_.value;
      resting_ticks_ = 0;
      fed_ns_ = now_ns_;
      if (const Status outcome = host_.set_dead_man(); outcome != status::ok) {
        dead_man_ticks_ = 0;
        return outcome;
      }
      return status::ok;
    case control::arm:
    case protocol::serve::dated_arm:
      if (!grant_.arm) {
        counters_.refused += 1;
        return protocol::serve::not_allowed;
      }
      return !arms() ? status::invalid : trips_ != host_.trips() ? status::denied : status::ok;
    default: return status::bad_address;
  }
}

// The board's registers, but what belongs to the client.
void Session::overlay(const Errand& errand, std::span<std::uint8_t> values) const noexcept {
  for (std::size_t index = 0; 4 * index < values.size(); ++index) {
    std::uint8_t* const at = values.data() + 4 * index;
    std::uint32_t value = number_at(at, 4);
    switch (errand.address + index) {
      case control::features: value = features(); break;
      case control::exchanges:
        value = static_cast<std::uint32_t>(exchanges_.size()) << 16 | exchange_words_most();
        break;
      case control::deadman_ticks: value = dead_man_ticks_; break;
      case control::arm: value = (value & 1) | (dead_man_ticks_ > 0 ? 2u : 0u) | (publishing_ ? 4u : 0u); break;
      case control::publish: value = publishing_ ? 1 : 0; break;
      default: continue;
    }
    for (std::size_t byte = 0; byte < 4; ++byte) {
      at[byte] = static_cast<std::uint8_t>(value >> (8 * (3 - byte)));
    }
  }
}

// The words of an exchange group that is all outputs.
std::uint32_t Session::exchange_words_most() const noexcept {
  const auto [address_bytes, data_bytes] = widths();
  const std::size_t head = frame_head::list + 2 * frame_head::operation;
  const std::size_t most = host_.facts().description.request_max;
  return most > head ? static_cast<std::uint32_t>((most - head) / (address_bytes + data_bytes)) : 0;
}

}  // namespace unitylink::server
