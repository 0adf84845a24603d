// SPDX-License-Identifier: BSD-3-Clause
#include "device/framed/frame_request.hpp"

#include <algorithm>

namespace unitylink::device {

namespace kind_of = protocol::request_kind;
namespace list = protocol::list_operation;

namespace {

constexpr std::uint8_t write_bit = 0x10;

bool known(std::uint8_t operation) noexcept {
  return operation == list::read || operation == list::read_up || operation == list::read_fifo ||
         (operation >= list::write && operation <= list::add);
}

}  // namespace

bool FrameRequest::parse_list(Fields& fields, Widths widths) {
  words.clear();
  while (!fields.empty()) {
    ListWord word;
    word.operation = static_cast<std::uint8_t>(fields.take(1));
    const std::uint32_t count = fields.take(1);
    if (!known(word.operation) || count == 0) {
      return false;
    }
    const auto shape = static_cast<std::uint8_t>(word.operation & ~write_bit);
    const bool together = shape == list::read_up || shape == list::read_fifo;
    word.address = together ? fields.take(widths.address_bytes) : 0;
    for (std::uint32_t index = 0; index < count; ++index) {
      if (!together) {
        word.address = fields.take(widths.address_bytes);
      } else if (shape == list::read_up && index > 0) {
        ++word.address;
      }
      word.mask = word.operation == list::write_masked ? fields.take(widths.data_bytes) : 0;
      word.value = word.writes() ? fields.take(widths.data_bytes) : 0;
      words.push_back(word);
    }
  }
  return !words.empty() && fields.ended_well();
}

bool FrameRequest::parse(std::uint8_t kind, std::span<const std::uint8_t> payload, Widths widths) {
  Fields fields(payload);
  operation = static_cast<std::uint8_t>(kind & ~(protocol::frame::chained_bit | protocol::frame::barrier_bit));
  id = static_cast<std::uint16_t>(fields.take(2));
  chained = (kind & protocol::frame::chained_bit) != 0;
  barrier.reset();
  if ((kind & protocol::frame::barrier_bit) != 0) {
    barrier = static_cast<std::uint16_t>(fields.take(2));
  }
  words.clear();
  switch (operation) {
    case kind_of::read: address = fields.take(widths.address_bytes); break;
    case kind_of::write:
      address = fields.take(widths.address_bytes);
      value = fields.take(widths.data_bytes);
      break;
    case kind_of::list:
      flags = static_cast<std::uint8_t>(fields.take(1));
      if ((flags & ~protocol::frame::atomic_flag) != 0 || !parse_list(fields, widths)) {
        return false;
      }
      break;
    case kind_of::exchange:
      address = fields.take(1);
      data = fields.rest();
      break;
    case kind_of::read_control:
      address = fields.take(2);
      value = fields.take(1);
      if (value == 0) {
        return false;
      }
      break;
    case kind_of::write_control:
      address = fields.take(2);
      value = fields.take(4);
      break;
    case kind_of::define_group: {
      address = fields.take(1);
      value = fields.take(4);
      flags = static_cast<std::uint8_t>(fields.take(1));
      const std::uint32_t count = fields.take(1);
      addresses.clear();
      for (std::uint32_t index = 0; index < count; ++index) {
        addresses.push_back(fields.take(widths.address_bytes));
      }
      if ((flags & ~protocol::frame::event_flag) != 0) {
        return false;
      }
      break;
    }
    case kind_of::define_exchange: {
      address = fields.take(1);
      outputs = fields.take(1);
      const std::size_t count = outputs + fields.take(1);
      members.clear();
      for (std::size_t index = 0; index < count; ++index) {
        const std::uint32_t word = fields.take(widths.address_bytes);
        members.push_back({word, fields.take(1)});
      }
      if (std::any_of(members.begin(), members.end(),
                      [widths](const ExchangeWord& m) { return m.bytes == 0 || m.bytes > widths.data_bytes; })) {
        return false;
      }
      break;
    }
    case kind_of::sync:
    case kind_of::close: break;
    default: return false;
  }
  return fields.ended_well();
}

bool FrameRequest::parse_post(std::uint8_t kind, std::span<const std::uint8_t> payload, Widths widths) {
  Fields fields(payload);
  operation = kind;
  id = static_cast<std::uint16_t>(fields.take(2));
  if (kind == kind_of::post) {
    const std::uint32_t where = fields.take(widths.address_bytes);
    const std::uint32_t what = fields.take(widths.data_bytes);
    words.assign(1, {static_cast<std::uint8_t>(list::write), where, what, 0});
    return fields.ended_well();
  }
  return parse_list(fields, widths) &&
         std::all_of(words.begin(), words.end(), [](const ListWord& word) { return word.writes(); });
}

}  // namespace unitylink::device
