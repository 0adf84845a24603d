// SPDX-License-Identifier: BSD-3-Clause
// Exchange groups: their words are named once. Then only data is sent, many times a second.
#include <algorithm>

#include "layer1_stream/frame_heads.hpp"
#include "layer2_message/failure.hpp"
#include "layer2_message/framed_request.hpp"
#include "layer2_message/link.hpp"

namespace unitylink {
namespace {

constexpr std::uint32_t slot_of(std::uint32_t id) noexcept { return id % protocol::limits::exchanges_max; }

std::vector<std::uint32_t> addresses_of(std::span<const ExchangeWord> words) {
  std::vector<std::uint32_t> addresses;
  addresses.reserve(words.size());
  for (const ExchangeWord& word : words) {
    addresses.push_back(word.address);
  }
  return addresses;
}

}  // namespace

struct Link::ExchangeLayout {
  std::uint32_t id = 0;
  std::vector<ExchangeWord> outputs;
  std::vector<ExchangeWord> inputs;
};

Outcome Link::check_exchange(const ExchangeLayout& layout) const {
  const std::size_t words = layout.outputs.size() + layout.inputs.size();
  std::size_t index = 0;
  for (const std::span<const ExchangeWord> sort : {std::span(layout.outputs), std::span(layout.inputs)}) {
    for (const ExchangeWord& word : sort) {
      if (Outcome outcome = check_address(word.address, index); !outcome.ok()) {
        return outcome;
      }
      if (word.bytes == 0 || word.bytes > configuration_.data_bytes) {
        Outcome outcome(Status::range, "word " + hex_address(word.address, configuration_.address_bytes) +
                                           " of an exchange group: 1 to " + std::to_string(configuration_.data_bytes) +
                                           " bytes of it can travel, not " + std::to_string(word.bytes));
        outcome.has_address = true;
        outcome.address = word.address;
        return outcome;
      }
      ++index;
    }
  }
  if (words == 0) {
    return {Status::range, "an exchange group without words"};
  }
  if (!framed_) {
    return {};
  }
  if ((description_.features & protocol::control_value::feature_exchanges) == 0) {
    return {Status::mismatch,
            "this gateware was built without exchange groups; use read_many and write_many, or exchange()"};
  }
  const auto too_large = [words](const std::string& why) {
    return Outcome{Status::mismatch, "an exchange group of " + std::to_string(words) + " words is too large: " + why +
                                         "; make two of it"};
  };
  if (words > description_.exchange_size) {
    return too_large("this gateware's hold " + std::to_string(description_.exchange_size));
  }
  const std::size_t definition = frame_head::exchange_definition + words * (configuration_.address_bytes + 1);
  const std::size_t asked = frame_head::exchange + bytes_of(layout.outputs);
  if (std::max(definition, asked) > description_.request_max) {
    return too_large("its messages would have " + std::to_string(std::max(definition, asked)) +
                     " bytes, and the device takes " + std::to_string(description_.request_max));
  }
  if (frame_head::reply + bytes_of(layout.inputs) > description_.reply_max) {
    return too_large("its answers would have " + std::to_string(frame_head::reply + bytes_of(layout.inputs)) +
                     " bytes, and the device sends " + std::to_string(description_.reply_max));
  }
  return {};
}

Outcome Link::define_exchange(std::span<const ExchangeWord> outputs, std::span<const ExchangeWord> inputs,
                              std::uint32_t& id) {
  auto layout = std::make_shared<ExchangeLayout>();
  layout->outputs.assign(outputs.begin(), outputs.end());
  layout->inputs.assign(inputs.begin(), inputs.end());
  if (Outcome outcome = check_exchange(*layout); !outcome.ok()) {
    return outcome;
  }
  const std::size_t groups =
      framed_ ? std::min<std::size_t>(description_.exchanges, exchanges_.size()) : exchanges_.size();
  std::uint32_t slot = 0;
  {
    const std::scoped_lock lock(mutex_);
    const auto end = exchanges_.begin() + static_cast<std::ptrdiff_t>(groups);
    const auto free = std::find(exchanges_.begin(), end, nullptr);
    if (free == end) {
      return {Status::mismatch,
              "all " + std::to_string(groups) + " exchange groups of the device are in use; close one"};
    }
    slot = static_cast<std::uint32_t>(free - exchanges_.begin());
    layout->id = slot + exchanges_made_++ * static_cast<std::uint32_t>(exchanges_.size());
    if (framed_ && !framed_->restoring()) {
      released_exchanges_.clear();
    }
    *free = layout;
  }
  id = layout->id;
  if (!framed_) {
    return {};
  }
  Exchange exchange;
  prepare(exchange, {.checked = std::nullopt, .repeat = true, .timeout_ns = 0});
  exchange.operation = Operation::define_exchange;
  exchange.address = slot;
  exchange.outputs = layout->outputs;
  exchange.inputs = layout->inputs;
  run(std::span(&exchange, 1));
  if (exchange.status != Status::ok) {
    release_exchange(id);
  }
  return outcome_of(exchange);
}

Outcome Link::exchange(std::uint32_t id, std::span<const std::uint32_t> outputs, std::span<std::uint32_t> inputs,
                       const RequestOptions& how) {
  std::shared_ptr<const ExchangeLayout> layout;
  {
    const std::scoped_lock lock(mutex_);
    layout = exchanges_[slot_of(id)];
  }
  if (!layout || layout->id != id) {
    return {Status::range, "there is no exchange group " + std::to_string(id) + "; it was closed"};
  }
  if (outputs.size() != layout->outputs.size() || inputs.size() < layout->inputs.size()) {
    return {Status::range, "an exchange group of " + std::to_string(layout->outputs.size()) + " outputs and " +
                               std::to_string(layout->inputs.size()) + " inputs, but " +
                               std::to_string(outputs.size()) + " values and room for " +
                               std::to_string(inputs.size())};
  }
  for (std::size_t index = 0; index < outputs.size(); ++index) {
    const ExchangeWord& word = layout->outputs[index];
    if (outputs[index] > highest(word.bytes)) {
      Outcome outcome(Status::range, "value " + hex_address(outputs[index], 0) + " for " +
                                         hex_address(word.address, configuration_.address_bytes) +
                                         " does not fit the " + std::to_string(word.bytes) +
                                         " bytes that the exchange group has for it");
      outcome.has_address = true;
      outcome.address = word.address;
      outcome.index = static_cast<std::uint32_t>(index);
      return outcome;
    }
  }
  if (!framed_) {
    if (!outputs.empty()) {
      if (Outcome outcome = write_many(addresses_of(layout->outputs), outputs, how); !outcome.ok()) {
        return outcome;
      }
    }
    const std::span<std::uint32_t> words = inputs.first(layout->inputs.size());
    Outcome outcome = words.empty() ? Outcome{} : read_many(addresses_of(layout->inputs), words, false, how);
    for (std::size_t index = 0; index < words.size(); ++index) {
      words[index] &= highest(layout->inputs[index].bytes);
    }
    return outputs.empty() ? outcome : behind_writes(std::move(outcome));
  }
  Exchange exchange;
  prepare(exchange, how);
  exchange.operation = Operation::exchange;
  exchange.address = slot_of(id);
  exchange.outputs = layout->outputs;
  exchange.inputs = layout->inputs;
  exchange.write_values = outputs;
  exchange.values = inputs;
  run(std::span(&exchange, 1));
  return outcome_of(exchange);
}

void Link::release_exchange(std::uint32_t id) {
  const std::scoped_lock lock(mutex_);
  std::shared_ptr<const ExchangeLayout>& layout = exchanges_[slot_of(id)];
  if (!layout || layout->id != id) {
    return;
  }
  if (framed_) {
    framed_->forget_exchange(slot_of(id));
  }
  released_exchanges_.push_back(std::move(layout));
  layout = nullptr;
}

}  // namespace unitylink
