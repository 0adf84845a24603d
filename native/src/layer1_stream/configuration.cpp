// SPDX-License-Identifier: BSD-3-Clause
#include "layer1_stream/configuration.hpp"

#include <algorithm>
#include <array>

#include "layer1_stream/hex.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {
namespace {

constexpr std::size_t fields_before_frequency = 4;
constexpr std::size_t fields_after_frequency = 3;
constexpr std::size_t frequency_bytes_max = 5;  // four bytes for 32 bits; 256**4 is sent as five

// Reads bytes and separators from the front of the text.
class Cursor {
 public:
  explicit Cursor(std::string_view text) noexcept : text_(text) {}

  [[nodiscard]] bool separator_next() const noexcept {
    return !text_.empty() && text_.front() == protocol::bytes::field_separator;
  }
  bool byte(std::uint8_t& value) noexcept {
    if (separator_next()) {
      value = static_cast<std::uint8_t>(protocol::bytes::field_separator);
      text_.remove_prefix(1);
      return true;
    }
    if (text_.size() < 2 || digit_value(text_[0]) == not_a_digit || digit_value(text_[1]) == not_a_digit) {
      return false;
    }
    value = static_cast<std::uint8_t>(digit_value(text_[0]) << 4 | digit_value(text_[1]));
    text_.remove_prefix(2);
    return true;
  }
  bool separator() noexcept {
    if (!separator_next()) {
      return false;
    }
    text_.remove_prefix(1);
    return true;
  }
  [[nodiscard]] bool done() const noexcept { return text_.empty(); }

 private:
  std::string_view text_;
};

struct ReplyBytes {
  std::array<std::uint8_t, fields_before_frequency + frequency_bytes_max + fields_after_frequency> value{};
  // whether it was sent as ','
  std::array<bool, fields_before_frequency + frequency_bytes_max + fields_after_frequency> as_comma{};

  [[nodiscard]] bool any_as_comma() const noexcept {
    return std::find(as_comma.begin(), as_comma.end(), true) != as_comma.end();
  }
};

bool split(std::string_view text, std::size_t frequency_bytes, ReplyBytes& bytes) noexcept {
  Cursor cursor(text);
  const std::size_t count = fields_before_frequency + frequency_bytes + fields_after_frequency;
  for (std::size_t index = 0; index < count; ++index) {
    const bool inside_frequency = index > fields_before_frequency && index < fields_before_frequency + frequency_bytes;
    if (index > 0 && !inside_frequency && !cursor.separator()) {
      return false;
    }
    bytes.as_comma[index] = cursor.separator_next();
    if (!cursor.byte(bytes.value[index])) {
      return false;
    }
  }
  return cursor.done();
}

// The gateware of 2012 leaves a byte that it sends as ',' out of its checksum. Both ways of counting are accepted.
bool checksum_right(const ReplyBytes& bytes, std::size_t count, const Crc8& sum, std::uint8_t checksum) noexcept {
  std::uint8_t with = protocol::crc8::initial;
  for (const char letter : protocol::reply::read_configuration) {
    with = sum.update(with, static_cast<std::uint8_t>(letter));
  }
  std::uint8_t without = with;
  for (std::size_t index = 0; index < count; ++index) {
    with = sum.update(with, bytes.value[index]);
    without = bytes.as_comma[index] ? without : sum.update(without, bytes.value[index]);
  }
  return with == checksum || without == checksum;
}

bool plausible(const Configuration& configuration) noexcept {
  return configuration.address_bytes >= 1 && configuration.address_bytes <= protocol::limits::address_bits_max / 8 &&
         configuration.data_bytes >= 1 && configuration.data_bytes <= protocol::limits::data_bits_max / 8 &&
         (configuration.publish_mode == 0 ||
          (configuration.rate_bytes >= 1 && configuration.rate_bytes <= protocol::limits::rate_bytes_max &&
           configuration.publish_mode <= 2));
}

}  // namespace

bool has_comma_byte(const Configuration& configuration) noexcept {
  bool has = configuration.read_many == static_cast<std::uint32_t>(protocol::bytes::field_separator);
  for (std::uint64_t rest = configuration.base_hz; rest != 0; rest >>= 8) {
    has = has || (rest & 0xFF) == static_cast<std::uint64_t>(protocol::bytes::field_separator);
  }
  return has;
}

std::optional<Configuration> parse_configuration(std::string_view fields, const Crc8& sum,
                                                 std::optional<std::uint8_t> checksum, bool of_2012) noexcept {
  for (std::size_t length = 1; length <= frequency_bytes_max; ++length) {
    ReplyBytes bytes{};
    if (!split(fields, length, bytes) || (!of_2012 && bytes.any_as_comma())) {
      continue;
    }
    if (checksum && !checksum_right(bytes, fields_before_frequency + length + fields_after_frequency, sum, *checksum)) {
      continue;
    }
    std::uint64_t frequency = 0;
    for (std::size_t index = 0; index < length; ++index) {
      frequency = frequency << 8 | bytes.value[fields_before_frequency + index];
    }
    const std::uint8_t* after = bytes.value.data() + fields_before_frequency + length;
    const Configuration configuration{
        .address_bytes = bytes.value[0],
        .data_bytes = bytes.value[1],
        .read_many = bytes.value[2],
        .publish_mode = bytes.value[3],
        .base_hz = frequency != 0 ? frequency : std::uint64_t{1} << (8 * length),
        .groups = after[0] != 0 || bytes.value[3] == 0 ? after[0] : protocol::limits::groups_max,
        .group_size = after[1],
        .rate_bytes = after[2],
        .discovered = true,
    };
    if (plausible(configuration)) {
      return configuration;
    }
  }
  return std::nullopt;
}

}  // namespace unitylink
