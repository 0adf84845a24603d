// SPDX-License-Identifier: BSD-3-Clause
#include "layer2_message/framed_request.hpp"

#include <algorithm>
#include <array>

#include "unitylink/protocol.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::size_t count_max = 255;  // words in one operation of a list
constexpr std::size_t run_min = 8;      // from so many addresses in a row on, a run is shorter at every width

// The first words, as one operation. It has an address for each word, or only the first address of a run.
struct Part {
  std::size_t count = 1;
  bool together = false;
  std::uint32_t step = 0;  // from one address of a run to the next
};

// Returns the words before the next run, or the run that begins here. `same`: equal addresses also make a run.
Part first_part(std::span<const std::uint32_t> addresses, bool same) noexcept {
  std::size_t rising = 1;  // addresses in a row that end here
  std::size_t standing = 1;
  const std::size_t end = std::min(addresses.size(), count_max + run_min - 1);
  for (std::size_t at = 1; at < end; ++at) {
    const std::uint32_t step = addresses[at] - addresses[at - 1];
    rising = step == 1 ? rising + 1 : 1;
    standing = step == 0 && same ? standing + 1 : 1;
    if (std::max(rising, standing) < run_min) {
      continue;
    }
    if (at >= run_min) {
      return {.count = std::min(at + 1 - run_min, count_max)};
    }
    std::size_t count = run_min;
    while (count < addresses.size() && count < count_max && addresses[count] == addresses[count - 1] + step) {
      ++count;
    }
    return {.count = count, .together = true, .step = step};
  }
  return {.count = std::min(addresses.size(), count_max)};
}

// Encodes the addresses as operations of a list. If there are words to write, each operation contains its words.
void put_words(FrameEncoder& result, std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> words,
               const Configuration& configuration) noexcept {
  FrameEncoder encoder = result;  // a local copy, which the compiler can keep in registers
  const bool writes = !words.empty();
  const unsigned width = configuration.address_bytes;
  for (std::size_t at = 0; at < addresses.size();) {
    // Equal addresses make no run in a read, because a list may answer "too_long" to such a run.
    const Part part = first_part(addresses.subspan(at), writes);
    const std::uint32_t operation = !part.together   ? (writes ? list_operation::write : list_operation::read)
                                    : part.step == 0 ? list_operation::write_fifo
                                    : writes         ? list_operation::write_up
                                                     : list_operation::read_up;
    encoder.word(operation, 1).word(static_cast<std::uint32_t>(part.count), 1);
    for (std::size_t index = at; index < at + part.count; ++index) {
      if (!part.together || index == at) {
        encoder.word(addresses[index], width);
      }
      if (writes) {
        encoder.word(words[index], configuration.data_bytes);
      }
    }
    at += part.count;
  }
  result = encoder;
}

// Calls put(operation, its words, together) for each operation. `together`: the first address stands for all.
template <class Put>
void for_each_operation(std::span<const ListWord> steps, const Put& put) {
  const auto run_from = [steps](std::size_t at, std::uint32_t step) {
    std::size_t end = at + 1;
    while (end < steps.size() && end - at < count_max && steps[end].operation == steps[at].operation &&
           steps[end].address == steps[end - 1].address + step) {
      ++end;
    }
    return end - at;
  };
  for (std::size_t at = 0; at < steps.size();) {
    const std::uint32_t operation = steps[at].operation;
    const bool fifo = operation == list_operation::read_fifo || operation == list_operation::write_fifo;
    const bool plain = operation == list_operation::read || operation == list_operation::write;
    const std::size_t rising = plain ? run_from(at, 1) : 1;
    std::size_t count = fifo ? run_from(at, 0) : rising;
    const bool up = rising >= run_min;
    if (!fifo && !up) {  // single words, up to the next run
      count = 1;
      while (at + count < steps.size() && count < count_max && steps[at + count].operation == operation &&
             !(plain && run_from(at + count, 1) >= run_min)) {
        ++count;
      }
    }
    const std::uint32_t named = !up                                 ? operation
                                : operation == list_operation::read ? list_operation::read_up
                                                                    : list_operation::write_up;
    put(named, steps.subspan(at, count), fifo || up);
    at += count;
  }
}

void put_steps(FrameEncoder& encoder, std::span<const ListWord> steps, const Configuration& configuration) noexcept {
  for_each_operation(steps, [&](std::uint32_t operation, std::span<const ListWord> words, bool together) {
    encoder.word(operation, 1).word(static_cast<std::uint32_t>(words.size()), 1);
    for (std::size_t index = 0; index < words.size(); ++index) {
      if (!together || index == 0) {
        encoder.word(words[index].address, configuration.address_bytes);
      }
      if (operation == list_operation::write_masked) {
        encoder.word(words[index].mask, configuration.data_bytes);
      }
      if (words[index].writes()) {
        encoder.word(words[index].value, configuration.data_bytes);
      }
    }
  });
}

constexpr std::array<std::string_view, 14> names{"",         "bus_error",   "bus_timeout", "bad_address",  "denied",
                                                 "busy",     "invalid",     "too_long",    "order",        "behind",
                                                 "no_group", "not_allowed", "lease_held",  "stopped_since"};
static_assert(names.size() == serve::stopped_since + 1);

std::size_t reply_words(const Exchange& exchange) noexcept {
  return exchange.operation == Operation::read   ? 1
         : exchange.operation == Operation::list ? exchange.values.size()
                                                 : exchange.addresses.size();
}

// The bytes of the number of executed words, with which the reply to a list begins.
std::size_t done_bytes(const Exchange& exchange) noexcept {
  const bool list = exchange.operation == Operation::read_many || exchange.operation == Operation::transfer ||
                    exchange.operation == Operation::list ||
                    (exchange.operation == Operation::forward && exchange.kind == request_kind::list);
  return list ? 2 : 0;
}

}  // namespace

std::size_t bytes_of(std::span<const ListWord> steps, const Configuration& configuration) noexcept {
  std::size_t bytes = 0;
  for_each_operation(steps, [&](std::uint32_t operation, std::span<const ListWord> words, bool together) {
    const std::size_t data = words[0].writes() ? configuration.data_bytes : 0;
    const std::size_t mask = operation == list_operation::write_masked ? configuration.data_bytes : 0;
    bytes += 2 + (together ? 1 : words.size()) * configuration.address_bytes + words.size() * (data + mask);
  });
  return bytes;
}

void put_post(FrameEncoder& encoder, std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> words,
              const Configuration& configuration) noexcept {
  put_words(encoder, addresses, words, configuration);
}

std::size_t bytes_of(std::span<const ExchangeWord> words) noexcept {
  std::size_t bytes = 0;
  for (const ExchangeWord& word : words) {
    bytes += word.bytes;
  }
  return bytes;
}

std::optional<std::string_view> framed_status_name(std::uint8_t status) noexcept {
  return status < names.size() ? std::optional(names[status]) : std::nullopt;
}

std::uint8_t framed_kind(const Exchange& exchange) noexcept {
  switch (exchange.operation) {
    case Operation::read: return request_kind::read;
    case Operation::write: return request_kind::write;
    case Operation::read_many:
    case Operation::transfer:
    case Operation::list: return request_kind::list;
    case Operation::define_group: return request_kind::define_group;
    case Operation::define_exchange: return request_kind::define_exchange;
    case Operation::exchange: return request_kind::exchange;
    case Operation::read_control: return request_kind::read_control;
    case Operation::write_control: return request_kind::write_control;
    case Operation::close_session: return request_kind::close;
    case Operation::forward: return exchange.kind;
    default: return request_kind::sync;
  }
}

void put_request(FrameEncoder& encoder, const Exchange& exchange, const Configuration& configuration) noexcept {
  switch (exchange.operation) {
    case Operation::read: encoder.word(exchange.address, configuration.address_bytes); break;
    case Operation::write:
      encoder.word(exchange.address, configuration.address_bytes).word(exchange.value, configuration.data_bytes);
      break;
    case Operation::read_many:
    case Operation::transfer:
      encoder.word(exchange.atomic ? frame::atomic_flag : 0, 1);
      put_words(encoder, exchange.write_addresses, exchange.write_values, configuration);
      put_words(encoder, exchange.addresses, {}, configuration);
      break;
    case Operation::list:
      encoder.word(exchange.atomic ? frame::atomic_flag : 0, 1);
      put_steps(encoder, exchange.steps, configuration);
      break;
    case Operation::define_group:
      encoder.word(exchange.address, 1).word(exchange.value, 4).word(exchange.on_event ? frame::event_flag : 0, 1);
      encoder.word(static_cast<std::uint32_t>(exchange.addresses.size()), 1);
      for (const std::uint32_t address : exchange.addresses) {
        encoder.word(address, configuration.address_bytes);
      }
      break;
    case Operation::define_exchange:
      encoder.word(exchange.address, 1).word(static_cast<std::uint32_t>(exchange.outputs.size()), 1);
      encoder.word(static_cast<std::uint32_t>(exchange.inputs.size()), 1);
      for (const std::span<const ExchangeWord> words : {exchange.outputs, exchange.inputs}) {
        for (const ExchangeWord& word : words) {
          encoder.word(word.address, configuration.address_bytes).word(word.bytes, 1);
        }
      }
      break;
    case Operation::exchange:
      encoder.word(exchange.address, 1);
      for (std::size_t index = 0; index < exchange.outputs.size(); ++index) {
        encoder.word(exchange.write_values[index], exchange.outputs[index].bytes);
      }
      break;
    case Operation::read_control:
      encoder.word(exchange.address, 2).word(static_cast<std::uint32_t>(exchange.values.size()), 1);
      break;
    case Operation::write_control: encoder.word(exchange.address, 2).word(exchange.value, 4); break;
    case Operation::forward: encoder.bytes(exchange.body); break;
    default: break;
  }
}

std::size_t reply_bytes(const Exchange& exchange, const Configuration& configuration) noexcept {
  switch (exchange.operation) {
    case Operation::read:
    case Operation::read_many:
    case Operation::transfer:
    case Operation::list: return done_bytes(exchange) + reply_words(exchange) * configuration.data_bytes;
    case Operation::exchange: return bytes_of(exchange.inputs);
    case Operation::read_control: return 4 * exchange.values.size();
    case Operation::forward: return exchange.answer.size();
    case Operation::synchronise: return sync_reply_bytes;
    default: return 0;
  }
}

bool take_reply(Exchange& exchange, std::uint8_t status, std::span<const std::uint8_t> body,
                const Configuration& configuration) noexcept {
  const std::size_t width = configuration.data_bytes;
  const bool list = done_bytes(exchange) > 0;
  if (status != reply_status::ok) {
    if (body.size() != (executed(status) ? done_bytes(exchange) : 0)) {
      return false;
    }
    exchange.words = executed(status) && list ? number_at(body.data(), 2) : 0;
    exchange.reply_status = status;
    return true;
  }
  if (body.size() != reply_bytes(exchange, configuration)) {
    return false;
  }
  exchange.reply_status = status;
  switch (exchange.operation) {
    case Operation::read: exchange.value = number_at(body.data(), width); return true;
    case Operation::read_many:
    case Operation::transfer:
    case Operation::list: {
      const std::size_t words = reply_words(exchange);
      exchange.words = number_at(body.data(), 2);
      if (exchange.words !=
          (exchange.steps.empty() ? exchange.write_addresses.size() + words : exchange.steps.size())) {
        return false;
      }
      for (std::size_t index = 0; index < words; ++index) {
        exchange.values[index] = number_at(body.data() + 2 + index * width, width);
      }
      return true;
    }
    case Operation::exchange:
      for (std::size_t index = 0, at = 0; index < exchange.inputs.size(); ++index) {
        exchange.values[index] = number_at(body.data() + at, exchange.inputs[index].bytes);
        at += exchange.inputs[index].bytes;
      }
      return true;
    case Operation::read_control:
      for (std::size_t index = 0; index < exchange.values.size(); ++index) {
        exchange.values[index] = number_at(body.data() + 4 * index, 4);
      }
      return true;
    case Operation::forward: std::copy(body.begin(), body.end(), exchange.answer.begin()); return true;
    case Operation::synchronise:
      exchange.words = number_at(body.data() + 2, 2);
      exchange.value = number_at(body.data() + 4, 2);
      exchange.first_failure = body[6];
      return true;
    default: return true;
  }
}

}  // namespace unitylink
