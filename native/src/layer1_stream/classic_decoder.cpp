// SPDX-License-Identifier: BSD-3-Clause
#include "layer1_stream/classic_decoder.hpp"

#include <algorithm>

#include "layer1_stream/hex.hpp"

namespace unitylink {
namespace {

using namespace protocol;

constexpr std::string_view error_codes[] = {
    application_error::incomplete_command, application_error::missing_address,    application_error::missing_data,
    application_error::invalid_block_size, application_error::invalid_group_size, application_error::invalid_group,
    application_error::bus_error_read,     application_error::bus_error_write,    application_error::bus_timeout,
    application_error::publish_vanished,
};
constexpr std::uint8_t datalink_code_max = datalink_error::physical + 7;
constexpr std::string_view reply_prefix = "S_";  // all replies except CNF begin with it

std::string_view text_of(std::span<const std::uint8_t> bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_letter(char character) noexcept {
  return (character >= 'A' && character <= 'Z') || (character >= 'a' && character <= 'z') || character == '_';
}

// One byte from two digits. 0x100 or more if one of them is not a digit.
unsigned pair(const std::uint8_t* digits) noexcept {
  const unsigned high = digit_values[digits[0]];
  const unsigned low = digit_values[digits[1]];
  return high << 4 | low | (low & 0xF0u) << 4;
}

}  // namespace

ClassicDecoder::ClassicDecoder(const Crc8& sum) noexcept : sum_(sum), publish_seed_(crc8::initial) {
  for (const char letter : reply::publish) {
    publish_seed_ = sum_.update(publish_seed_, static_cast<std::uint8_t>(letter));
  }
}

// The fast path for a complete publish at the front of the chunk. It returns 0 if there is none, or if anything is
// unusual. Then the slow path decides.
std::size_t ClassicDecoder::take_publish(std::span<const std::uint8_t> chunk) noexcept {
  if (chunk.size() < 10 || (chunk[0] != bytes::checked_publish && chunk[0] != bytes::plain_publish) ||
      std::memcmp(chunk.data() + 1, "PUB:", 4) != 0) {
    return 0;
  }
  switch (data_bytes_) {
    case 1: return take_publish_of<1>(chunk);
    case 2: return take_publish_of<2>(chunk);
    case 3: return take_publish_of<3>(chunk);
    case 4: return take_publish_of<4>(chunk);
    default: return 0;
  }
}

template <unsigned DataBytes>
std::size_t ClassicDecoder::take_publish_of(std::span<const std::uint8_t> chunk) noexcept {
  const std::uint8_t* at = chunk.data() + 5;
  const bool checked = chunk[0] == bytes::checked_publish;
  const unsigned group = pair(at);
  const unsigned count = pair(at + 2);
  if ((group | count) > 0xFF) {
    return 0;
  }
  const std::size_t size = 5 + 4 + std::size_t{2} * DataBytes * count + (checked ? 3u : 0u) + 1;
  if (chunk.size() < size || chunk[size - 1] != bytes::line_feed) {
    return 0;
  }
  std::uint8_t sum =
      sum_.update(sum_.update(publish_seed_, static_cast<std::uint8_t>(group)), static_cast<std::uint8_t>(count));
  unsigned bad = 0;
  at += 4;
  for (unsigned index = 0; index < count; ++index) {
    std::uint32_t word = 0;
    for (unsigned byte = 0; byte < DataBytes; ++byte, at += 2) {
      const unsigned value = pair(at);
      bad |= value;
      sum = sum_.update(sum, static_cast<std::uint8_t>(value));
      word = word << 8 | (value & 0xFF);
    }
    words_[index] = word;
  }
  if (checked) {
    const unsigned told = pair(at + 1);
    bad |= told | (at[0] == bytes::checksum_mark && static_cast<std::uint8_t>(told) == sum ? 0u : 0x100u);
  }
  if (bad > 0xFF) {
    return 0;
  }
  publish_ = {group, count, checked, std::span<const std::uint32_t>(words_.data(), count)};
  return size;
}

ClassicDecoder::Found ClassicDecoder::cut(std::span<const std::uint8_t> body) noexcept {
  if (!is_head(body[0])) {
    return Found::garbage;
  }
  message_ = {};
  message_.kind = MessageKind::malformed;
  message_.head = static_cast<char>(body[0]);
  return Found::message;
}

ClassicDecoder::Found ClassicDecoder::read_message(std::span<const std::uint8_t> body) noexcept {
  if (body.empty()) {
    return Found::garbage;
  }
  message_ = {};
  if (is_head(body[0])) {
    message_.head = static_cast<char>(body[0]);
    return read_headed(body);
  }
  if (text_of(body) == busy_line) {
    message_.kind = MessageKind::busy;
    return Found::message;
  }
  if (body.size() == 3 && body[0] == bytes::error_mark) {
    const unsigned code = pair(body.data() + 1);
    if (code >= datalink_error::message_too_long && code <= datalink_code_max) {
      message_.kind = MessageKind::datalink_error;
      message_.code = static_cast<std::uint8_t>(code);
      return Found::message;
    }
  }
  return Found::garbage;
}

ClassicDecoder::Found ClassicDecoder::read_headed(std::span<const std::uint8_t> body) noexcept {
  const std::string_view text = text_of(body);
  const bool checked = text[0] == bytes::checked_head || text[0] == bytes::checked_publish;
  std::size_t at = 1;
  while (at < text.size() && is_letter(text[at])) {
    ++at;
  }
  message_.letters = text.substr(1, at - 1);
  const bool configuration = message_.letters == reply::read_configuration && !message_.is_publish();
  std::size_t count = 0;
  if (at < text.size() && text[at] == bytes::data_mark) {
    ++at;
    if (configuration) {  // its commas need their own parser: parse_configuration
      const std::size_t begin = at;
      while (at < text.size() && (text[at] == bytes::field_separator || digit_value(text[at]) != not_a_digit)) {
        ++at;
      }
      message_.fields = text.substr(begin, at - begin);
    } else {
      while (at + 1 < text.size()) {
        const unsigned value = pair(body.data() + at);
        if (value > 0xFF) {
          break;
        }
        data_[count++] = static_cast<std::uint8_t>(value);
        at += 2;
      }
    }
  }
  message_.data = std::span<const std::uint8_t>(data_.data(), count);
  if (at < text.size() && text[at] == bytes::error_mark) {
    const std::string_view code = text.substr(at + 1);
    const auto* known = std::find(std::begin(error_codes), std::end(error_codes), code);
    if (known == std::end(error_codes)) {
      return Found::message;  // malformed
    }
    message_.kind = MessageKind::application_error;
    message_.error = *known;
    return Found::message;
  }
  if (message_.letters.empty()) {
    return Found::message;  // malformed: only an error may have no letters
  }
  if (checked) {
    if (at + 3 != text.size() || text[at] != bytes::checksum_mark) {
      return Found::message;
    }
    const unsigned told = pair(body.data() + at + 1);
    if (told > 0xFF) {
      return Found::message;
    }
    message_.checksum = static_cast<std::uint8_t>(told);
    std::uint8_t sum = crc8::initial;
    for (const char letter : message_.letters) {
      sum = sum_.update(sum, static_cast<std::uint8_t>(letter));
    }
    if (!configuration && sum_.of(message_.data, sum) != told) {
      message_.kind = MessageKind::bad_checksum;
      return Found::message;
    }
  } else if (at != text.size()) {
    return Found::message;
  }
  if (message_.is_publish()) {
    return read_publish();
  }
  if (!configuration && !message_.letters.starts_with(reply_prefix)) {
    return Found::message;  // not a reply: a damaged digit can look like a head with a letter after it
  }
  message_.kind = MessageKind::reply;
  return Found::message;
}

ClassicDecoder::Found ClassicDecoder::read_publish() noexcept {
  const std::span<const std::uint8_t> data = message_.data;
  const std::size_t width = data_bytes_ == 0 ? 1 : data_bytes_;
  if (message_.letters != reply::publish || data.size() < 2 || (data.size() - 2) % width != 0) {
    return Found::message;  // malformed
  }
  const std::size_t count = data_bytes_ == 0 ? 0 : (data.size() - 2) / width;
  for (std::size_t index = 0; index < count; ++index) {
    std::uint32_t word = 0;
    for (std::size_t byte = 0; byte < width; ++byte) {
      word = word << 8 | data[2 + index * width + byte];
    }
    words_[index] = word;
  }
  publish_ = {data[0], data[1], message_.checksum.has_value(), std::span<const std::uint32_t>(words_.data(), count)};
  return Found::publish;
}

}  // namespace unitylink
