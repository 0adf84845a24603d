/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The facts of one value of a spec, and the conversion between raw numbers and values. For the headers that
 * `unitylink generate --only c` and `--only cpp` write. C11 and C++20. It allocates nothing.
 *
 * A value is raw * scale + offset, in its unit. The raw number has `width` bits and lies in `words` words of the bus,
 * the low word first.
 */
#ifndef UNITYLINK_VALUE_H
#define UNITYLINK_VALUE_H

#include <unitylink.h>

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How the raw number is read. */
enum { UL_KIND_UNSIGNED, UL_KIND_SIGNED, UL_KIND_REAL, UL_KIND_SCALED, UL_KIND_BOOL, UL_KIND_ENUM, UL_KIND_BITS };
/* Facts that are true or false. */
enum {
  UL_VALUE_SIGNED = 1,       /* the raw number is two's complement */
  UL_VALUE_SATURATE = 2,     /* a value beyond the limits is replaced by the limit */
  UL_VALUE_CHECKED = 4,      /* its requests have a checksum */
  UL_VALUE_READ_AGAIN = 8,   /* reading it twice does no harm */
  UL_VALUE_WRITE_AGAIN = 16, /* writing it twice does no harm */
  UL_VALUE_OPEN = 32,        /* an enumeration that takes other numbers, too */
  UL_VALUE_FRAMES = 64       /* it has a SAFE value or is a PULSE, which needs the framed protocol */
};

typedef struct {
  const char* path;
  const char* unit;
  uint32_t address; /* of the low word; of a field the number of its lowest bit */
  uint8_t kind;
  uint8_t width; /* bits */
  uint8_t words;
  uint8_t flags;
  uint8_t link;   /* which link of the robot */
  int16_t memory; /* which committed memory of the robot; -1: none */
  uint16_t slot;  /* of an output: the place of its low word in this memory */
  uint64_t low;   /* the smallest raw number that may be written; of a signed type in two's complement of 64 bits */
  uint64_t high;  /* the largest one */
  double scale, offset;
  double multiplier, added, divisor; /* value = (raw * multiplier + added) / divisor; divisor 0: use scale and offset */
  double minimum, maximum;           /* of a real number, and for messages */
  const uint64_t* members;           /* the numbers of an enumeration */
  uint16_t member_count;
} ul_value;

/* Why a call failed. `path` is the name of the value, group or robot. `text` is for people. */
typedef struct {
  ul_status status;
  const char* path;
  char text[640];
} ul_failure;

/* Fills in a failure, and returns its status. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
static inline ul_status ul_fail(ul_failure* failure, ul_status status, const char* path, const char* format, ...) {
  va_list parts;
  int begin;
  failure->status = status;
  failure->path = path;
  begin = snprintf(failure->text, sizeof failure->text, "%s: ", path);
  if (begin >= 0 && (size_t)begin < sizeof failure->text) {
    va_start(parts, format);
    vsnprintf(failure->text + begin, sizeof failure->text - (size_t)begin, format, parts);
    va_end(parts);
  }
  return status;
}

/* The failure of a call of unitylink.h, with the name of the value. */
static inline ul_status ul_fail_link(ul_failure* failure, ul_status status, const char* path) {
  return status == UL_OK ? UL_OK : ul_fail(failure, status, path, "%s", ul_last_error_text());
}

static inline ul_status ul_fail_range(const ul_value* value, double given, ul_failure* failure) {
  const char* blank = *value->unit != '\0' ? " " : "";
  return ul_fail(failure, UL_RANGE, value->path, "%.9g%s%s is not in %.9g to %.9g%s%s; nothing was sent", given, blank,
                 value->unit, value->minimum, value->maximum, blank, value->unit);
}

static inline uint64_t ul_mask(unsigned width) { return width >= 64 ? UINT64_MAX : (UINT64_C(1) << width) - 1U; }

/* The raw number as its type reads it, for signed types. */
static inline int64_t ul_signed(const ul_value* value, uint64_t raw) {
  const uint64_t sign = UINT64_C(1) << (value->width - 1U);
  return (int64_t)(((raw & ul_mask(value->width)) ^ sign) - sign);
}

/* ---- whole numbers */

static inline ul_status ul_encode_signed(const ul_value* value, int64_t number, uint64_t* raw, ul_failure* failure) {
  const bool low = number < (int64_t)value->low;
  const bool high = number > (int64_t)value->high;
  if ((low || high) && (value->flags & UL_VALUE_SATURATE) == 0) return ul_fail_range(value, (double)number, failure);
  *raw = (low ? value->low : high ? value->high : (uint64_t)number) & ul_mask(value->width);
  return UL_OK;
}

static inline ul_status ul_encode_unsigned(const ul_value* value, uint64_t number, uint64_t* raw, ul_failure* failure) {
  const bool low = number < value->low;
  const bool high = number > value->high;
  if ((low || high) && (value->flags & UL_VALUE_SATURATE) == 0) return ul_fail_range(value, (double)number, failure);
  *raw = low ? value->low : high ? value->high : number;
  return UL_OK;
}

/* ---- numbers of enumerations */

static inline bool ul_is_member(const ul_value* value, uint64_t number) {
  for (uint16_t i = 0; i < value->member_count; ++i) {
    if (value->members[i] == number) return true;
  }
  return (value->flags & UL_VALUE_OPEN) != 0 && number <= ul_mask(value->width);
}

static inline ul_status ul_encode_member(const ul_value* value, uint64_t number, uint64_t* raw, ul_failure* failure) {
  if (!ul_is_member(value, number))
    return ul_fail(failure, UL_RANGE, value->path, "%llu is not one of its numbers; nothing was sent",
                   (unsigned long long)number);
  *raw = number;
  return UL_OK;
}

static inline ul_status ul_decode_member(const ul_value* value, uint64_t raw, uint64_t* number, ul_failure* failure) {
  *number = raw & ul_mask(value->width);
  if (ul_is_member(value, *number)) return UL_OK;
  return ul_fail(failure, UL_PROTOCOL_ERROR, value->path,
                 "the device holds %llu, which is not one of its numbers; if others may come, declare an open enum",
                 (unsigned long long)*number);
}

/* ---- real numbers, and whole numbers with a scale */

static inline double ul_decode_real(const ul_value* value, uint64_t raw) {
  double real = 0.0;
  if (value->kind == UL_KIND_SCALED) {
    real =
        (value->flags & UL_VALUE_SIGNED) != 0 ? (double)ul_signed(value, raw) : (double)(raw & ul_mask(value->width));
    return value->divisor != 0.0 ? (real * value->multiplier + value->added) / value->divisor
                                 : real * value->scale + value->offset;
  }
  if (value->width == 32) {
    const uint32_t word = (uint32_t)raw;
    float single = 0.0F;
    memcpy(&single, &word, sizeof single);
    real = (double)single;
  } else {
    memcpy(&real, &raw, sizeof real);
  }
  return value->scale == 1.0 && value->offset == 0.0 ? real : real * value->scale + value->offset; /* -0 stays -0 */
}

static inline ul_status ul_encode_scaled(const ul_value* value, double wanted, uint64_t* raw, ul_failure* failure) {
  const bool is_signed = (value->flags & UL_VALUE_SIGNED) != 0;
  const double number = nearbyint((wanted - value->offset) / value->scale);
  const double end = ldexp(1.0, is_signed ? 63 : 64); /* numbers from here on do not fit 64 bits */
  bool low = number < (is_signed ? -end : 0.0);
  bool high = number >= end;
  uint64_t bits = 0;
  if (isnan(number)) return ul_fail_range(value, wanted, failure);
  if (!low && !high) {
    bits = is_signed ? (uint64_t)(int64_t)number : (uint64_t)number;
    low = is_signed ? (int64_t)bits < (int64_t)value->low : bits < value->low;
    high = is_signed ? (int64_t)bits > (int64_t)value->high : bits > value->high;
  }
  if ((low || high) && (value->flags & UL_VALUE_SATURATE) == 0) return ul_fail_range(value, wanted, failure);
  *raw = (low ? value->low : high ? value->high : bits) & ul_mask(value->width);
  return UL_OK;
}

/* A set-point is never NaN or infinite. */
static inline ul_status ul_encode_real(const ul_value* value, double wanted, uint64_t* raw, ul_failure* failure) {
  const bool saturates = (value->flags & UL_VALUE_SATURATE) != 0;
  const double most = value->width == 32 ? (double)FLT_MAX : DBL_MAX;
  double number = wanted;
  if (value->kind == UL_KIND_SCALED) return ul_encode_scaled(value, wanted, raw, failure);
  if (!(value->minimum <= wanted && wanted <= value->maximum)) {
    if (isnan(wanted) || !saturates) return ul_fail_range(value, wanted, failure);
    number = wanted < value->minimum ? value->minimum : value->maximum;
  }
  number = (number - value->offset) / value->scale;
  if (value->width == 32) {
    float single;
    uint32_t word = 0;
    /* the largest number that is rounded to a finite one lies half a step above FLT_MAX */
    if (fabs(number) >= most + ldexp(1.0, 103)) {
      if (!saturates) return ul_fail_range(value, wanted, failure);
      number = copysign(most, number);
    }
    single = fabs(number) > most ? copysignf(FLT_MAX, number < 0.0 ? -1.0F : 1.0F) : (float)number;
    memcpy(&word, &single, sizeof word);
    *raw = word;
    return UL_OK;
  }
  if (isinf(number)) {
    if (!saturates) return ul_fail_range(value, wanted, failure);
    number = copysign(most, number);
  }
  memcpy(raw, &number, sizeof *raw);
  return UL_OK;
}

/* ---- words */

static inline void ul_split(const ul_value* value, unsigned data_bits, uint64_t raw, uint32_t* words) {
  for (unsigned i = 0; i < value->words; ++i) words[i] = (uint32_t)(raw >> (i * data_bits) & ul_mask(data_bits));
}

static inline uint64_t ul_join(const ul_value* value, unsigned data_bits, const uint32_t* words) {
  uint64_t raw = 0;
  for (unsigned i = 0; i < value->words; ++i) raw |= (uint64_t)words[i] << (i * data_bits);
  return raw & ul_mask(value->width);
}

#ifdef __cplusplus
}
#endif

#endif
