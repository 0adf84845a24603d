// SPDX-License-Identifier: BSD-3-Clause
// Lists: reads, writes, masked writes and additions in one message. Also what is done if the device knows no lists.
#include <algorithm>
#include <vector>

#include "layer1_stream/frame_heads.hpp"
#include "layer2_message/failure.hpp"
#include "layer2_message/framed_request.hpp"
#include "layer2_message/link.hpp"

namespace unitylink {
namespace {

namespace kinds = protocol::list_operation;

constexpr bool known_operation(std::uint32_t operation) noexcept {
  return operation == kinds::read || operation == kinds::read_fifo || operation == kinds::write ||
         operation == kinds::write_fifo || operation == kinds::write_masked || operation == kinds::add;
}

std::size_t reads_of(std::span<const ListWord> steps) noexcept {
  return static_cast<std::size_t>(
      std::count_if(steps.begin(), steps.end(), [](const ListWord& word) { return !word.writes(); }));
}

}  // namespace

Outcome Link::check_list(std::span<const ListWord> steps, std::size_t room) const {
  for (std::size_t index = 0; index < steps.size(); ++index) {
    const ListWord& word = steps[index];
    if (!known_operation(word.operation)) {
      return {Status::range, "operation " + std::to_string(index) +
                                 " of a list is of an unknown kind: " + std::to_string(word.operation)};
    }
    if (Outcome outcome = check_address(word.address, index); !outcome.ok()) {
      return outcome;
    }
    for (const std::uint32_t number : {word.value, word.mask}) {
      if (Outcome outcome = check_value(word.address, number, index); !outcome.ok()) {
        return outcome;
      }
    }
  }
  if (reads_of(steps) > room) {
    return {Status::range,
            "a list that reads " + std::to_string(reads_of(steps)) + " words, and room for " + std::to_string(room)};
  }
  return {};
}

// How many of the first steps fit into one message; 0: not even one.
std::size_t Link::list_fits(std::span<const ListWord> steps) const noexcept {
  const auto fits = [&](std::size_t count) {
    const std::span<const ListWord> part = steps.first(count);
    const std::size_t answer = reads_of(part) * configuration_.data_bytes;
    const bool takes =
        std::any_of(part.begin(), part.end(), [](const ListWord& word) { return word.operation == kinds::read_fifo; });
    return frame_head::list + bytes_of(part, configuration_) <= description_.request_max &&
           frame_head::list_reply + answer <= description_.reply_max && (!takes || 2 + answer <= description_.cache);
  };
  std::size_t low = 0;
  std::size_t high = steps.size();
  while (low < high) {
    const std::size_t middle = (low + high + 1) / 2;
    (fits(middle) ? low : high) = fits(middle) ? middle : middle - 1;
  }
  return low;
}

Outcome Link::list(std::span<const ListWord> steps, std::span<std::uint32_t> values, bool atomic,
                   const RequestOptions& how) {
  if (Outcome outcome = check_list(steps, values.size()); !outcome.ok() || steps.empty()) {
    return outcome;
  }
  const bool lists = framed_ && (description_.features & protocol::control_value::feature_lists) != 0;
  const std::size_t most = lists ? list_fits(steps) : 0;
  if (atomic && most < steps.size() && steps.size() > 1) {
    return {Status::mismatch, lists ? "the device takes " + std::to_string(most) + " of these " +
                                          std::to_string(steps.size()) +
                                          " operations in one message; do less at once, or without atomic"
                                    : "operations that nothing comes between need gateware with lists of the framed "
                                      "protocol; do them without atomic"};
  }
  if (most == 0) {
    return list_apart(steps, values, how);
  }
  Call call;
  std::vector<std::size_t> begins;
  std::size_t read = 0;
  for (std::size_t begin = 0; begin < steps.size();) {
    const std::size_t count = begin == 0 ? most : list_fits(steps.subspan(begin));
    if (count == 0) {
      return {Status::mismatch, "operation " + std::to_string(begin) + " of a list does not fit the device's messages"};
    }
    Exchange exchange;
    prepare(exchange, how);
    exchange.operation = Operation::list;
    exchange.steps = steps.subspan(begin, count);
    exchange.values = values.subspan(read, reads_of(exchange.steps));
    exchange.atomic = atomic;
    exchange.chained = begin > 0;
    read += exchange.values.size();
    begins.push_back(begin);
    call.exchanges.push_back(exchange);
    begin += count;
  }
  for (Exchange& exchange : call.exchanges) {
    exchange.batch = &call.batch;
  }
  run(call.exchanges);
  Outcome outcome = result(call);
  if (!outcome.ok()) {
    const std::size_t failed = first_failed(call.exchanges);
    outcome.index = static_cast<std::uint32_t>(begins[failed]) + call.exchanges[failed].words;
  }
  return outcome;
}

// Does the steps without lists. Reads in a row become one call, and so do writes.
Outcome Link::list_apart(std::span<const ListWord> steps, std::span<std::uint32_t> values, const RequestOptions& how) {
  std::size_t read = 0;
  for (std::size_t begin = 0; begin < steps.size();) {
    const std::uint32_t operation = steps[begin].operation;
    const bool changes = operation == kinds::write_masked || operation == kinds::add;
    std::size_t end = begin + 1;
    while (!changes && end < steps.size() && steps[end].operation == operation) {
      ++end;
    }
    std::vector<std::uint32_t> addresses;
    std::vector<std::uint32_t> words;
    for (const ListWord& word : steps.subspan(begin, end - begin)) {
      addresses.push_back(word.address);
      words.push_back(word.value);
    }
    Outcome outcome;
    if (changes) {
      std::uint32_t old = 0;
      const ListWord& word = steps[begin];
      outcome = this->read(word.address, old, how);
      if (outcome.ok()) {
        const std::uint32_t sum = configuration_.data_bytes >= 4
                                      ? old + word.value
                                      : (old + word.value) & ((1u << 8 * configuration_.data_bytes) - 1);
        outcome =
            write(word.address, operation == kinds::add ? sum : (old & ~word.mask) | (word.value & word.mask), how);
      }
    } else if (steps[begin].writes()) {
      outcome = write_many(addresses, words, how);
    } else {
      RequestOptions asked = how;
      asked.repeat = operation == kinds::read;
      outcome = read_each(addresses, values.subspan(read, addresses.size()), asked);
      read += addresses.size();
    }
    if (!outcome.ok()) {
      outcome.index += static_cast<std::uint32_t>(begin);
      const bool wrote = std::any_of(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(begin),
                                     [](const ListWord& word) { return word.writes(); });
      return wrote ? behind_writes(std::move(outcome)) : outcome;
    }
    begin = end;
  }
  return {};
}

}  // namespace unitylink
