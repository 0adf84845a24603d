/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The variables of the unit: how the importer gets and sets them. What is set is sent with the next step.
 */
#include "unit.h"

/* Returns the place of a value of type `type`, or -1 after telling why there is none. */
static int place_of(unit* self, fmi3ValueReference reference, char type) {
  if (reference >= FIRST_VALUE && reference - FIRST_VALUE < MODEL_VALUES &&
      model_types[reference - FIRST_VALUE] == type)
    return (int)(reference - FIRST_VALUE);
  failed(self, "there is no such variable of this type");
  return -1;
}

static const ul_value* facts_of(int place) { return &MODEL_TABLE.values[place]; }

static fmi3Status given(unit* self, int place, ul_status status) {
  if (status != UL_OK) return not_done(self);
  self->given[place] = true;
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                 fmi3Float64 values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] == TIME) {
      values[i] = self->time_s;
      continue;
    }
    const int place = place_of(self, references[i], 'r');
    if (place < 0) return fmi3Error;
    values[i] = ul_decode_real(facts_of(place), self->raws[place]);
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                 const fmi3Float64 values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    const int place = place_of(self, references[i], 'r');
    if (place < 0) return fmi3Error;
    ul_failure* failure = &self->robot.robot.failure;
    const fmi3Status status =
        given(self, place, ul_encode_real(facts_of(place), values[i], &self->raws[place], failure));
    if (status != fmi3OK) return status;
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetInt64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                               fmi3Int64 values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    const int place = place_of(self, references[i], 'i');
    if (place < 0) return fmi3Error;
    const ul_value* facts = facts_of(place);
    const uint64_t raw = self->raws[place];
    values[i] = facts->kind == UL_KIND_SIGNED ? ul_signed(facts, raw) : (int64_t)(raw & ul_mask(facts->width));
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetInt64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                               const fmi3Int64 values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    const int place = place_of(self, references[i], 'i');
    if (place < 0) return fmi3Error;
    const ul_value* facts = facts_of(place);
    uint64_t* raw = &self->raws[place];
    ul_failure* failure = &self->robot.robot.failure;
    ul_status status = UL_OK;
    if (facts->kind == UL_KIND_SIGNED)
      status = ul_encode_signed(facts, values[i], raw, failure);
    else if (values[i] < 0)
      status = ul_fail_range(facts, (double)values[i], failure);
    else if (facts->kind == UL_KIND_ENUM)
      status = ul_encode_member(facts, (uint64_t)values[i], raw, failure);
    else
      status = ul_encode_unsigned(facts, (uint64_t)values[i], raw, failure);
    if (given(self, place, status) != fmi3OK) return fmi3Error;
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                 fmi3Boolean values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] == PACED) {
      values[i] = self->paced;
      continue;
    }
    const int place = place_of(self, references[i], 'b');
    if (place < 0) return fmi3Error;
    values[i] = (self->raws[place] & 1U) != 0;
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                 const fmi3Boolean values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] == PACED) {
      self->paced = values[i];
      continue;
    }
    const int place = place_of(self, references[i], 'b');
    if (place < 0) return fmi3Error;
    self->raws[place] = values[i] ? 1 : 0;
    self->given[place] = true;
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                fmi3String values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] < URL || references[i] >= FIRST_VALUE) return failed(self, "there is no such text");
    values[i] = self->urls[references[i] - URL];
  }
  return fmi3OK;
}

EXPORT fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                                const fmi3String values[], size_t value_count) {
  (void)value_count;
  unit* self = instance;
  for (size_t i = 0; i < count; ++i) {
    if (references[i] < URL || references[i] >= FIRST_VALUE) return failed(self, "there is no such text");
    if (self->open) return failed(self, "the link is open; its URL is set before the initialization");
    if (strlen(values[i]) >= URL_ROOM) return failed(self, "a link URL of more than 511 characters");
    strcpy(self->urls[references[i] - URL], values[i]);
  }
  return fmi3OK;
}
