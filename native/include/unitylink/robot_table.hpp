// SPDX-License-Identifier: BSD-3-Clause
//
// The tables of a generated node: the values of the spec, the groups that are published together, and the memory that
// needs a commit. Also the conversion between words and numbers. C++17; it allocates nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace unitylink {

// A value of the spec. Its number in its unit is raw * scale + offset. If whole numbers express this, it is (raw *
// multiplier + added) / divisor, because 1254 * 0.01 is 12.540000000000001, but 1254 / 100 is 12.54. NaN means no
// limit, or no safe value. The limits of a float are numbers in its unit. All other limits are raw, so a value that was
// read can be written again.
struct Value {
  const char* path;
  std::uint32_t address;
  std::uint8_t words;  // number of words; the low word is at `address`
  std::uint8_t width;  // bits
  bool is_signed;
  bool is_float;  // IEEE 754, 32 or 64 bits
  bool writable;
  bool saturate;     // a number beyond the limits is replaced by the limit
  std::int8_t unit;  // index in `Table::units`; -1: it needs no commit
  double scale, offset;
  double multiplier, added, divisor;  // divisor 0: use scale and offset
  double minimum, maximum, safe;
  // for a closed enumeration with numbers below 64: one bit for each allowed number; 0: all numbers within the limits
  // are allowed
  std::uint64_t members;
};

// Values that the gateware publishes together. `divisor` 0 means on an event. If `polled`, the PC reads them at
// `divisor`.
struct Group {
  const std::uint16_t* values;
  std::size_t count;
  std::uint32_t divisor;
  bool polled;
};

// Memory whose outputs take effect by a commit. The commit swaps its buffers without copying, so it needs all outputs.
struct Unit {
  std::uint32_t commit;   // the address of the commit; on TosNet also of the status word
  std::uint32_t pending;  // bits of the status word; 0: there is no status word
  std::uint32_t aborted, online, halted;
};

struct Table {
  const char* robot;
  const char* spec;               // the file name of the spec
  const std::uint64_t* gateware;  // the wire hashes that gateware of this spec may have
  std::size_t gateware_count;
  std::uint32_t data_bits;
  const Value* values;
  std::size_t value_count;
  const Group* groups;
  std::size_t group_count;
  const Unit* units;
  std::size_t unit_count;
  // "arm.speed has a SAFE value", for the first value that needs frames (SAFE or PULSE); "": none
  const char* asks_for_frames;
};

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// The raw number in its type, without scale.
inline std::int64_t whole(const Value& value, std::uint64_t raw) noexcept {
  const unsigned unused = 64U - value.width;
  return value.is_signed ? static_cast<std::int64_t>(raw << unused) >> unused
                         : static_cast<std::int64_t>(raw << unused >> unused);
}

// The number in its unit.
inline double number(const Value& value, std::uint64_t raw) noexcept {
  if (value.is_float) {
    double real = 0.0;
    if (value.width == 32) {
      const auto word = static_cast<std::uint32_t>(raw);
      float single = 0.0F;
      std::memcpy(&single, &word, sizeof single);
      real = static_cast<double>(single);
    } else {
      std::memcpy(&real, &raw, sizeof real);
    }
    return value.scale == 1.0 && value.offset == 0.0 ? real : real * value.scale + value.offset;  // -0 stays -0
  }
  const std::int64_t signed_raw = whole(value, raw);
  const double exact =
      value.is_signed ? static_cast<double>(signed_raw) : static_cast<double>(static_cast<std::uint64_t>(signed_raw));
  return value.divisor != 0.0 ? (exact * value.multiplier + value.added) / value.divisor
                              : exact * value.scale + value.offset;
}

// Gets the raw number of a float. Returns false if there is none.
inline bool encode_float(const Value& value, double wanted, std::uint64_t& raw) noexcept {
  const bool low = wanted < value.minimum;  // false if the limit is NaN
  const bool high = wanted > value.maximum;
  if ((low || high) && !value.saturate) return false;
  double scaled = ((low ? value.minimum : high ? value.maximum : wanted) - value.offset) / value.scale;
  const double most =
      value.width == 32 ? static_cast<double>(std::numeric_limits<float>::max()) : std::numeric_limits<double>::max();
  if (!(std::fabs(scaled) <= most)) {  // a set-point is never infinite, not even after rounding to 32 bits
    if (!value.saturate) return false;
    scaled = std::copysign(most, scaled);
  }
  if (value.width == 32) {
    const auto single = static_cast<float>(scaled);
    std::uint32_t word = 0;
    std::memcpy(&word, &single, sizeof word);
    raw = word;
  } else {
    std::memcpy(&raw, &scaled, sizeof raw);
  }
  return true;
}

// Gets the raw number to be written. If there is none, it returns false and leaves `raw` as it is. Python does the
// same.
inline bool encode(const Value& value, double wanted, std::uint64_t& raw) noexcept {
  if (std::isnan(wanted)) return false;
  if (value.is_float) return encode_float(value, wanted, raw);
  const double rounded = std::nearbyint((wanted - value.offset) / value.scale);
  const bool unscaled = value.scale == 1.0 && value.offset == 0.0;
  // without a scale, only whole numbers are allowed
  if (unscaled && (rounded != wanted || std::isinf(wanted))) return false;
  const double top = std::ldexp(1.0, value.is_signed ? value.width - 1 : value.width);
  const double bottom = value.is_signed ? -top : 0.0;
  const bool low = rounded < bottom || rounded < value.minimum, high = rounded >= top || rounded > value.maximum;
  if ((low || high) && !value.saturate) return false;
  if (value.members != 0 && (value.members >> static_cast<unsigned>(rounded) & 1U) == 0) return false;
  const double fitting = low    ? std::fmax(bottom, value.minimum)
                         : high ? std::fmin(std::nextafter(top, 0.0), value.maximum)
                                : rounded;
  const std::uint64_t bits = fitting < 0.0 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(fitting))
                                           : static_cast<std::uint64_t>(fitting);
  raw = value.width == 64 ? bits : bits & ((std::uint64_t{1} << value.width) - 1U);
  return true;
}

}  // namespace unitylink
