/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Raw numbers as values of MATLAB, and back. A number is a double; only a whole number of more than 53 bits is an int64
 * or a uint64. A flag is logical, and a packed value is a struct.
 */
#ifndef UNITYLINK_MEX_CONVERSION_H
#define UNITYLINK_MEX_CONVERSION_H

#include "facts.h"

enum { DOUBLE_BITS = 53 }; /* the widest whole numbers that a double holds */

/* A column of values: `count` raw numbers, `step` apart. */
static mxArray* column(const ul_value* value, const fields* packed, const uint64_t* raws, size_t count, size_t step) {
  const bool wide = value->width > DOUBLE_BITS;
  mxArray* made;
  ul_failure failure;
  if (value->kind == UL_KIND_BITS && packed != NULL) {
    uint64_t* part = (uint64_t*)mxMalloc((count > 0 ? count : 1) * sizeof *part);
    made = mxCreateStructMatrix(count, 1, (int)packed->count, (const char**)packed->names);
    for (uint32_t i = 0; i < packed->count; ++i) {
      const ul_value* field = &packed->facts[i];
      for (size_t n = 0; n < count; ++n) part[n] = raws[n * step] >> field->address & ul_mask(field->width);
      for (size_t n = 0; n < count; ++n)
        mxSetFieldByNumber(made, n, (int)i, column(field, packed->inner[i], part + n, 1, 1));
    }
    mxFree(part);
    return made;
  }
  if (value->kind == UL_KIND_BOOL) {
    made = mxCreateLogicalMatrix(count, 1);
    for (size_t n = 0; n < count; ++n) mxGetLogicals(made)[n] = (raws[n * step] & 1U) != 0;
    return made;
  }
  if (wide && value->kind == UL_KIND_SIGNED) {
    made = mxCreateNumericMatrix(count, 1, mxINT64_CLASS, mxREAL);
    for (size_t n = 0; n < count; ++n) ((int64_t*)mxGetData(made))[n] = ul_signed(value, raws[n * step]);
    return made;
  }
  if (wide && value->kind != UL_KIND_REAL && value->kind != UL_KIND_SCALED) {
    made = mxCreateNumericMatrix(count, 1, mxUINT64_CLASS, mxREAL);
    for (size_t n = 0; n < count; ++n) {
      uint64_t number = raws[n * step] & ul_mask(value->width);
      if (value->kind == UL_KIND_ENUM && ul_decode_member(value, number, &number, &failure) != UL_OK)
        raise_text(failure.status, failure.text);
      ((uint64_t*)mxGetData(made))[n] = number;
    }
    return made;
  }
  made = mxCreateDoubleMatrix(count, 1, mxREAL);
  for (size_t n = 0; n < count; ++n) {
    const uint64_t raw = raws[n * step];
    uint64_t number = raw & ul_mask(value->width);
    double real = (double)number;
    if (value->kind == UL_KIND_REAL || value->kind == UL_KIND_SCALED) real = ul_decode_real(value, raw);
    if (value->kind == UL_KIND_SIGNED) real = (double)ul_signed(value, raw);
    if (value->kind == UL_KIND_ENUM && ul_decode_member(value, raw, &number, &failure) != UL_OK)
      raise_text(failure.status, failure.text);
    mxGetPr(made)[n] = real;
  }
  return made;
}

/* A whole number as its sign and its size. A double must have no part after the point. */
static ul_status whole_of(const ul_value* value, const mxArray* given, bool* negative, uint64_t* size,
                          ul_failure* failure) {
  const double end = ldexp(1.0, 64);
  double real;
  if (mxIsUint64(given)) {
    *negative = false;
    *size = *(const uint64_t*)mxGetData(given);
    return UL_OK;
  }
  if (mxIsInt64(given)) {
    const int64_t number = *(const int64_t*)mxGetData(given);
    *negative = number < 0;
    *size = number < 0 ? 0U - (uint64_t)number : (uint64_t)number;
    return UL_OK;
  }
  real = mxGetScalar(given);
  if (isnan(real) || (real != floor(real) && !isinf(real)))
    return ul_fail(failure, UL_RANGE, value->path, "%.9g is no whole number; nothing was sent", real);
  *negative = real < 0.0;
  *size = fabs(real) >= end ? UINT64_MAX : (uint64_t)fabs(real);
  if (fabs(real) >= end && (value->flags & UL_VALUE_SATURATE) == 0) return ul_fail_range(value, real, failure);
  return UL_OK;
}

static ul_status encode(const ul_value* value, const fields* packed, const mxArray* given, uint64_t* raw,
                        ul_failure* failure);

static ul_status encode_fields(const ul_value* value, const fields* packed, const mxArray* given, uint64_t* raw,
                               ul_failure* failure) {
  if (!mxIsStruct(given) || mxGetNumberOfElements(given) != 1)
    return ul_fail(failure, UL_ARGUMENT, value->path, "it is a packed value, so give a struct with its fields");
  *raw = 0;
  for (uint32_t i = 0; i < packed->count; ++i) {
    const ul_value* field = &packed->facts[i];
    const mxArray* part = mxGetField(given, 0, packed->names[i]);
    uint64_t bits = 0;
    ul_status status;
    if (part == NULL)
      return ul_fail(failure, UL_ARGUMENT, value->path, "the field '%s' is missing in the struct; nothing was sent",
                     packed->names[i]);
    status = encode(field, packed->inner[i], part, &bits, failure);
    if (status != UL_OK) return status;
    *raw |= (bits & ul_mask(field->width)) << field->address;
  }
  return UL_OK;
}

static ul_status encode(const ul_value* value, const fields* packed, const mxArray* given, uint64_t* raw,
                        ul_failure* failure) {
  const uint64_t top = UINT64_C(1) << 63;
  bool negative = false;
  uint64_t size = 0;
  ul_status status;
  if (value->kind == UL_KIND_BITS && packed != NULL) return encode_fields(value, packed, given, raw, failure);
  if (!(mxIsNumeric(given) || mxIsLogical(given)) || mxIsComplex(given) || mxGetNumberOfElements(given) != 1)
    return ul_fail(failure, UL_ARGUMENT, value->path, "it takes one number, not a %s of %u elements",
                   mxGetClassName(given), (unsigned)mxGetNumberOfElements(given));
  if (value->kind == UL_KIND_REAL || value->kind == UL_KIND_SCALED)
    return ul_encode_real(value, mxGetScalar(given), raw, failure);
  status = whole_of(value, given, &negative, &size, failure);
  if (status != UL_OK) return status;
  if (value->kind == UL_KIND_SIGNED) {
    const uint64_t kept = negative ? (size > top ? top : size) : (size >= top ? top - 1U : size);
    if (kept != size && (value->flags & UL_VALUE_SATURATE) == 0)
      return ul_fail_range(value, negative ? -(double)size : (double)size, failure);
    return ul_encode_signed(value, negative ? (int64_t)(0U - kept) : (int64_t)kept, raw, failure);
  }
  if (negative && size > 0) {
    if ((value->flags & UL_VALUE_SATURATE) == 0 || value->kind != UL_KIND_UNSIGNED)
      return ul_fail_range(value, -(double)size, failure);
    size = 0;
  }
  if (value->kind == UL_KIND_ENUM) return ul_encode_member(value, size, raw, failure);
  if (value->kind == UL_KIND_BOOL && size > 1)
    return ul_fail(failure, UL_RANGE, value->path, "it is true or false, and %.9g was given; nothing was sent",
                   (double)size);
  if (value->kind == UL_KIND_BOOL) {
    *raw = size;
    return UL_OK;
  }
  return ul_encode_unsigned(value, size, raw, failure);
}

#endif
