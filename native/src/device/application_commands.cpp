// SPDX-License-Identifier: BSD-3-Clause
// The effect of each request. It happens in the clock in which its last argument was read.
#include <array>

#include "device/application.hpp"

namespace unitylink::device {

namespace bytes = protocol::bytes;
namespace command = protocol::command;
namespace reply = protocol::reply;
namespace error = protocol::application_error;

bool Application::Cursor::take(std::uint32_t count, std::uint32_t& value) noexcept {
  if (data.size() < count) {
    clocks += data.size() + 1;  // the end of the message is read, too
    data = {};
    return false;
  }
  value = 0;
  for (const std::uint8_t byte : data.first(count)) {
    value = value << 8 | byte;
  }
  data = data.subspan(count);
  clocks += count;
  return true;
}

void Application::execute(std::string_view letters, Cursor& cursor) {
  std::uint32_t first = 0;
  if (letters == command::read || letters == command::write) {
    write_ = letters == command::write;
    if (!cursor.take(configuration_.address_bytes(), first)) {
      refuse_missing(error::missing_address);
    } else if (write_ && !cursor.take(configuration_.data_bytes(), write_value_)) {
      refuse_missing(error::missing_data);
    } else {
      address_ = first & configuration_.address_mask();
      after_emit_ = State::single_access;
    }
  } else if (letters == command::read_many) {
    if (!cursor.take(1, first)) {
      refuse_missing(error::missing_data);
    } else if (first == 0 || first > configuration_.read_many) {
      refuse(error::invalid_block_size);
    } else {
      block_words_ = first;
      addresses_.clear();
      next_address_ = 0;
      Cursor rest{cursor.data};  // addresses are read one by one, between the bus accesses
      const std::uint32_t width = configuration_.address_bytes();
      for (std::uint32_t address = 0; addresses_.size() < block_words_ && rest.take(width, address);) {
        addresses_.push_back(address & configuration_.address_mask());
      }
      this->letters(reply::read_many);
      mark(bytes::data_mark);
      after_emit_ = State::block_access;
    }
  } else if (letters == command::read_configuration) {
    read_configuration();
  } else if (letters == command::read_event_mask) {
    this->letters(reply::read_event_mask);
    mark(bytes::data_mark);
    const bool lost = configuration_.published_2012 && configuration_.data_bits <= 16;
    for (std::uint32_t byte = configuration_.mask_bytes(); byte-- > 0;) {
      std::uint32_t bits = 0;
      for (std::uint32_t bit = 0; bit < 8 && byte * 8 + bit < configuration_.groups; ++bit) {
        bits |= (subscriptions_.event_enabled(byte * 8 + bit) ? 1u : 0u) << bit;
      }
      value(lost ? 0 : bits, 1);
    }
    tail();
  } else if (letters == command::write_event_mask) {
    write_event_mask(cursor);
  } else if (letters == command::enable_publishing || letters == command::enable_checked_publishing) {
    checked_publish_ = letters == command::enable_checked_publishing;
    subscriptions_.enable(decision_ + cursor.clocks);
    success(checked_publish_ ? reply::enable_checked_publishing : reply::enable_publishing);
  } else if (letters == command::disable_publishing) {
    subscriptions_.disable(decision_ + cursor.clocks);
    success(reply::disable_publishing);
  } else if (!cursor.take(1, first)) {  // all other requests are about one group
    refuse_missing(error::missing_data);
  } else if (first >= configuration_.groups) {
    refuse(error::invalid_group);
  } else if (letters == command::read_group) {
    read_group(first);
  } else if (letters == command::write_group_addresses) {
    write_group_addresses(first, cursor);
  } else if (std::uint32_t rate = 0; cursor.take(configuration_.rate_bytes, rate)) {
    subscriptions_.set_rate(first, rate, decision_ + cursor.clocks);
    success(reply::write_group_rate);
  } else {
    refuse_missing(error::missing_data);
  }
}

void Application::read_configuration() {
  const bool old = configuration_.published_2012;
  // 2012: a power of 256 is sent with one byte too few
  const std::uint32_t highest = configuration_.base_hz - (old ? 1 : 0);
  std::uint32_t frequency_bytes = 1;
  while (frequency_bytes < 4 && highest >> (8 * frequency_bytes) != 0) {
    ++frequency_bytes;
  }
  letters(reply::read_configuration);
  const std::array<std::array<std::uint32_t, 2>, 8> fields{{{configuration_.address_bytes(), 1},
                                                            {configuration_.data_bytes(), 1},
                                                            {configuration_.read_many, 1},
                                                            {configuration_.publish_mode, 1},
                                                            {configuration_.base_hz, frequency_bytes},
                                                            // one byte: 256 groups are sent as 00
                                                            {configuration_.groups, 1},
                                                            {configuration_.group_size, 1},
                                                            {configuration_.rate_bytes, 1}}};
  char separator = bytes::data_mark;
  for (const auto& [content, width] : fields) {
    mark(separator);
    for (std::uint32_t byte = width; byte-- > 0;) {
      const auto part = static_cast<std::uint8_t>(content >> (8 * byte));
      old&& part == bytes::field_separator ? mark(bytes::field_separator) : value(part, 1);
    }
    separator = bytes::field_separator;
  }
  tail();
}

void Application::write_group_addresses(std::uint32_t group, Cursor& cursor) {
  std::uint32_t count = 0;
  if (!cursor.take(1, count)) {
    refuse_missing(error::missing_data);
    return;
  }
  if (count == 0 || count > configuration_.group_size) {
    refuse(error::invalid_group_size);
    return;
  }
  addresses_.clear();
  for (std::uint32_t address = 0; addresses_.size() < count;) {
    if (!cursor.take(configuration_.address_bytes(), address)) {
      refuse_missing(error::missing_address);  // the group is not changed
      // 2012: the group gets the new count, but only the addresses that were received
      if (configuration_.published_2012) {
        subscriptions_.set_part(group, count, addresses_, decision_ + cursor.clocks);
        // without a message buffer the group has lost its addresses
      } else if (configuration_.datalink != Datalink::full) {
        addresses_.clear();
        subscriptions_.set_addresses(group, addresses_, decision_ + cursor.clocks);
      }
      return;
    }
    addresses_.push_back(address & configuration_.address_mask());
    ++cursor.clocks;
  }
  subscriptions_.set_addresses(group, addresses_, decision_ + cursor.clocks);
  success(reply::write_group_addresses);
}

void Application::write_event_mask(Cursor& cursor) {
  std::array<std::uint8_t, protocol::limits::groups_max / 8> mask{};
  for (std::uint32_t group = 0; group < configuration_.groups; ++group) {
    mask[group / 8] |= static_cast<std::uint8_t>((subscriptions_.event_enabled(group) ? 1u : 0u) << group % 8);
  }
  std::uint32_t bits = 0;
  std::uint32_t left = configuration_.mask_bytes();
  while (left > 0 && cursor.take(1, bits)) {
    mask[--left] = static_cast<std::uint8_t>(bits);
  }
  // without a message buffer, the bytes that were received take effect
  if (left == 0 || configuration_.datalink != Datalink::full) {
    subscriptions_.enable_events(mask, decision_ + cursor.clocks);
  }
  if (left == 0) {
    success(reply::write_event_mask);
  } else {
    refuse_missing(error::missing_data);
  }
}

void Application::read_group(std::uint32_t group) {
  const std::span<const std::uint32_t> addresses = subscriptions_.addresses(group);
  letters(reply::read_group);
  mark(bytes::data_mark);
  value(subscriptions_.rate(group), configuration_.rate_bytes);
  value(static_cast<std::uint32_t>(addresses.size()), 1);
  for (const std::uint32_t address : addresses) {
    value(address, configuration_.address_bytes());
  }
  tail();
}

}  // namespace unitylink::device
